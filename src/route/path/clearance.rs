//! The largest fillet of a corner that keeps a distance from barriers, in closed form.
//!
//! Fillets of one corner are copies of each other, scaled about the corner. With a radius that grows from 0 they
//! sweep the wedge between the legs, and the part of the wedge beyond a fillet is convex. A surface inflated by the
//! reach of a body is convex too (a disc, or a stadium around an edge). So the first fillet that meets it either
//! meets it on a leg, or meets one of its round ends from outside: |V - C(R)| = R - reach for the end V of an edge,
//! or the centre V of a disc with a reach that is larger by its radius. In the wedge a is the part of V - B along the
//! bisector, c = cos(delta / 2), t = tan(delta / 2), and h, k are the distances of V from the legs; then
//!
//!   t² R² - 2 (a/c - reach) R + |V - B|² - reach² = 0,  R = ((a/c - reach) + sqrt((h - reach) (k - reach)) / c) / t².
//!
//! The smaller solution has the disc at the far side of the circle.

use super::fillet::Corner;
use crate::base::geometry::{Segment, Vec2, cross};
use crate::model::sight::ROUNDING;
use crate::model::{Piece as Surface, Sight};

/// The largest radius up to `limit`, m, for which fillets keep `reach` from all barriers. It is 0 where the corner
/// itself does not.
pub(super) fn largest_radius(corner: &Corner, limit: f64, reach: f64, sight: &Sight) -> f64 {
    let cut = limit * corner.tangent();
    let ends = [corner.at - corner.before * cut, corner.at + corner.after * cut];
    let (low, high) =
        ends.iter().fold((corner.at, corner.at), |(low, high), end| (low.inf(end), high.sup(end)));
    let half = 0.5 * (high - low);
    let near = sight.near(low + half, half.x.max(half.y) + reach);
    // No fillet up to the limit leaves the disc of the tangent length around the corner.
    let near = near.iter().filter(|surface| surface.distance(corner.at) < cut + reach);
    near.fold(limit, |radius, surface| radius.min(until(corner, surface, reach)))
}

/// The radius from which on fillets come nearer than `reach` to a surface, m.
pub(super) fn until(corner: &Corner, surface: &Surface, reach: f64) -> f64 {
    match surface {
        Surface::Disc { centre, radius } => until_disc(corner, *centre, radius + reach),
        Surface::Edge(edge) => {
            let ends = until_disc(corner, edge.a, reach).min(until_disc(corner, edge.b, reach));
            ends.min(until_band(corner, edge, reach))
        }
    }
}

/// The directions of the legs, away from the corner.
fn legs(corner: &Corner) -> [Vec2; 2] {
    [-corner.before, corner.after]
}

/// As [`until`], of a disc of radius `reach` around a point.
pub(super) fn until_disc(corner: &Corner, v: Vec2, reach: f64) -> f64 {
    let v = v - corner.at;
    let least = reach - ROUNDING;
    let beside = [corner.before, corner.after].map(|along| corner.side * cross(along, v));
    let tangent = corner.tangent();
    if v.norm() < least {
        0.0
    } else if beside.iter().all(|&distance| distance >= least) {
        let [h, k] = beside.map(|distance| (distance - reach).max(0.0));
        let ahead = v.dot(&corner.inward) / corner.cos - reach;
        (ahead + (h * k).sqrt() / corner.cos) / (tangent * tangent)
    } else {
        // The first place of a leg that is within reach.
        let enters = |(leg, distance): (Vec2, f64)| {
            let foot = leg.dot(&v);
            let is_met = distance.abs() < least && foot > 0.0;
            if is_met {
                (foot - (reach * reach - distance * distance).sqrt()).max(0.0)
            } else {
                f64::INFINITY
            }
        };
        let [first, second] = legs(corner);
        enters((first, beside[0])).min(enters((second, beside[1]))) / tangent
    }
}

/// As [`until`], of the places beside an edge that are within reach. Between the legs the ends of the edge are met
/// before them.
fn until_band(corner: &Corner, edge: &Segment, reach: f64) -> f64 {
    let length = edge.length();
    if length <= 0.0 {
        return f64::INFINITY;
    }
    let along = (edge.b - edge.a) / length;
    let from = corner.at - edge.a;
    let enters = |leg: Vec2| {
        let beside = inside(cross(along, from), cross(along, leg), ROUNDING - reach, reach - ROUNDING);
        let between = inside(along.dot(&from), along.dot(&leg), 0.0, length);
        let (enters, leaves) = (beside.0.max(between.0).max(0.0), beside.1.min(between.1));
        if enters < leaves { enters } else { f64::INFINITY }
    };
    let [first, second] = legs(corner);
    enters(first).min(enters(second)) / corner.tangent()
}

/// Between which s the value of `at + s slope` lies between `low` and `high`.
fn inside(at: f64, slope: f64, low: f64, high: f64) -> (f64, f64) {
    if slope == 0.0 {
        let is_inside = low < at && at < high;
        return if is_inside {
            (f64::NEG_INFINITY, f64::INFINITY)
        } else {
            (f64::INFINITY, f64::NEG_INFINITY)
        };
    }
    let (a, b) = ((low - at) / slope, (high - at) / slope);
    (a.min(b), a.max(b))
}
