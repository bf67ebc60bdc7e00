//! The default choice among estimators of a probability, which may wait for the proof of a level.

use super::calibration::{self, Level, Patience};
use super::{AnyEstimator, Calibrated, Counts, Invalid, Okamoto, Readings, Rule, Sequential, Spending};
use std::collections::BTreeMap;

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
    use crate::stats::Outcome;

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
}
