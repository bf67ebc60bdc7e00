//! Relative error by the Gamma Bernoulli approximation scheme (Huber, "A Bernoulli mean estimate with known
//! relative error distribution", Random Structures and Algorithms 50, 2017).
//!
//! Each trial adds an exponential number to a sum R until the k-th success; then (k - 1)/R over P has
//! exactly the law of (k - 1)/Gamma(k), whatever P is.

use crate::base::math;
use crate::base::random::{Purpose, Stream, TrialKey};
use crate::base::special::{gamma_quantile, gamma_reg, gamma_tails, gamma_upper_quantile};
use crate::stats::invalid::{Invalid, probability, range};
use crate::stats::{Counts, Coverage, Estimator, Interval, Rule, Sequential, bisection, clopper_pearson};

/// The share of the error kept for the interval at the cap.
const CAP_SHARE: f64 = 0.1;

/// The smallest number of successes with relative error at most `epsilon` but for probability `delta`.
pub fn size(epsilon: f64, delta: f64) -> u64 {
    let miss = |k: f64| {
        gamma_reg(k, (k - 1.0) / (1.0 + epsilon)) + gamma_tails(k, (k - 1.0) / (1.0 - epsilon)).upper()
    };
    let mut high = 4.0;
    while miss(high) > delta && high < 1e12 {
        high *= 2.0;
    }
    bisection::first(1, high as u64, |k| miss(k as f64) <= delta)
}

/// Estimates P to a relative error.
#[derive(Clone, Debug, PartialEq)]
pub struct Gbas {
    epsilon: f64,
    delta: f64,
    needed: u64,
    cap: Option<u64>,
    seed: u64,
    sum: f64,
}

impl Gbas {
    /// P(|estimate / P - 1| > epsilon) <= delta. Without a `cap` it never stops at P = 0; with one, a tenth
    /// of the error is kept for the Clopper-Pearson interval at the cap. `seed` addresses the exponential
    /// numbers, one per trial index.
    pub fn new(epsilon: f64, delta: f64, cap: Option<u64>, seed: u64) -> Result<Sequential<Self>, Invalid> {
        range("epsilon", epsilon, 1e-4, 0.999)?;
        probability("delta", delta)?;
        if let Some(cap) = cap {
            range("cap", cap as f64, 1.0, 1e15)?;
        }
        let own = if cap.is_some() { (1.0 - CAP_SHARE) * delta } else { delta };
        let needed = size(epsilon, own);
        Ok(Sequential::new(Self { epsilon, delta, needed, cap, seed, sum: 0.0 }))
    }

    /// Successes at which it stops.
    pub const fn needed(&self) -> u64 {
        self.needed
    }

    const fn succeeded(&self, counts: Counts) -> bool {
        counts.successes >= self.needed
    }
}

impl Rule for Gbas {
    type Answer = bool;

    #[inline]
    fn look(&mut self, counts: Counts, _: bool) -> bool {
        let key = TrialKey { seed: self.seed, index: counts.trials() - 1, branch: 0 };
        self.sum -= math::ln(Stream::of(key, 0, Purpose::Procedure).uniform(0));
        self.succeeded(counts) || self.cap.is_some_and(|cap| counts.trials() >= cap)
    }

    fn limit(&self) -> Option<u64> {
        self.cap
    }

    fn numbers(&self) -> Vec<(&'static str, f64)> {
        let cap = self.cap.map(|cap| ("cap", cap as f64));
        [("successes", self.needed as f64)].into_iter().chain(cap).collect()
    }
}

impl Estimator for Gbas {
    fn error(&self) -> f64 {
        self.delta
    }

    /// At its own stop the exact two-sided interval of the pivot P R, which has the law Gamma(k); at the cap
    /// a Clopper-Pearson interval, with upper end about 3/n without successes at 5 %.
    fn at_stop(&self, counts: Counts) -> Interval {
        if !self.succeeded(counts) {
            let at_cap = clopper_pearson::interval(counts, CAP_SHARE * self.delta);
            return Interval { error: self.delta, coverage: Coverage::Sequential, ..at_cap };
        }
        let own = if self.cap.is_some() { (1.0 - CAP_SHARE) * self.delta } else { self.delta };
        let k = self.needed as f64;
        Interval {
            // No probability is above 1, whatever the scheme says of one that is near it.
            low: math::at_most(gamma_quantile(k, 0.5 * own) / self.sum, 1.0),
            high: math::at_most(gamma_upper_quantile(k, 0.5 * own) / self.sum, 1.0),
            error: self.delta,
            coverage: Coverage::Sequential,
        }
    }

    fn estimate(&self, counts: Counts) -> f64 {
        if !self.succeeded(counts) {
            return counts.share();
        }
        math::at_most((self.needed as f64 - 1.0) / self.sum, 1.0)
    }

    fn is_capped(&self, counts: Counts) -> bool {
        !self.succeeded(counts)
    }
}

/// Trials after which it gives up.
pub(super) const CAP: u64 = 1_000_000;

#[cfg(test)]
mod tests {
    use super::*;

    /// T7.
    #[test]
    fn sizes_of_the_reference() {
        for (epsilon, k) in [(0.5, 17), (0.2, 97), (0.1, 385), (0.05, 1537)] {
            assert_eq!(size(epsilon, 0.05), k);
        }
    }

    #[test]
    fn what_is_certain_is_never_more_than_that() {
        for seed in 0..300 {
            let mut gbas = Gbas::new(0.5, 0.1, None, seed).unwrap();
            while !gbas.observe(true) {}
            let Interval { low, high, .. } = gbas.interval();
            assert!(low <= high && high <= 1.0 && gbas.estimate() <= 1.0, "seed {seed}: {low} {high}");
        }
    }

    #[test]
    fn at_the_cap_it_stops_with_an_upper_bound() {
        let mut gbas = Gbas::new(0.1, 0.05, Some(1000), 1).unwrap();
        while !gbas.observe(false) {}
        assert_eq!(gbas.counts().trials(), 1000);
        let interval = gbas.interval();
        assert!(interval.low == 0.0 && interval.high > 3e-3 && interval.high < 7e-3);
    }
}
