//! Any of several formulas at many positions, comparisons, and single answers.

use super::cell::{Cell, Context, Machine, Place, Ref, events, planes, truth};
use super::numbers;
use super::track::Track;
use crate::base::lanes::Mask;
use crate::logic::formula::Relation;

pub(super) fn step(cell: &mut Cell, before: &[Cell], cx: &Context) {
    match &cell.machine {
        Machine::Capture(child) => {
            let asked = cell.need & cx.work;
            let (t, f) = truth(before, *child);
            cell.t |= t & asked;
            cell.f |= f & asked;
        }
        Machine::CompareHeld(relation, x, y) => {
            let known = numbers::known(before, *x) & numbers::known(before, *y);
            if known & !(cell.t | cell.f) != 0 {
                let t = numbers::compare(*relation, before[x.cell].value, before[y.cell].value);
                (cell.t, cell.f) = (known & t, known & !t);
            }
        }
        Machine::AnyLate { children, cut } => {
            let track = &mut cell.track;
            for child in children {
                for (at, t, f) in events(before, *child, cx.now) {
                    let open = track.open(at, cx.now);
                    let t = t & open;
                    // False only if all the others are too; they may have settled long ago.
                    let mut f = f & open;
                    for other in children {
                        if f == 0 {
                            break;
                        }
                        f &= planes(before, *other, at, cx.now).1;
                    }
                    if t | f != 0 {
                        track.settle(at, cx.now, t, f);
                    }
                }
            }
            if *cut && cx.ending != 0 {
                cut_off(track, before, children, cx);
            }
        }
        Machine::CompareLate(relation, x, y) => {
            let track = &mut cell.track;
            for child in [x, y] {
                for (at, ..) in numbers::events_of(before, *child, cx.now) {
                    compare_late(track, before, (*relation, *x, *y), at, cx.now);
                }
            }
        }
        Machine::Watch { .. } => watch(cell, before, cx),
        _ => {}
    }
}

fn watch(cell: &mut Cell, before: &[Cell], cx: &Context) {
    let Machine::Watch { child, settled } = &mut cell.machine else { return };
    match child.place {
        Place::Held => {
            let (t, f) = truth(before, *child);
            cell.t |= t & cx.work;
            for lane in Mask((t | f) & cx.work).iter() {
                settled[lane] = 1;
            }
        }
        Place::Now => cell.t |= truth(before, *child).0 & cell.need & cx.work,
        // The child reports each of its positions once.
        _ => {
            for (_, t, f) in events(before, *child, cx.now) {
                cell.t |= t & cx.work;
                for lane in Mask((t | f) & cx.work).iter() {
                    settled[lane] += 1;
                }
            }
        }
    }
}

/// At the horizon, children beyond it are false.
fn cut_off(track: &mut Track, before: &[Cell], children: &[Ref], cx: &Context) {
    let furthest = children.iter().map(|child| child.ahead).max().unwrap_or(0);
    for at in cx.now.saturating_sub(furthest)..=cx.now {
        let mut f = track.open(at, cx.now) & cx.ending;
        for child in children {
            if at + child.ahead <= cx.now {
                f &= planes(before, *child, at, cx.now).1;
            }
        }
        if f != 0 {
            track.settle(at, cx.now, 0, f);
        }
    }
}

fn compare_late(
    track: &mut Track,
    before: &[Cell],
    (relation, x, y): (Relation, Ref, Ref),
    at: u64,
    now: u64,
) {
    let open = track.open(at, now);
    let known = open & numbers::known_at(before, x, at, now) & numbers::known_at(before, y, at, now);
    if known != 0 {
        let t = numbers::compare(relation, numbers::number(before, x, at), numbers::number(before, y, at));
        track.settle(at, now, known & t, known & !t);
    }
}
