//! Other bodies that move at constant velocity while a step is made.

use super::placed::PlacedStep;
use crate::base::geometry::{Segment, Vec2};

/// The gap in m between a body on a step and all other bodies; 0 or less where they meet.
pub type Gaps<'a> = &'a dyn Fn(&PlacedStep) -> f64;

/// Smaller gaps are avoided, m.
pub(super) const WIDE: f64 = 0.3;

/// Lines by which the path of a step is compared with other bodies.
const LINES: u32 = 6;

/// Another body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OtherBody {
    /// Its center at the begin of the step, m.
    pub at: Vec2,
    /// Its velocity, m/s.
    pub velocity: Vec2,
    /// Its radius, m.
    pub radius: f64,
}

/// The smallest gap between a body of a radius on a step and others at constant velocity, m; infinite without others. Negative
/// where they overlap.
pub fn least_gap(step: &PlacedStep, radius: f64, others: &[OtherBody]) -> f64 {
    let places: [Vec2; LINES as usize + 1] = std::array::from_fn(|k| step.place(k as f64 / f64::from(LINES)));
    let gap = |other: &OtherBody| {
        // Seen from the other body the path is a chain of lines too.
        let seen = |k: usize| {
            places[k] - other.at - other.velocity * (step.duration() * k as f64 / f64::from(LINES))
        };
        let distance = |k| Segment::new(seen(k), seen(k + 1)).distance(Vec2::zeros());
        (0..LINES as usize).map(distance).fold(f64::INFINITY, f64::min) - radius - other.radius
    };
    others.iter().map(gap).fold(f64::INFINITY, f64::min)
}

/// The logarithm of the weight of a step with a gap; `None` if it meets another body.
pub(super) fn log_weight(gap: f64) -> Option<f64> {
    (gap > 0.0).then(|| if gap < WIDE { -4.0 * (WIDE - gap) / WIDE } else { 0.0 })
}
