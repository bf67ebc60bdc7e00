//! The mean of a bounded metric: the predictable plug-in empirical Bernstein confidence sequence of
//! Waudby-Smith and Ramdas, "Estimating means of bounded random variables by betting", JRSS B 86 (2024),
//! at 0.8 of the error, capped by Hoeffding's bound at the other 0.2; or at the whole of the error, where there
//! is no cap. Or, at Okamoto's size, Hoeffding's interval alone, at the whole of the error.

use super::invalid::{Invalid, range};
use super::{Coverage, Intake, Interval};
use crate::base::math;
use std::ops::Deref;

/// The share of the error for the sequence; the rest is for the cap.
const SEQUENCE_SHARE: f64 = 0.8;

/// The confidence sequence of one reading, on [0, 1].
#[derive(Clone, Debug, Default, PartialEq)]
struct Sequence {
    /// ln(2 / error).
    ln_error: f64,
    /// Number of trials that bets aim at; None bets for all times.
    aim: Option<f64>,
    /// Trials, their sum, and the sum of squared deviations from the running means.
    n: u64,
    sum: f64,
    /// Least and largest value so far, in the unit of the metric.
    ends: (f64, f64),
    squares: f64,
    /// Sums of bets, of bets times values, and of the variance terms.
    bets: f64,
    weighted: f64,
    variance: f64,
}

impl Sequence {
    fn new(error: f64, aim: Option<u64>) -> Self {
        Self {
            ln_error: math::ln(2.0 / error),
            aim: aim.map(|n| n as f64),
            ends: (f64::INFINITY, f64::NEG_INFINITY),
            ..Self::default()
        }
    }

    fn push(&mut self, x: f64, value: f64) {
        self.ends = (math::at_most(self.ends.0, value), math::at_least(self.ends.1, value));
        let before = self.n as f64;
        let t = before + 1.0;
        // One pseudo-observation: mean 1/2, variance 1/4.
        let mean = (0.5 + self.sum) / t;
        let spread = (0.25 + self.squares) / t;
        let horizon = self.aim.unwrap_or_else(|| t * math::ln(1.0 + t));
        let bet = math::at_most((2.0 * self.ln_error / (spread * horizon)).sqrt(), 0.5);
        let deviation = x - mean;
        self.n += 1;
        self.sum += x;
        let after = (0.5 + self.sum) / (t + 1.0);
        self.squares += (x - after) * (x - after);
        self.bets += bet;
        self.weighted += bet * x;
        self.variance += deviation * deviation * (-math::ln_1p(-bet) - bet);
    }

    /// Centre and radius.
    fn interval(&self) -> (f64, f64) {
        if self.n == 0 {
            return (0.5, 0.5);
        }
        (self.weighted / self.bets, (self.ln_error + self.variance) / self.bets)
    }
}

/// Estimates the mean of a metric with a declared range.
///
/// Values outside of the range are clipped and counted. Unresolved trials are read as the lower end of the
/// range and as the upper end; the interval holds both readings, and is as narrow as asked for once both together are,
/// unless they lie so far apart that this is not worth it, or the largest number of trials comes before.
#[derive(Clone, Debug, PartialEq)]
pub struct Mean {
    intake: Intake,
    /// The part of the error that is for the cap.
    cap: f64,
    /// Half-width of the interval at the planned number of trials, over the range, where there is a plan.
    planned: Option<f64>,
    lower: Sequence,
    /// The reading with unresolved trials at the upper end, once there are any.
    upper: Option<Sequence>,
}

impl Deref for Mean {
    type Target = Intake;

    fn deref(&self) -> &Intake {
        &self.intake
    }
}

impl Mean {
    /// Values in [low, high], half-width `epsilon` in the same unit, error `delta`.
    pub fn within(low: f64, high: f64, epsilon: f64, delta: f64) -> Result<Self, Invalid> {
        let intake = Intake::new(low, high, delta, 0)?;
        let part = range("epsilon over the range", epsilon / (high - low), 1e-6, 0.5)?;
        let cap = (1.0 - SEQUENCE_SHARE) * delta;
        let limit = super::okamoto::size(part, cap);
        Ok(Self::new(Intake { epsilon: Some(part), limit, ..intake }, cap, None))
    }

