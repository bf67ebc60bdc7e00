//! What estimators of a probability have in common, and unresolved trials.

use super::{Counts, Interval, Readings, Rule, Sequential, sequence};

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

impl<R: Estimator + Clone> Readings<R> {
    /// The interval that holds both readings: each reading's own probability is missed with at most the estimator's
    /// error.
    pub fn interval(&self) -> Interval {
        let (low, high) = self.readings();
        if std::ptr::eq(low, high) { low.interval() } else { low.interval().hull(high.interval()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stats::{Calibrated, Coverage, FixedSize, Outcome};

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
