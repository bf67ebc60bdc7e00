//! The way ahead of a step, and steps that follow it: a step is a straight line with sway; its line is laid along the way, so that
//! a corner is turned where it is and not at the next end of a step.
//!
//! ```text
//!  start ───────┐ corner          ───── the way
//!         · · · ·\                · · · the line of the step on it: straight, an arc at the corner, straight
//!                 \ · ·  end
//! ```

use super::placed::{angle, end_of, turned};
use super::task::Walk;
use super::turn::WIDEST;
use crate::base::geometry::{Vec2, rotated};
use crate::gait::Shape;
use crate::route::grid::Way;

/// Length of a piece of the course, m.
const PIECE: f64 = 0.1;

/// A correction is made within this first share of a step; the widest turn on a way around barriers takes the whole step.
const AT_ONCE: f64 = 0.2;

/// Pieces of a course: longer than any step.
const PIECES: usize = 16;

/// The way ahead in pieces of 0.1 m, in a frame that begins at the step and whose +x is the direction of the way there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Course {
    /// The direction of each piece, of length 1.
    directions: [Vec2; PIECES],
    /// Whether it is a straight line to the goal.
    is_straight: bool,
}

impl Walk<'_> {
    /// The course from a place whose way is `way`.
    pub(super) fn course(&self, from: Vec2, way: &Way) -> Course {
        let mut directions = [Vec2::x(); PIECES];
        let (mut at, mut ahead) = (from, *way);
        let back = Vec2::new(way.direction.x, -way.direction.y);
        for direction in &mut directions {
            *direction = turned(ahead.direction, back);
            if ahead.is_straight {
                continue;
            }
            at += ahead.direction * PIECE;
            ahead = self.way(at).unwrap_or(ahead);
        }
        Course { directions, is_straight: way.is_straight }
    }
}

impl Course {
    /// A straight way.
    pub(super) fn straight() -> Self {
        Self { directions: [Vec2::x(); PIECES], is_straight: true }
    }

    /// A scaled step whose line turns by an angle, rad, within the first part of its way, and follows the course besides.
    pub(super) fn led(&self, shape: &Shape, by: f64, scale: f64) -> Shape {
        let within = if self.is_straight { AT_ONCE } else { (by.abs() / WIDEST).clamp(AT_ONCE, 1.0) };
        let arc = (end_of(shape).norm() * scale * within).max(1e-6);
        // The beginning of each piece, and its direction.
        let mut pieces = [(Vec2::zeros(), Vec2::x()); PIECES];
        let mut at = Vec2::zeros();
        for (k, piece) in pieces.iter_mut().enumerate() {
            let middle = (k as f64 + 0.5) * PIECE;
            *piece = (at, rotated(self.directions[k], by * (middle / arc).min(1.0)));
            at += piece.1 * PIECE;
        }
        let lead = |p: Vec2| {
            let (x, y) = (p.x * scale, p.y * scale);
            let k = ((x / PIECE).max(0.0) as usize).min(PIECES - 1);
            let (begin, along) = pieces[k];
            begin + along * (x - k as f64 * PIECE) + Vec2::new(-along.y, along.x) * y
        };
        Shape { landmarks: shape.landmarks.map(lead), duration: shape.duration }
    }

    /// The turn of the course at a length from its begin, rad, and the direction from its begin to there.
    pub(super) fn ahead(&self, length: f64) -> (f64, Vec2) {
        let pieces = ((length / PIECE).ceil().max(1.0) as usize).min(PIECES);
        let chord: Vec2 = self.directions.iter().take(pieces).sum();
        (angle(Vec2::x(), self.directions[pieces - 1]), chord)
    }
}
