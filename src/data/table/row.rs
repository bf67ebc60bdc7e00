//! One row of a table of traces.

use crate::base::geometry::Vec2;
use std::borrow::Cow;
use std::io;

/// The names of the columns before those of the signals.
pub const COLUMNS: [&str; 9] = ["time", "trial", "agent", "x", "y", "vx", "vy", "speed", "present"];

/// One agent in one state of one trial.
#[derive(Clone, Debug, PartialEq)]
pub struct Row<'a> {
    /// Seconds since the start (steps where steps have no length).
    pub time: f64,
    /// Index of the trial.
    pub trial: u64,
    /// Name of the agent.
    pub agent: Cow<'a, str>,
    /// Position, m.
    pub position: Vec2,
    /// Velocity, m/s.
    pub velocity: Vec2,
    /// Whether the agent is in the scene.
    pub present: bool,
    /// One value per signal, in the order of their names.
    pub signals: Cow<'a, [f64]>,
    /// One word per column of words, after the signals; empty where there is none.
    pub words: Vec<&'a str>,
}

impl Row<'_> {
    /// x, y, vx, vy and speed, where the agent is present.
    pub(super) fn motion(&self) -> [Option<f64>; 5] {
        let (p, v) = (self.position, self.velocity);
        [p.x, p.y, v.x, v.y, v.norm()].map(|value| self.present.then_some(value))
    }

    /// Refuses a row whose signals do not fit their names.
    pub(super) fn checked(&self, names: &[&str]) -> io::Result<()> {
        let found = self.signals.len() + self.words.len();
        if found == names.len() {
            return Ok(());
        }
        let message = format!("a row has {found} signals where there are {} names", names.len());
        Err(io::Error::new(io::ErrorKind::InvalidInput, message))
    }
}

#[cfg(test)]
pub(super) mod samples {
    use super::*;

    /// Two rows with one signal, the second of an absent agent.
    pub(in crate::data::table) fn rows() -> [Row<'static>; 2] {
        [
            Row {
                time: 0.02,
                trial: 3,
                agent: "oncoming[2]".into(),
                position: Vec2::new(1.5, -0.25),
                velocity: Vec2::new(0.3, 0.4),
                present: true,
                signals: Cow::Borrowed(&[f64::INFINITY]),
                words: Vec::new(),
            },
            Row {
                time: 0.04,
                trial: 3,
                agent: "a, \"b\"".into(),
                position: Vec2::new(9.0, 9.0),
                velocity: Vec2::zeros(),
                present: false,
                signals: Cow::Borrowed(&[f64::NAN]),
                words: Vec::new(),
            },
        ]
    }
}
