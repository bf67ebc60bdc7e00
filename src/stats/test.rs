//! What tests of P >= theta have in common, and unresolved trials.

use super::{Counts, Readings, Rule, Sequential};

/// What a test decided.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Decision {
    /// P is above the threshold (or, with an indifference region, not below the region).
    Above,
    /// P is below the threshold (or not above the region).
    Below,
    /// P is close to the threshold: inside the indifference region.
    Within,
}

/// What a decision certifies about P.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub enum Claim {
    /// P > the number.
    Above(f64),
    /// P >= the number.
    AtLeast(f64),
    /// P < the number.
    Below(f64),
    /// P <= the number.
    AtMost(f64),
    /// P lies strictly between the two numbers.
    Between(f64, f64),
}

/// What a test without an indifference region decides about. One side is the opposite of the other, so whatever P is only
/// one of them is false, and no more than the error of that one is ever at stake. With the threshold on neither side both
/// would be false at P = theta, and their errors would add up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hypothesis {
    /// P >= theta against P < theta.
    AtLeast,
    /// P > theta against P <= theta.
    Above,
}

impl Hypothesis {
    /// What deciding for the upper or for the lower side claims.
    pub(super) const fn claims(self, theta: f64) -> (Claim, Claim) {
        match self {
            Self::AtLeast => (Claim::AtLeast(theta), Claim::Below(theta)),
            Self::Above => (Claim::Above(theta), Claim::AtMost(theta)),
        }
    }
}

/// A claim and the probability, at most, with which the procedure makes it when it is wrong.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Statement {
    /// What is claimed.
    pub claim: Claim,
    /// Bound on the probability of claiming it although it is false, whatever P is.
    pub error: f64,
}

/// The logarithm of the evidence for a decision, and what it has to reach.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weight {
    /// The logarithm of the evidence.
    pub log: f64,
    /// The decision is made where this is reached.
    pub threshold: f64,
}

/// The evidence for deciding above, and for deciding below.
pub type Weights = [Weight; 2];

/// The rule of a test of P >= theta.
pub trait Test: Rule<Answer = Option<Decision>> {
    /// The evidence after some outcomes; of tests that only count there is none.
    fn weights(&self, _: Counts) -> Option<Weights> {
        None
    }

    /// What `decision` certifies, whatever P is: no caveat about the indifference region is left.
    fn certifies(&self, decision: Decision) -> Statement;
}

impl<R: Test> Sequential<R> {
    /// The decision, if there is one.
    pub const fn decision(&self) -> Option<Decision> {
        self.answer()
    }

    /// What `decision` certifies.
    pub fn certifies(&self, decision: Decision) -> Statement {
        self.rule().certifies(decision)
    }
}

/// How both readings of unresolved trials came out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Both readings decide the same.
    Agreed(Decision),
    /// With unresolved trials as failures the first, as successes the second: undecided.
    Split(Decision, Decision),
}

impl<R: Test + Clone> Readings<R> {
    /// The evidence on which both readings agree: for above that with unresolved trials as failures, for below that with
    /// them as successes.
    pub fn weights(&self) -> Option<Weights> {
        let (low, high) = self.readings();
        let [above, _] = low.rule().weights(low.counts())?;
        let [_, below] = high.rule().weights(high.counts())?;
        Some([above, below])
    }

    /// How both readings came out, once both have decided. The error bound of the test holds for an agreed decision,
    /// however the unresolved trials would have ended.
    pub fn verdict(&self) -> Option<Verdict> {
        let (low, high) = self.readings();
        let (low, high) = (low.decision()?, high.decision()?);
        Some(if low == high { Verdict::Agreed(low) } else { Verdict::Split(low, high) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stats::{Outcome, Sprt};

    fn readings() -> Readings<Sprt> {
        Readings::new(Sprt::new(0.5, 0.1, 0.05, 0.05).unwrap())
    }

    #[test]
    fn without_unresolved_trials_it_is_the_test_itself() {
        let (mut wrapped, mut bare) = (readings(), Sprt::new(0.5, 0.1, 0.05, 0.05).unwrap());
        for _ in 0..8 {
            let decision = bare.observe(true);
            assert_eq!(wrapped.observe(Outcome::True), decision.is_some());
            assert_eq!(wrapped.verdict(), decision.map(Verdict::Agreed));
        }
        assert_eq!(wrapped.verdict(), Some(Verdict::Agreed(Decision::Above)));
    }

    #[test]
    fn readings_that_disagree_are_a_split() {
        let mut test = readings();
        for _ in 0..7 {
            assert!(!test.observe(Outcome::Unresolved));
        }
        assert!(test.observe(Outcome::Unresolved) && test.observe(Outcome::True));
        assert_eq!(test.verdict(), Some(Verdict::Split(Decision::Below, Decision::Above)));
        let (low, high) = test.readings();
        assert_eq!((low.counts().failures, high.counts().successes), (8, 8));
    }

    #[test]
    fn few_unresolved_trials_only_delay_the_decision() {
        let mut test = readings();
        test.observe(Outcome::Unresolved);
        let mut n = 1;
        while test.verdict().is_none() {
            test.observe(Outcome::True);
            n += 1;
        }
        assert_eq!((n, test.verdict()), (10, Some(Verdict::Agreed(Decision::Above))));
    }
}
