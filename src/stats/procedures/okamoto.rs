//! The fixed number of trials by the bound of Okamoto (1958), Chernoff and Hoeffding (1963).

use crate::base::math;
use crate::stats::invalid::{Invalid, probability, range};
use crate::stats::{Counts, Coverage, Estimator, Interval, Rule, Sequential};

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
}

impl Okamoto {
    /// P(|share - P| > epsilon) <= delta.
    pub fn new(epsilon: f64, delta: f64) -> Result<Sequential<Self>, Invalid> {
        Self::rule(epsilon, delta).map(Sequential::new)
    }

    pub(in crate::stats) fn rule(epsilon: f64, delta: f64) -> Result<Self, Invalid> {
        range("epsilon", epsilon, 1e-5, 0.5)?;
        probability("delta", delta)?;
        Ok(Self { epsilon, delta, size: size(epsilon, delta) })
    }
}

impl Rule for Okamoto {
    type Answer = bool;

    #[inline]
    fn look(&mut self, counts: Counts, _: bool) -> bool {
        counts.trials() >= self.size
    }

    fn limit(&self) -> Option<u64> {
        Some(self.size)
    }

    fn is_planned(&self) -> bool {
        true
    }

    fn numbers(&self) -> Vec<(&'static str, f64)> {
        vec![("trials", self.size as f64)]
    }
}

impl Estimator for Okamoto {
    fn error(&self) -> f64 {
        self.delta
    }

    fn at_stop(&self, counts: Counts) -> Interval {
        Interval::around(counts.share(), self.epsilon, self.delta, Coverage::FixedSize)
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
