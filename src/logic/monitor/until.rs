//! Until without a bound, at many positions, by its recurrence
//! `until(i) = second(i) or (first(i) and until(i + 1))`.
//!
//! A bounded until is this one and the second operand within the bound. Each plane, "known to be true"
//! and "not known to be false", is a two-valued evaluation, so equivalences of positive formulas carry
//! over to open values and to the state at which the verdict falls.

use super::cell::{Cell, Context, Machine, Ref, events, planes};
use super::track::Track;

pub(super) fn step(cell: &mut Cell, before: &[Cell], cx: &Context) {
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
