//! Sequential Clopper-Pearson at a calibrated level: stop when the interval at level gamma is narrow
//! enough, where gamma is such that the whole procedure misses with probability at most delta.
//!
//! At gamma = delta the procedure misses more often than it says; how much smaller gamma must be is proven
//! in `calibration`. The proof can wait: as long as the interval at gamma = delta is wide, so are those of all
//! smaller levels, and the procedure goes on whatever its level is. Related: Frey, "Fixed-width sequential confidence intervals for a proportion",
//! American Statistician 64 (2010).

use crate::stats::invalid::{Invalid, probability, range};
use crate::stats::width::Ahead;
use crate::stats::{
    Counts, Coverage, Estimator, Interval, Rule, Sequential, calibration, clopper_pearson, okamoto,
};

/// Estimates P within a half-width.
#[derive(Clone, Debug, PartialEq)]
pub struct Calibrated {
    epsilon: f64,
    delta: f64,
    gamma: f64,
    limit: u64,
    ahead: Ahead,
    /// Whether the level still has to be found.
    open: bool,
    /// Whether nothing more is to be read before it is.
    waits: bool,
    /// Whether what it has read depends on the level.
    used: bool,
}

impl Calibrated {
    /// Half-width `epsilon` at level `gamma`, of which the caller knows that it keeps the error below
    /// `delta`: from `calibration::level`.
    pub fn at_level(epsilon: f64, delta: f64, gamma: f64) -> Result<Sequential<Self>, Invalid> {
        Self::rule(epsilon, delta, gamma).map(Sequential::new)
    }

    pub(in crate::stats) fn rule(epsilon: f64, delta: f64, gamma: f64) -> Result<Self, Invalid> {
        range("epsilon", epsilon, 1e-5, 0.5)?;
        probability("delta", delta)?;
        probability("gamma", gamma)?;
        Ok(Self {
            epsilon,
            delta,
            gamma,
            limit: clopper_pearson::size(epsilon, gamma),
            ahead: Ahead::new(),
            open: false,
            waits: false,
            used: true,
        })
    }

    /// The same where the level is still to be found: reads outcomes as long as no level can stop it, then waits.
    pub fn without_level(epsilon: f64, delta: f64) -> Result<Sequential<Self>, Invalid> {
        let rule = Self::rule(epsilon, delta, delta)?;
        Ok(Sequential::new(Self { open: true, used: false, ..rule }))
    }

    /// Goes on at its level after outcomes at which it cannot have stopped, but for the last.
    pub(in crate::stats) fn resumed(mut self, counts: Counts) -> Sequential<Self> {
        let before = counts.trials();
        let finished = before >= self.limit
            || (before > 0 && clopper_pearson::narrow(counts, self.gamma, 2.0 * self.epsilon));
        self.used = finished || before == 0;
        Sequential::resumed(self, counts, finished)
    }

    /// Half-width and error.
    pub const fn asked(&self) -> (f64, f64) {
        (self.epsilon, self.delta)
    }

    /// Whether it waits, and may turn out to have stopped with its last outcome: at few trials the largest level that
    /// can be proven may have come to its stop, too.
    pub(in crate::stats) fn may_have_stopped(&self, counts: Counts) -> bool {
        let largest = calibration::LARGEST_SHARE * self.delta;
        self.waits
            && (counts.trials() >= self.limit || clopper_pearson::narrow(counts, largest, 2.0 * self.epsilon))
    }

    /// Whether its level still has to be found.
    pub const fn is_open(&self) -> bool {
        self.open
    }

    /// The level at which the intervals are formed, if what it has read depends on it.
    pub fn gamma(&self) -> Option<f64> {
        self.used.then_some(self.gamma)
    }
}

impl Rule for Calibrated {
    type Answer = bool;

    #[inline]
    fn look(&mut self, counts: Counts, _: bool) -> bool {
        let (gamma, width) = (self.gamma, 2.0 * self.epsilon);
        let narrow =
            self.ahead.reached(counts, self.limit, |counts| clopper_pearson::narrow(counts, gamma, width));
        if self.open {
            self.waits = narrow;
            return false;
        }
        self.used = true;
        narrow
    }

    fn limit(&self) -> Option<u64> {
        // Where no level can be proven, the least of two others is taken, and this is one of them.
        Some(if self.open { okamoto::size(self.epsilon, self.delta) } else { self.limit })
    }

    #[inline]
    fn waits(&self) -> bool {
        self.waits
    }

    fn numbers(&self) -> Vec<(&'static str, f64)> {
        self.gamma().map(|gamma| ("gamma", gamma)).into_iter().collect()
    }
}

impl Estimator for Calibrated {
    fn error(&self) -> f64 {
        self.delta
    }

    fn at_stop(&self, counts: Counts) -> Interval {
        Interval {
            error: self.delta,
            coverage: Coverage::Sequential,
            ..clopper_pearson::interval(counts, self.gamma)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::random::{Purpose, Stream, TrialKey};
    use crate::stats::sequence;

    #[test]
    fn found_late_the_level_stops_it_where_it_would_have_stopped() {
        for (epsilon, delta, gamma) in [(0.05, 0.05, 0.036), (0.1, 0.02, 0.012_8), (0.3, 0.1, 0.04)] {
            for step in [2, 3, 7, 100_000] {
                let outcome = |k: u64| k % step == 1;
                let mut known = Calibrated::at_level(epsilon, delta, gamma).unwrap();
                let mut late = Calibrated::without_level(epsilon, delta).unwrap();
                let mut k = 0;
                while !late.rule().waits() {
                    assert_eq!(late.interval(), sequence::interval(late.counts(), delta));
                    assert!(
                        !late.observe(outcome(k)) && late.rule().gamma().is_none() && late.rule().is_open()
                    );
                    k += 1;
                }
                assert!(k < late.limit().unwrap());
                let mut late = Calibrated::rule(epsilon, delta, gamma).unwrap().resumed(late.counts());
                assert!(late.finished() || late.rule().gamma().is_none());
                assert!((0..k).all(|k| !known.observe(outcome(k)) || k + 1 == late.counts().trials()));
                while !late.finished() {
                    let (outcome, before) = (outcome(k), known.finished());
                    assert!(!before && late.observe(outcome) == known.observe(outcome));
                    assert_eq!(late.rule().gamma(), Some(gamma));
                    k += 1;
                }
                assert_eq!((late.counts(), late.interval()), (known.counts(), known.interval()));
            }
        }
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
