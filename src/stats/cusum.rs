//! Cumulative sums (Page 1954): has the probability of success fallen (or risen) from one value to another?

use super::invalid::{Invalid, probability, range};
use crate::base::math;

/// Watches outcomes for a change of P.
///
/// The mean number of outcomes to a false alarm is at least e^h (Lorden 1971), and often much larger; an
/// alarm follows a change after about h over the divergence of `after` from `before`.
#[derive(Clone, Debug, PartialEq)]
pub struct Cusum {
    per_success: f64,
    per_failure: f64,
    threshold: f64,
    after: f64,
    sum: f64,
    read: u64,
}

impl Cusum {
    /// Change from `before` to `after`, alarm at `threshold` h > 0.
    pub fn new(before: f64, after: f64, threshold: f64) -> Result<Self, Invalid> {
        probability("before", before)?;
        probability("after", after)?;
        range("threshold", threshold, 1e-9, 700.0)?;
        if before == after {
            return Err(Invalid::Equal { first: "before", second: "after", value: before });
        }
        Ok(Self {
            per_success: math::ln(after / before),
            per_failure: math::ln((1.0 - after) / (1.0 - before)),
            threshold,
            after,
            sum: 0.0,
            read: 0,
        })
    }

    /// Reads the next outcome; true if it raises the alarm, after which the sum starts anew.
    #[inline]
    pub fn observe(&mut self, success: bool) -> bool {
        self.read += 1;
        let next = self.sum + if success { self.per_success } else { self.per_failure };
        self.sum = math::at_least(next, 0.0);
        let alarm = self.sum >= self.threshold;
        if alarm {
            self.sum = 0.0;
        }
        alarm
    }

    /// The present sum.
    pub const fn sum(&self) -> f64 {
        self.sum
    }

    /// Outcomes read.
    pub const fn read(&self) -> u64 {
        self.read
    }

    /// The threshold of the alarm.
    pub const fn threshold(&self) -> f64 {
        self.threshold
    }

    /// About how many outcomes an alarm takes after the change: the threshold over the divergence of `after`
    /// from `before`.
    pub fn delay(&self) -> f64 {
        self.threshold / (self.after * self.per_success + (1.0 - self.after) * self.per_failure)
    }

    /// The proven lower bound e^h on the mean number of outcomes to a false alarm.
    pub fn mean_to_false_alarm_at_least(&self) -> f64 {
        math::exp(self.threshold)
    }
}
