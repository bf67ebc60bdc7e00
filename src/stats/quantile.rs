//! Quantiles by order statistics, and the band of Dvoretzky, Kiefer and Wolfowitz (Massart 1990) around the
//! whole distribution function; both for a number of trials fixed in advance. Where sampling ended before that, at
//! a time nobody chose beforehand, the ranks come from the confidence sequences of the two events "at most the
//! quantile" and "below the quantile", and the band from a union bound over all numbers of trials.

use super::invalid::{Invalid, probability, range};
use super::{Counts, Coverage, Interval, sequence};
use crate::base::math;
use crate::base::special::beta_tails;

/// P(Bin(n, q) <= k).
fn at_most(n: u64, k: u64, q: f64) -> f64 {
    if k >= n { 1.0 } else { beta_tails(k as f64 + 1.0, (n - k) as f64, q, 1.0 - q).upper() }
}

/// P(Bin(n, q) > k): not one less the other, which would lose what is smaller than the rounding of 1.
fn above(n: u64, k: u64, q: f64) -> f64 {
    if k >= n { 0.0 } else { beta_tails(k as f64 + 1.0, (n - k) as f64, q, 1.0 - q).lower() }
}

/// The smallest k in 0..n for which something holds that holds from some k on; n where it does for none.
fn first(n: u64, holds: &dyn Fn(u64) -> bool) -> u64 {
    let (mut low, mut high) = (0, n);
    while low < high {
        let middle = low + (high - low) / 2;
        if holds(middle) {
            high = middle;
        } else {
            low = middle + 1;
        }
    }
    low
}

/// The same at all numbers of trials at once, and so at any that the values or the clock have chosen. With P(X <= Q)
/// at least q and P(X < Q) at most q at the quantile Q, the confidence sequences of these two, at half of the error
/// each, leave the Q at which the first reaches up to q and the second down to it.
pub fn ranks_at_all_times(n: u64, q: f64, delta: f64) -> (Option<u64>, Option<u64>) {
    let inside = |k: u64| sequence::holds(Counts { successes: k, failures: n - k }, 0.5 * delta, q);
    let share = |k: u64| k as f64 / n as f64;
    // So many values at most Q there are at least, so many below Q at most.
    let least = first(n, &|k| share(k) >= q || inside(k));
    let most = first(n, &|k| share(k + 1) > q && !inside(k + 1));
    ((least >= 1).then_some(least), (most < n).then_some(most + 1))
}

/// Half-width of the band at all numbers of trials at once: each n has delta / (n (n + 1)) of the error.
pub fn band_at_all_times(n: u64, delta: f64) -> f64 {
    let n = n as f64;
    band(n as u64, delta / (n * (n + 1.0)))
}

/// The ranks, from 1, of the order statistics that hold the `q`-quantile with error at most `delta`, half
/// of it on either side; None where no rank is far enough out.
pub fn ranks(n: u64, q: f64, delta: f64) -> (Option<u64>, Option<u64>) {
    // The largest l with P(Bin <= l - 1) <= delta / 2, the smallest u with P(Bin > u - 1) <= delta / 2.
    let lower = first(n, &|k| at_most(n, k, q) > 0.5 * delta);
    let upper = first(n, &|k| above(n, k, q) <= 0.5 * delta) + 1;
    ((lower >= 1).then_some(lower), (upper <= n).then_some(upper))
}

/// The rank, from 1, of the empirical `q`-quantile of `n` values: the least one that is not below `q n`. A level such as
/// 0.07 is a rounded one, and so is its product; what is within that of a whole number is that number.
fn rank(n: u64, q: f64) -> u64 {
    let product = q * n as f64;
    let whole = product.round();
    let near = (product - whole).abs() <= math::at_least(1e-9, 4.0 * f64::EPSILON * product);
    math::at_least(if near { whole } else { product.ceil() }, 1.0) as u64
}

/// Half-width of the band: sqrt(ln(2 / delta) / (2 n)).
pub fn band(n: u64, delta: f64) -> f64 {
    (math::ln(2.0 / delta) / (2.0 * n as f64)).sqrt()
}

