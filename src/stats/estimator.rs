//! What estimators of a probability have in common, the default choice, and unresolved trials.

use super::calibration::{self, Level, Patience};
use super::{Calibrated, Counts, FixedSize, Gbas, Invalid, Massart, Okamoto, Outcome, Spending};
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

/// An estimator of a probability that reads outcomes in index order.
pub trait Estimator {
    /// Reads the next outcome; true once finished. Outcomes after that are ignored.
    fn observe(&mut self, success: bool) -> bool;

    /// Whether it has stopped.
    fn finished(&self) -> bool;

    /// The outcomes read.
    fn counts(&self) -> Counts;

    /// Once finished, the interval with the procedure's own guarantee; before, the time-uniform interval
    /// of the confidence sequence at the same error, which holds at any deadline.
    fn interval(&self) -> Interval;

    /// The point estimate.
    fn estimate(&self) -> f64 {
        self.counts().share()
    }

    /// The number of trials after which it has surely stopped, if it has one.
    fn limit(&self) -> Option<u64>;

    /// Whether it has to know more of itself before it can read more.
    #[inline]
    fn waits(&self) -> bool {
        false
    }
}

/// Any of the estimators.
#[derive(Clone, Debug)]
pub enum AnyEstimator {
    /// Calibrated sequential Clopper-Pearson.
    Calibrated(Calibrated),
    /// Clopper-Pearson with the error spent over geometric looks.
    Spending(Spending),
    /// Fixed size by Okamoto and Hoeffding.
    Okamoto(Okamoto),
    /// Sequential Massart.
    Massart(Massart),
    /// Clopper-Pearson at a fixed size.
    FixedSize(FixedSize),
    /// Relative error.
    Gbas(Gbas),
}

impl AnyEstimator {
    /// The default for half-width `epsilon` and error `delta`: calibrated sequential Clopper-Pearson where
    /// the level, or that of a slightly smaller error, is in the proven table or can be proven in seconds (Okamoto's
    /// size is that small), else whichever of alpha spending and Okamoto has the smaller largest number of trials.
    ///
    /// Which one it is depends on `epsilon` and `delta` alone. Where it takes a proof to know, that can wait: the
    /// estimator reads outcomes up to where it `waits`, and goes on once the level is `settle`d.
    pub fn within(epsilon: f64, delta: f64) -> Result<Self, Invalid> {
        match calibration::known(epsilon, delta) {
            Some(level) => Self::with(epsilon, delta, level, Counts::default()),
            None => Ok(Self::Calibrated(Calibrated::without_level(epsilon, delta)?)),
        }
    }

    /// The default, if that is what there is of a level, after outcomes at which it cannot have stopped, but for the last.
    fn with(epsilon: f64, delta: f64, level: Level, counts: Counts) -> Result<Self, Invalid> {
        let (spending, okamoto) = (Spending::new(epsilon, delta)?, Okamoto::new(epsilon, delta)?);
        if let Level::Proven(gamma) = level {
            let calibrated = Calibrated::at_level(epsilon, delta, gamma)?;
            if calibrated.limit() <= okamoto.limit() {
                return Ok(Self::Calibrated(calibrated.after(counts)));
            }
        }
        Ok(if spending.limit() < okamoto.limit() {
            Self::Spending(spending.after(counts))
        } else {
            Self::Okamoto(okamoto.after(counts))
        })
    }

    /// Goes on with what is now known of its level.
    fn settle(&mut self, level: Level) -> Result<(), Invalid> {
        if let Self::Calibrated(open) = self
            && open.is_open()
        {
            let (epsilon, delta) = open.asked();
            *self = Self::with(epsilon, delta, level, open.counts())?;
        }
        Ok(())
    }

    fn inner(&self) -> &dyn Estimator {
        match self {
            Self::Calibrated(e) => e,
            Self::Spending(e) => e,
            Self::Okamoto(e) => e,
            Self::Massart(e) => e,
            Self::FixedSize(e) => e,
            Self::Gbas(e) => e,
        }
    }
}

impl Estimator for AnyEstimator {
    #[inline]
    fn observe(&mut self, success: bool) -> bool {
        match self {
            Self::Calibrated(e) => e.observe(success),
            Self::Spending(e) => e.observe(success),
            Self::Okamoto(e) => e.observe(success),
            Self::Massart(e) => e.observe(success),
            Self::FixedSize(e) => e.observe(success),
            Self::Gbas(e) => e.observe(success),
        }
    }

    // Asked at each trial: no way through a table of functions.
    #[inline]
    fn finished(&self) -> bool {
        match self {
            Self::Calibrated(e) => e.finished(),
            Self::Spending(e) => e.finished(),
            Self::Okamoto(e) => e.finished(),
            Self::Massart(e) => e.finished(),
            Self::FixedSize(e) => e.finished(),
            Self::Gbas(e) => e.finished(),
        }
    }

    fn counts(&self) -> Counts {
        self.inner().counts()
    }

    fn interval(&self) -> Interval {
        self.inner().interval()
    }

    fn estimate(&self) -> f64 {
        self.inner().estimate()
    }

    fn limit(&self) -> Option<u64> {
        self.inner().limit()
    }

