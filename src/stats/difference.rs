//! The difference of two probabilities from paired outcomes, with or without common random numbers, by
//! betting on the difference D in {-1, 0, 1} of each pair (Waudby-Smith and Ramdas 2024).
//!
//! For each candidate m two mixtures of bets against E\[D\] <= m and E\[D\] >= m are nonnegative
//! supermartingales; those m that neither has refuted by the factor 2 / delta form a confidence sequence.
//! Only the law of a pair is used: any dependence within a pair is allowed.

use super::bets::{geometric, log_mean};
use super::invalid::{Invalid, probability, range};
use super::{Coverage, Interval, Outcome, bisection};
use crate::base::math;

/// Bets of the mixture, as shares of the largest allowed, in geometric steps.
const BETS: usize = 16;
const LEAST_BET: f64 = 0.002;
const MOST_BET: f64 = 0.95;

/// How often the first held alone, both were alike, and the second held alone.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Pairs {
    /// The first held, the second did not.
    pub first: u64,
    /// Both alike.
    pub alike: u64,
    /// The second held, the first did not.
    pub second: u64,
}

impl Pairs {
    /// All pairs.
    pub const fn trials(self) -> u64 {
        self.first + self.alike + self.second
    }

    /// The mean difference.
    pub fn mean(self) -> f64 {
        if self.trials() == 0 {
            return 0.0;
        }
        (self.first as f64 - self.second as f64) / self.trials() as f64
    }

    const fn add(&mut self, first: bool, second: bool) {
        match (first, second) {
            (true, false) => self.first += 1,
            (false, true) => self.second += 1,
            _ => self.alike += 1,
        }
    }

    const fn swapped(self) -> Self {
        Self { first: self.second, alike: self.alike, second: self.first }
    }
}

/// The logarithm of the mixture of bets against E\[D\] <= m, for m in (-1, 1).
fn log_against(pairs: Pairs, m: f64, bets: &[f64; BETS]) -> f64 {
    let mut logs = [0.0; BETS];
    for (log, bet) in logs.iter_mut().zip(bets) {
        // The stake is bet / (1 + m), so that the worst pair, D = -1, leaves 1 - bet.
        let stake = bet / (1.0 + m);
        *log = pairs.first as f64 * math::ln_1p(stake * (1.0 - m))
            + pairs.alike as f64 * math::ln_1p(-stake * m)
            + pairs.second as f64 * math::ln_1p(-bet);
    }
    log_mean(&logs)
}

fn bets() -> [f64; BETS] {
    geometric(LEAST_BET, MOST_BET)
}

/// The largest m that is refuted from below; -1 if there is none.
fn lower_end(pairs: Pairs, delta: f64) -> f64 {
    let bets = bets();
    let threshold = math::ln(2.0 / delta) + 1e-9;
    // The evidence falls in m, and at the mean difference it is at most 1.
    bisection::halved(-1.0, pairs.mean(), 60, |m| log_against(pairs, m, &bets) >= threshold).0
}

/// The interval for P(first) - P(second) that holds at all numbers of pairs at once.
pub fn interval(pairs: Pairs, delta: f64) -> Interval {
    let none = pairs.trials() == 0;
    Interval {
        low: if none { -1.0 } else { lower_end(pairs, delta) },
        high: if none { 1.0 } else { -lower_end(pairs.swapped(), delta) },
        error: delta,
        coverage: Coverage::TimeUniform,
    }
}

/// Estimates P(first) - P(second) from paired outcomes; for the difference of two means of bounded metrics
/// use `Mean` on the differences.
///
/// Unresolved outcomes are read both ways: one reading takes them against the first and for the second,
/// the other the reverse; the interval holds both.
#[derive(Clone, Debug, PartialEq)]
pub struct Difference {
    epsilon: Option<f64>,
    delta: f64,
    low: Pairs,
    high: Pairs,
    unresolved: u64,
    next: u64,
    finished: bool,
}

impl Difference {
    /// Error `delta`, at all numbers of pairs at once; with `epsilon` it stops when the half-width of both
    /// readings is at most that (looked at after each percent of more pairs).
    pub fn new(delta: f64, epsilon: Option<f64>) -> Result<Self, Invalid> {
        probability("delta", delta)?;
        if let Some(epsilon) = epsilon {
            range("epsilon", epsilon, 1e-5, 1.0)?;
        }
        let none = Pairs::default();
        Ok(Self { epsilon, delta, low: none, high: none, unresolved: 0, next: 1, finished: false })
    }

