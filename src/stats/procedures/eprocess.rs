//! Tests of P >= theta without an indifference region: one-sided Beta-mixture e-processes.
//!
//! The evidence against P <= theta is the likelihood ratio of a Beta prior cut to (theta, 1) over theta, a
//! nonnegative supermartingale for every P <= theta (Robbins 1970; Ville 1939). So the error holds at any
//! stopping time, and at P = theta it is right never to stop.

use crate::base::math;
use crate::base::special::{beta_tails, ln_beta};
use crate::stats::invalid::{Invalid, probability, region};
use crate::stats::sprt::SLACK;
use crate::stats::{
    Claim, Counts, Decision, Hypothesis, Rule, Sequential, Statement, Test, Weight, Weights, bisection,
};

/// Beyond this no count is exact as a double; thresholds closer to 0 or 1 than that never decide.
const MOST_TRIALS: u64 = 1 << 53;

/// Weight of the prior around the threshold, in trials: 100, and 10 at the very ends.
fn weight(theta: f64) -> f64 {
    if (0.01..=0.99).contains(&theta) { 100.0 } else { 10.0 }
}

/// The evidence against P <= theta, and the number of successes at which it can first reach a threshold.
#[derive(Clone, Debug, PartialEq)]
struct OneSided {
    theta: f64,
    a: f64,
    b: f64,
    /// ln B(a, b) plus the logarithm of the prior mass above theta.
    ln_prior: f64,
    ln_theta: f64,
    ln_rest: f64,
    threshold: f64,
    /// No count of successes below this reaches the threshold, whatever the failures from now on.
    wanted: u64,
}

impl OneSided {
    /// Against P <= theta, with a prior of weight 100 around theta (10 at the very ends), each parameter
    /// at least 1/2.
    fn new(theta: f64, error: f64) -> Self {
        let weight = weight(theta);
        let a = math::at_least(weight * theta, 0.5);
        let b = math::at_least(weight * (1.0 - theta), 0.5);
        let mut process = Self {
            theta,
            a,
            b,
            ln_prior: ln_beta(a, b) + beta_tails(a, b, theta, 1.0 - theta).ln_upper,
            ln_theta: math::ln(theta),
            ln_rest: math::ln_1p(-theta),
            threshold: -math::ln(error) + SLACK,
            wanted: 0,
        };
        process.wanted = process.first_reaching(0, 0);
        process
    }

    /// The logarithm of the evidence.
    fn log(&self, successes: u64, failures: u64) -> f64 {
        let (s, f) = (successes as f64, failures as f64);
        let (a, b) = (self.a + s, self.b + f);
        ln_beta(a, b) + beta_tails(a, b, self.theta, 1.0 - self.theta).ln_upper
            - self.ln_prior
            - s * self.ln_theta
            - f * self.ln_rest
    }

    /// The least number of successes, not below `successes`, that reaches the threshold with `failures`.
    ///
    /// A success raises the evidence and a failure lowers it, because the mixture predicts success with
    /// a probability of at least theta. So no path through more failures gets there with fewer.
    fn first_reaching(&self, successes: u64, failures: u64) -> u64 {
        let reached = |s: u64| self.log(s, failures) >= self.threshold;
        let (mut low, mut step) = (successes, 1);
        if reached(low) {
            return low;
        }
        while !reached(low + step) {
            low += step;
            step *= 2;
            if low > MOST_TRIALS {
                return low;
            }
        }
        bisection::first(low, low + step, reached)
    }

    /// Whether the threshold is reached now. `log` is evaluated only where it could be.
    #[inline]
    fn reached(&mut self, successes: u64, failures: u64) -> bool {
        if successes < self.wanted {
            return false;
        }
        self.wanted = self.first_reaching(successes, failures);
        successes >= self.wanted
    }
}

/// The evidence of two processes, of which the second counts failures.
fn weights(above: &OneSided, below: &OneSided, Counts { successes, failures }: Counts) -> Weights {
    [
        Weight { log: above.log(successes, failures), threshold: above.threshold },
        Weight { log: below.log(failures, successes), threshold: below.threshold },
    ]
}

/// P above or below theta, each with its own error, for every P.
#[derive(Clone, Debug, PartialEq)]
pub struct Evidence {
    hypothesis: Hypothesis,
    theta: f64,
    alpha: f64,
    beta: f64,
    above: OneSided,
    below: OneSided,
}

impl Evidence {
    /// `alpha` bounds the error of deciding `Below` though P >= theta, `beta` that of deciding `Above`
    /// though P <= theta (the roles they have in the SPRT). At P = theta only that decision is wrong which the
    /// hypothesis denies.
    pub fn new(
        hypothesis: Hypothesis,
        theta: f64,
        alpha: f64,
        beta: f64,
    ) -> Result<Sequential<Self>, Invalid> {
        probability("theta", theta)?;
        probability("alpha", alpha)?;
        probability("beta", beta)?;
        Ok(Sequential::new(Self {
            hypothesis,
            theta,
            alpha,
            beta,
            above: OneSided::new(theta, beta),
            // The other side is the same test of failures against 1 - theta.
            below: OneSided::new(1.0 - theta, alpha),
        }))
    }

