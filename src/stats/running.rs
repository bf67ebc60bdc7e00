//! A confidence sequence of a probability or of a number of a bounded metric, for procedures that look at several of them.

use super::invalid::Invalid;
use super::spec::Range;
use super::{Bounded, Counts, Interval, sequence};

/// One of them on its way.
#[derive(Clone, Debug, PartialEq)]
pub enum Running {
    /// A probability: trials that held, that did not, and that are unresolved.
    Share {
        /// Resolved trials.
        counts: Counts,
        /// Unresolved ones.
        unresolved: u64,
        /// The error of the interval.
        delta: f64,
    },
    /// A mean, or the mean of the largest share.
    Number(Box<Bounded>),
}

impl Running {
    /// A probability with this error of its interval.
    pub fn share(delta: f64) -> Self {
        Self::Share { counts: Counts::default(), unresolved: 0, delta }
    }

    /// The mean of a metric in a range, or that of its largest share.
    pub fn number(range: Range, share: Option<f64>, delta: f64) -> Result<Self, Invalid> {
        Ok(Self::Number(Box::new(Bounded::running(range, share, delta)?)))
    }

    /// Reads the next trial: a number, 0 or 1 of a probability, or `None` if it is unresolved.
    pub fn observe(&mut self, value: Option<f64>) {
        match (self, value) {
            (Self::Share { counts, .. }, Some(value)) => counts.add(value > 0.5),
            (Self::Share { unresolved, .. }, None) => *unresolved += 1,
            (Self::Number(number), value) => {
                number.observe(value);
            }
        }
    }

    /// Reads the next trials.
    pub fn observe_all(&mut self, values: &[Option<f64>]) {
        for value in values {
            self.observe(*value);
        }
    }

    /// Trials read.
    pub fn trials(&self) -> u64 {
        match self {
            Self::Share { counts, unresolved, .. } => counts.trials() + unresolved,
            Self::Number(number) => number.read().0,
        }
    }

    /// The estimate; unresolved trials lie in the middle of what they can be.
    pub fn estimate(&self) -> f64 {
        match self {
            Self::Share { counts, unresolved, .. } => {
                let trials = counts.trials() + unresolved;
                if trials == 0 {
                    0.5
                } else {
                    (counts.successes as f64 + 0.5 * *unresolved as f64) / trials as f64
                }
            }
            Self::Number(number) => {
                let (low, high) = number.estimate();
                0.5 * (low + high)
            }
        }
    }

    /// The interval, which holds at all times and both readings of unresolved trials.
    pub fn interval(&self) -> Interval {
        match self {
            Self::Share { counts, unresolved, delta } => {
                sequence::interval_with(*counts, *unresolved, *delta)
            }
            Self::Number(number) => number.interval(),
        }
    }
}
