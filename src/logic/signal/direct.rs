//! The short way: one temporal operator, or one metric, at the start of a trial, over present states.
//!
//! Nothing is stored; a state costs a few comparisons of its instants with the bounds in seconds.

use super::Reading;
use super::integral::Integral;
use super::moment::{Moment, Scale};
use crate::base::instant::Instant;
use crate::logic::flat::Sort;
use crate::logic::formula::{Aggregation, Operation};
use crate::logic::present::Present;

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
    pub(super) start: Instant,
    pub(super) end: Instant,
}

impl Stay {
    /// Until, or weak until, in a state of this sort: the truth and when it was forced, if it is.
    #[inline]
    pub(super) fn until(self, sort: Sort, (from, to): (Instant, Instant), weak: bool) -> Option<(bool, f64)> {
        let is_early = self.start.is_before(from);
        let reached = if is_early { from } else { self.start };
        if sort.goal && reached.is_before(self.end) && (sort.hold || !is_early) {
            Some((true, reached.seconds))
        } else if !sort.hold {
            Some((false, self.start.seconds))
        } else {
            to.is_before(self.end).then_some((weak, to.seconds))
        }
    }
}

/// The formula or metric that is evaluated at the start of the trial.
#[derive(Clone, Copy, Debug)]
pub(super) enum Question {
    /// Until, or weak until, perhaps negated; without `first` the second somewhere in the window.
    Until { first: Option<Probe>, second: Probe, weak: bool, negated: bool },
    /// An aggregate of a number.
    Fold { aggregation: Aggregation, of: usize },
    /// Seconds until a truth.
    Time { goal: Probe },
}

/// A question about the window `from ..= to`.
#[derive(Clone, Debug)]
pub(super) struct Direct {
    pub(super) question: Question,
    pub(super) from: Instant,
    pub(super) to: Instant,
    /// So far: smallest or largest.
    folded: Option<f64>,
    average: Option<Box<Average>>,
}

/// How far a mean has come.
#[derive(Clone, Debug)]
struct Average {
    scale: Scale,
    reached: Moment,
    integral: Integral,
}

impl Direct {
    pub(super) fn new(question: Question, (from, to): (Instant, Instant), scale: Scale) -> Self {
        let is_mean = matches!(question, Question::Fold { aggregation: Aggregation::Mean, .. });
        let average = Average { scale, reached: scale.at(from), integral: Integral::EMPTY };
        Self { question, from, to, folded: None, average: is_mean.then(|| Box::new(average)) }
    }

    pub(super) fn clear(&mut self) {
        self.folded = None;
        if let Some(average) = &mut self.average {
            (average.reached, average.integral) = (average.scale.at(self.from), Integral::EMPTY);
        }
    }

    /// The present state lasts from `start` to before `end`; infinite after the horizon. The reading, and
    /// when it was forced.
    #[inline]
    pub(super) fn step(&mut self, stay: Stay, present: &Present) -> Option<(Reading, f64)> {
        let Stay { start, end } = stay;
        match self.question {
            Question::Until { first, second, weak, negated } => {
                let hold = first.is_none_or(|probe| probe.is(present));
                let sort = Sort { hold, goal: second.is(present) };
                let (truth, at) = stay.until(sort, (self.from, self.to), weak)?;
                Some((Reading::Truth(truth != negated), at))
            }
            Question::Time { goal } if goal.is(present) => {
                Some((Reading::Value(start.seconds), start.seconds))
            }
            Question::Time { .. } => {
                self.to.is_before(end).then_some((Reading::Value(f64::INFINITY), self.to.seconds))
            }
            Question::Fold { aggregation, of } => self.fold(aggregation, present.number(of), stay),
        }
    }

    fn fold(&mut self, aggregation: Aggregation, value: f64, stay: Stay) -> Option<(Reading, f64)> {
        if !self.from.is_before(stay.end) {
            return None;
        }
        self.folded = Some(match (aggregation, self.folded) {
            (Aggregation::Min | Aggregation::First, Some(folded)) => Operation::Min.apply(folded, value),
            (Aggregation::Max, Some(folded)) => Operation::Max.apply(folded, value),
            _ => value,
        });
        if let Some(average) = &mut self.average {
            let to = average.scale.at(if self.to.is_before(stay.end) { self.to } else { stay.end });
            average.integral.add(value, average.reached, to);
            average.reached = to;
        }
        if !self.to.is_before(stay.end) {
            return None;
        }
        let value = match &self.average {
            Some(average) if self.from.is_before(self.to) => average.integral.mean(),
            Some(_) => value,
            None => self.folded.unwrap_or(f64::NAN),
        };
        Some((Reading::Value(value), self.to.seconds))
    }
}
