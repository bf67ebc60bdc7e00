//! An interval around an estimate, and in which sense it holds.

use crate::base::math;

/// In which sense an interval holds what it should.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Coverage {
    /// At a number of trials fixed in advance.
    FixedSize,
    /// At the stopping time of this procedure.
    Sequential,
    /// At all numbers of trials at once: at deadlines and interruptions too.
    TimeUniform,
}

/// An interval that misses the truth with probability at most `error`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// Bound on the probability of missing.
    pub error: f64,
    /// When that bound holds.
    pub coverage: Coverage,
}

impl Interval {
    /// `reach` to either side of an estimate of a probability.
    pub(super) fn around(middle: f64, reach: f64, error: f64, coverage: Coverage) -> Self {
        let (low, high) = (math::at_least(middle - reach, 0.0), math::at_most(middle + reach, 1.0));
        Self { low, high, error, coverage }
    }

    /// Half of the width.
    pub fn half_width(self) -> f64 {
        0.5 * (self.high - self.low)
    }

    /// The middle.
    pub fn middle(self) -> f64 {
        0.5 * (self.low + self.high)
    }

    /// Whether `x` lies in it, ends included.
    pub fn holds(self, x: f64) -> bool {
        self.low <= x && x <= self.high
    }

    /// The smallest interval that holds both. It holds at all times if one of them is meant to: of two readings one
    /// has stopped, and the other goes on.
    pub fn hull(self, other: Self) -> Self {
        let endless = other.coverage == Coverage::TimeUniform;
        Self {
            low: if other.low < self.low { other.low } else { self.low },
            high: if other.high > self.high { other.high } else { self.high },
            error: if other.error > self.error { other.error } else { self.error },
            coverage: if endless { other.coverage } else { self.coverage },
        }
    }
}
