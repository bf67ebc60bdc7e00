//! The fixed number of trials by the bound of Okamoto (1958), Chernoff and Hoeffding (1963).

use super::invalid::{Invalid, probability, range};
use super::{Counts, Coverage, Estimator, Interval, sequence};
use crate::base::math;

/// ceil(ln(2 / delta) / (2 epsilon^2)).
pub fn size(epsilon: f64, delta: f64) -> u64 {
    (math::ln(2.0 / delta) / (2.0 * epsilon * epsilon)).ceil() as u64
}

/// Estimates P within a half-width by the share of successes.
#[derive(Clone, Debug, PartialEq)]
pub struct Okamoto {
    epsilon: f64,
    delta: f64,
    size: u64,
    counts: Counts,
}

impl Okamoto {
    /// P(|share - P| > epsilon) <= delta.
    pub fn new(epsilon: f64, delta: f64) -> Result<Self, Invalid> {
        range("epsilon", epsilon, 1e-5, 0.5)?;
        probability("delta", delta)?;
        Ok(Self { epsilon, delta, size: size(epsilon, delta), counts: Counts::default() })
    }

    /// The same after so many outcomes.
    pub(super) fn after(self, counts: Counts) -> Self {
        Self { counts, ..self }
    }
}

impl Estimator for Okamoto {
    #[inline]
    fn observe(&mut self, success: bool) -> bool {
        if self.counts.trials() < self.size {
            self.counts.add(success);
        }
        self.finished()
    }

    #[inline]
    fn finished(&self) -> bool {
        self.counts.trials() >= self.size
    }

    fn counts(&self) -> Counts {
        self.counts
    }

    fn interval(&self) -> Interval {
        if !self.finished() {
            return sequence::interval(self.counts, self.delta);
        }
        let share = self.counts.share();
        Interval {
            low: math::at_least(share - self.epsilon, 0.0),
            high: math::at_most(share + self.epsilon, 1.0),
            error: self.delta,
            coverage: Coverage::FixedSize,
        }
    }

    fn limit(&self) -> Option<u64> {
        Some(self.size)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// T7.
    #[test]
    fn sizes_of_the_reference() {
        let sizes = [(0.05, 0.05, 738), (0.02, 0.05, 4612), (0.01, 0.05, 18_445), (0.01, 0.01, 26_492)];
        for (epsilon, delta, n) in sizes {
            assert_eq!(size(epsilon, delta), n);
        }
    }
}
