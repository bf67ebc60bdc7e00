//! The statistical procedure of a check or an estimate, fed with cells in index order.

use crate::compile::study::{Ask, MeasureKind};
use crate::engine::fault::Fault;
use crate::engine::outcome::{Counts, Curve, CurvePoint, Distribution, Histogram, Interval, Quantile, Step};
use crate::stats::calibration::Level;
use crate::stats::quantile::Sample;
use crate::stats::ranking::Goal;
use crate::stats::spec::{Against, Make};
use crate::stats::test::Verdict as TestVerdict;
use crate::stats::{
    self, AnyEstimator, AnyTest, Bounded, Coverage, Decision, Estimator as _, Hypothesis, Outcome, Readings,
    Rule as _, Statement,
};
use crate::trials::cell::{Cell, Reading};

/// Bins of the histogram of a metric.
const BINS: usize = 40;
/// Most steps of an empirical distribution function.
const STEPS: usize = 100;
/// A procedure of one query.
pub(in crate::engine) enum Procedure {
    /// Is a probability above a threshold?
    Test(Box<Readings<AnyTest>>),
    /// What is a probability?
    Probability(Box<Readings<AnyEstimator>>),
    /// What is an expectation, and perhaps: is it above a threshold?
    Mean {
        /// The estimator.
        mean: Box<Bounded>,
        /// Threshold of a check.
        threshold: Option<f64>,
        /// Values, for the histogram.
        values: Vec<f64>,
    },
    /// What is a quantile?
    Quantile {
        /// The values.
        sample: Box<Sample>,
        /// Its level.
        level: f64,
        /// Error probability.
        delta: f64,
        /// Whether the interval is that of the band around the whole distribution function.
        band: bool,
    },
    /// What is a probability as a function of a time?
    Curve {
        /// The times of trials.
        sample: Box<Sample>,
        /// The points.
        times: Vec<f64>,
        /// Whether it is the probability that the time is above a point.
        falls: bool,
        /// The name of the bound, and its unit.
        names: (String, String),
        /// Error probability.
        delta: f64,
    },
}

/// The outcome of a cell for a procedure of probabilities.
pub(in crate::engine) fn outcome(cell: &Cell) -> Outcome {
    cell.reading.truth().map_or(Outcome::Unresolved, Outcome::from)
}

/// The value of a cell for a procedure of metrics.
pub(in crate::engine) fn value(cell: &Cell) -> Option<f64> {
    cell.reading.value()
}

/// What a cell counts for: a number, 1 or 0 for a truth value.
pub(in crate::engine) fn score(cell: &Cell) -> Option<f64> {
    cell.reading.value().or_else(|| cell.reading.truth().map(|held| f64::from(u8::from(held))))
}

/// What a measure aims at; `None` if options are not compared by it.
pub(in crate::engine) fn goal(kind: &MeasureKind) -> Option<Goal> {
    match kind {
        MeasureKind::Probability => Some(Goal::Probability),
        MeasureKind::Expectation { range, .. } => {
            Some(kind.share().map_or(Goal::Mean(*range), |share| Goal::Tail(*range, share)))
        }
        MeasureKind::Quantile { .. } | MeasureKind::Curve { .. } => None,
    }
}

/// The evidence of a test of a probability after its last outcome but one, and after the last one.
pub fn last_evidence(ask: &Ask, readings: &[Reading]) -> Option<[stats::Weights; 2]> {
    let Ok(Procedure::Test(mut test)) = Procedure::new(ask, 0) else { return None };
    let outcome = |reading: &Reading| reading.truth().map_or(Outcome::Unresolved, Outcome::from);
    let (last, others) = readings.split_last()?;
    for reading in others {
        test.observe(outcome(reading));
    }
    let before = test.weights()?;
    test.observe(outcome(last));
    Some([before, test.weights()?])
}

