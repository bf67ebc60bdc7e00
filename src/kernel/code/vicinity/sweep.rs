//! One question of everybody: each pair of members who may be near is looked at once, for both of them.
//!
//! The squares are swept row by row; a square meets those after it, a few columns and rows on. For the nearest these are
//! the next ones; who has nobody so near searches farther alone.

use super::answers::All;
use super::{Around, Asker, Question, Vicinity, square, value};
use crate::base::geometry::Vec2;
use crate::base::lanes::{LANES, Lanes, Mask};
use crate::kernel::code::node::{Cut, Measure};
use crate::model::Comparison;
use std::ops::Range;

/// At most so many squares from one to another that are looked at: with more, one by one is as fast, since
/// the first who is too near ends a look.
const FARTHEST_SQUARE: usize = 2;

/// Of squares, what rounding may take off a distance, amply.
pub(super) const ROUNDING: f64 = 1e-6;

impl Vicinity {
    /// Answers everybody; false where one by one is as fast.
    pub(super) fn swept(&mut self, around: &Around<'_>, question: Question, all: &mut All) -> bool {
        // Where it is cut it is asked again, in full.
        if matches!(question, Question::Nearest { cut: Cut::Least(_) | Cut::Above(_), .. })
            || !self.is_sorted(around)
        {
            return false;
        }
        let blocks = around.state.motion.x.len();
        match question {
            Question::Nearest { measure, .. } => {
                let found = self.nearest_of_each(measure);
                let least = found.iter().fold(f64::INFINITY, |a, &b| if b < a { b } else { a });
                self.least[usize::from(measure == Measure::Centres)] = least;
                all.nearest.clear();
                all.nearest.resize(blocks, Lanes::splat(f64::NAN));
                for (&agent, found) in self.agent.iter().zip(found) {
                    all.nearest[agent as usize / LANES].0[agent as usize % LANES] = found;
                }
                true
            }
            Question::AllFar { measure, test, wanted, bound } => {
                let found = self.all_far_of_each(measure, f64::from_bits(bound), (test, wanted));
                let Some(found) = found else { return false };
                all.far.clear();
                all.far.resize(blocks, (Mask::NONE, Mask::NONE));
                for (&agent, far) in self.agent.iter().zip(found) {
                    let (known, holds) = &mut all.far[agent as usize / LANES];
                    let lane = Mask::lane(agent as usize % LANES);
                    *known |= lane;
                    *holds |= if far { lane } else { Mask::NONE };
                }
                true
            }
        }
    }

    /// Calls `pair` with the places of all pairs at most `span` squares apart, once each, and the squared distance.
    #[inline(always)]
    pub(super) fn each_pair(&self, span: usize, mut pair: impl FnMut(usize, usize, f64)) {
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
    ) -> Option<Vec<bool>> {
        let mut far = vec![true; self.agent.len()];
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
                far[a] = false;
            }
            if test.of(value(measure, distance, rb, ra), bound) != wanted {
                far[b] = false;
            }
        });
        Some(far)
    }
}
