//! What estimators of a probability have in common, the default choice, and unresolved trials.

use super::calibration::{self, Level, Patience};
use super::spec::{DELTA, EPSILON, Forecast, Guess, Make, Serves, Spec};
use super::{
    AnyEstimator, Calibrated, Counts, Invalid, Okamoto, Readings, Rule, Sequential, Spending, sequence,
};
use crate::base::math;
use crate::base::special::normal_quantile;
use std::collections::BTreeMap;

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

/// The rule of an estimator of a probability: true once it has stopped.
pub trait Estimator: Rule<Answer = bool> {
    /// Bound on the probability that its interval misses.
    fn error(&self) -> f64;

    /// The interval at its stop, with the procedure's own guarantee.
    fn at_stop(&self, counts: Counts) -> Interval;

    /// The point estimate.
    fn estimate(&self, counts: Counts) -> f64 {
        counts.share()
    }

    /// Whether, stopped at these counts, it did not come to what was asked: at its own largest number of trials.
    fn is_capped(&self, _: Counts) -> bool {
        false
    }
}

impl<R: Estimator> Sequential<R> {
    /// Once finished, the interval with the procedure's own guarantee; before, the time-uniform interval
    /// of the confidence sequence at the same error, which holds at any deadline.
    pub fn interval(&self) -> Interval {
        if self.finished() {
            self.rule().at_stop(self.counts())
        } else {
            sequence::interval(self.counts(), self.rule().error())
        }
    }

    /// The point estimate.
    pub fn estimate(&self) -> f64 {
        self.rule().estimate(self.counts())
    }
}

/// The default of estimates of a probability, which nothing names.
pub const DEFAULT: Spec = Spec {
    name: "default",
    reported: "calibrated",
    serves: Serves::Probability,
    arguments: &[EPSILON, DELTA],
    summary: "fewest trials for ± {epsilon}, error {delta}",
    guarantee: "P in the interval of half width epsilon",
    make: Make::Estimator(|values, _| AnyEstimator::within(values[0], values[1])),
    forecast: Some(Forecast { trials: until_narrow, scatter: WIDTH_SCATTER }),
};

/// Factors of forecasts of estimates.
pub(super) const WIDTH_SCATTER: (f64, f64) = (0.8, 1.25);

/// Trials of the arguments epsilon, delta: the normal approximation, with a factor for looking after each trial.
pub(super) fn until_narrow(values: &[f64], guess: &Guess) -> f64 {
    let (epsilon, p) = (values[0], guess.share);
    let z = normal_quantile(1.0 - 0.5 * values[1]);
    1.15 * z * z * p * (1.0 - p) / (epsilon * epsilon) + 2.0 / epsilon
}

impl Estimator for AnyEstimator {
    fn error(&self) -> f64 {
        self.inner().error()
    }

    fn at_stop(&self, counts: Counts) -> Interval {
        self.inner().at_stop(counts)
    }

    fn estimate(&self, counts: Counts) -> f64 {
        self.inner().estimate(counts)
    }

    fn is_capped(&self, counts: Counts) -> bool {
        self.inner().is_capped(counts)
    }
}

impl AnyEstimator {
    /// The default for half-width `epsilon` and error `delta`: calibrated sequential Clopper-Pearson where
    /// the level, or that of a slightly smaller error, is in the proven table or can be proven in seconds (Okamoto's
    /// size is that small), else whichever of alpha spending and Okamoto has the smaller largest number of trials.
    ///
    /// Which one it is depends on `epsilon` and `delta` alone. Where it takes a proof to know, that can wait: the
    /// estimator reads outcomes up to where it `waits`, and goes on once the level is `settle`d.
    pub fn within(epsilon: f64, delta: f64) -> Result<Sequential<Self>, Invalid> {
        match calibration::known(epsilon, delta) {
            Some(level) => Self::with(epsilon, delta, level, Counts::default()),
            None => Ok(Calibrated::without_level(epsilon, delta)?.into_any()),
        }
    }