impl Procedure {
    /// The procedure of a check or an estimate. `seed` addresses what a procedure draws for itself.
    pub(in crate::engine) fn new(ask: &Ask, seed: u64) -> Result<Self, Fault> {
        let (measure, chosen, against) = match ask {
            Ask::Check { measure, at_least, or_equal, threshold, test, .. } => {
                // `>=` and `<` put the threshold above, `>` and `<=` below.
                let hypothesis = if at_least == or_equal { Hypothesis::AtLeast } else { Hypothesis::Above };
                (measure, test, Some(Against { hypothesis, theta: *threshold }))
            }
            Ask::Estimate { measure, estimator, .. } => (measure, estimator, None),
            Ask::Compare { .. } | Ask::Rank { .. } => return Err(Fault::Unsuitable),
        };
        let values = &chosen.values;
        Ok(match (chosen.spec.make, &measure.kind, against) {
            (Make::Test(make), MeasureKind::Probability, Some(against)) => {
                Self::Test(Box::new(Readings::new(make(against, values)?)))
            }
            (Make::Estimator(make), MeasureKind::Probability, None) => {
                Self::Probability(Box::new(Readings::new(make(values, seed)?)))
            }
            (Make::Mean(make), kind @ MeasureKind::Expectation { range, .. }, against) => Self::Mean {
                mean: Box::new(make(*range, kind.share(), values)?),
                threshold: against.map(|against| against.theta),
                values: Vec::new(),
            },
            (Make::Quantile { band }, MeasureKind::Quantile { level, .. }, None) => Self::Quantile {
                sample: Box::new(Sample::new(chosen.value("trials") as u64)?),
                level: *level,
                delta: chosen.value("delta"),
                band,
            },
            (Make::Curve, MeasureKind::Curve { times, falls, name, dimension, .. }, None) => Self::Curve {
                names: (name.clone(), dimension.to_string()),
                sample: Box::new(Sample::new(chosen.value("trials") as u64)?),
                times: times.clone(),
                falls: *falls,
                delta: chosen.value("delta"),
            },
            _ => return Err(Fault::Unsuitable),
        })
    }

    /// Reads the cell of the next trial; true once finished.
    pub(in crate::engine) fn observe(&mut self, cell: &Cell) -> bool {
        match self {
            Self::Test(test) => test.observe(outcome(cell)),
            Self::Probability(estimator) => estimator.observe(outcome(cell)),
            Self::Mean { mean, threshold, values } => {
                let value = value(cell);
                values.extend(value);
                let finished = mean.observe(value);
                match threshold {
                    None => finished,
                    // The interval holds at all times at once, so it may be looked at whenever that is worth it.
                    Some(theta) => match mean.look() {
                        Some(interval) => {
                            finished || interval.low > *theta || interval.high < *theta || mean.splits(*theta)
                        }
                        None => finished,
                    },
                }
            }
            Self::Quantile { sample, .. } | Self::Curve { sample, .. } => sample.observe(value(cell)),
        }
    }

    /// The number of trials after which it has surely stopped, if there is one.
    pub(in crate::engine) fn limit(&self) -> Option<u64> {
        match self {
            Self::Test(test) => test.readings().0.limit(),
            Self::Probability(estimator) => estimator.readings().0.limit(),
            Self::Mean { mean, threshold: None, .. } => Some(mean.limit()),
            Self::Mean { .. } => None,
            Self::Quantile { sample, .. } | Self::Curve { sample, .. } => Some(sample.size()),
        }
    }

    /// How many values it keeps at most.
    pub(in crate::engine) fn most_values(&self, max_trials: u64) -> u64 {
        match self {
            Self::Test(_) | Self::Probability(_) => 0,
            Self::Mean { .. } | Self::Quantile { .. } | Self::Curve { .. } => {
                self.limit().unwrap_or(u64::MAX).min(max_trials)
            }
        }
    }

