//! One piece of a path: a line, an arc, or a turn on the spot.

use crate::base::geometry::{Segment, Vec2, cross};
use crate::base::math::{atan2, sin_cos};
use crate::model::Piece as Surface;
use std::f64::consts::TAU;

/// A piece of a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Piece {
    /// A straight line.
    Line {
        /// Where it begins, m.
        from: Vec2,
        /// Where it ends, m.
        to: Vec2,
    },
    /// An arc of a circle.
    Arc {
        /// Centre of the circle, m.
        centre: Vec2,
        /// Its radius, m; positive.
        radius: f64,
        /// Angle from the centre to where the arc begins, rad.
        from: f64,
        /// How far it turns, rad; positive to the left.
        turn: f64,
    },
    /// A stop at which an agent turns on the spot. Its length is 0.
    Turn {
        /// The place, m.
        at: Vec2,
        /// Direction of the path before it, a unit vector.
        from: Vec2,
        /// Direction of the path after it, a unit vector.
        to: Vec2,
    },
}

/// A place on a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Where it is, m.
    pub position: Vec2,
    /// Direction of the path there, a unit vector.
    pub direction: Vec2,
    /// Curvature, 1/m; positive where the path turns to the left.
    pub curvature: f64,
}

/// The vector turned by a right angle to the left.
pub(super) fn left(v: Vec2) -> Vec2 {
    Vec2::new(-v.y, v.x)
}

/// The unit vector at an angle, rad.
pub(super) fn unit(angle: f64) -> Vec2 {
    let (sin, cos) = sin_cos(angle);
    Vec2::new(cos, sin)
}

/// The angle of a vector, rad.
pub(super) fn angle(v: Vec2) -> f64 {
    atan2(v.y, v.x)
}

/// The angle from one direction to another in the sense of `side` (1 to the left, -1 to the right), rad; at least 0
/// and below a full turn.
pub(super) fn swept(from: Vec2, to: Vec2, side: f64) -> f64 {
    let turn = atan2(side * cross(from, to), from.dot(&to));
    if turn < 0.0 { turn + TAU } else { turn }
}

impl Piece {
    /// Its length, m.
    pub fn length(&self) -> f64 {
        match *self {
            Self::Line { from, to } => (to - from).norm(),
            Self::Arc { radius, turn, .. } => radius * turn.abs(),
            Self::Turn { .. } => 0.0,
        }
    }

    /// Its radius, m: infinite for a line, 0 for a turn.
    pub fn radius(&self) -> f64 {
        match *self {
            Self::Line { .. } => f64::INFINITY,
            Self::Arc { radius, .. } => radius,
            Self::Turn { .. } => 0.0,
        }
    }

    /// The place at a distance along it, m, held between 0 and its length. A turn has the direction in which the path
    /// goes on.
    pub fn at(&self, along: f64) -> Place {
        match *self {
            Self::Line { from, to } => {
                let (whole, length) = (to - from, self.length());
                let direction = if length > 0.0 { whole / length } else { Vec2::x() };
                let position = from + direction * along.min(length).max(0.0);
                Place { position, direction, curvature: 0.0 }
            }
            Self::Arc { centre, radius, from, turn } => {
                let side = turn.signum();
                let out = unit(from + side * (along / radius).min(turn.abs()).max(0.0));
                let position = centre + out * radius;
                Place { position, direction: left(out) * side, curvature: side / radius }
            }
            Self::Turn { at, to, .. } => Place { position: at, direction: to, curvature: 0.0 },
        }
    }

    /// Where it begins.
    pub fn start(&self) -> Place {
        match *self {
            Self::Turn { at, from, .. } => Place { position: at, direction: from, curvature: 0.0 },
            _ => self.at(0.0),
        }
    }

    /// Where it ends.
    pub fn end(&self) -> Place {
        self.at(self.length())
    }

    /// The nearest place of the part between two distances along it, `low` <= `high`, m: its distance along the piece
    /// and its distance from `p`, m. The first of several that are equally near.
    pub fn nearest_within(&self, p: Vec2, low: f64, high: f64) -> (f64, f64) {
        let apart = |along: f64| (along, (self.at(along).position - p).norm());
        match *self {
            Self::Line { from, to } => {
                let length = self.length();
                let foot = if length > 0.0 { (p - from).dot(&(to - from)) / length } else { 0.0 };
                apart(foot.min(high).max(low))
            }
            Self::Arc { centre, radius, from, turn } => {
                let (out, side) = (p - centre, turn.signum());
                let first = unit(from + side * low / radius);
                if out == Vec2::zeros() {
                    return (low, radius);
                }
                let along = low + radius * swept(first, out, side);
                if along <= high {
                    return (along, (out.norm() - radius).abs());
                }
                let (low, high) = (apart(low), apart(high));
                if high.1 < low.1 { high } else { low }
            }
            Self::Turn { at, .. } => (0.0, (p - at).norm()),
        }
    }

    /// Distance from a point, m.
    pub fn distance(&self, p: Vec2) -> f64 {
        self.nearest_within(p, 0.0, self.length()).1
    }

    /// Distance from a surface of a barrier, m; 0 where they meet, and within a disc.
    pub fn distance_to(&self, surface: &Surface) -> f64 {
        match (self, surface) {
            (_, Surface::Disc { centre, radius }) => (self.distance(*centre) - radius).max(0.0),
            (Self::Line { from, to }, Surface::Edge(_)) => surface.distance_to(&Segment::new(*from, *to)),
            (Self::Turn { at, .. }, Surface::Edge(edge)) => edge.distance(*at),
            (Self::Arc { centre, .. }, Surface::Edge(edge)) => {
                if self.meets(edge) {
                    return 0.0;
                }
                // The distance is least at an end of one of the two, or on the normal of the edge through the centre.
                let ends = edge.distance(self.at(0.0).position).min(edge.distance(self.end().position));
                let places = [edge.a, edge.b, edge.nearest(*centre)];
                places.map(|p| self.distance(p)).into_iter().fold(ends, f64::min)
            }
        }
    }

    /// Whether an arc meets an edge.
    fn meets(&self, edge: &Segment) -> bool {
        let Self::Arc { centre, radius, from, turn } = *self else { return false };
        let length = edge.length();
        if length <= 0.0 {
            return false;
        }
        let along = (edge.b - edge.a) / length;
        let middle = (centre - edge.a).dot(&along);
        let half = radius * radius - (edge.a + along * middle - centre).norm_squared();
        let is_on = |s: f64| {
            let out = edge.a + along * s - centre;
            (0.0..=length).contains(&s) && swept(unit(from), out, turn.signum()) <= turn.abs()
        };
        half >= 0.0 && (is_on(middle - half.sqrt()) || is_on(middle + half.sqrt()))
    }
}
