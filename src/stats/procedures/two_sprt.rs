//! The 2-SPRT of Lorden, "2-SPRT's and the modified Kiefer-Weiss problem", Annals of Statistics 4 (1976):
//! two one-sided tests of theta against either end of the indifference region.
//!
//! Errors are bounded as with the SPRT, and the number of trials has a bound: the test for hard deadlines.

use crate::base::math;
use crate::stats::invalid::Invalid;
use crate::stats::sprt::{Indifference, SLACK};
use crate::stats::{Counts, Decision, Rule, Sequential, Statement, Test, Weight, Weights};

/// P >= theta + indifference against P <= theta - indifference, with a closed region.
#[derive(Clone, Debug, PartialEq)]
pub struct TwoSprt {
    region: Indifference,
    /// Log likelihood ratios of theta over the high end, per success and failure.
    over_high: (f64, f64),
    /// Log likelihood ratios of theta over the low end, per success and failure.
    over_low: (f64, f64),
    /// ln(1 / alpha) and ln(1 / beta), widened.
    thresholds: (f64, f64),
    limit: u64,
}

impl TwoSprt {
    /// Parameters as those of the SPRT; the indifference must be at least 0.00001.
    pub fn new(theta: f64, indifference: f64, alpha: f64, beta: f64) -> Result<Sequential<Self>, Invalid> {
        let region = Indifference::new(theta, indifference, 1e-5, (alpha, beta))?;
        let over = |end: f64| (math::ln(theta / end), math::ln((1.0 - theta) / (1.0 - end)));
        let (over_high, over_low) = (over(region.high), over(region.low));
        let thresholds = (-math::ln(alpha) + SLACK, -math::ln(beta) + SLACK);
        let mut test = Self { region, over_high, over_low, thresholds, limit: 0 };
        test.limit = test.closed_at();
        Ok(Sequential::new(test))
    }

    /// The first number of trials at which no count of successes is undecided.
    fn closed_at(&self) -> u64 {
        let ((a, b), (c, d), (below, above)) = (self.over_high, self.over_low, self.thresholds);
        // At n trials the undecided counts of successes lie between two lines in n, which meet where both
        // ratios are at their thresholds. As long as they are more than one apart there is such a count.
        let from = |n: f64| (b * n - below) / (b - a);
        let to = |n: f64| (above - d * n) / (c - d);
        let apart = |n: f64| to(n) - from(n);
        let slope = apart(0.0) - apart(1.0);
        let mut n = math::at_least(((apart(0.0) - 1.0) / slope).floor() - 1.0, 1.0);
        loop {
            let middle = 0.5 * (from(n) + to(n));
            let undecided = |s: f64| {
                let f = n - s;
                s >= 0.0 && f >= 0.0 && s * a + f * b < below && s * c + f * d < above
            };
            if apart(n) <= 1.0 && !undecided(middle.floor()) && !undecided(middle.ceil()) {
                return n as u64;
            }
            n += 1.0;
        }
    }
}

impl TwoSprt {
    /// The log likelihood ratios of theta over the low and over the high end.
    #[inline]
    fn ratios(&self, counts: Counts) -> [f64; 2] {
        let (s, f) = (counts.successes as f64, counts.failures as f64);
        [self.over_low, self.over_high].map(|(success, failure)| s * success + f * failure)
    }
}

impl Rule for TwoSprt {
    type Answer = Option<Decision>;

    #[inline]
    fn look(&mut self, counts: Counts, _: bool) -> Option<Decision> {
        let [above, below] = self.ratios(counts);
        if below >= self.thresholds.0 {
            Some(Decision::Below)
        } else if above >= self.thresholds.1 {
            Some(Decision::Above)
        } else {
            None
        }
    }

    fn limit(&self) -> Option<u64> {
        Some(self.limit)
    }
}

impl Test for TwoSprt {
    fn weights(&self, counts: Counts) -> Option<Weights> {
        let [above, below] = self.ratios(counts);
        Some([
            Weight { log: above, threshold: self.thresholds.1 },
            Weight { log: below, threshold: self.thresholds.0 },
        ])
    }

    fn certifies(&self, decision: Decision) -> Statement {
        self.region.certifies(decision)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_region_is_closed_at_the_limit_and_open_before_it() {
        let test = TwoSprt::new(0.9, 0.01, 0.01, 0.01).unwrap();
        let (limit, test) = (test.limit().unwrap(), test.rule());
        assert_eq!(limit, 8189);
        let outside = |s: u64, f: u64| {
            let (s, f) = (s as f64, f as f64);
            s * test.over_high.0 + f * test.over_high.1 >= test.thresholds.0
                || s * test.over_low.0 + f * test.over_low.1 >= test.thresholds.1
        };
        assert!((0..=limit).all(|s| outside(s, limit - s)));
        assert!((1..limit).all(|n| (0..=n).any(|s| !outside(s, n - s))));
    }
}