    /// The default, if that is what there is of a level, after outcomes at which it cannot have stopped, but for the last.
    fn with(epsilon: f64, delta: f64, level: Level, counts: Counts) -> Result<Sequential<Self>, Invalid> {
        let (spending, okamoto) = (Spending::rule(epsilon, delta)?, Okamoto::rule(epsilon, delta)?);
        if let Level::Proven(gamma) = level {
            let calibrated = Calibrated::rule(epsilon, delta, gamma)?;
            if calibrated.limit() <= okamoto.limit() {
                return Ok(calibrated.resumed(counts).into_any());
            }
        }
        Ok(if spending.limit() < okamoto.limit() {
            spending.resumed(counts).into_any()
        } else {
            let finished = okamoto.limit().is_some_and(|size| counts.trials() >= size);
            Sequential::resumed(okamoto.into(), counts, finished)
        })
    }

    /// The name of what the default turned out to be.
    pub fn chosen(&self) -> &'static str {
        match self {
            // It was stopped before it mattered which procedure it is.
            Self::Calibrated(rule) if rule.gamma().is_none() => "default",
            Self::Calibrated(_) => "calibrated",
            Self::Spending(_) => "spending",
            _ => "okamoto",
        }
    }
}

/// Levels that were proven before, by half-width and error: a proof takes seconds, and the points of a sweep ask for
/// the same one.
#[derive(Clone, Debug, Default)]
pub struct Levels(BTreeMap<(u64, u64), Level>);

impl Levels {
    /// What there is of a level; `None` if the proof is given up.
    pub fn find(&mut self, epsilon: f64, delta: f64, patience: Patience<'_>) -> Option<Level> {
        let key = (epsilon.to_bits(), delta.to_bits());
        if let Some(known) = self.0.get(&key) {
            return Some(*known);
        }
        let level = calibration::level(epsilon, delta, patience)?;
        self.0.insert(key, level);
        Some(level)
    }
}

impl<R: Estimator + Clone> Readings<R> {
    /// The interval that holds both readings: each reading's own probability is missed with at most the estimator's
    /// error.
    pub fn interval(&self) -> Interval {
        let (low, high) = self.readings();
        if std::ptr::eq(low, high) { low.interval() } else { low.interval().hull(high.interval()) }
    }
}

impl Readings<AnyEstimator> {
    /// Half-width and error of the level that it has to know before it can read more.
    pub fn waits_for(&self) -> Option<(f64, f64)> {
        match self.readings().0.rule() {
            AnyEstimator::Calibrated(rule) if self.waits() => Some(rule.asked()),
            _ => None,
        }
    }

    /// Whether a reading that waits may turn out to have stopped with its last outcome.
    pub fn may_have_stopped(&self) -> bool {
        let may = |one: &Sequential<AnyEstimator>| match one.rule() {
            AnyEstimator::Calibrated(rule) => rule.may_have_stopped(one.counts()),
            _ => false,
        };
        let (low, high) = self.readings();
        may(low) || may(high)
    }