    /// The logarithms of the evidence that P is above theta and that it is below.
    pub fn logs(&self, counts: Counts) -> (f64, f64) {
        let [above, below] = weights(&self.above, &self.below, counts);
        (above.log, below.log)
    }
}

impl Rule for Evidence {
    type Answer = Option<Decision>;

    #[inline]
    fn look(&mut self, Counts { successes, failures }: Counts, success: bool) -> Option<Decision> {
        if success {
            self.above.reached(successes, failures).then_some(Decision::Above)
        } else {
            self.below.reached(failures, successes).then_some(Decision::Below)
        }
    }

    fn numbers(&self) -> Vec<(&'static str, f64)> {
        vec![("weight", weight(self.theta))]
    }
}

impl Test for Evidence {
    fn weights(&self, counts: Counts) -> Option<Weights> {
        Some(weights(&self.above, &self.below, counts))
    }

    fn certifies(&self, decision: Decision) -> Statement {
        let (above, below) = self.hypothesis.claims(self.theta);
        match decision {
            Decision::Above => Statement { claim: above, error: self.beta },
            Decision::Below => Statement { claim: below, error: self.alpha },
            Decision::Within => Statement { claim: Claim::Between(self.theta, self.theta), error: 1.0 },
        }
    }
}

/// P above theta, P below theta, or P within the indifference of theta; it stops for every P.
#[derive(Clone, Debug, PartialEq)]
pub struct ThreeWay {
    hypothesis: Hypothesis,
    theta: f64,
    ends: (f64, f64),
    error: f64,
    above: OneSided,
    below: OneSided,
    /// Against P <= theta - indifference and, counting failures, against P >= theta + indifference.
    above_low: OneSided,
    below_high: OneSided,
    passed: (bool, bool),
}

impl ThreeWay {
    /// `error` bounds the probability of any wrong decision; each part is run at half of it.
    pub fn new(
        hypothesis: Hypothesis,
        theta: f64,
        indifference: f64,
        error: f64,
    ) -> Result<Sequential<Self>, Invalid> {
        let ends = region(theta, indifference)?;
        probability("error", error)?;
        let half = 0.5 * error;
        Ok(Sequential::new(Self {
            hypothesis,
            theta,
            ends,
            error,
            above: OneSided::new(theta, half),
            below: OneSided::new(1.0 - theta, half),
            above_low: OneSided::new(ends.0, half),
            below_high: OneSided::new(1.0 - ends.1, half),
            passed: (false, false),
        }))
    }
}

impl Rule for ThreeWay {
    type Answer = Option<Decision>;

    #[inline]
    fn look(&mut self, Counts { successes, failures }: Counts, success: bool) -> Option<Decision> {
        // Ville's inequality bounds the highest evidence ever, so what was once passed stays passed.
        let decision = if success {
            self.passed.0 = self.passed.0 || self.above_low.reached(successes, failures);
            self.above.reached(successes, failures).then_some(Decision::Above)
        } else {
            self.passed.1 = self.passed.1 || self.below_high.reached(failures, successes);
            self.below.reached(failures, successes).then_some(Decision::Below)
        };
        decision.or_else(|| (self.passed == (true, true)).then_some(Decision::Within))
    }
}

impl Test for ThreeWay {
    fn weights(&self, counts: Counts) -> Option<Weights> {
        Some(weights(&self.above, &self.below, counts))
    }

