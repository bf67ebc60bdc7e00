//! Where people who were recorded are between and after the frames of a recording.

use crate::base::geometry::Vec2;
use crate::data::tracks::Recording;

/// What is taken of people after the end of their track.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Beyond {
    /// What needs them is unresolved.
    Unresolved,
    /// They go on with their last velocity.
    Onward,
}

impl Beyond {
    /// `unresolved` or `onward`
    pub const fn name(self) -> &'static str {
        match self {
            Self::Unresolved => "unresolved",
            Self::Onward => "onward",
        }
    }
}

/// Position, m, and velocity, m/s, of a person of a recording at a time, s: in proportion between two frames; `None` where
/// the person is not in the recording. `beyond` holds after the end of the track and in its holes.
pub(super) fn course(recording: &Recording, id: u32, time: f64, beyond: Beyond) -> Option<(Vec2, Vec2)> {
    if let Some(state) = recording.person_at(id, time) {
        return Some((state.position, state.velocity));
    }
    if beyond == Beyond::Unresolved {
        return None;
    }
    let samples = &recording.person(id)?.samples;
    let last = samples.iter().rfind(|sample| recording.time_of(sample.frame) <= time)?;
    let velocity = last.velocity.unwrap_or_default();
    Some((last.position + velocity * (time - recording.time_of(last.frame)), velocity))
}