/// A quantile: its estimate in both readings of unresolved trials, and its interval. Infinite ends mean
/// that the trials do not bound it on that side (or that the values there are censored).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quantile {
    /// Which quantile.
    pub q: f64,
    /// The empirical quantile with unresolved trials below everything.
    pub low_estimate: f64,
    /// The empirical quantile with unresolved trials above everything.
    pub high_estimate: f64,
    /// The interval, which holds both readings.
    pub interval: Interval,
}

/// Values of a fixed number of trials. Censored values are +infinity and come last; unresolved ones are
/// read as lying below and above everything.
#[derive(Clone, Debug, PartialEq)]
pub struct Sample {
    size: u64,
    values: Vec<f64>,
    unresolved: u64,
    sorted: bool,
}

impl Sample {
    /// For `size` trials.
    pub fn new(size: u64) -> Result<Self, Invalid> {
        range("trials", size as f64, 1.0, 1e9)?;
        Ok(Self { size, values: Vec::new(), unresolved: 0, sorted: true })
    }

    /// Reads the next value, `None` (or NaN) if it is unresolved; true once all are there.
    pub fn observe(&mut self, value: Option<f64>) -> bool {
        if !self.finished() {
            match value.filter(|x| !x.is_nan()) {
                Some(value) => {
                    self.values.push(value);
                    self.sorted = false;
                }
                None => self.unresolved += 1,
            }
        }
        self.finished()
    }

    /// The number of trials it is for.
    pub const fn size(&self) -> u64 {
        self.size
    }

    /// Whether all trials are there.
    pub fn finished(&self) -> bool {
        self.trials() >= self.size
    }

    /// Trials read.
    pub fn trials(&self) -> u64 {
        self.values.len() as u64 + self.unresolved
    }

    /// Unresolved trials among them.
    pub const fn unresolved(&self) -> u64 {
        self.unresolved
    }

    /// The resolved values in ascending order.
    pub fn sorted(&mut self) -> &[f64] {
        if !self.sorted {
            self.values.sort_by(f64::total_cmp);
            self.sorted = true;
        }
        &self.values
    }

    /// Half-width of the band around the distribution function of the resolved values that holds both readings of
    /// the unresolved ones: each of these moves that function by no more than their share.
    pub fn reach(&self, delta: f64) -> f64 {
        let n = self.trials();
        let reach = if self.finished() { band(n, delta) } else { band_at_all_times(n, delta) };
        math::at_most(reach + self.unresolved as f64 / n as f64, 1.0)
    }

    /// The value of rank `rank`, from 1, with `below` unresolved trials before the values.
    fn at(&self, rank: Option<u64>, below: u64, missing: f64) -> f64 {
        let Some(rank) = rank else { return missing };
        if rank <= below {
            return f64::NEG_INFINITY;
        }
        self.values.get((rank - below - 1) as usize).copied().unwrap_or(f64::INFINITY)
    }

    /// The quantile `q` by the band around the distribution function: with error at most `delta`, all quantiles
    /// lie in such intervals at once. Before the end it is the band that holds at all times. `None` without trials.
    pub fn banded(&mut self, q: f64, delta: f64) -> Result<Option<Quantile>, Invalid> {
        probability("delta", delta)?;
        let alone = self.quantiles(&[q], delta)?;
        let n = self.trials();
        let reach = if self.finished() { band(n, delta) } else { band_at_all_times(n, delta) };
        // Outward by a part of a rank, so that rounding never narrows.
        let lower = ((q - reach) * n as f64).floor();
        let upper = ((q + reach) * n as f64).ceil();
        let lower = (lower >= 1.0).then_some(lower as u64);
        let upper = (upper <= n as f64).then_some(upper as u64);
        Ok(alone.into_iter().next().map(|quantile| Quantile {
            interval: Interval {
                low: self.at(lower, self.unresolved, f64::NEG_INFINITY),
                high: self.at(upper, 0, f64::INFINITY),
                ..quantile.interval
            },
            ..quantile
        }))
    }

