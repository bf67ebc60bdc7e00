//! Tapes: trials that a program elsewhere has run, state by state. They are played back in the place of steps, so whatever
//! reads a trial reads one of these in the same way.

use super::fault::Fault;
use crate::base::geometry::Vec2;
use crate::base::random::TrialKey;
use crate::model::Scenario;
use std::fmt::Debug;
use std::sync::Arc;

/// Somebody in one state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    /// Which of the places for people is theirs; these are taken one after the other.
    pub place: u32,
    /// Where, m.
    pub position: Vec2,
    /// How fast, m/s.
    pub velocity: Vec2,
}

/// The states of a trial.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tape {
    /// How many variables a state has.
    pub width: usize,
    /// The values of the variables, state by state.
    pub values: Vec<f64>,
    /// Who is there, state by state. Beyond the last one nothing changes.
    pub people: Vec<Vec<Seen>>,
}

impl Tape {
    /// The state of a tick, or the last one.
    fn state(&self, tick: u64) -> usize {
        (tick as usize).min(self.people.len().saturating_sub(1))
    }

    /// Who is there.
    pub(super) fn seen(&self, tick: u64) -> &[Seen] {
        self.people.get(self.state(tick)).map_or(&[], Vec::as_slice)
    }

    /// The values of the variables.
    pub(super) fn variables(&self, tick: u64) -> &[f64] {
        self.values
            .get(self.state(tick) * self.width..)
            .and_then(|rest| rest.get(..self.width))
            .unwrap_or(&[])
    }
}

/// Why there is no tape.
#[derive(Clone, Debug, PartialEq)]
pub enum Unplayed {
    /// The trial is unresolved, for this reason.
    Failed(Arc<str>),
    /// No trial of the program can be trusted.
    Wrong(Fault),
}

/// Runs trials of a program elsewhere.
pub trait Player: Debug + Send + Sync {
    /// The trial of a key, in which a move of this name is followed.
    ///
    /// # Errors
    /// When the program ends without a whole trace, or does what no program may.
    fn play(&self, scenario: &Scenario, key: TrialKey, option: Option<&str>) -> Result<Arc<Tape>, Unplayed>;
}
