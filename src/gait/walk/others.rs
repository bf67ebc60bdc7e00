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

/// The smallest gap between a body of a radius on a step and others at constant velocity, m. Negative where they overlap.
/// Gaps of `WIDE` and more make no difference: then it is not exact, and infinite without others.
pub fn least_gap(step: &PlacedStep, radius: f64, others: &[OtherBody]) -> f64 {
    let places: [Vec2; LINES as usize + 1] = std::array::from_fn(|k| step.place(k as f64 / f64::from(LINES)));
    let far = places.iter().map(|place| (place - places[0]).norm_squared()).fold(0.0, f64::max).sqrt();
    // Who cannot come near while the step is made.
    let is_near = |other: &&OtherBody| {
        let reach = far + step.duration() * other.velocity.norm() + radius + other.radius + WIDE;
        (other.at - places[0]).norm_squared() < reach * reach
    };
    let gap = |other: &OtherBody| {
        // Seen from the other body the path is a chain of lines too.
        let seen = |k: usize| {
            places[k] - other.at - other.velocity * (step.duration() * k as f64 / f64::from(LINES))
        };
        let distance = |k| Segment::new(seen(k), seen(k + 1)).distance(Vec2::zeros());
        (0..LINES as usize).map(distance).fold(f64::INFINITY, f64::min) - radius - other.radius
    };
    others.iter().filter(is_near).map(gap).fold(f64::INFINITY, f64::min)
}

/// The logarithm of the weight of a step with a gap; `None` if it meets another body.
pub(super) fn log_weight(gap: f64) -> Option<f64> {
    (gap > 0.0).then(|| if gap < WIDE { -4.0 * (WIDE - gap) / WIDE } else { 0.0 })
}