    /// The quantiles with error at most `delta` for all of them together (Bonferroni). Before the
    /// end the intervals are those that hold at all times: the number of trials may depend on their values then.
    /// Empty without trials.
    pub fn quantiles(&mut self, qs: &[f64], delta: f64) -> Result<Vec<Quantile>, Invalid> {
        probability("delta", delta)?;
        for q in qs {
            probability("quantile", *q)?;
        }
        let n = self.trials();
        if n == 0 {
            return Ok(Vec::new());
        }
        self.sorted();
        let each = delta / qs.len() as f64;
        let finished = self.finished();
        let coverage = if finished { Coverage::FixedSize } else { Coverage::TimeUniform };
        let of = |q: f64| {
            let (lower, upper) = if finished { ranks(n, q, each) } else { ranks_at_all_times(n, q, each) };
            let middle = Some(rank(n, q));
            Quantile {
                q,
                low_estimate: self.at(middle, self.unresolved, f64::NEG_INFINITY),
                high_estimate: self.at(middle, 0, f64::INFINITY),
                interval: Interval {
                    low: self.at(lower, self.unresolved, f64::NEG_INFINITY),
                    high: self.at(upper, 0, f64::INFINITY),
                    error: delta,
                    coverage,
                },
            }
        };
        Ok(qs.iter().map(|q| of(*q)).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// T22: ranks of the reference.
    #[test]
    fn ranks_of_the_reference() {
        assert_eq!(ranks(1000, 0.5, 0.05), (Some(469), Some(532)));
        assert_eq!(ranks(1000, 0.95, 0.05), (Some(936), Some(964)));
        assert_eq!(ranks(1000, 0.99, 0.05), (Some(983), Some(997)));
        assert!((band(1000, 0.05) - 0.042_947).abs() < 1e-6);
    }

    #[test]
    fn ranks_of_rounded_levels_are_exact() {
        for n in [1, 7, 100, 1000, 4096, 1_000_000_000] {
            for percent in 1..100_u64 {
                let exact = (percent * n).div_ceil(100).max(1);
                assert_eq!(rank(n, percent as f64 / 100.0), exact, "{percent} % of {n}");
            }
        }
        let mut sample = Sample::new(100).unwrap();
        (1..=100).for_each(|k| {
            sample.observe(Some(f64::from(k)));
        });
        let found = sample.quantiles(&[0.07, 0.14, 0.28, 0.55, 0.56], 0.05).unwrap();
        let estimates: Vec<f64> = found.iter().map(|quantile| quantile.high_estimate).collect();
        assert_eq!(estimates, [7.0, 14.0, 28.0, 55.0, 56.0]);
    }

    #[test]
    fn coverage_by_enumeration_is_kept() {
        for n in [20, 300, 1000] {
            for q in [0.05, 0.5, 0.9] {
                let (lower, upper) = ranks(n, q, 0.05);
                let miss_low = lower.map_or(0.0, |l| at_most(n, l - 1, q));
                let miss_high = upper.map_or(0.0, |u| 1.0 - at_most(n, u - 1, q));
                assert!(miss_low <= 0.025 && miss_high <= 0.025 + 1e-12, "{n} {q}");
            }
        }
    }

    /// Both sides of the median are alike, however small the error is.
    #[test]
    fn no_error_is_lost_in_rounding() {
        for delta in [1e-3, 1e-12, 1e-16, 1e-18, 1e-40] {
            let (lower, upper) = ranks(1000, 0.5, delta);
            assert_eq!(lower.map(|l| 1001 - l), upper, "{delta}");
            let (lower, upper) = (lower.unwrap(), upper.unwrap());
            assert!(above(1000, upper - 1, 0.5) <= 0.5 * delta && above(1000, upper - 2, 0.5) > 0.5 * delta);
            assert!(at_most(1000, lower - 1, 0.5) <= 0.5 * delta);
        }
    }

    #[test]
    fn ranks_at_all_times_are_those_of_the_confidence_sequence() {
        for (n, q) in [(1, 0.5), (37, 0.5), (400, 0.95), (1000, 0.5), (1000, 0.02)] {
            let (lower, upper) = ranks_at_all_times(n, q, 0.05);
            let of = |k: u64| sequence::interval(Counts { successes: k, failures: n - k }, 0.025);
            // By definition: from `lower` values on the upper end reaches q, up to `upper` - 1 the lower end does.
            let least = (0..=n).find(|k| of(*k).high >= q).unwrap();
            let most = (0..=n).rev().find(|k| of(*k).low <= q).unwrap();
            assert_eq!(lower.unwrap_or(0), least, "{n} {q}");
            assert_eq!(upper.unwrap_or(n + 1), most + 1, "{n} {q}");
            let (inner_lower, inner_upper) = ranks(n, q, 0.05);
            assert!(lower <= inner_lower && upper.unwrap_or(n + 1) >= inner_upper.unwrap_or(n + 1));
        }
        assert!(ranks_at_all_times(1000, 0.5, 0.05).0.is_some_and(|lower| lower > 430));
    }

    /// Somebody who stops as soon as the interval misses the median finds it missing in 5 % of sequences at most.
    #[test]
    fn a_sample_that_is_cut_short_is_honest() {
        let mut missed = 0;
        for run in 0..200u64 {
            let mut sample = Sample::new(10_000).unwrap();
            let key = crate::base::random::TrialKey { seed: 77, index: run, branch: 0 };
            let stream = crate::base::random::Stream::of(key, 1, crate::base::random::Purpose::Procedure);
            let mut ever = false;
            for n in 1..400u32 {
                sample.observe(Some(stream.uniform(n)));
                let interval = sample.quantiles(&[0.5], 0.05).unwrap()[0].interval;
                assert_eq!(interval.coverage, Coverage::TimeUniform);
                ever |= !interval.holds(0.5);
            }
            missed += u32::from(ever);
        }
        assert!(missed <= 10 + 9, "{missed} of 200");
    }

    #[test]
    fn the_band_holds_both_readings_of_unresolved_values() {
        let mut sample = Sample::new(1000).unwrap();
        for k in 0..1000 {
            sample.observe((k % 5 != 0).then_some(f64::from(k)));
        }
        assert!((sample.reach(0.05) - (band(1000, 0.05) + 0.2)).abs() < 1e-12);
        let mut short = Sample::new(1000).unwrap();
        short.observe(Some(1.0));
        assert_eq!(short.reach(0.05), 1.0);
        assert!(band_at_all_times(1000, 0.05) < 2.3 * band(1000, 0.05));
    }

    #[test]
    fn a_finite_upper_end_needs_enough_trials() {
        // With both sides at 0.025: n >= ln(0.025) / ln(0.99) = 367.04.
        assert_eq!(ranks(367, 0.99, 0.05).1, None);
        assert_eq!(ranks(368, 0.99, 0.05).1, Some(368));
    }

    /// T22: the band of the reference at the 0.95-quantile of 1000 values has the ranks 907 and 993.
    #[test]
    fn the_band_of_the_reference() {
        let mut sample = Sample::new(1000).unwrap();
        (1..=1000).for_each(|k| {
            sample.observe(Some(f64::from(k)));
        });
        let interval = sample.banded(0.95, 0.05).unwrap().unwrap().interval;
        assert_eq!((interval.low, interval.high), (907.0, 993.0));
        let extreme = sample.banded(0.99, 0.05).unwrap().unwrap().interval;
        assert_eq!((extreme.low, extreme.high), (947.0, f64::INFINITY));
    }

    #[test]
    fn censored_and_unresolved_values() {
        let mut sample = Sample::new(100).unwrap();
        for k in 0..100 {
            sample.observe(match k {
                0..80 => Some(f64::from(k)),
                80..90 => Some(f64::INFINITY),
                _ => None,
            });
        }
        assert!(sample.finished());
        let found = sample.quantiles(&[0.5, 0.85], 0.05).unwrap();
        assert_eq!((found[0].low_estimate, found[0].high_estimate), (39.0, 49.0));
        assert!(found[0].interval.low < 39.0 && found[0].interval.high > 49.0);
        assert_eq!(found[1].high_estimate, f64::INFINITY);
        assert_eq!(found[1].interval.high, f64::INFINITY);
        assert!(sample.quantiles(&[1.0], 0.05).is_err());
    }
}