    /// Values in [low, high], a fixed number of trials, error `delta`.
    pub fn fixed(low: f64, high: f64, trials: u64, delta: f64) -> Result<Self, Invalid> {
        range("trials", trials as f64, 1.0, 1e15)?;
        let intake = Intake::new(low, high, delta, trials)?;
        Ok(Self::new(intake, (1.0 - SEQUENCE_SHARE) * delta, Some(trials)))
    }

    /// Values in [low, high], Okamoto's number of trials for half-width `epsilon` in the same unit at error `delta`: the
    /// interval is then `epsilon` around the mean. Before, it is that of the sequence at the whole error.
    pub fn planned(low: f64, high: f64, epsilon: f64, delta: f64) -> Result<Self, Invalid> {
        let part = range("epsilon over the range", epsilon / (high - low), 1e-6, 0.5)?;
        let trials = super::okamoto::size(part, delta);
        let intake = Intake::new(low, high, delta, trials)?;
        Ok(Self { planned: Some(part), ..Self::new(intake, 0.0, Some(trials)) })
    }

    /// Values in [low, high], error `delta`, as many trials as somebody shows it: the bets are for all times alike, so
    /// that the interval may be looked at after each trial and is narrow at small numbers of them too.
    pub fn running(low: f64, high: f64, delta: f64) -> Result<Self, Invalid> {
        Ok(Self::new(Intake::new(low, high, delta, u64::MAX)?, 0.0, None))
    }

    fn new(intake: Intake, cap: f64, aim: Option<u64>) -> Self {
        let lower = Sequence::new(intake.delta - cap, aim);
        Self { intake, cap, planned: None, lower, upper: None }
    }

    /// Reads the next value, `None` (or NaN) if it is unresolved; true once finished.
    pub fn observe(&mut self, value: Option<f64>) -> bool {
        match value.filter(|x| !x.is_nan()) {
            Some(value) => {
                self.intake.clipped += u64::from(!self.finished && (value < self.low || value > self.high));
                self.read_ends((value, value))
            }
            None => self.observe_between((self.low, self.high)),
        }
    }

    /// Reads an unresolved value, of which it is known between which ends it lies; true once finished.
    pub fn observe_between(&mut self, ends: (f64, f64)) -> bool {
        if !self.finished {
            self.intake.unresolved += 1;
            if self.upper.is_none() {
                self.upper = Some(self.lower.clone());
            }
        }
        self.read_ends(ends)
    }

    fn read_ends(&mut self, ends: (f64, f64)) -> bool {
        if self.finished {
            return true;
        }
        self.intake.read += 1;
        let (low, high) = (self.low, self.high);
        let push = |sequence: &mut Sequence, x: f64| {
            let x = math::at_most(math::at_least(x, low), high);
            sequence.push((x - low) / (high - low), x);
        };
        push(&mut self.lower, ends.0);
        if let Some(upper) = &mut self.upper {
            push(upper, ends.1);
        }
        self.intake.finished = self.lower.n >= self.limit || self.epsilon.is_some_and(|e| self.is_narrow(e));
        self.finished
    }

    /// Whether the interval of both readings is so narrow, or each of them is and they lie too far apart for both.
    fn is_narrow(&self, epsilon: f64) -> bool {
        let (centre, radius) = self.lower.interval();
        let Some(upper) = &self.upper else { return radius <= epsilon };
        let (other, reach) = upper.interval();
        let low = math::at_most(centre - radius, other - reach);
        let high = math::at_least(centre + radius, other + reach);
        let apart = (upper.sum - self.lower.sum) / upper.n as f64;
        0.5 * (high - low) <= epsilon || (radius <= epsilon && reach <= epsilon && apart > epsilon)
    }

    /// The largest number of trials that follows from a width, for reports.
    pub fn numbers(&self) -> Option<(&'static str, f64)> {
        let name = if self.epsilon.is_some() { "cap" } else { "trials" };
        (self.epsilon.is_some() || self.planned.is_some()).then_some((name, self.limit as f64))
    }

    /// The means of both readings; the same without unresolved trials.
    pub fn estimate(&self) -> (f64, f64) {
        let of = |s: &Sequence| {
            let mean = if s.n == 0 { 0.5 } else { s.sum / s.n as f64 };
            let mean = self.low + (self.high - self.low) * mean;
            // A mean lies among its values, however it is rounded: that of one value, again and again, is this value.
            if s.n == 0 { mean } else { math::at_most(math::at_least(mean, s.ends.0), s.ends.1) }
        };
        (of(&self.lower), of(self.upper.as_ref().unwrap_or(&self.lower)))
    }

