//! One question of everybody: each pair of members who may be near is looked at once, for both of them.
//!
//! The squares are swept row by row; a square meets those after it, a few columns and rows on. For the nearest these are
//! the next ones; who has nobody so near searches farther alone.

use super::{Asker, Vicinity, square, value};
use crate::base::geometry::Vec2;
use crate::kernel::code::node::Measure;
use crate::model::Comparison;
use std::ops::Range;

/// Questions of everybody that are kept apart; others are answered one by one.
const QUESTIONS: usize = 8;

/// At most so many squares from one to another that are looked at: with more, one by one is as fast, since
/// the first who is too near ends a look.
const FARTHEST_SQUARE: usize = 2;

/// Of squares, what rounding may take off a distance, amply.
const ROUNDING: f64 = 1e-6;

/// What everybody may ask.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Question {
    /// The smallest measure to the others.
    Nearest(Measure),
    /// Whether a comparison has the wanted value for all others; 1 where it has, else 0.
    AllFar {
        /// What is measured.
        measure: Measure,
        /// Its comparison with the bound.
        test: Comparison,
        /// The value it must have.
        wanted: bool,
        /// The bits of the bound.
        bound: u64,
    },
}

/// The answers to a question.
#[derive(Clone, Debug)]
pub(super) struct Answers {
    question: Question,
    /// How many asked it in this state, and in the one before.
    asked: (u32, u32),
    /// Whether all are answered for this state, if that was tried.
    given: Option<bool>,
    /// By agents; NaN for those who are no members or not there.
    of: Vec<f64>,
}

impl Answers {
    /// A new state.
    pub(super) fn forget(&mut self) {
        self.asked = (0, self.asked.0);
        self.given = None;
    }
}

impl Vicinity {
    /// The answer for one who is left out of the members, where most members ask the same in every state.
    #[inline(always)]
    pub(super) fn answer(&mut self, question: Question, agent: usize) -> Option<f64> {
        let place = match self.answers.iter().position(|answers| answers.question == question) {
            Some(place) => place,
            None => self.begin(question)?,
        };
        let answers = &mut self.answers[place];
        answers.asked.0 = answers.asked.0.saturating_add(1);
        let given = match answers.given {
            Some(given) => given,
            None => self.give(place),
        };
        if !given {
            return None;
        }
        self.answers[place].of.get(agent).copied().filter(|answer| !answer.is_nan())
    }

    /// A place for a new question, if there is one: that of a question which nobody asks any more.
    fn begin(&mut self, question: Question) -> Option<usize> {
        let new = Answers { question, asked: (0, 0), given: None, of: Vec::new() };
        if self.answers.len() < QUESTIONS {
            self.answers.push(new);
            return Some(self.answers.len() - 1);
        }
        let place = self.answers.iter().position(|answers| answers.asked == (0, 0))?;
        self.answers[place] = new;
        Some(place)
    }

    /// Answers everybody, if it pays.
    fn give(&mut self, place: usize) -> bool {
        let Answers { question, asked, .. } = self.answers[place];
        if (asked.1 as usize) < self.here.len() / 2 {
            return false;
        }
        let found = match question {
            Question::Nearest(measure) => Some(self.nearest_of_each(measure)),
            Question::AllFar { measure, test, wanted, bound } => {
                self.all_far_of_each(measure, f64::from_bits(bound), (test, wanted))
            }
        };
        let answers = &mut self.answers[place];
        answers.given = Some(found.is_some());
        let Some(found) = found else { return false };
        answers.of.clear();
        answers.of.resize(self.far.len(), f64::NAN);
        for (&agent, found) in self.agent.iter().zip(found) {
            answers.of[agent as usize] = found;
        }
        true
    }

    /// Calls `pair` with the places of all pairs at most `span` squares apart, once each, and the squared distance.
    #[inline(always)]
    fn each_pair(&self, span: usize, mut pair: impl FnMut(usize, usize, f64)) {
        let (rows, columns) = (self.squares.rows, self.squares.columns);
        for row in 0..rows {
            for column in 0..columns {
                let own = self.stretch(row, &(column..column + 1));
                if own.is_empty() {
                    continue;
                }
                let last = (column + span).min(columns - 1) + 1;
                let right = self.stretch(row, &(column..last)).end;
                let mut all = |first: usize, others: Range<usize>| {
                    let at = Vec2::new(self.x[first], self.y[first]);
                    for second in others {
                        pair(first, second, self.squared(at, second));
                    }
                };
                for first in own.clone() {
                    all(first, first + 1..right);
                }
                for above in row + 1..=(row + span).min(rows - 1) {
                    let others = self.stretch(above, &(column.saturating_sub(span)..last));
                    for first in own.clone() {
                        all(first, others.clone());
                    }
                }
            }
        }
    }

    fn nearest_of_each(&mut self, measure: Measure) -> Vec<f64> {
        let mut best = vec![f64::INFINITY; self.agent.len()];
        self.each_pair(1, |a, b, squared| {
            let (distance, ra, rb) = (squared.sqrt(), self.radius[a], self.radius[b]);
            let (of_a, of_b) = (value(measure, distance, ra, rb), value(measure, distance, rb, ra));
            best[a] = if of_a < best[a] { of_a } else { best[a] };
            best[b] = if of_b < best[b] { of_b } else { best[b] };
        });
        // Between those who are not in the same or the next squares is at least one square.
        let seen = self.side * (1.0 - ROUNDING);
        for (k, best) in best.iter_mut().enumerate() {
            let radius = if measure == Measure::Centres { 0.0 } else { self.radius[k] };
            if self.reach(measure, radius, *best) > seen {
                let (agent, at) = (self.agent[k] as usize, Vec2::new(self.x[k], self.y[k]));
                *best = self.search(&Asker { agent, at, radius, measure }, self.agent[k]);
            }
        }
        best
    }

    /// `None` where that takes too many squares.
    fn all_far_of_each(
        &self,
        measure: Measure,
        bound: f64,
        (test, wanted): (Comparison, bool),
    ) -> Option<Vec<f64>> {
        let mut far = vec![1.0; self.agent.len()];
        let reach = self.reach(measure, self.widest, bound);
        if reach < 0.0 {
            return Some(far);
        }
        let span = (reach / self.side + ROUNDING) as u32 as usize + 1;
        if span > FARTHEST_SQUARE {
            return None;
        }
        let farther = square(reach);
        self.each_pair(span, |a, b, squared| {
            if squared > farther {
                return;
            }
            let (distance, ra, rb) = (squared.sqrt(), self.radius[a], self.radius[b]);
            if test.of(value(measure, distance, ra, rb), bound) != wanted {
                far[a] = 0.0;
            }
            if test.of(value(measure, distance, rb, ra), bound) != wanted {
                far[b] = 0.0;
            }
        });
        Some(far)
    }
}