    #[inline]
    fn waits(&self) -> bool {
        matches!(self, Self::Calibrated(e) if e.waits())
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

/// An estimator over outcomes of which some are unresolved: it runs with all of them as failures and with
/// all of them as successes, each to its own stop.
///
/// The interval holds both readings; each reading's own probability is missed with at most the
/// estimator's error.
#[derive(Clone, Debug)]
pub struct EstimatorReadings<E> {
    pessimistic: E,
    optimistic: Option<E>,
    unresolved: u64,
    read: u64,
}

impl<E: Estimator + Clone> EstimatorReadings<E> {
    /// Around a fresh estimator.
    pub const fn new(estimator: E) -> Self {
        Self { pessimistic: estimator, optimistic: None, unresolved: 0, read: 0 }
    }

    /// Reads the next outcome; true once both readings have stopped, or one waits.
    #[inline]
    pub fn observe(&mut self, outcome: Outcome) -> bool {
        if self.finished() || self.waits() {
            return true;
        }
        self.read += 1;
        if outcome == Outcome::Unresolved {
            self.unresolved += 1;
            if self.optimistic.is_none() {
                self.optimistic = Some(self.pessimistic.clone());
            }
        }
        let low = self.pessimistic.observe(outcome == Outcome::True);
        let both = match &mut self.optimistic {
            None => low,
            Some(estimator) => estimator.observe(outcome != Outcome::False) && low,
        };
        both || self.waits()
    }

    /// Whether a reading has to know more of itself before more can be read.
    #[inline]
    pub fn waits(&self) -> bool {
        self.pessimistic.waits() || self.optimistic.as_ref().is_some_and(Estimator::waits)
    }

    /// Whether both readings have stopped.
    #[inline]
    pub fn finished(&self) -> bool {
        self.pessimistic.finished() && self.optimistic.as_ref().is_none_or(Estimator::finished)
    }

    /// The interval that holds both readings.
    pub fn interval(&self) -> Interval {
        let low = self.pessimistic.interval();
        self.optimistic.as_ref().map_or(low, |e| low.hull(e.interval()))
    }

    /// Outcomes read, and how many of them were unresolved.
    pub const fn read(&self) -> (u64, u64) {
        (self.read, self.unresolved)
    }

    /// The two readings: unresolved trials as failures, as successes.
    pub fn readings(&self) -> (&E, &E) {
        (&self.pessimistic, self.optimistic.as_ref().unwrap_or(&self.pessimistic))
    }
}

impl EstimatorReadings<AnyEstimator> {
    /// Whether a reading that waits may turn out to have stopped with its last outcome.
    pub fn may_have_stopped(&self) -> bool {
        let may = |one: &AnyEstimator| matches!(one, AnyEstimator::Calibrated(one) if one.may_have_stopped());
        may(&self.pessimistic) || self.optimistic.as_ref().is_some_and(may)
    }

    /// Both readings go on with what is now known of their level. Fails as making the estimator does.
    pub fn settle(&mut self, level: Level) -> Result<(), Invalid> {
        self.pessimistic.settle(level)?;
        self.optimistic.as_mut().map_or(Ok(()), |estimator| estimator.settle(level))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_default_takes_the_table_then_proves_then_falls_back() {
        let is_open = |made: Result<AnyEstimator, Invalid>| match made {
            Ok(AnyEstimator::Calibrated(one)) => Some(one.is_open()),
            _ => None,
        };
        assert_eq!(is_open(AnyEstimator::within(0.01, 0.05)), Some(false));
        assert_eq!(is_open(AnyEstimator::within(0.08, 0.02)), Some(true));
        assert!(matches!(AnyEstimator::within(0.0015, 0.05), Ok(AnyEstimator::Okamoto(_))));
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
        let mut late = EstimatorReadings::new(AnyEstimator::within(0.08, 0.02).unwrap());
        let known = AnyEstimator::with(0.08, 0.02, level, Counts::default()).unwrap();
        let mut known = EstimatorReadings::new(known);
        let mut k = 0;
        while !late.observe(outcome(k)) {
            k += 1;
        }
        assert!(late.waits() && !late.finished() && late.observe(Outcome::True));
        assert_eq!(late.read().0, u64::from(k) + 1);
        late.settle(level).unwrap();
        assert!((0..k).all(|k| !known.observe(outcome(k))));
        known.observe(outcome(k));
        while !late.finished() {
            k += 1;
            assert_eq!(late.observe(outcome(k)), known.observe(outcome(k)));
        }
        assert_eq!((late.interval(), late.read()), (known.interval(), known.read()));
        assert!(known.finished());
    }

    #[test]
    fn no_level_is_taken_up_in_the_middle_too() {
        let mut late = AnyEstimator::within(0.08, 0.02).unwrap();
        assert!((0..100).all(|k| !late.observe(k % 2 == 0)));
        late.settle(Level::None).unwrap();
        assert!(matches!(late, AnyEstimator::Okamoto(_) | AnyEstimator::Spending(_)), "{late:?}");
        assert_eq!(late.counts().trials(), 100);
    }

    #[test]
    fn a_reading_that_goes_on_has_an_interval_of_all_times_and_so_have_both() {
        let mut readings = EstimatorReadings::new(Calibrated::at_level(0.1, 0.05, 0.033).unwrap());
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
        let mut readings = EstimatorReadings::new(FixedSize::new(100, 0.05).unwrap());
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
        assert_eq!(readings.read(), (100, 10));
    }
}
