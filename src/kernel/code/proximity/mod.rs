//! How near others are in one large crowd: gaps and distances between a body and the members of a list.
//!
//! Asked of each member of a crowd, the clearance and the contact with all others cost the square of their number. Here a
//! question looks only at the cells around a place (`kernel::near`), wider and wider until no agent outside can change the
//! answer; the forces have sorted the agents of a state already, else that is done when the first questions show that it
//! pays. The least of several gaps is one of them, and whether some gap is below a bound does not depend on the order
//! either: both have the bits of a look at all, whose roundings are kept. Where most of the members ask the same in each
//! state, all of them are answered at once. What can be read off the pairs that the forces found near enough to touch
//! (`touching`) needs no search at all, and what can be read off the pairs that were close a while ago (`neighbours`) needs
//! one only now and then.
//!
//! Where a position or a radius is no number, or beyond reason, nothing is sorted: a look at all covers that.

mod answers;
mod asker;
mod neighbours;
mod question;
mod touching;

use super::node::Cut;
use crate::base::lanes::{LANES, Mask};
use crate::kernel::near::{Close, FARTHEST, Index};
use crate::kernel::state::State;
use crate::model::Comparison;
use answers::Answers;
use asker::{has, square, squared, value};
use neighbours::Neighbours;
use touching::Asked;

pub(super) use asker::{Asker, MARGIN};
pub(super) use question::Question;

/// In a list of so many, a look at all is as fast.
const FEW: usize = 32;

/// So many questions of a state are answered sooner than the agents are sorted.
const FEW_QUESTIONS: u32 = 4;

/// A state, and the members who are asked about.
#[derive(Clone, Copy, Debug)]
pub(super) struct Around<'a> {
    /// Number of the state.
    pub(super) number: u64,
    pub(super) state: &'a State,
    /// All lists of agents, and which of them holds the members.
    pub(super) lists: &'a [Vec<u32>],
    pub(super) own: u32,
    /// Who may touch whom in this state, where that is known.
    pub(super) close: Option<Close<'a>>,
}

impl<'a> Around<'a> {
    /// The members.
    #[inline(always)]
    fn list(&self) -> &'a [u32] {
        &self.lists[self.own as usize]
    }
}

/// What is known of the members of a list in a state of one large crowd.
#[derive(Clone, Debug, Default)]
pub(super) struct Proximity {
    /// The state that was last asked about, by its number.
    state: u64,
    /// Questions about it, and about the one before.
    asked: (u32, u32),
    /// Whether the agents are sorted, if that was tried.
    sorted: Option<bool>,
    /// Members who were present when that was last tried.
    count: u32,
    /// The order of the agents where the forces have none.
    own: Index,
    /// For each agent of the scene how far one had to look for the nearest in the last state, m; 0 where that is unknown.
    far: Vec<f64>,
    /// What everybody asks.
    answers: Vec<Answers>,
    /// Members who were close a while ago, by gaps and by centres.
    neighbours: [Neighbours; 2],
    /// The least gap, and distance of centres, that was last seen, m.
    least: [f64; 2],
    /// Lists of agents as sets of each block, as far as they were needed.
    sets: Vec<(u32, Vec<Mask>)>,
}

impl Proximity {
    /// Takes note of some more questions about a state. Whether they are so many that a look at all each is too much.
    #[inline(always)]
    pub(super) fn is_asked_much(&mut self, around: &Around<'_>, questions: u32) -> bool {
        if around.list().len() <= FEW {
            return false;
        }
        if self.state != around.number {
            self.state = around.number;
            self.asked = (0, self.asked.0);
            self.sorted = None;
            self.answers.iter_mut().for_each(Answers::forget);
        }
        self.asked.0 = self.asked.0.saturating_add(questions);
        self.asked.0 > FEW_QUESTIONS || self.asked.1 > FEW_QUESTIONS
    }

    /// Whether the agents are sorted and some member is present; sorts them where that is new.
    #[inline(always)]
    fn is_sorted(&mut self, around: &Around<'_>) -> bool {
        match self.sorted {
            Some(sorted) => sorted,
            None => self.sort(around),
        }
    }

    fn sort(&mut self, around: &Around<'_>) -> bool {
        let sorted =
            around.close.is_some_and(|close| close.index.is_some()) || self.own.sort_alone(around.state);
        let members = self.set(around, around.own);
        let present = self.sets[members].1.iter().zip(&around.state.present);
        self.count = present.map(|(&member, &here)| (member & here).0.count_ones()).sum();
        self.far.resize(around.state.agents, 0.0);
        let sorted = sorted && self.count > 0;
        self.sorted = Some(sorted);
        sorted
    }

