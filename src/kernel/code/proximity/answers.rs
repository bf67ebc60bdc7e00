//! What everybody asks in each state: kept by blocks of agents, so that eight of them are told at once.

use super::asker::Asker;
use super::question::{All, Question};
use super::touching::read_off;
use super::{Around, Proximity};
use crate::base::lanes::{LANES, Lanes, Mask};
use crate::kernel::code::node::{Cut, Measure};

/// Questions of everybody that are kept apart; others are answered one by one.
const QUESTIONS: usize = 8;

/// The answers to a question.
#[derive(Clone, Debug)]
pub(super) struct Answers {
    pub(super) question: Question,
    /// How many asked it in this state, and in the one before.
    pub(super) asked: (u32, u32),
    /// Whether all are answered for this state, if that was tried.
    given: Option<bool>,
    all: All,
}

impl Answers {
    /// A new state.
    pub(super) fn forget(&mut self) {
        self.asked = (0, self.asked.0);
        self.given = None;
    }
}

impl Proximity {
    /// Answers everybody who is there, if the pairs who may touch can. Of centres that near nobody asks.
    pub(super) fn touching(&mut self, around: &Around<'_>, question: Question, all: &mut All) -> bool {
        let Some(close) = around.close else { return false };
        if question.measure() == Measure::Centres {
            return false;
        }
        let places = self.sets(around, question);
        let asked = self.asked(places, &around.state.present);
        read_off(around.state, close, question, asked, all).is_some()
    }

    /// The smallest measure of one who is left out of the members, where most members ask the same in every state.
    #[inline(always)]
    pub(super) fn known_nearest(
        &mut self,
        around: &Around<'_>,
        measure: Measure,
        agent: usize,
    ) -> Option<f64> {
        let all = self.answers(around, Question::Nearest { measure, cut: Cut::Nowhere }, 1)?;
        all.nearest.get(agent / LANES).map(|block| block.0[agent % LANES]).filter(|answer| !answer.is_nan())
    }

    /// Whether it holds for one who is left out of the members, where most members ask the same in every state.
    #[inline(always)]
    pub(super) fn known_far(
        &mut self,
        around: &Around<'_>,
        question: Question,
        agent: usize,
    ) -> Option<bool> {
        let (known, far) = *self.answers(around, question, 1)?.far.get(agent / LANES)?;
        known.has(agent % LANES).then(|| far.has(agent % LANES))
    }

    /// The smallest measures of a block of agents each of whom is left out of the members; no number for who has none.
    #[inline(always)]
    pub(in crate::kernel::code) fn nearest_of_block(
        &mut self,
        around: &Around<'_>,
        question: Question,
        block: usize,
    ) -> Option<&Lanes> {
        self.answers(around, question, LANES as u32)?.nearest.get(block)
    }

    /// For whom it holds of a block of agents each of whom is left out of the members, if all have an answer.
    #[inline(always)]
    pub(in crate::kernel::code) fn far_of_block(
        &mut self,
        around: &Around<'_>,
        question: Question,
        block: usize,
    ) -> Option<Mask> {
        let (known, far) = *self.answers(around, question, LANES as u32)?.far.get(block)?;
        (known == Mask::ALL).then_some(far)
    }

    /// The answers to a question which some more agents ask, if all are answered.
    #[inline(always)]
    fn answers(&mut self, around: &Around<'_>, question: Question, agents: u32) -> Option<&All> {
        let place = match self.answers.iter().position(|answers| answers.question == question) {
            Some(place) => place,
            None => self.begin(question)?,
        };
        let answers = &mut self.answers[place];
        answers.asked.0 = answers.asked.0.saturating_add(agents);
        let given = match answers.given {
            Some(given) => given,
            None => self.give(around, place),
        };
        if given { Some(&self.answers[place].all) } else { None }
    }

    /// A place for a new question, if there is one: that of a question which nobody asks any more.
    fn begin(&mut self, question: Question) -> Option<usize> {
        let new = Answers { question, asked: (0, 0), given: None, all: All::default() };
        if self.answers.len() < QUESTIONS {
            self.answers.push(new);
            return Some(self.answers.len() - 1);
        }
        let place = self.answers.iter().position(|answers| answers.asked == (0, 0))?;
        self.answers[place] = new;
        Some(place)
    }

    /// Answers everybody, if it pays.
    fn give(&mut self, around: &Around<'_>, place: usize) -> bool {
        let Answers { question, asked, .. } = self.answers[place];
        let mut all = std::mem::take(&mut self.answers[place].all);
        let given = if self.touching(around, question, &mut all) {
            Some(true)
        } else if self.count == 0 && !self.is_sorted(around) {
            Some(false)
        } else if asked.1 < self.count / 2 {
            // Perhaps more will ask.
            None
        } else {
            Some(self.listed(around, question, &mut all) || self.searched(around, question, &mut all))
        };
        let answers = &mut self.answers[place];
        (answers.all, answers.given) = (all, given);
        given == Some(true)
    }

    /// Answers everybody's nearest, where it is not cut, by a search each; false of other questions: where the first who is
    /// too near ends a look, one by one is as fast.
    fn searched(&mut self, around: &Around<'_>, question: Question, all: &mut All) -> bool {
        let Question::Nearest { measure, cut: Cut::Nowhere } = question else { return false };
        if !self.is_sorted(around) {
            return false;
        }
        all.nearest.clear();
        all.nearest.resize(around.state.motion.x.len(), Lanes::splat(f64::NAN));
        let mut least = f64::INFINITY;
        for &agent in around.list() {
            let (block, lane) = (agent as usize / LANES, agent as usize % LANES);
            if around.state.present[block].has(lane) {
                let found = self.search(around, &Asker::new(around.state, agent as usize, measure), agent);
                all.nearest[block].0[lane] = found;
                least = if found < least { found } else { least };
            }
        }
        self.least[usize::from(measure == Measure::Centres)] = least;
        true
    }
}
