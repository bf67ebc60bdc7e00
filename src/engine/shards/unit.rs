//! Units of work: trials in a row of one table, or a run of splitting.

use crate::engine::sampling::splitting::SplitRun;
use serde::{Deserialize, Serialize};
use std::fmt;

/// Trials in a row, of one world and perhaps one option in it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Trials {
    /// Number of the world.
    pub world: usize,
    /// The columns that are observed.
    pub columns: Vec<usize>,
    /// Number of the moves and of their option, if one is followed.
    pub advice: Option<(usize, usize)>,
    /// Index of the first trial.
    pub from: u64,
    /// One past the last.
    pub to: u64,
}

/// What a shard consists of.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Unit {
    /// Trials in a row.
    Trials(Trials),
    /// A run of splitting.
    Run(SplitRun),
}

impl Unit {
    /// The number of its world.
    pub const fn world(&self) -> usize {
        match self {
            Self::Trials(trials) => trials.world,
            Self::Run(run) => run.world,
        }
    }

    /// The columns that are observed.
    pub(super) fn columns(&self) -> &[usize] {
        match self {
            Self::Trials(trials) => &trials.columns,
            Self::Run(run) => &run.columns,
        }
    }

    /// How many trials it is worth, roughly.
    pub fn weight(&self) -> u64 {
        match self {
            Self::Trials(trials) => trials.to.saturating_sub(trials.from),
            // Each of a few levels replaces some of the paths.
            Self::Run(run) => run.rule.replicas.saturating_mul(4),
        }
    }

    /// Trials in rows of so many; what cannot be divided as it is.
    pub(super) fn slices(self, size: u64) -> Vec<Self> {
        let Self::Trials(trials) = &self else { return vec![self] };
        let starts = (trials.from..trials.to).step_by(usize::try_from(size).unwrap_or(usize::MAX));
        let to = |from: u64| from.saturating_add(size).min(trials.to);
        starts.map(|from| Self::Trials(Trials { from, to: to(from), ..trials.clone() })).collect()
    }
}

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Trials(Trials { world, advice, from, to, .. }) => {
                write!(f, "trials {from} to {} of world {world}", to.saturating_sub(1))?;
                advice.map_or(Ok(()), |(_, option)| write!(f, ", option {option}"))
            }
            Self::Run(run) => write!(f, "run {} of splitting in world {}", run.branch, run.world),
        }
    }
}