    /// Both readings go on with what is now known of their level. Fails as making the estimator does.
    pub fn settled(&self, level: Level) -> Result<Self, Invalid> {
        self.clone().map(|one| match one.rule() {
            AnyEstimator::Calibrated(open) if open.is_open() => {
                let (epsilon, delta) = open.asked();
                AnyEstimator::with(epsilon, delta, level, one.counts())
            }
            _ => Ok(one),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stats::{FixedSize, Outcome};

    #[test]
    fn the_default_takes_the_table_then_proves_then_falls_back() {
        let is_open = |epsilon, delta| match AnyEstimator::within(epsilon, delta).unwrap().rule() {
            AnyEstimator::Calibrated(one) => Some(one.is_open()),
            _ => None,
        };
        assert_eq!(is_open(0.01, 0.05), Some(false));
        assert_eq!(is_open(0.08, 0.02), Some(true));
        assert_eq!(AnyEstimator::within(0.0015, 0.05).unwrap().rule().chosen(), "okamoto");
        assert!(AnyEstimator::within(0.0, 0.05).is_err());
        assert!(AnyEstimator::within(0.6, 0.05).is_err());
        assert!(AnyEstimator::within(0.01, 1.0).is_err());
    }

    #[test]
    fn both_readings_wait_and_go_on_together() {
        let mut levels = Levels::default();
        let level = levels.find(0.08, 0.02, Patience::ENDLESS).unwrap();
        assert!(matches!(level, Level::Proven(gamma) if gamma < 0.02));
        assert_eq!(levels.find(0.08, 0.02, Patience { go_on: &|| false }), Some(level));
        assert_eq!(levels.find(0.08, 0.03, Patience { go_on: &|| false }), None);
        let outcome = |k: u32| match k % 9 {
            0 => Outcome::Unresolved,
            1..4 => Outcome::True,
            _ => Outcome::False,
        };
        let mut late = Readings::new(AnyEstimator::within(0.08, 0.02).unwrap());
        let known = AnyEstimator::with(0.08, 0.02, level, Counts::default()).unwrap();
        let mut known = Readings::new(known);
        let mut k = 0;
        while !late.observe(outcome(k)) {
            k += 1;
        }
        assert!(late.waits() && !late.finished() && late.observe(Outcome::True));
        assert_eq!(late.readings().1.counts().trials(), u64::from(k) + 1);
        late = late.settled(level).unwrap();
        assert!((0..k).all(|k| !known.observe(outcome(k))));
        known.observe(outcome(k));
        while !late.finished() {
            k += 1;
            assert_eq!(late.observe(outcome(k)), known.observe(outcome(k)));
        }
        let read = |both: &Readings<AnyEstimator>| (both.readings().0.counts(), both.readings().1.counts());
        assert_eq!((late.interval(), read(&late)), (known.interval(), read(&known)));
        assert!(known.finished());
    }

    #[test]
    fn no_level_is_taken_up_in_the_middle_too() {
        let mut late = Readings::new(AnyEstimator::within(0.08, 0.02).unwrap());
        assert!((0..100).all(|k| !late.observe(Outcome::from(k % 2 == 0))));
        let late = late.settled(Level::None).unwrap();
        let late = late.readings().0;
        assert!(matches!(late.rule(), AnyEstimator::Okamoto(_) | AnyEstimator::Spending(_)), "{late:?}");
        assert_eq!(late.counts().trials(), 100);
    }

    #[test]
    fn a_reading_that_goes_on_has_an_interval_of_all_times_and_so_have_both() {
        let mut readings = Readings::new(Calibrated::at_level(0.1, 0.05, 0.033).unwrap());
        readings.observe(Outcome::Unresolved);
        let mut trials = 1;
        while !readings.readings().0.finished() {
            // One reading sees none, and soon stops; the other sees a third.
            readings.observe(if trials % 3 == 0 { Outcome::Unresolved } else { Outcome::False });
            trials += 1;
        }
        assert!(!readings.finished() && trials < 40, "{trials}");
        assert_eq!(readings.readings().0.interval().coverage, Coverage::Sequential);
        assert_eq!(readings.interval().coverage, Coverage::TimeUniform);
    }

    #[test]
    fn the_interval_holds_both_readings() {
        let mut readings = Readings::new(FixedSize::new(100, 0.05).unwrap());
        for k in 0..100 {
            readings.observe(match k % 10 {
                0 => Outcome::Unresolved,
                1..5 => Outcome::True,
                _ => Outcome::False,
            });
        }
        assert!(readings.finished());
        let (low, high) = readings.readings();
        assert_eq!((low.counts().successes, high.counts().successes), (40, 50));
        let interval = readings.interval();
        assert_eq!((interval.low, interval.high), (low.interval().low, high.interval().high));
        assert_eq!((low.counts().trials(), high.counts().trials()), (100, 100));
    }
}
