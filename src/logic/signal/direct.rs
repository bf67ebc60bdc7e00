//! The short way: one temporal operator, or one metric, at the start of a trial, over present states.
//!
//! Nothing is stored; a state costs a few comparisons of its instants with the bounds in seconds.

use super::Reading;
use super::present::Present;
use crate::logic::formula::{Aggregation, Operation};

/// A truth of the present state, perhaps negated.
#[derive(Clone, Copy, Debug)]
pub(super) struct Probe {
    pub(super) slot: usize,
    pub(super) negated: bool,
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
        let is = |probe: Probe| present.truth(probe.slot) != probe.negated;
        match self.question {
            Question::Until { first, second, weak, negated } => {
                let goes_on = first.is_none_or(is);
                let reached = if start >= self.from { start } else { self.from };
                let (truth, at) = if is(second) && reached < end && (goes_on || reached == start) {
                    (true, reached)
                } else if !goes_on {
                    (false, start)
                } else if end > self.to {
                    (weak, self.to)
                } else {
                    return None;
                };
                Some((Reading::Truth(truth != negated), at))
            }
            Question::Time { goal } if is(goal) => Some((Reading::Value(start), start)),
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