    /// Reads the outcomes of the next pair; true once finished.
    #[inline]
    pub fn observe(&mut self, first: Outcome, second: Outcome) -> bool {
        if self.finished {
            return true;
        }
        self.unresolved += u64::from(first == Outcome::Unresolved || second == Outcome::Unresolved);
        self.low.add(first == Outcome::True, second != Outcome::False);
        self.high.add(first != Outcome::False, second == Outcome::True);
        if let Some(epsilon) = self.epsilon
            && self.low.trials() >= self.next
        {
            self.next += 1 + self.next / 100;
            self.finished = self.is_narrow(epsilon);
        }
        self.finished
    }

    /// Whether the interval of both readings is so narrow, or each of them is and they lie too far apart for both: the
    /// rest of the width, less than half of it, would take more than four times as many pairs.
    fn is_narrow(&self, epsilon: f64) -> bool {
        let low = interval(self.low, self.delta);
        if self.unresolved == 0 || low.half_width() > epsilon {
            return self.unresolved == 0 && low.half_width() <= epsilon;
        }
        let high = interval(self.high, self.delta);
        let apart = self.high.mean() - self.low.mean();
        low.hull(high).half_width() <= epsilon || (high.half_width() <= epsilon && apart > epsilon)
    }

    /// Whether it has stopped.
    pub const fn finished(&self) -> bool {
        self.finished
    }

    /// The pairs in both readings: unresolved against the first, for the first.
    pub const fn pairs(&self) -> (Pairs, Pairs) {
        (self.low, self.high)
    }

    /// Pairs with an unresolved outcome.
    pub const fn unresolved(&self) -> u64 {
        self.unresolved
    }

    /// The interval, at any time.
    pub fn interval(&self) -> Interval {
        let low = interval(self.low, self.delta);
        if self.unresolved == 0 { low } else { low.hull(interval(self.high, self.delta)) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_lie_on_the_threshold_and_swapping_mirrors() {
        let pairs = Pairs { first: 120, alike: 800, second: 80 };
        let found = interval(pairs, 0.05);
        assert!((log_against(pairs, found.low, &bets()) - math::ln(40.0)).abs() < 1e-6);
        let mirror = interval(pairs.swapped(), 0.05);
        assert_eq!((mirror.low, mirror.high), (-found.high, -found.low));
        assert!(found.holds(0.04) && found.half_width() < 0.08, "{found:?}");
    }

    #[test]
    fn evidence_is_a_supermartingale_up_to_the_candidate() {
        // One step from any state under any law with mean at most m.
        for m in [-0.9, -0.2, 0.0, 0.4, 0.95] {
            let pairs = Pairs { first: 5, alike: 9, second: 3 };
            let now = log_against(pairs, m, &bets());
            let then = |first: u64, alike: u64, second: u64| {
                let next = Pairs { first: 5 + first, alike: 9 + alike, second: 3 + second };
                math::exp(log_against(next, m, &bets()) - now)
            };
            let (win, tie, lose) = (then(1, 0, 0), then(0, 1, 0), then(0, 0, 1));
            for p_first in [0.0, 0.1, 0.3, 0.6, 0.99] {
                for p_second in [0.0, 0.05, 0.3, 0.9] {
                    if p_first + p_second <= 1.0 && p_first - p_second <= m {
                        let mean = p_first * win + (1.0 - p_first - p_second) * tie + p_second * lose;
                        assert!(mean <= 1.0 + 1e-12, "{m} {p_first} {p_second}: {mean}");
                    }
                }
            }
        }
    }

    #[test]
    fn unresolved_pairs_are_held_both_ways() {
        let mut difference = Difference::new(0.05, None).unwrap();
        for k in 0..1000 {
            let first = if k % 10 == 0 { Outcome::Unresolved } else { Outcome::True };
            difference.observe(first, Outcome::True);
        }
        let interval = difference.interval();
        assert!(interval.low < -0.1 && interval.high > 0.0);
        assert_eq!(difference.unresolved(), 100);
    }

    #[test]
    fn a_few_unresolved_pairs_take_more_pairs_and_many_end_it() {
        let run = |every: u32| {
            let mut difference = Difference::new(0.05, Some(0.1)).unwrap();
            let mut k = 0;
            let outcome = |held: bool| if held { Outcome::True } else { Outcome::False };
            loop {
                k += 1;
                let first = if k % every == 0 { Outcome::Unresolved } else { outcome(k % 2 == 0) };
                if difference.observe(first, outcome(k % 3 == 0)) {
                    return (k, difference.interval());
                }
            }
        };
        let (none, few, many) = (run(u32::MAX), run(40), run(3));
        assert!(few.0 > none.0 && few.1.half_width() <= 0.1, "{few:?}");
        assert!(many.1.half_width() > 0.16 && many.0 < 4 * none.0, "{many:?}");
    }
}
