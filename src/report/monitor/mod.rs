//! Properties of recorded people: `smc monitor`.

mod csv;
mod json;
mod property;
mod text;

pub use csv::write_csv;
pub use json::to_json;
pub use property::MonitoredProperty;
pub use text::to_text;

use crate::data::tracks::Velocity;
use crate::replay::Beyond;

/// Properties on a recording, and how they were read.
#[derive(Clone, Debug, PartialEq)]
pub struct Monitored {
    /// Name of the scenario's file.
    pub model: String,
    /// Names of the files of properties.
    pub properties: Vec<String>,
    /// Name of the recording.
    pub recording: String,
    /// Which velocities were used.
    pub velocity: Velocity,
    /// The person who is the user; `None` if each one is in turn.
    pub user: Option<u32>,
    /// Time between instants, s.
    pub every: f64,
    /// What is assumed of people after their tracks.
    pub beyond: Beyond,
    /// Confidence of intervals.
    pub confidence: f64,
    /// The properties, in order.
    pub results: Vec<MonitoredProperty>,
    /// All instants, in the order of the rows.
    pub instants: Vec<MonitoredInstant>,
}

/// All properties from one instant on, with one person as the user.
#[derive(Clone, Debug, PartialEq)]
pub struct MonitoredInstant {
    /// Time in the recording, s.
    pub time: f64,
    /// Id of the person.
    pub person: u32,
    /// One for each property, in order.
    pub verdicts: Vec<InstantVerdict>,
}

/// A property at one instant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InstantVerdict {
    /// It is satisfied.
    True,
    /// It is violated.
    False,
    /// It cannot be decided, for this reason: `the track ends`.
    Unresolved(&'static str),
}

impl InstantVerdict {
    /// `true`, `false`, `unresolved`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::True => "true",
            Self::False => "false",
            Self::Unresolved(_) => "unresolved",
        }
    }
}

#[cfg(test)]
mod tests;
