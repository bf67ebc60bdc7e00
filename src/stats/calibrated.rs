//! Sequential Clopper-Pearson at a calibrated level: stop when the interval at level gamma is narrow
//! enough, where gamma is such that the whole procedure misses with probability at most delta.
//!
//! At gamma = delta the procedure misses more often than it says; how much smaller gamma must be is proven
//! in `calibration`. Related: Frey, "Fixed-width sequential confidence intervals for a proportion",
//! American Statistician 64 (2010).

use super::invalid::{Invalid, probability, range};
use super::width::Ahead;
use super::{Counts, Coverage, Estimator, Interval, clopper_pearson, sequence};

/// Estimates P within a half-width.
#[derive(Clone, Debug, PartialEq)]
pub struct Calibrated {
    epsilon: f64,
    delta: f64,
    gamma: f64,
    limit: u64,
    ahead: Ahead,
    counts: Counts,
    finished: bool,
    proven: bool,
}

impl Calibrated {
    /// Half-width `epsilon` at level `gamma`, of which the caller knows that it keeps the error below
    /// `delta`: from `calibration::level`.
    pub fn at_level(epsilon: f64, delta: f64, gamma: f64) -> Result<Self, Invalid> {
        range("epsilon", epsilon, 1e-5, 0.5)?;
        probability("delta", delta)?;
        probability("gamma", gamma)?;
        Ok(Self {
            epsilon,
            delta,
            gamma,
            limit: clopper_pearson::size(epsilon, gamma),
            ahead: Ahead::new(),
            counts: Counts::default(),
            finished: false,
            proven: true,
        })
    }

    /// The same where time ended before its level was known: it has the interval that holds at all times, and never
    /// stops by itself.
    pub fn without_level(epsilon: f64, delta: f64) -> Result<Self, Invalid> {
        Ok(Self { proven: false, ..Self::at_level(epsilon, delta, delta)? })
    }

    /// Whether its level is known.
    pub const fn is_proven(&self) -> bool {
        self.proven
    }

    /// The level at which the intervals are formed.
    pub const fn gamma(&self) -> f64 {
        self.gamma
    }
}

impl Estimator for Calibrated {
    #[inline]
    fn observe(&mut self, success: bool) -> bool {
        if !self.finished {
            self.counts.add(success);
            if !self.proven {
                return false;
            }
            let (gamma, width) = (self.gamma, 2.0 * self.epsilon);
            self.finished = self
                .ahead
                .reached(self.counts, self.limit, |counts| clopper_pearson::narrow(counts, gamma, width));
        }
        self.finished
    }

    fn finished(&self) -> bool {
        self.finished
    }

    fn counts(&self) -> Counts {
        self.counts
    }

    fn interval(&self) -> Interval {
        if !self.finished {
            return sequence::interval(self.counts, self.delta);
        }
        Interval {
            error: self.delta,
            coverage: Coverage::Sequential,
            ..clopper_pearson::interval(self.counts, self.gamma)
        }
    }

    fn limit(&self) -> Option<u64> {
        self.proven.then_some(self.limit)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::random::{Purpose, Stream, TrialKey};

    #[test]
    fn without_a_level_it_has_the_interval_of_all_times_and_never_stops() {
        let mut estimator = Calibrated::without_level(0.05, 0.05).unwrap();
        assert!((0..10_000u32).all(|k| !estimator.observe(k.is_multiple_of(4))));
        assert_eq!(estimator.interval(), sequence::interval(estimator.counts(), 0.05));
        assert!(estimator.limit().is_none() && !estimator.is_proven());
    }

    #[test]
    fn the_lazy_stop_is_the_stop_of_checking_every_index() {
        for (branch, p) in [0.0, 0.001, 0.01, 0.1, 0.3, 0.5, 0.93, 1.0].into_iter().enumerate() {
            let mut estimator = Calibrated::at_level(0.05, 0.05, 0.035).unwrap();
            for index in 0..10_000 {
                let key = TrialKey { seed: 3, index, branch: branch as u16 };
                let done = estimator.observe(Stream::of(key, 0, Purpose::Test).uniform(0) < p);
                let direct = clopper_pearson::interval(estimator.counts(), 0.035).half_width() <= 0.05;
                assert_eq!(done, direct, "{p} {index}");
                if done {
                    break;
                }
            }
            assert!(estimator.finished());
            assert!(estimator.counts().trials() <= 462);
        }
    }
}
