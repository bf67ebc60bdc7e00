//! What time or trials did not suffice for.

use super::outcome::{QueryResult, Stop};

/// How a query that is no `check` falls short of what it asks, for lack of time or of trials.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shortfall {
    /// It got no trial.
    NotBegun,
    /// It got fewer trials than it takes.
    Incomplete,
}

impl Shortfall {
    /// Its words.
    pub const fn name(self) -> &'static str {
        match self {
            Self::NotBegun => "not begun",
            Self::Incomplete => "incomplete",
        }
    }
}

impl QueryResult {
    /// How it falls short of what it asks, if it does. A `check` that does is undecided.
    pub fn shortfall(&self) -> Option<Shortfall> {
        let short = self.stopped_by == Stop::Cap || self.stopped_by.is_early();
        (self.verdict.is_none() && short).then_some(match self.consumed.counts.trials {
            0 => Shortfall::NotBegun,
            _ => Shortfall::Incomplete,
        })
    }
}
