//! The short way: one temporal operator, or one metric, at the start of a trial, over present states.
//!
//! Nothing is stored; a state costs a few comparisons of its instants with the bounds in seconds.

use super::Reading;
use super::present::Present;
use crate::logic::flat::Sort;
use crate::logic::formula::{Aggregation, Operation};

/// A truth of the present state, perhaps negated.
#[derive(Clone, Copy, Debug)]
pub(super) struct Probe {
    pub(super) slot: usize,
    pub(super) negated: bool,
}

impl Probe {
    /// Whether it is so in the present state.
    #[inline]
    pub(super) fn is(self, present: &Present) -> bool {
        present.truth(self.slot) != self.negated
    }
}

/// A state lasts from `start` to before `end`, s; infinite after the horizon.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stay {
    pub(super) start: f64,
    pub(super) end: f64,
}

impl Stay {
    /// Until, or weak until, in a state of this sort: the truth and when it was forced, if it is.
    #[inline]
    pub(super) fn until(self, sort: Sort, (from, to): (f64, f64), weak: bool) -> Option<(bool, f64)> {
        let reached = if self.start >= from { self.start } else { from };
        if sort.goal && reached < self.end && (sort.hold || reached == self.start) {
            Some((true, reached))
        } else if !sort.hold {
            Some((false, self.start))
        } else {
            (self.end > to).then_some((weak, to))
        }
    }
}

/// What is asked at the start of the trial.
#[derive(Clone, Copy, Debug)]
pub(super) enum Question {
    /// Until, or weak until, perhaps negated; without `first` the second somewhere in the window.
    Until { first: Option<Probe>, second: Probe, weak: bool, negated: bool },
    /// An aggregate of a number.
    Fold { aggregation: Aggregation, of: usize },
    /// Seconds until a truth.
    Time { goal: Probe },
}

/// A question about the window `from ..= to` in seconds.
#[derive(Clone, Debug)]
pub(super) struct Direct {
    pub(super) question: Question,
    pub(super) from: f64,
    pub(super) to: f64,
    /// So far: smallest, largest or integral.
    folded: Option<f64>,
}

impl Direct {
    pub(super) fn new(question: Question, from: f64, to: f64) -> Self {
        Self { question, from, to, folded: None }
    }

    pub(super) fn clear(&mut self) {
        self.folded = None;
    }

    /// The present state lasts from `start` to before `end`; infinite after the horizon. The reading, and
    /// when it was forced.
    #[inline]
    pub(super) fn step(&mut self, start: f64, end: f64, present: &Present) -> Option<(Reading, f64)> {
        match self.question {
            Question::Until { first, second, weak, negated } => {
                let hold = first.is_none_or(|probe| probe.is(present));
                let sort = Sort { hold, goal: second.is(present) };
                let (truth, at) = Stay { start, end }.until(sort, (self.from, self.to), weak)?;
                Some((Reading::Truth(truth != negated), at))
            }
            Question::Time { goal } if goal.is(present) => Some((Reading::Value(start), start)),
            Question::Time { .. } => (end > self.to).then_some((Reading::Value(f64::INFINITY), self.to)),
            Question::Fold { aggregation, of } => self.fold(aggregation, present.number(of), start, end),
        }
    }

    fn fold(&mut self, aggregation: Aggregation, value: f64, start: f64, end: f64) -> Option<(Reading, f64)> {
        if end <= self.from {
            return None;
        }
        let (left, right) = (start.max(self.from), end.min(self.to));
        self.folded = Some(match (aggregation, self.folded) {
            (Aggregation::Min, Some(folded)) => Operation::Min.apply(folded, value),
            (Aggregation::Max, Some(folded)) => Operation::Max.apply(folded, value),
            (Aggregation::Min | Aggregation::Max, None) => value,
            (Aggregation::Sum | Aggregation::Mean, folded) => {
                folded.unwrap_or(0.0) + if right > left { value * (right - left) } else { 0.0 }
            }
        });
        if end <= self.to {
            return None;
        }
        let folded = self.folded.unwrap_or(f64::NAN);
        let value = match aggregation {
            Aggregation::Mean if self.from == self.to => value,
            Aggregation::Mean => folded / (self.to - self.from),
            _ => folded,
        };
        Some((Reading::Value(value), self.to))
    }
}
