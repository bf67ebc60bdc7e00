//! Sequential procedures on the counts of successes and failures: what their rules have in common, and unresolved trials.

use super::{Counts, Outcome};
use std::fmt::Debug;

/// When to stop reading, and with which answer, as a function of the counts.
pub trait Rule {
    /// `Option<Decision>` of a test, `bool` of an estimator. The default means that it goes on.
    type Answer: Copy + Debug + Default + PartialEq;

    /// The answer after an outcome, which is among the counts already. It is not asked again once it has answered.
    fn look(&mut self, counts: Counts, success: bool) -> Self::Answer;

    /// The number of trials after which it has surely stopped, if it has one.
    fn limit(&self) -> Option<u64> {
        None
    }

    /// Whether that number is fixed beforehand.
    fn is_planned(&self) -> bool {
        false
    }

    /// Whether it has to know more of itself before it can read more.
    fn waits(&self) -> bool {
        false
    }

    /// Numbers that it works with beside those it was given, for reports.
    fn numbers(&self) -> Vec<(&'static str, f64)> {
        Vec::new()
    }
}

/// A procedure that reads outcomes in index order until its rule stops it.
#[derive(Clone, Debug, PartialEq)]
pub struct Sequential<R: Rule> {
    rule: R,
    counts: Counts,
    answer: R::Answer,
}

impl<R: Rule> Sequential<R> {
    /// Before the first outcome.
    pub fn new(rule: R) -> Self {
        Self::resumed(rule, Counts::default(), R::Answer::default())
    }

    /// After outcomes that led to an answer, or to none yet.
    pub(super) const fn resumed(rule: R, counts: Counts, answer: R::Answer) -> Self {
        Self { rule, counts, answer }
    }

    /// Reads the next outcome. Outcomes after the answer are ignored.
    #[inline]
    pub fn observe(&mut self, success: bool) -> R::Answer {
        if !self.finished() {
            self.counts.add(success);
            self.answer = self.rule.look(self.counts, success);
        }
        self.answer
    }

    /// Whether it has stopped.
    #[inline]
    pub fn finished(&self) -> bool {
        self.answer != R::Answer::default()
    }

    /// The answer, or the default before it.
    pub const fn answer(&self) -> R::Answer {
        self.answer
    }

    /// The outcomes read.
    pub const fn counts(&self) -> Counts {
        self.counts
    }

    /// The rule.
    pub const fn rule(&self) -> &R {
        &self.rule
    }

    /// The number of trials after which it has surely stopped, if it has one.
    pub fn limit(&self) -> Option<u64> {
        self.rule.limit()
    }

    /// The same with a rule that contains this one.
    pub(super) fn into_any<A: Rule<Answer = R::Answer> + From<R>>(self) -> Sequential<A> {
        Sequential { rule: self.rule.into(), counts: self.counts, answer: self.answer }
    }
}

/// A procedure over outcomes of which some are unresolved: it runs with all of them as failures and with all of them as
/// successes, each to its own stop.
#[derive(Clone, Debug)]
pub struct Readings<R: Rule> {
    pessimistic: Sequential<R>,
    /// The reading with successes; apart from the other only from the first unresolved trial on.
    optimistic: Option<Sequential<R>>,
}

impl<R: Rule + Clone> Readings<R> {
    /// Around a fresh procedure.
    pub const fn new(procedure: Sequential<R>) -> Self {
        Self { pessimistic: procedure, optimistic: None }
    }

    /// Reads the next outcome; true once both readings have stopped, or one waits.
    #[inline]
    pub fn observe(&mut self, outcome: Outcome) -> bool {
        if self.finished() || self.waits() {
            return true;
        }
        if outcome == Outcome::Unresolved && self.optimistic.is_none() {
            self.optimistic = Some(self.pessimistic.clone());
        }
        self.pessimistic.observe(outcome == Outcome::True);
        if let Some(procedure) = &mut self.optimistic {
            procedure.observe(outcome != Outcome::False);
        }
        self.finished() || self.waits()
    }

    /// Whether a reading has to know more of itself before more can be read.
    #[inline]
    pub fn waits(&self) -> bool {
        self.pessimistic.rule.waits() || self.optimistic.as_ref().is_some_and(|other| other.rule.waits())
    }

    /// Whether both readings have stopped.
    #[inline]
    pub fn finished(&self) -> bool {
        self.pessimistic.finished() && self.optimistic.as_ref().is_none_or(Sequential::finished)
    }

    /// The two readings: unresolved trials as failures, as successes.
    pub fn readings(&self) -> (&Sequential<R>, &Sequential<R>) {
        (&self.pessimistic, self.optimistic.as_ref().unwrap_or(&self.pessimistic))
    }

    /// The same with each reading changed.
    pub(super) fn map<E>(
        self,
        change: impl Fn(Sequential<R>) -> Result<Sequential<R>, E>,
    ) -> Result<Self, E> {
        Ok(Self {
            pessimistic: change(self.pessimistic)?,
            optimistic: self.optimistic.map(change).transpose()?,
        })
    }
}

/// An enum of rules that is a rule itself, without a call through a table of functions at each trial.
macro_rules! any_rule {
    ($(#[$doc:meta])* $any:ident: $kind:ident { $($rule:ident),* $(,)? }) => {
        $(#[$doc])*
        #[derive(Clone, Debug, PartialEq)]
        pub enum $any {
            $(#[doc = concat!("[`", stringify!($rule), "`].")] $rule($rule)),*
        }

        $(impl From<$rule> for $any {
            fn from(rule: $rule) -> Self {
                Self::$rule(rule)
            }
        })*

        impl $any {
            /// The rule that it is.
            pub fn inner(&self) -> &dyn $kind {
                match self {
                    $(Self::$rule(rule) => rule),*
                }
            }
        }

        impl $crate::stats::Rule for $any {
            type Answer = <dyn $kind as $crate::stats::Rule>::Answer;

            #[inline]
            fn look(&mut self, counts: Counts, success: bool) -> Self::Answer {
                match self {
                    $(Self::$rule(rule) => rule.look(counts, success)),*
                }
            }

            fn limit(&self) -> Option<u64> {
                self.inner().limit()
            }

            fn is_planned(&self) -> bool {
                self.inner().is_planned()
            }

            #[inline]
            fn waits(&self) -> bool {
                match self {
                    $(Self::$rule(rule) => rule.waits()),*
                }
            }

            fn numbers(&self) -> Vec<(&'static str, f64)> {
                self.inner().numbers()
            }
        }
    };
}
pub(super) use any_rule;