    /// Whether the number of trials is fixed beforehand.
    pub(in crate::engine) fn is_planned(&self) -> bool {
        match self {
            Self::Test(test) => test.readings().0.rule().is_planned(),
            Self::Probability(estimator) => estimator.readings().0.rule().is_planned(),
            Self::Mean { mean, threshold, .. } => threshold.is_none() && mean.is_fixed(),
            Self::Quantile { .. } | Self::Curve { .. } => true,
        }
    }

    /// Half-width and error of the level that it has to know before it can read more.
    pub(in crate::engine) fn waits_for(&self) -> Option<(f64, f64)> {
        match self {
            Self::Probability(readings) => readings.waits_for(),
            _ => None,
        }
    }

    /// Whether, where it waits, it may turn out to have stopped.
    pub(in crate::engine) fn may_have_stopped(&self) -> bool {
        matches!(self, Self::Probability(readings) if readings.may_have_stopped())
    }

    /// What it has read so far, with what is now known of its level.
    pub(in crate::engine) fn settled(&self, level: Level) -> Result<Option<Self>, Fault> {
        let Self::Probability(readings) = self else { return Ok(None) };
        Ok(Some(Self::Probability(Box::new(readings.settled(level)?))))
    }

    /// Whether it has stopped.
    pub(in crate::engine) fn is_finished(&self) -> bool {
        matches!(self, Self::Probability(readings) if readings.finished())
    }

    /// Whether it is over without having come to what was asked: at its own largest number of trials.
    pub(in crate::engine) fn is_capped(&self) -> bool {
        match self {
            Self::Probability(estimator) => {
                let reading = estimator.readings().0;
                reading.rule().is_capped(reading.counts())
            }
            _ => false,
        }
    }

    /// The decision of a test on which both readings of unresolved trials agree.
    pub(in crate::engine) fn decision(&self) -> Option<Decision> {
        match self {
            Self::Test(test) => match test.verdict() {
                Some(TestVerdict::Agreed(decision)) => Some(decision),
                _ => None,
            },
            Self::Mean { mean, threshold: Some(theta), .. } => {
                let interval = mean.interval();
                let above = (interval.low > *theta).then_some(Decision::Above);
                above.or((interval.high < *theta).then_some(Decision::Below))
            }
            _ => None,
        }
    }

    /// Whether the readings of unresolved trials disagree.
    pub(in crate::engine) fn split(&self) -> bool {
        match self {
            Self::Test(test) => matches!(test.verdict(), Some(TestVerdict::Split(..))),
            Self::Mean { mean, threshold: Some(theta), .. } => mean.splits(*theta),
            _ => false,
        }
    }

    /// Whether the interval is wider than was asked for, as that of both readings of unresolved trials can be.
    pub(in crate::engine) fn is_wide(&self, ask: &Ask) -> bool {
        let Ask::Estimate { estimator, .. } = ask else { return false };
        let interval = match self {
            Self::Probability(estimator) => estimator.interval(),
            Self::Mean { mean, .. } => mean.interval(),
            Self::Test(_) | Self::Quantile { .. } | Self::Curve { .. } => return false,
        };
        estimator.width(interval).is_some_and(|epsilon| interval.half_width() > epsilon * (1.0 + 1e-9))
    }

    /// Numbers that it works with beside those that it was given, for reports.
    pub(in crate::engine) fn numbers(&self) -> Vec<(&'static str, f64)> {
        match self {
            Self::Test(test) => test.readings().0.rule().numbers(),
            Self::Probability(estimator) => estimator.readings().0.rule().numbers(),
            Self::Mean { mean, .. } => mean.numbers().into_iter().collect(),
            Self::Quantile { .. } | Self::Curve { .. } => Vec::new(),
        }
    }

    /// The evidence of a test for above and for below.
    pub(in crate::engine) fn weights(&self) -> Option<stats::Weights> {
        match self {
            Self::Test(test) => test.weights(),
            _ => None,
        }
    }

