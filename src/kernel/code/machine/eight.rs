//! Loops over one large crowd, eight members at once.
//!
//! In a state of one trial every lane has the same; a loop whose body is `lanewise` gives each lane a member of its own
//! instead. What the members say is joined one after the other, so that no bit depends on how many are taken at once.

use super::super::lanes::{Body, greater, lesser};
use super::super::node::Join;
use super::super::schedule::Loop;
use super::Machine;
use crate::base::lanes::{LANES, Mask};
use crate::model::{Fold, Who};
use fearless_simd::Simd;

impl<S: Simd, const ONE: bool> Machine<'_, S, ONE> {
    /// Whoever is read.
    #[inline(always)]
    pub(super) fn body(&self, who: Who) -> Body {
        match (self.eight, who) {
            (Some((var, eight)), Who::Running(running)) if ONE && var == running => eight,
            _ => Body::One(self.who(who)),
        }
    }

    /// Goes to the next eight members that are present, or to what is left of them.
    #[inline(always)]
    pub(super) fn advance_eight(&mut self, info: &Loop) -> bool {
        let members = self.members(info.crowd);
        let mut next = self.frames[info.var as usize].next;
        let block = |next: usize| {
            let eight = members.list.get(next..next + LANES)?;
            let first = eight[0] as usize;
            let follows =
                |(k, member): (usize, &u32)| *member as usize == first + k && *member != members.except;
            let whole = first.is_multiple_of(LANES) && eight.iter().enumerate().all(follows);
            (whole && self.view.state.present[first / LANES] == Mask::ALL).then_some(first / LANES)
        };
        if let Some(block) = block(next) {
            self.frames[info.var as usize].next = next + LANES;
            self.frames[info.var as usize].present = Mask::ALL;
            self.eight = Some((info.var, Body::Block(block)));
            return true;
        }
        let (mut eight, mut found) = ([0; LANES], 0);
        while let Some(&member) = members.list.get(next) {
            // What is left of a block is read by itself where whole ones follow.
            let turn = found > 0 && (member as usize).is_multiple_of(LANES) && block(next).is_some();
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
