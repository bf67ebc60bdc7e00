//! What differs between people who walk (Weidmann 1993 for the speed; stature and step width of adults).

use crate::base::random::{Stream, name_hash};
use crate::model::{Family, Law};

/// What the gait of a person depends on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Person {
    /// Stature, m.
    pub height: f64,
    /// Speed chosen on free ground, m/s.
    pub speed: f64,
    /// Distance between the feet across the direction of walking, m.
    pub width: f64,
}

impl Person {
    /// Draws a person. A height (m) or speed (m/s) that is given replaces the drawn one and changes no other draw.
    pub fn draw(stream: Stream, height: Option<f64>, speed: Option<f64>) -> Self {
        let drawn = |address: u64, mean, sd, low, high| {
            let law = Law::Random { family: Family::Normal { mean, sd }, low, high };
            law.draw(stream.uniform(address as u32))
        };
        Self {
            height: height.unwrap_or_else(|| drawn(const { name_hash("gait height") }, 1.72, 0.09, 1.3, 2.2)),
            speed: speed.unwrap_or_else(|| drawn(const { name_hash("gait speed") }, 1.34, 0.26, 0.5, 2.2)),
            width: drawn(const { name_hash("gait width") }, 0.155, 0.03, 0.05, 0.3),
        }
    }
}
