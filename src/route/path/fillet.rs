//! The fillet of one corner: the arc that touches both legs.
//!
//! With the turning angle delta and the radius R, the arc leaves both legs at R tan(delta / 2) from the corner and is
//! R delta long.

use super::piece::{Piece, angle, left};
use crate::base::geometry::{Vec2, cross};
use crate::base::math::atan2;

/// A corner of a polyline.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    pub(super) at: Vec2,
    /// Direction before it, a unit vector.
    pub(super) before: Vec2,
    /// Direction after it, a unit vector.
    pub(super) after: Vec2,
    /// 1 where it turns to the left, else -1.
    pub(super) side: f64,
    /// Unit vector from the corner to the centres of its fillets.
    pub(super) inward: Vec2,
    /// Cosine of half of the turning angle.
    pub(super) cos: f64,
    /// Its sine.
    sin: f64,
}

impl Corner {
    pub(super) fn new(at: Vec2, before: Vec2, after: Vec2) -> Self {
        let side = if cross(before, after) < 0.0 { -1.0 } else { 1.0 };
        // The sum and the difference of the directions are exact for small angles, where a cosine of the angle is not.
        let (sum, difference) = (before + after, after - before);
        let (cos, sin) = (0.5 * sum.norm(), 0.5 * difference.norm());
        let inward = if cos > 0.0 { left(sum) * (0.5 * side / cos) } else { -before };
        Self { at, before, after, side, inward, cos, sin }
    }

    /// Tangent of half of the turning angle: the tangent length for a radius of 1.
    pub(super) fn tangent(&self) -> f64 {
        self.sin / self.cos
    }

    /// The fillet of a radius, m.
    pub(super) fn arc(&self, radius: f64) -> Piece {
        let out = left(self.before) * -self.side;
        let begin = self.at - self.before * (radius * self.tangent());
        let turn = 2.0 * self.side * atan2(self.sin, self.cos);
        Piece::Arc { centre: begin - out * radius, radius, from: angle(out), turn }
    }
}