    /// Whether how unresolved trials are read decides on which side of `theta` the mean is: each reading is on its own.
    /// Holds at all times.
    pub fn splits(&self, theta: f64) -> bool {
        let scaled = (theta - self.low) / (self.high - self.low);
        let beyond = |sequence: &Sequence, sign: f64| {
            let (centre, radius) = sequence.interval();
            sign * (centre - scaled) > radius
        };
        self.upper.as_ref().is_some_and(|upper| beyond(&self.lower, -1.0) && beyond(upper, 1.0))
    }

    /// The interval. It holds at all times, but at the end of a fixed number of trials at that one, where it is narrower.
    pub fn interval(&self) -> Interval {
        let one = |sequence: &Sequence| {
            let (centre, radius) = sequence.interval();
            let (mut low, mut high) = (centre - radius, centre + radius);
            if sequence.n >= self.limit {
                // At the number of trials fixed in advance Hoeffding's interval holds too.
                let n = sequence.n as f64;
                let mean = sequence.sum / n;
                (low, high) = if let Some(reach) = self.planned {
                    (mean - reach, mean + reach)
                } else {
                    let reach = (math::ln(2.0 / self.cap) / (2.0 * n)).sqrt();
                    (math::at_least(low, mean - reach), math::at_most(high, mean + reach))
                };
            }
            // The ends of the range are meant exactly.
            let scale = |x: f64| {
                if x <= 0.0 {
                    self.low
                } else if x >= 1.0 {
                    self.high
                } else {
                    self.low + (self.high - self.low) * x
                }
            };
            Interval {
                low: scale(low),
                high: scale(high),
                error: self.delta,
                coverage: if self.finished && self.is_fixed() {
                    Coverage::FixedSize
                } else {
                    Coverage::TimeUniform
                },
            }
        };
        let lower = one(&self.lower);
        self.upper.as_ref().map_or(lower, |upper| lower.hull(one(upper)))
    }
}

