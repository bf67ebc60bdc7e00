//! What tests of P >= theta have in common, and unresolved trials.

use super::{Counts, Evidence, Outcome, Plan, Sprt, ThreeWay, TwoSprt};

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
#[derive(Clone, Copy, Debug, PartialEq)]
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

/// A test of P >= theta that reads outcomes in index order.
pub trait Test {
    /// Reads the next outcome. `Some` once decided; outcomes after that are ignored.
    fn observe(&mut self, success: bool) -> Option<Decision>;

    /// The decision, if there is one.
    fn decision(&self) -> Option<Decision>;

    /// The outcomes read.
    fn counts(&self) -> Counts;

    /// What `decision` certifies, whatever P is: no caveat about the indifference region is left.
    fn certifies(&self, decision: Decision) -> Statement;

    /// The number of trials after which it has surely decided, if it has one.
    fn limit(&self) -> Option<u64>;
}

/// Any of the tests.
#[derive(Clone, Debug)]
pub enum AnyTest {
    /// Wald's sequential probability ratio test.
    Sprt(Sprt),
    /// Lorden's 2-SPRT.
    TwoSprt(TwoSprt),
    /// The exact plan of fixed size.
    Plan(Plan),
    /// One-sided Beta-mixture e-processes.
    Evidence(Evidence),
    /// The three-way variant.
    ThreeWay(ThreeWay),
}

impl AnyTest {
    fn inner(&self) -> &dyn Test {
        match self {
            Self::Sprt(test) => test,
            Self::TwoSprt(test) => test,
            Self::Plan(test) => test,
            Self::Evidence(test) => test,
            Self::ThreeWay(test) => test,
        }
    }
}

impl Test for AnyTest {
    #[inline]
    fn observe(&mut self, success: bool) -> Option<Decision> {
        match self {
            Self::Sprt(test) => test.observe(success),
            Self::TwoSprt(test) => test.observe(success),
            Self::Plan(test) => test.observe(success),
            Self::Evidence(test) => test.observe(success),
            Self::ThreeWay(test) => test.observe(success),
        }
    }

    fn decision(&self) -> Option<Decision> {
        self.inner().decision()
    }

    fn counts(&self) -> Counts {
        self.inner().counts()
    }

    fn certifies(&self, decision: Decision) -> Statement {
        self.inner().certifies(decision)
    }

    fn limit(&self) -> Option<u64> {
        self.inner().limit()
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

/// A test over outcomes of which some are unresolved: it runs with all of them as failures and with all of
/// them as successes, each to its own stop, and decides where both agree.
///
/// The error bound of the test holds for the agreed decision, however the trials would have ended.
#[derive(Clone, Debug)]
pub struct TestReadings<T> {
    pessimistic: T,
    /// The reading with successes; apart from the other only from the first unresolved trial on.
    optimistic: Option<T>,
    unresolved: u64,
    read: u64,
    verdict: Option<Verdict>,
}

impl<T: Test + Clone> TestReadings<T> {
    /// Around a fresh test.
    pub const fn new(test: T) -> Self {
        Self { pessimistic: test, optimistic: None, unresolved: 0, read: 0, verdict: None }
    }

    /// Reads the next outcome. `Some` once both readings have decided.
    #[inline]
    pub fn observe(&mut self, outcome: Outcome) -> Option<Verdict> {
        if self.verdict.is_some() {
            return self.verdict;
        }
        self.read += 1;
        if outcome == Outcome::Unresolved {
            self.unresolved += 1;
            if self.optimistic.is_none() {
                self.optimistic = Some(self.pessimistic.clone());
            }
        }
        let low = self.pessimistic.observe(outcome == Outcome::True);
        let high = match &mut self.optimistic {
            None => low,
            Some(test) => test.observe(outcome != Outcome::False),
        };
        if let (Some(low), Some(high)) = (low, high) {
            self.verdict = Some(if low == high { Verdict::Agreed(low) } else { Verdict::Split(low, high) });
        }
        self.verdict
    }

    /// The verdict, if there is one.
    pub const fn verdict(&self) -> Option<Verdict> {
        self.verdict
    }

    /// Outcomes read, and how many of them were unresolved.
    pub const fn read(&self) -> (u64, u64) {
        (self.read, self.unresolved)
    }

    /// The two readings: unresolved trials as failures, as successes.
    pub fn readings(&self) -> (&T, &T) {
        (&self.pessimistic, self.optimistic.as_ref().unwrap_or(&self.pessimistic))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn readings() -> TestReadings<Sprt> {
        TestReadings::new(Sprt::new(0.5, 0.1, 0.05, 0.05).unwrap())
    }

    #[test]
    fn without_unresolved_trials_it_is_the_test_itself() {
        let (mut wrapped, mut bare) = (readings(), Sprt::new(0.5, 0.1, 0.05, 0.05).unwrap());
        for _ in 0..8 {
            let decision = bare.observe(true);
            assert_eq!(wrapped.observe(Outcome::True), decision.map(Verdict::Agreed));
        }
        assert_eq!(wrapped.verdict(), Some(Verdict::Agreed(Decision::Above)));
    }

    #[test]
    fn readings_that_disagree_are_a_split() {
        let mut test = readings();
        for _ in 0..7 {
            assert_eq!(test.observe(Outcome::Unresolved), None);
        }
        assert_eq!(test.observe(Outcome::Unresolved), Some(Verdict::Split(Decision::Below, Decision::Above)));
        assert_eq!(test.read(), (8, 8));
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
