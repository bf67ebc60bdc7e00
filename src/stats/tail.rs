//! The mean of the largest share of a bounded metric: conditional value at risk, or expected shortfall.
//!
//! With `a` the share and `Y_c = c + (X - c)+ / a`, it is the least of `E[Y_c]` over all c, and the quantile at level 1 - a
//! attains it (Rockafellar and Uryasev, "Optimization of conditional value-at-risk", Journal of Risk 2, 2000). Both ends of
//! the interval are found by betting (Waudby-Smith and Ramdas, JRSS B 86, 2024), each at half of the error:
//!
//! - **Upper end.** Whatever c is, the tail is at most `E[Y_c]`; so c may be the quantile of the trials *before*. If the tail
//!   is u or more, capital that bets on `Y_c < u` is a nonnegative supermartingale: u is refuted once it reaches 2 / delta.
//! - **Lower end.** If the tail is u, then `E[Y_c] = u` at one c, which nobody knows. Capital that bets on `Y_c > u` is a
//!   supermartingale there, and the least capital over all c is no larger: it costs nothing that c is not known.
//!
//! ```text
//!  E[Y_c]  \                      /
//!           \                ___/      each c bounds the tail from above;
//!  tail ---- `--.________.--'          only where the curve is least, from below
//!                     |
//!                  quantile        c
//! ```
//!
//! Both ends hold at all numbers of trials at once.

use super::bets::{geometric, log_mean};
use super::invalid::{Invalid, probability, range};
use super::{Coverage, Intake, Interval};
use crate::base::math;
use std::ops::Deref;

/// Bets of the mixture, as shares of the largest that cannot lose all.
const BETS: usize = 16;
const LEAST_BET: f64 = 0.002;
const MOST_BET: f64 = 0.95;
/// Factors of a product before its logarithm is taken: each lies between 0.05 and 1e12.
const CHUNK: usize = 16;
/// Bound on what rounding adds to a logarithm for each trial.
const ROUNDING: f64 = 1e-14;
/// The first trials only say about where the quantile is: a bet at a wrong place would widen the interval for good.
const FIRST_BET: usize = 32;
/// Ends are found to this part of the range.
const PRECISION: f64 = 1e-6;
/// Most parts into which all c are divided to find the least capital; where that is too few, the end is a little lower.
const MOST_PARTS: usize = 400;

/// Estimates the mean of the largest share of a metric with a declared range.
///
/// Values outside of the range are clipped and counted. Unresolved trials are read as the lower end of the range for the
/// lower end of the interval, and as the upper end for its upper end.
#[derive(Clone, Debug, PartialEq)]
pub struct Tail {
    intake: Intake,
    share: f64,
    /// The least and the greatest that each value can be, over the range; and the quantile of those before it, where the
    /// trial is bet on.
    values: Vec<(f64, f64, Option<f64>)>,
    quantile: Option<f64>,
    /// The number of trials at which the quantile is next found, and at which the interval is next looked at.
    next: (usize, usize),
}

impl Deref for Tail {
    type Target = Intake;

    fn deref(&self) -> &Intake {
        &self.intake
    }
}

impl Tail {
    /// The mean of the largest `share` of values in [low, high], to half width `epsilon` in the same unit, error `delta`.
    pub fn within((low, high): (f64, f64), share: f64, epsilon: f64, delta: f64) -> Result<Self, Invalid> {
        let mut tail = Self::running((low, high), share, delta)?;
        tail.intake.epsilon = Some(range("epsilon over the range", epsilon / (high - low), 1e-6, 0.5)?);
        Ok(tail)
    }

    /// The same of a fixed number of trials.
    pub fn fixed((low, high): (f64, f64), share: f64, trials: u64, delta: f64) -> Result<Self, Invalid> {
        range("trials", trials as f64, 1.0, 1e9)?;
        let mut tail = Self::running((low, high), share, delta)?;
        tail.intake.limit = trials;
        Ok(tail)
    }

    /// The same of as many trials as somebody shows it.
    pub fn running((low, high): (f64, f64), share: f64, delta: f64) -> Result<Self, Invalid> {
        let intake = Intake::new(low, high, delta, u64::MAX)?;
        probability("share", share)?;
        Ok(Self { intake, share, values: Vec::new(), quantile: None, next: (FIRST_BET, 1) })
    }

