//! One step of a cell: which code each kind of cell runs.

use super::cell::{Cell, Context, Machine, Ref, events, planes, truth};
use super::track::Track;
use super::{boolean, numbers};
use crate::base::lanes::{Lanes, Mask};

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
            Machine::Count { .. } | Machine::Slide { .. } => step_window(self, before, cx),
            Machine::Capture(_)
            | Machine::AnyLate { .. }
            | Machine::CompareHeld(..)
            | Machine::CompareLate(..)
            | Machine::Watch { .. } => boolean::step(self, before, cx),
            Machine::Chain { .. } => step_chain(self, before, cx),
            _ => numbers::step(self, before, cx),
        }
        self.track.ascend();
        if self.single {
            self.keep_answer(cx.now);
        }
    }
}

// Until without a bound, at many positions, by its recurrence
// `until(i) = second(i) or (first(i) and until(i + 1))`.
//
// A bounded until is this one and the second operand within the bound. Each plane, "known to be true"
// and "not known to be false", is a two-valued evaluation, so equivalences of positive formulas carry
// over to open values and to the state at which the verdict falls.

fn step_chain(cell: &mut Cell, before: &[Cell], cx: &Context) {
    let Machine::Chain { first, second } = &cell.machine else { return };
    let track = &mut cell.track;
    for child in std::iter::once(second).chain(first) {
        for (at, ..) in events(before, *child, cx.now) {
            settle(track, before, (*first, *second), at, cx);
        }
    }
    if cx.ending != 0 {
        settle(track, before, (*first, *second), cx.now, cx);
    }
}

/// Settles position `at` as far as it is known now, and then those before it that depend on it.
fn settle(
    track: &mut Track,
    before: &[Cell],
    (first, second): (Option<Ref>, Ref),
    mut at: u64,
    cx: &Context,
) {
    loop {
        let open = track.open(at, cx.now);
        if open == 0 {
            return;
        }
        let (next_t, next_f) = if at == cx.now {
            (0, cx.ending)
        } else {
            let (t, f) = track.planes(at.wrapping_add(1));
            // Both: a lane in which that position is not needed any more.
            (t & !f, f & !t)
        };
        let (second_t, second_f) = planes(before, second, at, cx.now);
        let (first_t, first_f) = first.map_or((0xff, 0), |first| planes(before, first, at, cx.now));
        let t = open & (second_t | first_t & next_t);
        let f = open & !t & second_f & (first_f | next_f);
        if t | f == 0 {
            return;
        }
        track.settle(at, cx.now, t, f);
        at = at.wrapping_sub(1);
    }
}

// Windows over formulas: something holds at some state of a window. That it holds at every state is the
// negation of the negation.

fn step_window(cell: &mut Cell, before: &[Cell], cx: &Context) {
    match &mut cell.machine {
        // The child reports each of its positions once, and they are those of the window.
        Machine::Count { child, left, .. } => {
            for (_, t, f) in events(before, *child, cx.now) {
                cell.t |= t & cx.work;
                let f = f & cx.work;
                if f != 0 {
                    for (lane, left) in left.iter_mut().enumerate() {
                        *left -= u64::from(f >> lane & 1);
                    }
                    let done = Mask(f).iter().filter(|&lane| left[lane] == 0);
                    cell.f |= done.fold(0, |all, lane| all | 1 << lane);
                }
            }
        }
        Machine::Slide { child, width, cut } => {
            for (at, t, f) in events(before, *child, cx.now) {
                slide(&mut cell.track, cx.now, *width, at, t, f);
            }
            if *cut && cx.ending != 0 {
                cut_off(&mut cell.track, cx);
            }
        }
        _ => {}
    }
}

/// At the horizon what is still open never comes.
fn cut_off(track: &mut Track, cx: &Context) {
    let mut at = cx.now;
    loop {
        let never = track.open(at, cx.now) & cx.ending;
        if never == 0 {
            return;
        }
        track.settle(at, cx.now, 0, never);
        at = at.wrapping_sub(1);
    }
}

/// Finally over `at ..= at + width`, after the child settled at `at`. It settles in order, so the open
/// positions of a lane are the last ones before `at` without a gap, and no true state was seen in the
/// windows of any of them. Each turn of the loop settles a position: constant work on average.
#[inline(always)]
fn slide(track: &mut Track, now: u64, width: u64, at: u64, t: u8, f: u8) {
    let oldest = at.wrapping_sub(width);
    let (mut position, mut hit) = (at, t);
    loop {
        hit &= track.open(position, now);
        if hit == 0 {
            break;
        }
        track.settle(position, now, hit, 0);
        if position == oldest {
            break;
        }
        position = position.wrapping_sub(1);
    }
    // The window of the oldest position ends here.
    let missed = (t | f) & track.open(oldest, now);
    if missed != 0 {
        track.settle(oldest, now, 0, missed);
    }
}
