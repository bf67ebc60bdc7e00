//! What one trial yields for one column.

use crate::base::random::TrialKey;
use crate::kernel::Address;

/// What a column came to in one trial.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reading {
    /// Of a formula.
    Truth(bool),
    /// Of a metric, in SI units; infinite where it lies beyond the horizon.
    Value(f64),
    /// The trial diverged, or the column has no value in it.
    Unresolved,
    /// A process did what the model forbids: the run ends here.
    Faulty,
}

impl Reading {
    /// The truth of a formula.
    pub fn truth(&self) -> Option<bool> {
        if let Self::Truth(truth) = self { Some(*truth) } else { None }
    }

    /// The value of a metric.
    pub fn value(&self) -> Option<f64> {
        if let Self::Value(value) = self { Some(*value) } else { None }
    }
}

/// What one trial yields for one column.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    /// What it came to.
    pub reading: Reading,
    /// Steps of the model until it was decided.
    pub steps: u64,
    /// The implications in it that were triggered, bit k for the k-th (the 64th stands for all beyond).
    pub triggered: u64,
    /// Whether radii were shrunk to part people who overlap at the start.
    pub shrunk: bool,
    /// Whether somebody had no way to a goal.
    pub no_way: bool,
}

impl Cell {
    /// What is known before the first state.
    pub const BLANK: Self =
        Self { reading: Reading::Unresolved, steps: 0, triggered: 0, shrunk: false, no_way: false };
    /// Not decided when its trial was cut.
    pub const OPEN: Self = Self { steps: u64::MAX, ..Self::BLANK };

    /// Whether it was not decided when its trial was cut.
    #[inline]
    pub const fn is_open(&self) -> bool {
        self.steps == u64::MAX
    }
}

/// A series of trials: the seed, and which of the calls that ask again with this seed it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Series {
    /// Seed of all random numbers.
    pub seed: u64,
    /// Number of the call, modulo 65 536.
    pub branch: u16,
}

impl From<u64> for Series {
    fn from(seed: u64) -> Self {
        Self { seed, branch: 0 }
    }
}

/// A trial of a table: which option of which moves is followed, and the index of the trial.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Item {
    /// Index of the moves declaration and of its option, if one is followed.
    pub advice: Option<(usize, usize)>,
    /// Index of the trial.
    pub index: u64,
}

impl Item {
    /// Its address in a series.
    pub fn address(self, series: impl Into<Series>) -> Address<'static> {
        let Series { seed, branch } = series.into();
        let key = TrialKey { seed, index: self.index, branch };
        Address { key, advice: self.advice, changes: &[] }
    }

    /// Trials in a row, nobody advised.
    pub fn run(from: u64, count: u64) -> Vec<Self> {
        Self::row(from, count).collect()
    }

    /// The same, one by one.
    pub fn row(from: u64, count: u64) -> impl Iterator<Item = Self> {
        (from..from + count).map(|index| Self { advice: None, index })
    }
}

/// Trials in a row of a round, and where their cells go.
#[derive(Debug)]
pub struct Block<'c> {
    /// The trials.
    pub items: &'c [Item],
    /// Their cells, trial by trial.
    pub cells: &'c mut [Cell],
    /// Which of them are finished.
    pub finished: &'c mut [bool],
}