    fn certifies(&self, decision: Decision) -> Statement {
        let (above, below) = self.hypothesis.claims(self.theta);
        let claim = match decision {
            Decision::Above => above,
            Decision::Below => below,
            Decision::Within => Claim::Between(self.ends.0, self.ends.1),
        };
        Statement { claim, error: self.error }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::random::{Purpose, Stream, TrialKey};

    fn outcome(index: u64, p: f64) -> bool {
        Stream::of(TrialKey { seed: 5, index, branch: 0 }, 0, Purpose::Test).uniform(0) < p
    }

    #[test]
    fn the_lazy_stop_is_the_stop_of_checking_every_index() {
        for (run, p) in [0.5, 0.85, 0.88, 0.93, 0.99].into_iter().enumerate() {
            let mut test = Evidence::new(Hypothesis::AtLeast, 0.9, 0.01, 0.02).unwrap();
            let mut n = run as u64 * 1_000_000;
            loop {
                let decision = test.observe(outcome(n, p));
                n += 1;
                let (above, below) = test.rule().logs(test.counts());
                let direct = if above >= -math::ln(0.02) + SLACK {
                    Some(Decision::Above)
                } else if below >= -math::ln(0.01) + SLACK {
                    Some(Decision::Below)
                } else {
                    None
                };
                assert_eq!(decision, direct, "{p} {n}");
                if decision.is_some() {
                    break;
                }
            }
        }
    }

    #[test]
    fn evidence_is_a_supermartingale_at_the_boundary_and_below() {
        // One step from any state: the mean of the next value is at most the present one.
        for theta in [0.1, 0.5, 0.9, 0.999] {
            let process = OneSided::new(theta, 0.01);
            for (s, f) in [(0, 0), (3, 5), (90, 10), (500, 500), (1000, 1)] {
                let now = process.log(s, f);
                let win = math::exp(process.log(s + 1, f) - now);
                let lose = math::exp(process.log(s, f + 1) - now);
                assert!((theta * win + (1.0 - theta) * lose - 1.0).abs() < 1e-9, "{theta} {s} {f}");
                assert!(win >= 1.0 - 1e-12 && lose <= 1.0 + 1e-12);
            }
        }
    }

    #[test]
    fn thresholds_at_the_very_ends_do_no_harm() {
        for theta in [f64::MIN_POSITIVE, 1e-16, 1.0 - f64::EPSILON] {
            let mut test = Evidence::new(Hypothesis::AtLeast, theta, 0.01, 0.01).unwrap();
            for k in 0..100 {
                test.observe(k % 2 == 0);
            }
            assert!(test.decision().is_some());
        }
    }

    /// Exact probabilities, at P = theta, of having decided above and below by `trials`.
    fn decided_at_the_threshold(theta: f64, error: f64, trials: u64) -> (f64, f64) {
        let test = Evidence::new(Hypothesis::AtLeast, theta, error, error).unwrap();
        let test = test.rule();
        // Mass of going on with so many successes.
        let mut open = vec![1.0];
        let (mut above, mut below) = (0.0, 0.0);
        let (mut most, mut fewest) = (test.above.wanted, test.below.wanted);
        for n in 1..=trials {
            let mut next = vec![0.0; open.len() + 1];
            for (s, mass) in open.iter().enumerate() {
                next[s] += (1.0 - theta) * mass;
                next[s + 1] += theta * mass;
            }
            // The fewest successes, and failures, that decide at n trials.
            while most < n && test.above.log(most, n - most) < test.above.threshold {
                most += 1;
            }
            while fewest < n && test.below.log(fewest, n - fewest) < test.below.threshold {
                fewest += 1;
            }
            for (s, mass) in next.iter_mut().enumerate() {
                if *mass == 0.0 {
                    continue;
                }
                let s = s as u64;
                if s >= most && test.above.log(s, n - s) >= test.above.threshold {
                    above += std::mem::take(mass);
                } else if n - s >= fewest && test.below.log(n - s, s) >= test.below.threshold {
                    below += std::mem::take(mass);
                }
            }
            open = next;
        }
        (above, below)
    }

    /// A family of four checks of fair coins that shares an error of 20 %, each at its threshold.
    #[test]
    fn at_the_threshold_only_one_certificate_is_false() {
        let error = 0.05;
        let (above, below) = decided_at_the_threshold(0.5, error, 4_000);
        let wrong = |hypothesis: Hypothesis| {
            let (upper, lower) = hypothesis.claims(0.5);
            above * f64::from(u8::from(!holds(upper, 0.5))) + below * f64::from(u8::from(!holds(lower, 0.5)))
        };
        let family = |each: f64| 1.0 - (1.0 - each) * (1.0 - each) * (1.0 - each) * (1.0 - each);
        for hypothesis in [Hypothesis::AtLeast, Hypothesis::Above] {
            assert!(wrong(hypothesis) > 0.6 * error, "{hypothesis:?}: some decide");
            assert!(wrong(hypothesis) <= error && family(wrong(hypothesis)) <= 0.2, "{hypothesis:?}");
        }
        // Strict claims on both sides are both false there.
        assert!(above + below > error && family(above + below) > 0.2, "{above} {below}");
    }

    fn holds(claim: Claim, p: f64) -> bool {
        match claim {
            Claim::Above(x) => p > x,
            Claim::AtLeast(x) => p >= x,
            Claim::Below(x) => p < x,
            Claim::AtMost(x) => p <= x,
            Claim::Between(low, high) => low < p && p < high,
        }
    }

    #[test]
    fn three_answers() {
        let run = |p: f64| {
            let mut test = ThreeWay::new(Hypothesis::AtLeast, 0.5, 0.1, 0.05).unwrap();
            (0..100_000).find_map(|n| test.observe(outcome(n, p)))
        };
        assert_eq!(run(0.5), Some(Decision::Within));
        assert_eq!(run(0.8), Some(Decision::Above));
        assert_eq!(run(0.2), Some(Decision::Below));
    }
}