/// Trials until an interval of half width `epsilon` and error `delta` of a mean in a range of length `range`,
/// looked at after every trial: a normal approximation.
pub fn until_narrow(variance: f64, range: f64, epsilon: f64, delta: f64) -> f64 {
    let level = math::ln(2.0 / delta);
    2.6 * variance * level / (epsilon * epsilon) + 3.0 * range * level / epsilon
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_constant_is_soon_known_and_units_are_kept() {
        let mut mean = Mean::within(0.0, 60.0, 0.6, 0.05).unwrap();
        while !mean.observe(Some(15.0)) {}
        let interval = mean.interval();
        assert!(interval.holds(15.0) && interval.half_width() <= 0.6 + 1e-9);
        assert!(mean.read().0 < 1200, "{:?}", mean.read());
        assert_eq!(mean.limit(), 26_492);
    }

    #[test]
    fn the_mean_of_one_value_is_this_value() {
        for (low, high, value) in
            [(0.0, 3.0, 1.0), (0.0, 60.0, 0.1), (-0.7, 0.1, 0.1), (0.1, 0.7, 0.7), (0.1, 0.7, 0.3)]
        {
            for mut mean in [
                Mean::within(low, high, 0.02 * (high - low), 0.05).unwrap(),
                Mean::planned(low, high, 0.05 * (high - low), 0.05).unwrap(),
                Mean::fixed(low, high, 1000, 0.05).unwrap(),
            ] {
                while !mean.observe(Some(value)) {
                    assert_eq!(mean.estimate(), (value, value));
                }
                assert_eq!(mean.estimate(), (value, value));
                assert!(mean.interval().holds(value), "{value} in {:?}", mean.interval());
            }
        }
    }

    #[test]
    fn unresolved_trials_widen_to_both_ends_and_clipping_is_counted() {
        let mut mean = Mean::fixed(0.0, 1.0, 1000, 0.05).unwrap();
        for k in 0..1000 {
            mean.observe(match k % 10 {
                0 => None,
                1 => Some(7.0),
                _ => Some(0.5),
            });
        }
        assert!(mean.finished());
        let (low, high) = mean.estimate();
        assert!((low - 0.5).abs() < 1e-12 && (high - 0.6).abs() < 1e-12);
        assert_eq!(mean.read(), (1000, 100, 100));
        let interval = mean.interval();
        assert!(interval.low < 0.5 && interval.high > 0.6);
    }

    #[test]
    fn a_few_unresolved_trials_take_more_trials_and_many_end_it() {
        let run = |is_unresolved: fn(u32) -> bool| {
            let mut mean = Mean::within(0.0, 4.0, 0.3, 0.05).unwrap();
            let mut k = 0;
            while !mean.observe((!is_unresolved(k)).then_some(1.0)) {
                k += 1;
            }
            (mean.read().0, mean.interval())
        };
        let (none, few, many) = (run(|_| false), run(|k| k % 50 == 3), run(|k| k % 3 == 0));
        assert!(few.0 > none.0 && few.1.half_width() <= 0.3 + 1e-12, "{few:?}");
        // They lie 4/3 apart: no number of trials makes that less.
        assert!(many.1.half_width() > 0.6 && many.0 < 1_000, "{many:?}");
        assert!(many.1.low < 1.0 - 0.1 && many.1.high > 1.0 + 1.0);
    }

    #[test]
    fn an_unresolved_value_lies_between_what_is_known() {
        let mut mean = Mean::fixed(-4.0, 4.0, 100, 0.05).unwrap();
        for k in 0..100 {
            if k % 4 == 0 {
                mean.observe_between((-3.0, 1.0))
            } else {
                mean.observe(Some(0.0))
            };
        }
        assert_eq!(mean.estimate(), (-0.75, 0.25));
        assert_eq!(mean.read(), (100, 25, 0));
    }

    /// As for a probability, whose values are 0 and 1: the same size and the same interval.
    #[test]
    fn okamotos_size_gives_what_was_asked_for() {
        use crate::stats::Okamoto;
        let mut mean = Mean::planned(0.0, 1.0, 0.05, 0.05).unwrap();
        let mut share = Okamoto::new(0.05, 0.05).unwrap();
        assert_eq!((mean.limit(), mean.is_fixed()), (738, true));
        for k in 0..738u32 {
            let success = k.is_multiple_of(3);
            // Until it is over the interval is one that holds at all times.
            assert_eq!(mean.interval().coverage, Coverage::TimeUniform);
            assert_eq!(mean.observe(Some(f64::from(u8::from(success)))), share.observe(success));
        }
        let (one, other) = (mean.interval(), share.interval());
        assert_eq!((one.low, one.high, one.error), (other.low, other.high, other.error));
        assert!((one.half_width() - 0.05).abs() < 1e-15);
        // In the unit of the metric.
        let mut mean = Mean::planned(10.0, 30.0, 1.0, 0.05).unwrap();
        while !mean.observe(Some(20.0)) {}
        assert_eq!(mean.read().0, 738);
        assert!((mean.interval().low - 19.0).abs() < 1e-12 && (mean.interval().high - 21.0).abs() < 1e-12);
        assert!(Mean::planned(0.0, 1.0, 0.6, 0.05).is_err() && Mean::planned(1.0, 1.0, 0.1, 0.05).is_err());
    }

    /// Uniform values on 5 .. 15 in 0 .. 20, error 0.01: the mean lies above 9 after 275 trials or so, where Hoeffding's
    /// inequality takes 1060 at a size fixed beforehand; bets that aim at a million trials take thousands.
    #[test]
    fn a_threshold_is_passed_about_as_soon_as_it_can_be() {
        let passed = |mut mean: Mean| {
            let mut n = 0u64;
            while mean.interval().low <= 9.0 {
                // The golden ratio's multiples fill the interval evenly.
                let u = (n as f64 * 0.618_033_988_749_894_9).fract();
                mean.observe(Some(5.0 + 10.0 * u));
                n += 1;
            }
            n
        };
        let sequential = passed(Mean::running(0.0, 20.0, 0.01).unwrap());
        assert!((230..320).contains(&sequential), "{sequential}");
        assert!(passed(Mean::fixed(0.0, 20.0, 1_000_000, 0.01).unwrap()) > 4_000);
        let endless = Mean::running(0.0, 20.0, 0.01).unwrap();
        assert!(!endless.is_fixed() && !endless.finished());
    }

    #[test]
    fn bad_ranges_are_refused() {
        assert!(Mean::within(1.0, 1.0, 0.1, 0.05).is_err());
        assert!(Mean::within(0.0, f64::INFINITY, 0.1, 0.05).is_err());
        assert!(Mean::within(0.0, 1.0, 0.0, 0.05).is_err());
        assert!(Mean::fixed(0.0, 1.0, 0, 0.05).is_err());
    }
}
