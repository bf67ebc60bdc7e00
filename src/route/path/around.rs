//! Polylines that also turn around circles: a stop is a point or a circle, and the legs are common tangents.
//!
//! A taut polyline turns at the corners of obstacles, where no fillet is free. There the circle of the body's reach around the
//! obstacle's corner takes the place of the vertex. An arc of it is never inside of the inflated obstacle.

use super::clearance::until_disc;
use super::fillet::Corner;
use super::piece::{Piece, angle, left, swept};
use crate::base::geometry::Vec2;
use crate::model::sight::ROUNDING;
use crate::model::{Piece as Surface, Sight};
use std::f64::consts::PI;

/// Arcs that turn farther are not taken, rad: their legs would cross.
const FARTHEST_TURN: f64 = 1.5 * PI;

/// A vertex of a polyline, or a circle that takes its place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stop {
    /// The vertex, or the centre, m.
    pub(super) at: Vec2,
    /// Radius of the circle, m; positive where it lies to the left, 0 at a vertex.
    pub(super) around: f64,
}

/// The straight line between two stops.
#[derive(Clone, Copy, Debug)]
pub(super) struct Leg {
    pub(super) from: Vec2,
    pub(super) to: Vec2,
    /// Its direction, a unit vector.
    pub(super) along: Vec2,
    /// Its length, m.
    pub(super) length: f64,
}

impl Leg {
    /// The line that touches both stops; none where one circle holds the other stop.
    pub(super) fn between(a: Stop, b: Stop) -> Option<Self> {
        // b - a = length along + (b.around - a.around) left(along)
        let (between, aside) = (b.at - a.at, b.around - a.around);
        let (square, rest) = (between.norm_squared(), between.norm_squared() - aside * aside);
        if square <= 0.0 || rest < 0.0 {
            return None;
        }
        let length = rest.sqrt();
        let along = (between * length - left(between) * aside) / square;
        let (from, to) = (a.at - left(along) * a.around, b.at - left(along) * b.around);
        Some(Self { from, to, along, length })
    }
}

/// The arc around a circle between two legs.
pub(super) fn arc(stop: Stop, before: Vec2, after: Vec2) -> Piece {
    let side = stop.around.signum();
    let turn = side * swept(before, after, side);
    Piece::Arc { centre: stop.at, radius: stop.around.abs(), from: angle(left(before) * -side), turn }
}

/// The circle that can take the place of a corner whose fillets below a radius of `least`, m, are not free: the nearest one that
/// blocks them and lies on the inside of the turn.
pub(super) fn circle(corner: &Corner, least: f64, reach: f64, sight: &Sight) -> Option<Stop> {
    let near = sight.near(corner.at, reach + least * corner.tangent());
    let circles = near.iter().flat_map(|surface| match surface {
        Surface::Edge(edge) => [Some((edge.a, reach)), Some((edge.b, reach))],
        Surface::Disc { centre, radius } => [Some((*centre, radius + reach)), None],
    });
    let blocks = |&(at, radius): &(Vec2, f64)| {
        radius >= least
            && (at - corner.at).dot(&corner.inward) > -ROUNDING
            && until_disc(corner, at, radius) < least
    };
    let depth = |&(at, radius): &(Vec2, f64)| (at - corner.at).norm() - radius;
    let nearest = circles.flatten().filter(blocks).reduce(|a, b| if depth(&b) < depth(&a) { b } else { a });
    nearest.map(|(at, radius)| Stop { at, around: corner.side * radius })
}

/// The stops with circles in the place of vertices, `circles` by stop. A circle whose arc or legs are not free gives its place back.
pub(super) fn replace(
    stops: &[Stop],
    mut circles: Vec<Option<Stop>>,
    reach: f64,
    sight: &Sight,
) -> Vec<Stop> {
    loop {
        let mut changed: Vec<Stop> = Vec::with_capacity(stops.len());
        // Which changed stop each stop became: several vertices may lead around one circle.
        let mut became = Vec::with_capacity(stops.len());
        for (stop, circle) in stops.iter().zip(&circles) {
            if circle.is_none() || changed.last() != circle.as_ref() {
                changed.push(circle.unwrap_or(*stop));
            }
            became.push(changed.len() - 1);
        }
        let blocked = (1..changed.len().saturating_sub(1)).find(|&k| !is_free(&changed, k, reach, sight));
        let Some(blocked) = blocked else { return changed };
        for (circle, _) in circles.iter_mut().zip(became).filter(|(_, became)| *became == blocked) {
            *circle = None;
        }
    }
}

/// Whether the arc of an inner stop and both of its legs are free, if it is a circle.
fn is_free(stops: &[Stop], k: usize, reach: f64, sight: &Sight) -> bool {
    let Some(&[a, stop, b]) = stops.get(k - 1..=k + 1) else { return true };
    if stop.around == 0.0 {
        return true;
    }
    let (Some(before), Some(after)) = (Leg::between(a, stop), Leg::between(stop, b)) else { return false };
    let arc = arc(stop, before.along, after.along);
    arc.length() <= FARTHEST_TURN * arc.radius()
        && [before, after].iter().all(|leg| sight.is_clear(leg.from, leg.to, reach))
        && sight.near(stop.at, arc.radius() + reach).iter().all(|s| arc.distance_to(s) >= reach - ROUNDING)
}
