//! Wald's sequential probability ratio test (1945), with the strict thresholds 1/alpha and beta.
//!
//! By Ville's inequality each error is then at most its nominal value, where Wald's own pair
//! (1 - beta)/alpha, beta/(1 - alpha) only bounds their sum.

use crate::base::math;
use crate::stats::invalid::{Invalid, probability, range, region};
use crate::stats::{Claim, Counts, Decision, Rule, Sequential, Statement, Test, Weight, Weights};

/// Thresholds are widened by this much, against rounding.
pub(super) const SLACK: f64 = 1e-9;

/// The indifference region of a test, and the errors at its ends.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Indifference {
    pub(super) low: f64,
    pub(super) high: f64,
    alpha: f64,
    beta: f64,
}

impl Indifference {
    /// Refuses a region that leaves (0, 1), and an indifference below `least`.
    pub(super) fn new(
        theta: f64,
        indifference: f64,
        least: f64,
        (alpha, beta): (f64, f64),
    ) -> Result<Self, Invalid> {
        let (low, high) = region(theta, indifference)?;
        range("indifference", indifference, least, 0.5)?;
        probability("alpha", alpha)?;
        probability("beta", beta)?;
        Ok(Self { low, high, alpha, beta })
    }

    /// What a decision certifies: `Above` is wrong only for P <= low, with probability at most `beta`; `Below` only for
    /// P >= high, at most `alpha`.
    pub(super) fn certifies(&self, decision: Decision) -> Statement {
        let Self { low, high, alpha, beta } = *self;
        match decision {
            Decision::Above => Statement { claim: Claim::Above(low), error: beta },
            Decision::Below => Statement { claim: Claim::Below(high), error: alpha },
            Decision::Within => Statement { claim: Claim::Between(low, high), error: alpha + beta },
        }
    }
}

/// P >= theta + indifference against P <= theta - indifference.
#[derive(Clone, Debug, PartialEq)]
pub struct Sprt {
    region: Indifference,
    /// Log likelihood ratio of `low` over `high` of one success (negative) and of one failure.
    per_success: f64,
    per_failure: f64,
    /// ln(1 / alpha) and ln(beta), widened.
    say_below: f64,
    say_above: f64,
}

impl Sprt {
    /// `alpha` bounds the error of deciding `Below` though P >= theta + indifference, `beta` that of
    /// deciding `Above` though P <= theta - indifference. Refuses a region that leaves (0, 1).
    pub fn new(theta: f64, indifference: f64, alpha: f64, beta: f64) -> Result<Sequential<Self>, Invalid> {
        let region = Indifference::new(theta, indifference, 0.0, (alpha, beta))?;
        Ok(Sequential::new(Self {
            per_success: math::ln(region.low / region.high),
            per_failure: math::ln((1.0 - region.low) / (1.0 - region.high)),
            region,
            say_below: -math::ln(alpha) + SLACK,
            say_above: math::ln(beta) - SLACK,
        }))
    }
}

impl Sprt {
    /// The log likelihood ratio of theta - indifference over theta + indifference, from whole numbers each time: no drift,
    /// and the same whatever the order.
    #[inline]
    fn ratio(&self, counts: Counts) -> f64 {
        counts.successes as f64 * self.per_success + counts.failures as f64 * self.per_failure
    }
}

impl Rule for Sprt {
    type Answer = Option<Decision>;

    #[inline]
    fn look(&mut self, counts: Counts, _: bool) -> Option<Decision> {
        let ratio = self.ratio(counts);
        if ratio >= self.say_below {
            Some(Decision::Below)
        } else if ratio <= self.say_above {
            Some(Decision::Above)
        } else {
            None
        }
    }
}

impl Test for Sprt {
    fn weights(&self, counts: Counts) -> Option<Weights> {
        let ratio = self.ratio(counts);
        Some([
            Weight { log: -ratio, threshold: -self.say_above },
            Weight { log: ratio, threshold: self.say_below },
        ])
    }

    fn certifies(&self, decision: Decision) -> Statement {
        self.region.certifies(decision)
    }
}

/// Wald's expected number of trials of a sequential probability ratio test where the share is `p`: the mean
/// of the exit divided by the drift, or where there is hardly any drift, by the variance of a step.
pub(super) fn expected(p: f64, theta: f64, indifference: f64, alpha: f64, beta: f64) -> f64 {
    let (high, low) =
        (math::at_most(theta + indifference, 1.0 - 1e-9), math::at_least(theta - indifference, 1e-9));
    let (success, failure) = (math::ln(low / high), math::ln((1.0 - low) / (1.0 - high)));
    let drift = p * success + (1.0 - p) * failure;
    let exit = if drift > 0.0 { -math::ln(alpha) } else { -math::ln(beta) };
    let between = math::ln(alpha) * math::ln(beta) / (p * success * success + (1.0 - p) * failure * failure);
    math::at_most(exit / math::at_least(drift.abs(), 1e-9), between)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn with_symmetric_parameters_it_is_the_gamblers_ruin() {
        // theta = 1/2, indifference 0.1, errors 0.05: the boundary is |S - F| = 8.
        let mut test = Sprt::new(0.5, 0.1, 0.05, 0.05).unwrap();
        for k in 0..100 {
            assert_eq!(test.observe(k % 2 == 0), None);
        }
        let decisions: Vec<_> = (0..8).map(|_| test.observe(false)).collect();
        assert_eq!(decisions[6], None);
        assert_eq!(decisions[7], Some(Decision::Below));
        assert_eq!(test.observe(true), Some(Decision::Below));
        assert_eq!(test.counts(), Counts { successes: 50, failures: 58 });
        assert_eq!(test.certifies(Decision::Below), Statement { claim: Claim::Below(0.6), error: 0.05 });
    }

    #[test]
    fn bad_parameters_are_refused_with_both_numbers() {
        assert_eq!(
            Sprt::new(0.9, 0.1, 0.01, 0.01),
            Err(Invalid::Indifference { theta: 0.9, indifference: 0.1 })
        );
        assert!(Sprt::new(0.9, 0.0, 0.01, 0.01).is_err());
        assert!(Sprt::new(0.9, f64::NAN, 0.01, 0.01).is_err());
        assert!(Sprt::new(1.9, 0.1, 0.01, 0.01).is_err());
        let message = Sprt::new(0.9, 0.01, 1.5, 0.01).unwrap_err().to_string();
        assert!(message.contains("alpha") && message.contains("1.5"), "{message}");
        let message = Sprt::new(0.95, 0.2, 0.01, 0.01).unwrap_err().to_string();
        assert!(message.contains("0.2") && message.contains("0.95"), "{message}");
    }

    #[test]
    fn it_takes_what_wald_says() {
        // Theta 0.8 with a region of 0.02 and errors 0.01, the truth 0.9: a few hundred trials.
        let trials = expected(0.9, 0.8, 0.02, 0.01, 0.01);
        assert!((150.0..260.0).contains(&trials), "{trials}");
        // On the threshold itself: the product of the boundaries over the variance of a step.
        let trials = expected(0.8, 0.8, 0.02, 0.01, 0.01);
        assert!((1_000.0..2_500.0).contains(&trials), "{trials}");
    }
}
