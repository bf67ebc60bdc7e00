//! The sequential scheme on Massart's bound of Jegourel, Sun and Dong, "Sequential schemes for frequentist
//! estimation of properties in statistical model checking", QEST 2017.
//!
//! The share of the error that goes into the running Clopper-Pearson interval is charged once although the
//! interval is formed at every trial: the guarantee is argued by its authors, with much slack, rather than
//! proven at every index.

use crate::base::math;
use crate::stats::invalid::{Invalid, probability, range};
use crate::stats::width::Ahead;
use crate::stats::{Counts, Coverage, Estimator, Interval, Rule, Sequential, clopper_pearson, okamoto};

/// Estimates P within a half-width by the share of successes.
#[derive(Clone, Debug, PartialEq)]
pub struct Massart {
    epsilon: f64,
    delta: f64,
    /// Error of the running interval.
    share: f64,
    limit: u64,
    ahead: Ahead,
}

/// The number of trials that the bound asks for, given the running interval.
fn needed(counts: Counts, epsilon: f64, delta: f64, share: f64) -> f64 {
    let low = clopper_pearson::lower(counts, 0.5 * share);
    let high = clopper_pearson::upper(counts, 0.5 * share);
    let spread = if high < 0.5 {
        (3.0 * high + epsilon) * (3.0 * (1.0 - high) - epsilon)
    } else if low > 0.5 {
        (3.0 * (1.0 - low) + epsilon) * (3.0 * low + epsilon)
    } else {
        (1.5 + epsilon) * (1.5 + epsilon)
    };
    2.0 / (9.0 * epsilon * epsilon) * math::ln(2.0 / (delta - share)) * spread
}

impl Massart {
    /// Half-width `epsilon`, error `delta`, of which `share` (0.001 to 0.01 are good) goes into the running
    /// interval.
    pub fn new(epsilon: f64, delta: f64, share: f64) -> Result<Sequential<Self>, Invalid> {
        range("epsilon", epsilon, 1e-5, 0.5)?;
        probability("delta", delta)?;
        probability("share", share)?;
        if share >= delta {
            return Err(Invalid::Order { low_name: "share", low: share, high_name: "delta", high: delta });
        }
        let limit = okamoto::size(epsilon, delta);
        Ok(Sequential::new(Self { epsilon, delta, share, limit, ahead: Ahead::new() }))
    }
}

impl Rule for Massart {
    type Answer = bool;

    #[inline]
    fn look(&mut self, counts: Counts, _: bool) -> bool {
        let (epsilon, delta, share) = (self.epsilon, self.delta, self.share);
        self.ahead.reached(counts, self.limit, |counts| {
            counts.trials() as f64 >= needed(counts, epsilon, delta, share)
        })
    }

    fn limit(&self) -> Option<u64> {
        Some(self.limit)
    }

    fn numbers(&self) -> Vec<(&'static str, f64)> {
        vec![("auxiliary", self.share)]
    }
}

impl Estimator for Massart {
    fn error(&self) -> f64 {
        self.delta
    }

    fn at_stop(&self, counts: Counts) -> Interval {
        Interval::around(counts.share(), self.epsilon, self.delta, Coverage::Sequential)
    }
}

/// Share of the error that goes into the running interval.
pub(super) const SHARE: f64 = 0.02;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::random::{Purpose, Stream, TrialKey};

    #[test]
    fn the_lazy_stop_is_the_stop_of_checking_every_index() {
        for (branch, p) in [0.0, 0.02, 0.2, 0.5, 0.9].into_iter().enumerate() {
            let mut estimator = Massart::new(0.05, 0.05, 0.005).unwrap();
            let mut index = 0;
            while !estimator.finished() {
                let key = TrialKey { seed: 4, index, branch: branch as u16 };
                let done = estimator.observe(Stream::of(key, 0, Purpose::Test).uniform(0) < p);
                let n = estimator.counts().trials();
                let direct = n as f64 >= needed(estimator.counts(), 0.05, 0.05, 0.005) || n >= 738;
                assert_eq!(done, direct, "{p} {n}");
                index += 1;
            }
        }
    }

    #[test]
    fn the_cost_of_the_reference() {
        // Mean 7554 and 95 % quantile 7874 at p = 0.1, epsilon = 0.01: one regular path lies near.
        let mut estimator = Massart::new(0.01, 0.05, 0.001).unwrap();
        let mut n = 0;
        while !estimator.observe(n % 10 == 0) {
            n += 1;
        }
        assert!((7300..7800).contains(&n), "{n}");
    }
}