    /// What the decision of a test certifies.
    pub(in crate::engine) fn statement(&self) -> Option<Statement> {
        let decision = self.decision()?;
        match self {
            Self::Test(test) => Some(test.readings().0.certifies(decision)),
            Self::Mean { mean, threshold: Some(theta), .. } => {
                let claim = match decision {
                    Decision::Above => stats::Claim::Above(*theta),
                    _ => stats::Claim::Below(*theta),
                };
                Some(Statement { claim, error: mean.interval().error })
            }
            _ => None,
        }
    }

    /// Estimate and interval, and the kind of the interval. `beside` is the error of that beside the verdict of a test.
    pub(in crate::engine) fn interval(
        &mut self,
        counts: Counts,
        beside: f64,
    ) -> Option<(Interval, Coverage, f64)> {
        if counts.trials == 0 {
            return None;
        }
        match self {
            Self::Test(_) => {
                // An interval beside a test holds at its stopping time: that of the confidence sequence.
                Some((around(share(counts), sequence(counts, beside)), Coverage::TimeUniform, beside))
            }
            Self::Probability(estimator) => {
                let interval = estimator.interval();
                let (low, high) = estimator.readings();
                let estimate = 0.5 * (low.estimate() + high.estimate());
                Some((around(estimate, interval), interval.coverage, interval.error))
            }
            Self::Mean { mean, .. } => {
                let (estimate, interval) = of_mean(mean);
                Some((around(estimate, interval), interval.coverage, interval.error))
            }
            Self::Quantile { sample, level, delta, band } => {
                // Where somebody or the clock ended it before its number of trials, it holds at all times.
                let coverage = if sample.finished() { Coverage::FixedSize } else { Coverage::TimeUniform };
                Some((quantile(sample, *level, *delta, *band)?, coverage, *delta))
            }
            Self::Curve { sample, delta, .. } => {
                let coverage = if sample.finished() { Coverage::FixedSize } else { Coverage::TimeUniform };
                let delta = *delta;
                Some((self.curve()?.points.last()?.value, coverage, delta))
            }
        }
    }

    /// The points of a curve, jointly within the band.
    pub(in crate::engine) fn curve(&mut self) -> Option<Curve> {
        let Self::Curve { sample, times, falls, names, delta } = self else { return None };
        let (trials, unresolved) = (sample.trials() as f64, sample.unresolved() as f64);
        if trials == 0.0 {
            return None;
        }
        // The band of both readings of unresolved trials.
        let reach = sample.reach(*delta) - unresolved / trials;
        let sorted = sample.sorted().to_vec();
        let falls = *falls;
        let point = |time: &f64| {
            // Times are multiples of a step, and points decimals.
            let held = sorted.partition_point(|value| *value <= time + 1e-9) as f64;
            let (least, most) = (held / trials, (held + unresolved) / trials);
            let (low, high) = ((least - reach).max(0.0), (most + reach).min(1.0));
            let middle = 0.5 * (least + most);
            let value = if falls {
                Interval { estimate: 1.0 - middle, low: 1.0 - high, high: 1.0 - low }
            } else {
                Interval { estimate: middle, low, high }
            };
            CurvePoint { at: *time, value }
        };
        let points = times.iter().map(point).collect();
        let (name, unit) = names.clone();
        Some(Curve { points, reach: sample.reach(*delta), name, unit })
    }