    /// Reads the next value, `None` (or NaN) if it is unresolved; true once finished.
    pub fn observe(&mut self, value: Option<f64>) -> bool {
        if self.finished {
            return true;
        }
        let n = self.values.len();
        if n >= self.next.0 {
            self.quantile = Some(self.quantile_so_far());
            self.next.0 = n + n / 8;
        }
        let (low, high) = (self.low, self.high);
        let (least, greatest) = match value.filter(|value| !value.is_nan()) {
            Some(value) => {
                self.intake.clipped += u64::from(value < low || value > high);
                let value = (math::at_most(math::at_least(value, low), high) - low) / (high - low);
                (value, value)
            }
            None => {
                self.intake.unresolved += 1;
                (0.0, 1.0)
            }
        };
        self.values.push((least, greatest, self.quantile));
        self.intake.read += 1;
        self.intake.finished = self.read >= self.limit;
        if let Some(epsilon) = self.epsilon
            && let Some(interval) = self.look()
        {
            self.intake.finished |= self.is_narrow(interval, epsilon);
        }
        self.finished
    }

    /// Whether an interval is so narrow, or would be if unresolved trials were read in one way.
    fn is_narrow(&self, interval: Interval, epsilon: f64) -> bool {
        let half = interval.half_width() / (self.high - self.low);
        let (low, high) = (self.mean_of_largest(|v| v.0), self.mean_of_largest(|v| v.1));
        let apart = high - low;
        half <= epsilon || (apart > epsilon && half - 0.5 * apart <= epsilon)
    }

    /// The interval where it is time to look at it, which takes longer than to read a trial: after every twentieth part more.
    pub fn look(&mut self) -> Option<Interval> {
        let n = self.values.len();
        if n < self.next.1 {
            return None;
        }
        self.next.1 = n + 1 + n / 20;
        Some(self.interval())
    }

    /// The estimates of both readings of unresolved trials; the same without any.
    pub fn estimate(&self) -> (f64, f64) {
        let scale = |x: f64| self.low + (self.high - self.low) * x;
        (scale(self.mean_of_largest(|v| v.0)), scale(self.mean_of_largest(|v| v.1)))
    }

    /// Whether how unresolved trials are read decides on which side of `theta` it is: each reading is on its own.
    pub fn splits(&self, theta: f64) -> bool {
        let theta = (theta - self.low) / (self.high - self.low);
        self.unresolved > 0 && self.upper_end(|v| v.0) < theta && self.lower_end(|v| v.1) > theta
    }

    /// The interval. It holds at all times.
    pub fn interval(&self) -> Interval {
        let (low, high) = (self.lower_end(|v| v.0), self.upper_end(|v| v.1));
        let width = self.high - self.low;
        Interval {
            low: if low <= 0.0 { self.low } else { self.low + width * low },
            high: if high >= 1.0 { self.high } else { self.low + width * high },
            error: self.delta,
            coverage: Coverage::TimeUniform,
        }
    }

    fn sorted(&self, of: impl Fn(&(f64, f64, Option<f64>)) -> f64) -> Vec<f64> {
        let mut sorted: Vec<f64> = self.values.iter().map(of).collect();
        sorted.sort_unstable_by(f64::total_cmp);
        sorted
    }

    fn quantile_so_far(&self) -> f64 {
        let sorted = self.sorted(|v| v.1);
        let rank = ((1.0 - self.share) * sorted.len() as f64).ceil() as usize;
        sorted[rank.clamp(1, sorted.len()) - 1]
    }

    /// The mean of the largest share of one reading; a value at the border counts in part.
    fn mean_of_largest(&self, of: impl Fn(&(f64, f64, Option<f64>)) -> f64) -> f64 {
        let sorted = self.sorted(of);
        let room = self.share * sorted.len() as f64;
        let (mut left, mut sum) = (room, 0.0);
        for value in sorted.iter().rev() {
            let part = math::at_most(left, 1.0);
            if part <= 0.0 {
                break;
            }
            sum += part * value;
            left -= part;
        }
        if room > 0.0 { math::at_most(sum / room, sorted[sorted.len() - 1]) } else { 0.5 }
    }

    /// `Y_c` of a value.
    fn at(&self, c: f64, value: f64) -> f64 {
        c + math::at_least(value - c, 0.0) / self.share
    }