    /// The agents in sorted order, if they are sorted.
    #[inline(always)]
    fn index<'a>(&'a self, around: &Around<'a>) -> &'a Index {
        around.close.and_then(|close| close.index).unwrap_or(&self.own)
    }

    /// Where a list is, as a set of each block of agents.
    fn set(&mut self, around: &Around<'_>, list: u32) -> usize {
        if let Some(known) = self.sets.iter().position(|(known, _)| *known == list) {
            return known;
        }
        let mut set = vec![Mask::NONE; around.state.motion.x.len()];
        for &agent in &around.lists[list as usize] {
            set[agent as usize / LANES] |= Mask::lane(agent as usize % LANES);
        }
        self.sets.push((list, set));
        self.sets.len() - 1
    }

    /// Where the sets of members, and of those whose least is wanted, are.
    fn sets(&mut self, around: &Around<'_>, question: Question) -> (usize, usize) {
        let askers = match question {
            Question::Nearest { cut: Cut::Least(askers), .. } => askers,
            _ => around.own,
        };
        (self.set(around, around.own), self.set(around, askers))
    }

    fn asked<'a>(&'a self, (members, askers): (usize, usize), known: &'a [Mask]) -> Asked<'a> {
        Asked { known, members: &self.sets[members].1, askers: &self.sets[askers].1 }
    }

    /// Smallest measure from somebody to the members; infinite over nobody. `None` where only a look at all can tell.
    pub(super) fn nearest(&mut self, around: &Around<'_>, asker: &Asker, except: u32) -> Option<f64> {
        if except as usize == asker.agent
            && let Some(found) = self.known_nearest(around, asker.measure, asker.agent)
        {
            return Some(found);
        }
        (asker.is_reasonable() && self.is_sorted(around)).then(|| self.search(around, asker, except))
    }

    /// The same, of this one only.
    fn search(&mut self, around: &Around<'_>, asker: &Asker, except: u32) -> f64 {
        let Asker { at, radius, measure, .. } = *asker;
        let members = self.set(around, around.own);
        let (members, index) = (&self.sets[members].1, self.index(around));
        let mut best = f64::INFINITY;
        // Nobody goes far in a step.
        let mut reach = self.far[asker.agent] + 0.125 * index.grid.spacing;
        let needed = loop {
            let area = index.area(at, reach);
            let mut farther = square(asker.reach(index, best));
            for places in index.places(&area) {
                for k in places {
                    let squared = squared(index, at, k);
                    if squared > farther || index.agent[k] == except || !has(members, index.agent[k]) {
                        continue;
                    }
                    let found = value(measure, squared.sqrt(), radius, index.r[k]);
                    if found < best {
                        best = found;
                        farther = square(asker.reach(index, best));
                    }
                }
            }
            // Who is outside of the cells looked at is farther than the reach.
            let needed = asker.reach(index, best);
            if needed <= reach || index.is_all(&area) {
                break needed;
            }
            reach = if needed < f64::INFINITY { needed } else { 2.0 * reach };
        };
        // With nobody else there, all cells are looked at next time, too.
        self.far[asker.agent] = if 0.0 < needed && needed < FARTHEST { needed } else { 0.0 };
        best
    }

    /// Whether the comparison with a bound has the wanted value for all members, where it has for all who are far
    /// away. `None` where only a look at all can tell.
    pub(super) fn all_far(
        &mut self,
        around: &Around<'_>,
        asker: &Asker,
        except: u32,
        bound: f64,
        (test, wanted): (Comparison, bool),
    ) -> Option<bool> {
        let Asker { agent, at, radius, measure } = *asker;
        if !(asker.is_reasonable() && bound.abs() <= FARTHEST) {
            return None;
        }
        let question = Question::AllFar { measure, test, wanted, bound: bound.to_bits() };
        if except as usize == agent
            && let Some(far) = self.known_far(around, question, agent)
        {
            return Some(far);
        }
        if !self.is_sorted(around) {
            return None;
        }
        let members = self.set(around, around.own);
        let (members, index) = (&self.sets[members].1, self.index(around));
        let reach = asker.reach(index, bound);
        if reach < 0.0 {
            return Some(true);
        }
        let farther = square(reach);
        let is_near = |k: usize| {
            let squared = squared(index, at, k);
            squared <= farther
                && index.agent[k] != except
                && has(members, index.agent[k])
                && test.of(value(measure, squared.sqrt(), radius, index.r[k]), bound) != wanted
        };
        Some(!index.places(&index.area(at, reach)).any(|mut places| places.any(&is_near)))
    }
}
