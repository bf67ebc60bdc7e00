//! Loops over one large crowd, eight members at once.
//!
//! In a state of one trial every lane has the same; a loop whose body is `lanewise` gives each lane a member of its own
//! instead. What the members say is joined one after the other, so that no bit depends on how many are taken at once.

use super::super::crowd::Members;
use super::super::lanes::{Body, Vector, greater, lesser, narrow};
use super::super::node::{Crowd, Cut, Id, Join, Measure};
use super::super::proximity::Question;
use super::super::schedule::Loop;
use super::Machine;
use crate::base::lanes::{LANES, Mask};
use crate::model::{Comparison, Fold, Who};
use fearless_simd::{Simd, prelude::*};

impl<S: Simd, const ONE: bool> Machine<'_, S, ONE> {
    /// Whoever is read.
    #[inline(always)]
    pub(super) fn body(&self, who: Who) -> Body {
        match (self.eight, who) {
            (Some((var, eight)), Who::Running(running)) if ONE && var == running => eight,
            _ => Body::One(self.who(who)),
        }
    }

    /// The block that the next eight members are, if they are one and all present.
    #[inline(always)]
    fn whole_block(&self, members: Members<'_>, next: usize) -> Option<usize> {
        let eight = members.list.get(next..next + LANES)?;
        // Lists ascend: eight members who end seven after the first are a block.
        let (first, last) = (eight[0] as usize, eight[LANES - 1] as usize);
        let block = first / LANES;
        let whole = first.is_multiple_of(LANES) && last == first + LANES - 1;
        let all = whole && members.except as usize / LANES != block;
        if all && self.view.state.present[block] == Mask::ALL { Some(block) } else { None }
    }

    /// Goes to the next eight members that are present, or to what is left of them.
    #[inline(always)]
    pub(super) fn advance_eight(&mut self, info: &Loop) -> bool {
        let members = self.members(info.crowd);
        let mut next = self.frames[info.var as usize].next;
        if let Some(block) = self.whole_block(members, next) {
            self.frames[info.var as usize].next = next + LANES;
            self.frames[info.var as usize].present = Mask::ALL;
            self.eight = Some((info.var, Body::Block(block)));
            return true;
        }
        let (mut eight, mut found) = ([0; LANES], 0);
        while let Some(&member) = members.list.get(next) {
            // What is left of a block is read by itself where whole ones follow.
            let turn = found > 0
                && (member as usize).is_multiple_of(LANES)
                && self.whole_block(members, next).is_some();
            if found == LANES || turn {
                break;
            }
            next += 1;
            if member != members.except && !self.view.present(member as usize).is_empty() {
                eight[found] = member;
                found += 1;
            }
        }
        // Lanes without a member read the first again; nobody looks at them.
        let first = eight[0];
        eight[found..].fill(first);
        self.frames[info.var as usize].next = next;
        self.frames[info.var as usize].present = Mask(((1u32 << found) - 1) as u8);
        self.eight = (found > 0).then_some((info.var, Body::Eight(eight)));
        found > 0
    }

    /// Joins the body's values of eight members, one after the other; whether nothing can change the result any more.
    #[inline(always)]
    pub(super) fn join_eight(&mut self, info: &Loop) -> bool {
        let present = self.frames[info.var as usize].present;
        let into = info.into as usize;
        let fold = match info.join {
            Join::Forall => {
                let all = (self.truth(info.body) | !present) == Mask::ALL;
                self.truths[into] = if all { self.truths[into] } else { Mask::NONE };
                return !all;
            }
            Join::Exists => {
                let none = (self.truth(info.body) & present).is_empty();
                self.truths[into] = if none { self.truths[into] } else { Mask::ALL };
                return !none;
            }
            Join::Count => {
                let more = (self.truth(info.body) & present).0.count_ones();
                self.put(info.into, self.number(info.into) + f64::from(more));
                return false;
            }
            Join::Fold(fold) => fold,
        };
        let (mut joined, values) = (self.number(info.into), self.number(info.body));
        for lane in present.iter() {
            let value = self.view.splat(values[lane]);
            joined = match fold {
                Fold::Min => lesser(joined, value),
                Fold::Max => greater(joined, value),
                Fold::Sum | Fold::Mean => joined + value,
            };
        }
        self.put(info.into, joined);
        if fold == Fold::Mean {
            self.put(info.count, self.number(info.count) + f64::from(present.0.count_ones()));
        }
        false
    }

    /// The block of running agents who ask about a crowd without themselves, if they are a whole one.
    #[inline(always)]
    fn asking_block(&self, who: Who, crowd: Crowd) -> Option<usize> {
        match (self.eight, who, crowd.except) {
            (Some((var, Body::Block(block))), Who::Running(asks), Some(Who::Running(out)))
                if asks == var && out == var =>
            {
                Some(block)
            }
            _ => None,
        }
    }

    /// Smallest measures between a block of running agents and a crowd, if they are known; where some may be larger than
    /// they are, perhaps that.
    #[inline(always)]
    pub(super) fn nearest_of_block(
        &mut self,
        into: Id,
        who: Who,
        crowd: Crowd,
        measure: Measure,
    ) -> Option<Vector<S>> {
        let block = self.asking_block(who, crowd)?;
        let around = self.around(crowd);
        let proximity = self.proximities.get_mut(crowd.list as usize)?;
        if !proximity.is_asked_much(&around, LANES as u32) {
            return None;
        }
        for cut in [self.cut.filter(|(cut, _)| *cut == into).map(|(_, cut)| cut), Some(Cut::Nowhere)] {
            let Some(cut) = cut else { continue };
            if let Some(found) =
                proximity.nearest_of_block(&around, Question::Nearest { measure, cut }, block)
            {
                let found = self.view.register(found);
                if narrow(found.simd_eq(found)) == Mask::ALL {
                    return Some(found);
                }
            }
        }
        None
    }

    /// The running agents of a block from which all of a crowd are far, if that is known and the bound the same for each.
    #[inline(always)]
    pub(super) fn all_far_of_block(
        &mut self,
        who: Who,
        crowd: Crowd,
        measure: Measure,
        (test, wanted): (Comparison, bool),
        bound: Vector<S>,
    ) -> Option<Mask> {
        let block = self.asking_block(who, crowd)?;
        let first = bound[0];
        if narrow(bound.simd_eq(self.view.splat(first))) != Mask::ALL {
            return None;
        }
        let around = self.around(crowd);
        let proximity = self.proximities.get_mut(crowd.list as usize)?;
        if !proximity.is_asked_much(&around, LANES as u32) {
            return None;
        }
        let question = Question::AllFar { measure, test, wanted, bound: first.to_bits() };
        proximity.far_of_block(&around, question, block)
    }

    /// What `f` says of whoever is read, one after the other.
    #[inline(always)]
    pub(super) fn one_by_one(&mut self, mut f: impl FnMut(&mut Self, usize)) {
        let Some((var, eight)) = self.eight.take() else { return };
        for lane in self.frames[var as usize].present.iter() {
            self.frames[var as usize].agent = eight.agent(lane) as u32;
            f(self, lane);
        }
        self.eight = Some((var, eight));
    }
}