    /// Histogram, quantiles and empirical distribution of a metric.
    pub(in crate::engine) fn distribution(&mut self) -> Option<Distribution> {
        let (mut values, quantiles, band) = match self {
            Self::Mean { mean, values, threshold } => {
                // Only a number of trials that was fixed beforehand has a band.
                let fixed = threshold.is_none() && mean.is_fixed() && mean.finished();
                let (trials, unresolved, _) = mean.read();
                let lost = unresolved as f64 / trials as f64;
                // Each reading of the unresolved trials moves the function by their share at most.
                let band =
                    fixed.then(|| (stats::quantile::band(trials, mean.interval().error) + lost).min(1.0));
                (values.clone(), Vec::new(), band)
            }
            Self::Quantile { sample, level, delta, band } => {
                let found = quantile(sample, *level, *delta, *band);
                let quantiles = found.map(|value| Quantile { level: *level, value });
                let reach = (sample.trials() > 0).then(|| sample.reach(*delta));
                (sample.sorted().to_vec(), quantiles.into_iter().collect(), reach)
            }
            Self::Curve { .. } => {
                return Some(Distribution { curve: self.curve(), ..Distribution::default() });
            }
            _ => return None,
        };
        values.sort_by(f64::total_cmp);
        let finite: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
        let histogram = match (finite.first(), finite.last()) {
            (Some(&low), Some(&high)) if low < high => {
                let mut bins = stats::Histogram::new(low, high, BINS).ok()?;
                for value in &finite {
                    bins.add(*value);
                }
                let at = |end: f64| values.iter().filter(|value| **value == end).count() as u64;
                let (below, beyond) = (at(f64::NEG_INFINITY), at(f64::INFINITY));
                Some(Histogram { low, high, counts: bins.bins, below, beyond })
            }
            _ => None,
        };
        Some(Distribution { histogram, quantiles, empirical: empirical(&values), band, curve: None })
    }
}

/// A quantile with its interval.
fn quantile(sample: &mut Sample, level: f64, delta: f64, band: bool) -> Option<Interval> {
    let found = if band {
        sample.banded(level, delta).ok()??
    } else {
        sample.quantiles(&[level], delta).ok()?.into_iter().next()?
    };
    // The middle of both readings of what is unresolved; of two that bound it on no side nobody knows.
    let estimate = match (found.low_estimate, found.high_estimate) {
        (low, high) if low == high => low,
        (low, high) if low.is_finite() && high.is_finite() => 0.5 * (low + high),
        (f64::NEG_INFINITY, f64::INFINITY) => f64::NAN,
        (f64::NEG_INFINITY, high) => high,
        (low, _) => low,
    };
    Some(Interval { estimate, low: found.interval.low, high: found.interval.high })
}

/// The empirical distribution function of sorted values, at a hundred shares at most.
fn empirical(values: &[f64]) -> Vec<Step> {
    let n = values.len();
    let mut steps: Vec<Step> = Vec::new();
    for k in 1..=n.min(STEPS) {
        let rank = (k * n).div_ceil(n.min(STEPS));
        let value = values[rank - 1];
        // All that are equal count.
        let share = values.partition_point(|x| *x <= value) as f64 / n as f64;
        if steps.last().is_none_or(|last| last.value < value) {
            steps.push(Step { value, share });
        }
    }
    steps
}

pub(in crate::engine) fn around(estimate: f64, interval: stats::Interval) -> Interval {
    Interval { estimate, low: interval.low, high: interval.high }
}

/// The confidence sequence of a probability, over both readings of unresolved trials.
pub(in crate::engine) fn sequence(counts: Counts, error: f64) -> stats::Interval {
    let resolved = stats::Counts {
        successes: counts.successes,
        failures: counts.trials - counts.successes - counts.unresolved,
    };
    stats::sequence::interval_with(resolved, counts.unresolved, error)
}

/// The estimate of a mean, in the middle between both readings of unresolved trials, and its interval.
pub(in crate::engine) fn of_mean(mean: &Bounded) -> (f64, stats::Interval) {
    let (low, high) = mean.estimate();
    (0.5 * (low + high), mean.interval())
}

/// Share of successes; unresolved trials count half. Of no trials it is not a number.
pub(in crate::engine) fn share(counts: Counts) -> f64 {
    if counts.trials == 0 {
        // The sign of 0 / 0 is the platform's.
        return f64::NAN;
    }
    (counts.successes as f64 + 0.5 * counts.unresolved as f64) / counts.trials as f64
}
