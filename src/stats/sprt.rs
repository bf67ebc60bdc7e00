//! Wald's sequential probability ratio test (1945), with the strict thresholds 1/alpha and beta.
//!
//! By Ville's inequality each error is then at most its nominal value, where Wald's own pair
//! (1 - beta)/alpha, beta/(1 - alpha) only bounds their sum.

use super::invalid::{Invalid, probability, region};
use super::{Claim, Counts, Decision, Statement, Test};
use crate::base::math;

/// Thresholds are widened by this much, against rounding.
pub(super) const SLACK: f64 = 1e-9;

/// P >= theta + indifference against P <= theta - indifference.
#[derive(Clone, Debug, PartialEq)]
pub struct Sprt {
    low: f64,
    high: f64,
    alpha: f64,
    beta: f64,
    /// Log likelihood ratio of `low` over `high` of one success (negative) and of one failure.
    per_success: f64,
    per_failure: f64,
    /// ln(1 / alpha) and ln(beta), widened.
    say_below: f64,
    say_above: f64,
    counts: Counts,
    decision: Option<Decision>,
}

impl Sprt {
    /// `alpha` bounds the error of deciding `Below` though P >= theta + indifference, `beta` that of
    /// deciding `Above` though P <= theta - indifference. Refuses a region that leaves (0, 1).
    pub fn new(theta: f64, indifference: f64, alpha: f64, beta: f64) -> Result<Self, Invalid> {
        let (low, high) = region(theta, indifference)?;
        probability("alpha", alpha)?;
        probability("beta", beta)?;
        Ok(Self {
            low,
            high,
            alpha,
            beta,
            per_success: math::ln(low / high),
            per_failure: math::ln((1.0 - low) / (1.0 - high)),
            say_below: -math::ln(alpha) + SLACK,
            say_above: math::ln(beta) - SLACK,
            counts: Counts::default(),
            decision: None,
        })
    }

    /// The log likelihood ratio of theta - indifference over theta + indifference so far.
    #[inline]
    pub fn log_ratio(&self) -> f64 {
        // From whole numbers each time: no drift, and the same whatever the order.
        self.counts.successes as f64 * self.per_success + self.counts.failures as f64 * self.per_failure
    }
}

impl Test for Sprt {
    #[inline]
    fn observe(&mut self, success: bool) -> Option<Decision> {
        if self.decision.is_none() {
            self.counts.add(success);
            let ratio = self.log_ratio();
            if ratio >= self.say_below {
                self.decision = Some(Decision::Below);
            } else if ratio <= self.say_above {
                self.decision = Some(Decision::Above);
            }
        }
        self.decision
    }

    fn decision(&self) -> Option<Decision> {
        self.decision
    }

    fn counts(&self) -> Counts {
        self.counts
    }

    fn certifies(&self, decision: Decision) -> Statement {
        region_statement(decision, (self.low, self.high), self.alpha, self.beta)
    }

    fn limit(&self) -> Option<u64> {
        None
    }
}

/// What a decision of a test with an indifference region certifies: `Above` is wrong only for P <= low,
/// with probability at most `beta`; `Below` only for P >= high, at most `alpha`.
pub(super) fn region_statement(
    decision: Decision,
    (low, high): (f64, f64),
    alpha: f64,
    beta: f64,
) -> Statement {
    match decision {
        Decision::Above => Statement { claim: Claim::Above(low), error: beta },
        Decision::Below => Statement { claim: Claim::Below(high), error: alpha },
        Decision::Within => Statement { claim: Claim::Between(low, high), error: alpha + beta },
    }
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
        assert!(message.contains("alpha = 1.5"), "{message}");
        let message = Sprt::new(0.95, 0.2, 0.01, 0.01).unwrap_err().to_string();
        assert!(message.contains("0.2") && message.contains("0.95"), "{message}");
    }
}
