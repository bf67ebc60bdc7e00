//! The range of a metric, and how far its values were read: what estimators of a number in a range have in common.

use super::invalid::{Invalid, probability};

/// A range, and how far values in it were read.
#[derive(Clone, Debug, PartialEq)]
pub struct Intake {
    pub(super) low: f64,
    pub(super) high: f64,
    /// Half width to stop at, over the range.
    pub(super) epsilon: Option<f64>,
    pub(super) delta: f64,
    pub(super) limit: u64,
    pub(super) read: u64,
    pub(super) unresolved: u64,
    pub(super) clipped: u64,
    pub(super) finished: bool,
}

impl Intake {
    /// Before the first of at most `limit` values in [low, high].
    pub(super) fn new(low: f64, high: f64, delta: f64, limit: u64) -> Result<Self, Invalid> {
        probability("delta", delta)?;
        if !(low < high && (high - low).is_finite()) {
            return Err(Invalid::Order { low_name: "low", low, high_name: "high", high });
        }
        let (epsilon, finished) = (None, false);
        Ok(Self { low, high, epsilon, delta, limit, read: 0, unresolved: 0, clipped: 0, finished })
    }

    /// Whether it has stopped.
    pub const fn finished(&self) -> bool {
        self.finished
    }

    /// Whether the number of trials is fixed beforehand.
    pub const fn is_fixed(&self) -> bool {
        self.epsilon.is_none() && self.limit < u64::MAX
    }

    /// The number of trials after which it has surely stopped.
    pub const fn limit(&self) -> u64 {
        self.limit
    }

    /// Trials read, unresolved among them, and values that were clipped.
    pub const fn read(&self) -> (u64, u64, u64) {
        (self.read, self.unresolved, self.clipped)
    }
}
