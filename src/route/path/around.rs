//! Polylines that also turn around circles: a stop is a point or a circle, and the legs are common tangents.
//!
//! A taut polyline turns at the corners of obstacles, where no fillet is free. There the circle of the body's reach
//! around the obstacle's corner takes the place of the vertex. An arc of it is never inside of the inflated obstacle.

use super::clearance::until_disc;
use super::fillet::Corner;
use super::piece::{Piece, angle, left, swept};
use crate::base::geometry::Vec2;
use crate::model::sight::ROUNDING;
use crate::model::{Piece as Surface, Sight};

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

/// The discs at the ends of a surface that is inflated by `reach`, m: their centres and radii.
pub(super) fn discs(surface: &Surface, reach: f64) -> impl Iterator<Item = (Vec2, f64)> {
    let (first, second) = match surface {
        Surface::Edge(edge) => ((edge.a, reach), Some((edge.b, reach))),
        Surface::Disc { centre, radius } => ((*centre, radius + reach), None),
    };
    std::iter::once(first).chain(second)
}

/// The circle that can take the place of a corner whose fillets below a radius of `least`, m, are not free: the
/// nearest one that blocks them and lies on the inside of the turn.
pub(super) fn circle(corner: &Corner, least: f64, reach: f64, sight: &Sight) -> Option<Stop> {
    let near = sight.near(corner.at, reach + least * corner.tangent());
    let blocks = |&(at, radius): &(Vec2, f64)| {
        radius >= least
            && (at - corner.at).dot(&corner.inward) > -ROUNDING
            && until_disc(corner, at, radius) < least
    };
    let depth = |&(at, radius): &(Vec2, f64)| (at - corner.at).norm() - radius;
    let nearest = near
        .iter()
        .flat_map(|surface| discs(surface, reach))
        .filter(blocks)
        .reduce(|a, b| if depth(&b) < depth(&a) { b } else { a });
    nearest.map(|(at, radius)| Stop { at, around: corner.side * radius })
}