    /// The least u that is refuted from above; 1 if there is none.
    fn upper_end(&self, of: impl Fn(&(f64, f64, Option<f64>)) -> f64) -> f64 {
        let threshold = math::ln(2.0 / self.delta);
        // What is left of the largest possible value, and the largest.
        let bet_on = |value: &(f64, f64, Option<f64>)| {
            let c = value.2?;
            let most = self.at(c, 1.0);
            Some((most - self.at(c, of(value)), most))
        };
        let left: Vec<(f64, f64)> = self.values.iter().filter_map(bet_on).collect();
        let is_refuted = |u: f64| {
            let ratios =
                left.iter().filter(|(_, most)| *most - u > 1e-9).map(|(left, most)| left / (most - u));
            log_mean(&capitals(ratios)) - ROUNDING * left.len() as f64 >= threshold
        };
        if is_refuted(1.0) { narrowed(1.0, self.mean_of_largest(&of), is_refuted) } else { 1.0 }
    }

    /// The largest u that is refuted from below; 0 if there is none.
    fn lower_end(&self, of: impl Fn(&(f64, f64, Option<f64>)) -> f64) -> f64 {
        let sorted = self.sorted(of);
        let most = sorted.last().copied().unwrap_or(0.0);
        narrowed(0.0, most, |u| self.is_refuted_below(&sorted, u))
    }

    /// Whether the capital against u reaches the threshold for all c at once. A part of all c whose bound is too small is
    /// divided further, until some c itself refuses.
    fn is_refuted_below(&self, sorted: &[f64], u: f64) -> bool {
        let threshold = math::ln(2.0 / self.delta) + ROUNDING * sorted.len() as f64;
        let mut parts = vec![(0.0, u)];
        let mut looked = 0;
        while let Some((from, to)) = parts.pop() {
            looked += 1;
            if self.least_capital(sorted, u, (from, to)) >= threshold {
                continue;
            }
            let middle = 0.5 * (from + to);
            if looked > MOST_PARTS || self.least_capital(sorted, u, (middle, middle)) < threshold {
                return false;
            }
            parts.extend([(from, middle), (middle, to)]);
        }
        true
    }

    /// A lower bound of the logarithm of the capital for each c of a part.
    ///
    /// For one bet, the logarithm is concave in c but for the values inside of the part, at each of which `Y_c` has its least
    /// value, which is the value itself. With that in their place the rest is least at one of the ends.
    fn least_capital(&self, sorted: &[f64], u: f64, (from, to): (f64, f64)) -> f64 {
        let below = sorted.partition_point(|value| *value <= from);
        let above = below + sorted[below..].partition_point(|value| *value < to);
        let inside = capitals(sorted[below..above].iter().map(|value| value / u));
        let bets: [f64; BETS] = geometric(LEAST_BET, MOST_BET);
        let at_end = |c: f64| {
            let mut logs = capitals(sorted[above..].iter().map(|value| self.at(c, *value) / u));
            for (k, log) in logs.iter_mut().enumerate() {
                *log += inside[k] + below as f64 * math::ln_1p(bets[k] * (c / u - 1.0));
            }
            logs
        };
        let (one, other) = (at_end(from), if from < to { at_end(to) } else { [f64::INFINITY; BETS] });
        let least: [f64; BETS] = std::array::from_fn(|k| math::at_most(one[k], other[k]));
        log_mean(&least)
    }
}

/// A number at which a condition holds, so close to one at which it does not, by bisection.
fn narrowed(mut yes: f64, mut no: f64, holds: impl Fn(f64) -> bool) -> f64 {
    while (no - yes).abs() > PRECISION {
        let middle = 0.5 * (yes + no);
        if holds(middle) {
            yes = middle;
        } else {
            no = middle;
        }
    }
    yes
}

/// The logarithms of the capital of each bet on ratios whose mean is at most 1 if what is bet against is true.
fn capitals(ratios: impl Iterator<Item = f64>) -> [f64; BETS] {
    let bets: [f64; BETS] = geometric(LEAST_BET, MOST_BET);
    let (mut logs, mut products, mut count) = ([0.0; BETS], [1.0; BETS], 0_usize);
    for ratio in ratios {
        for (product, bet) in products.iter_mut().zip(&bets) {
            *product *= 1.0 + bet * (ratio - 1.0);
        }
        count += 1;
        if count % CHUNK == 0 {
            for (log, product) in logs.iter_mut().zip(&mut products) {
                *log += math::ln(std::mem::replace(product, 1.0));
            }
        }
    }
    for (log, product) in logs.iter_mut().zip(products) {
        *log += math::ln(product);
    }
    logs
}

#[cfg(test)]
mod tests;
