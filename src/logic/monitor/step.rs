//! One step of a cell: which code each kind of cell runs.

use super::cell::{Cell, Context, Machine, truth};
use super::{boolean, numbers, until, window};
use crate::base::lanes::Lanes;

impl Cell {
    /// One step: the children have taken theirs.
    #[inline(always)]
    pub(super) fn step(&mut self, before: &[Cell], cx: &Context) {
        if self.live & cx.work == 0 {
            self.track.changes.clear();
            return;
        }
        match &mut self.machine {
            Machine::Atom(k) => {
                let t = cx.atoms.get(*k).map_or(0, |mask| mask.0);
                self.present(t, cx.now);
            }
            Machine::CompareNow(relation, x, y) => {
                let t = numbers::compare(*relation, before[*x].value, before[*y].value);
                self.present(t, cx.now);
            }
            Machine::AnyNow(children) => {
                let t = children.iter().fold(0, |t, child| t | truth(before, *child).0);
                self.present(t, cx.now);
            }
            Machine::Signal(k) => {
                let value = cx.signals.get(*k).copied().unwrap_or(Lanes::splat(f64::NAN));
                self.present_number(value, cx.now);
            }
            Machine::CombineNow(arithmetic, x, y) => {
                let value = numbers::combine(*arithmetic, before[*x].value, before[*y].value);
                self.present_number(value, cx.now);
            }
            Machine::Fixed => {}
            Machine::Scan { first, second } => {
                let open = self.need & cx.work & !(self.t | self.f);
                let rest = open & !truth(before, *second).0;
                let missed = first.map_or(0, |first| truth(before, first).1);
                self.t |= open & !rest;
                // At the last state of the window it is too late.
                self.f |= rest & (missed | self.last);
            }
            Machine::AnyHeld(children) => {
                let (mut t, mut f) = (0, 0xff);
                for child in children {
                    let (child_t, child_f) = truth(before, *child);
                    t |= child_t;
                    f &= child_f;
                }
                (self.t, self.f) = (t, f);
            }
            _ => self.late_step(before, cx),
        }
    }

    /// The cells that take longer, out of the way of those that do not.
    #[inline(never)]
    fn late_step(&mut self, before: &[Cell], cx: &Context) {
        if self.track.is_kept() {
            self.track.begin(cx.now, !self.live, self.need);
        }
        match &self.machine {
            Machine::Count { .. } | Machine::Slide { .. } => window::step(self, before, cx),
            Machine::Capture(_)
            | Machine::AnyLate { .. }
            | Machine::CompareHeld(..)
            | Machine::CompareLate(..)
            | Machine::Watch { .. } => boolean::step(self, before, cx),
            Machine::Chain { .. } => until::step(self, before, cx),
            _ => numbers::step(self, before, cx),
        }
        self.track.ascend();
        if self.single {
            self.keep_answer(cx.now);
        }
    }
}
