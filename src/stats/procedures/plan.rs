//! The exact single-sampling plan: the smallest fixed number of trials, and of successes among them, that
//! bounds both errors of a test with an indifference region.

use crate::base::special::{beta_tails, normal_quantile};
use crate::stats::invalid::Invalid;
use crate::stats::sprt::Indifference;
use crate::stats::{Counts, Decision, Rule, Sequential, Statement, Test, bisection};

/// P >= theta + indifference against P <= theta - indifference by a fixed number of trials.
///
/// It stops as soon as the rest cannot change the decision, which changes neither decision nor errors.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    region: Indifference,
    size: u64,
    needed: u64,
}

/// P(Bin(n, p) < c).
fn below(n: u64, c: u64, p: f64) -> f64 {
    if c == 0 {
        return 0.0;
    }
    if c > n {
        return 1.0;
    }
    beta_tails(c as f64, (n - c + 1) as f64, p, 1.0 - p).upper()
}

/// P(Bin(n, p) >= c).
fn at_least(n: u64, c: u64, p: f64) -> f64 {
    if c == 0 {
        return 1.0;
    }
    if c > n {
        return 0.0;
    }
    beta_tails(c as f64, (n - c + 1) as f64, p, 1.0 - p).lower()
}

/// The largest c with P(Bin(n, p) < c) <= alpha.
fn critical(n: u64, p: f64, alpha: f64) -> u64 {
    bisection::first(0, n + 1, |c| below(n, c, p) > alpha) - 1
}

impl Plan {
    /// Parameters as those of the SPRT; the indifference must be at least 0.0005.
    pub fn new(theta: f64, indifference: f64, alpha: f64, beta: f64) -> Result<Sequential<Self>, Invalid> {
        let region = Indifference::new(theta, indifference, 0.000_5, (alpha, beta))?;
        let Indifference { low, high, .. } = region;
        // The best test with randomisation only improves with n, so the smallest n at which it meets both
        // bounds is found by bisection; the smallest plan without randomisation lies at most a little
        // beyond.
        let feasible_randomised = |n: u64| {
            let c = critical(n, high, alpha);
            let spent = below(n, c, high);
            let at_c = below(n, c + 1, high) - spent;
            let reject_at_c = if at_c > 0.0 { (alpha - spent) / at_c } else { 0.0 };
            let accept_above = at_least(n, c + 1, low);
            let accept_at_c = at_least(n, c, low) - accept_above;
            accept_above + (1.0 - reject_at_c) * accept_at_c <= beta
        };
        let spread = -normal_quantile(alpha) - normal_quantile(beta);
        let mut most = 16 + (spread * spread * 0.25 / (4.0 * indifference * indifference)) as u64;
        while !feasible_randomised(most) && most < 1 << 40 {
            most *= 2;
        }
        let mut size = bisection::first(0, most, feasible_randomised);
        let mut needed = critical(size, high, alpha);
        while at_least(size, needed, low) > beta {
            size += 1;
            needed = critical(size, high, alpha);
        }
        Ok(Sequential::new(Self { region, size, needed }))
    }

    /// The number of trials, and the least number of successes for `Above`.
    pub const fn size(&self) -> (u64, u64) {
        (self.size, self.needed)
    }
}

impl Rule for Plan {
    type Answer = Option<Decision>;

    #[inline]
    fn look(&mut self, counts: Counts, _: bool) -> Option<Decision> {
        if counts.successes >= self.needed {
            Some(Decision::Above)
        } else if counts.failures > self.size - self.needed {
            Some(Decision::Below)
        } else {
            None
        }
    }

    fn limit(&self) -> Option<u64> {
        Some(self.size)
    }

    fn is_planned(&self) -> bool {
        true
    }

    fn numbers(&self) -> Vec<(&'static str, f64)> {
        vec![("trials", self.size as f64), ("accept", self.needed as f64)]
    }
}

impl Test for Plan {
    fn certifies(&self, decision: Decision) -> Statement {
        self.region.certifies(decision)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// T7: the exact plan of the reference.
    #[test]
    fn the_smallest_plan_is_found() {
        let plan = Plan::new(0.9, 0.01, 0.01, 0.01).unwrap();
        assert_eq!(plan.rule().size(), (4861, 4377));
    }

    #[test]
    fn no_smaller_plan_meets_both_bounds() {
        let plan = Plan::new(0.6, 0.1, 0.05, 0.1).unwrap();
        let (size, needed) = plan.rule().size();
        assert!(below(size, needed, 0.7) <= 0.05 && at_least(size, needed, 0.5) <= 0.1);
        for n in 1..size {
            assert!((0..=n + 1).all(|c| below(n, c, 0.7) > 0.05 || at_least(n, c, 0.5) > 0.1), "{n}");
        }
    }

    #[test]
    fn it_stops_when_the_rest_cannot_change_the_decision() {
        let mut plan = Plan::new(0.6, 0.1, 0.05, 0.1).unwrap();
        let (size, needed) = plan.rule().size();
        for _ in 0..size - needed {
            assert_eq!(plan.observe(false), None);
        }
        assert_eq!(plan.clone().observe(false), Some(Decision::Below));
        for _ in 1..needed {
            assert_eq!(plan.observe(true), None);
        }
        assert_eq!(plan.observe(true), Some(Decision::Above));
        assert_eq!(plan.counts().trials(), size);
    }
}
