//! Numbers: arithmetic, aggregates over windows, times, and comparisons.
//!
//! NaN makes every comparison with it false, and every aggregate, smaller and
//! larger of it none. Sums run over the states in ascending order; a mean lies between the least and the greatest number that
//! it averages.

use super::cell::{Arithmetic, Cell, Context, Extent, Machine, Place, Ref, events, identity, planes, truth};
use super::track::{Numbers, Track, select};
use crate::base::lanes::{Lanes, Mask};
use crate::logic::formula::{Aggregation, Operation, Relation, bracket};

/// Lanes in which the relation holds.
#[inline(always)]
pub(super) fn compare(relation: Relation, x: Lanes, y: Lanes) -> u8 {
    match relation {
        Relation::Less => x.compare(y, |x, y| x < y),
        Relation::AtMost => x.compare(y, |x, y| x <= y),
        Relation::Greater => x.compare(y, |x, y| x > y),
        Relation::AtLeast => x.compare(y, |x, y| x >= y),
        Relation::Equal => x.compare(y, |x, y| x == y),
        Relation::Unequal => x.compare(y, |x, y| Relation::Unequal.holds(x, y)),
    }
    .0
}

/// Arithmetic, lane by lane.
#[inline(always)]
pub(super) fn combine(arithmetic: Arithmetic, x: Lanes, y: Lanes) -> Lanes {
    match arithmetic {
        Arithmetic::Of(Operation::Add) => x.zip(y, |x, y| x + y),
        Arithmetic::Of(Operation::Subtract) => x.zip(y, |x, y| x - y),
        Arithmetic::Of(Operation::Multiply) => x.zip(y, |x, y| x * y),
        Arithmetic::Of(Operation::Divide) => x.zip(y, |x, y| x / y),
        Arithmetic::Of(Operation::Min) => x.zip(y, |x, y| Operation::Min.apply(x, y)),
        Arithmetic::Of(Operation::Max) => x.zip(y, |x, y| Operation::Max.apply(x, y)),
        Arithmetic::Abs => x.map(f64::abs),
    }
}

#[inline(always)]
fn gather(aggregation: Aggregation, so_far: Lanes, next: Lanes) -> Lanes {
    match aggregation {
        Aggregation::Min | Aggregation::First => so_far.zip(next, |x, y| Operation::Min.apply(x, y)),
        Aggregation::Max => so_far.zip(next, |x, y| Operation::Max.apply(x, y)),
        Aggregation::Sum | Aggregation::Mean => so_far.zip(next, |x, y| x + y),
    }
}

/// The lanes whose number is finite.
#[inline(always)]
fn finite(value: Lanes) -> u8 {
    value.compare(Lanes::splat(f64::INFINITY), |x, y| x < y).0
}

#[inline(always)]
fn finish(aggregation: Aggregation, mut so_far: Lanes, states: u64, extent: &Extent) -> Lanes {
    if aggregation == Aggregation::Mean {
        for (lane, sum) in so_far.0.iter_mut().enumerate() {
            *sum = bracket(*sum / states as f64, extent.least.0[lane], extent.most.0[lane]);
        }
    }
    so_far
}

/// The lanes in which an answer is known.
#[inline(always)]
pub(super) fn known(before: &[Cell], child: Ref) -> u8 {
    if child.place == Place::Fixed { 0xff } else { before[child.cell].t }
}

/// The lanes in which a number is known at a position of the parent.
#[inline(always)]
pub(super) fn known_at(before: &[Cell], child: Ref, at: u64, now: u64) -> u8 {
    if child.place == Place::Fixed {
        return 0xff;
    }
    let (t, f) = planes(before, child, at, now);
    if child.place == Place::Now { t } else { t & !f }
}

/// The number at a position of the parent at which it is known.
#[inline(always)]
pub(super) fn number(before: &[Cell], child: Ref, at: u64) -> Lanes {
    let cell = &before[child.cell];
    if child.place == Place::Fixed { cell.value } else { cell.numbers.at(at.wrapping_add(child.ahead)) }
}

/// The positions of the parent at which a number became known in this step, and the lanes.
#[inline(always)]
pub(super) fn events_of(before: &[Cell], child: Ref, now: u64) -> impl Iterator<Item = (u64, u8)> {
    let cell = &before[child.cell];
    let present = (child.place == Place::Now).then_some((now, 0xff));
    let changes = if child.place == Place::Late { cell.track.changes.as_slice() } else { &[] };
    let late = changes.iter().map(move |change| (now.wrapping_sub(u64::from(change.back)), change.t));
    present.into_iter().chain(late).map(move |(at, lanes)| (at.wrapping_sub(child.ahead), lanes))
}

pub(super) fn step(cell: &mut Cell, before: &[Cell], cx: &Context) {
    let now = cx.now;
    match &mut cell.machine {
        Machine::CaptureNumber(child) => {
            let asked = cell.need & cx.work;
            cell.value = select(asked, before[child.cell].value, cell.value);
            cell.t |= asked;
        }
        Machine::CombineHeld(arithmetic, x, y) => {
            let fresh = known(before, *x) & known(before, *y) & !cell.t;
            if fresh != 0 {
                let value = combine(*arithmetic, before[x.cell].value, before[y.cell].value);
                cell.value = select(fresh, value, cell.value);
                cell.t |= fresh;
            }
        }
        Machine::Fold { aggregation, child, states, extent } => {
            let asked = cell.need & cx.work;
            let mut value = gather(*aggregation, cell.value, before[*child].value);
            if *aggregation == Aggregation::Mean {
                **extent = extent.with(before[*child].value).within(asked, **extent);
            }
            let early = if *aggregation == Aggregation::First { finite(value) } else { 0 };
            let done = asked & (cell.last | early);
            if done != 0 {
                value = select(done, finish(*aggregation, value, *states, extent), value);
                cell.t |= done;
            }
            cell.value = select(asked, value, cell.value);
        }
        Machine::Time { child, from } => {
            let open = cell.need & cx.work & !cell.t;
            let hit = open & truth(before, *child).0;
            for lane in Mask(hit).iter() {
                cell.value.0[lane] = cx.seconds(now - cx.starts[lane] - *from);
            }
            let never = open & !hit & cell.last;
            cell.value = select(never, Lanes::splat(f64::INFINITY), cell.value);
            cell.t |= hit | never;
        }
        Machine::TimeHeld(child) => {
            let (t, f) = truth(before, *child);
            let value = select(t, Lanes::ZERO, Lanes::splat(f64::INFINITY));
            cell.value = select((t | f) & !cell.t, value, cell.value);
            cell.t |= t | f;
        }
        Machine::CombineLate(arithmetic, x, y) => {
            for child in [*x, *y] {
                for (at, _) in events_of(before, child, now) {
                    let fresh = cell.track.open(at, now)
                        & known_at(before, *x, at, now)
                        & known_at(before, *y, at, now);
                    if fresh != 0 {
                        let value = combine(*arithmetic, number(before, *x, at), number(before, *y, at));
                        cell.numbers.store(at, fresh, value);
                        cell.track.settle(at, now, fresh, 0);
                    }
                }
            }
        }
        Machine::FoldLate { aggregation, child, width: Some(width), in_order } => {
            for (at, lanes) in events_of(before, *child, now) {
                // In order, the last state of a window is the last to be known.
                let oldest = at.wrapping_sub(*width);
                let newest = if *in_order { oldest } else { at };
                for position in oldest..=newest {
                    let mut fresh = lanes & cell.track.open(position, now);
                    if !*in_order {
                        for state in position..=position + *width {
                            fresh &= known_at(before, *child, state, now);
                        }
                    }
                    if fresh != 0 {
                        let end = position + *width;
                        let value = fold(*aggregation, before, *child, position, end);
                        cell.numbers.store(position, fresh, value);
                        cell.track.settle(position, now, fresh, 0);
                    }
                }
            }
        }
        Machine::FoldLate { aggregation, child, width: None, .. } => {
            let mut position = now;
            // The least and the largest do not depend on the order of states: each window is the next one and a state more.
            let joins = !matches!(aggregation, Aggregation::Sum | Aggregation::Mean);
            let mut joined = Lanes::splat(identity(*aggregation));
            while cx.ending & cell.track.open(position, now) != 0 {
                let fresh = cx.ending & cell.track.open(position, now);
                if joins {
                    joined = gather(*aggregation, number(before, *child, position), joined);
                }
                if fresh & cell.track.needed(position) != 0 {
                    let value =
                        if joins { joined } else { fold(*aggregation, before, *child, position, now) };
                    cell.numbers.store(position, fresh, value);
                }
                cell.track.settle(position, now, fresh, 0);
                position = position.wrapping_sub(1);
            }
        }
        Machine::TimeLate { child, ticks } => {
            for (at, ..) in events(before, *child, now) {
                settle_time(&mut cell.track, (&mut cell.numbers, ticks), before, *child, at, cx);
            }
        }
        Machine::EndLate(end) => {
            let (known, value) = (before[*end].t, before[*end].value);
            let mut position = now;
            while cx.ending & known & cell.track.open(position, now) != 0 {
                let fresh = cx.ending & known & cell.track.open(position, now);
                cell.numbers.store(position, fresh, value);
                cell.track.settle(position, now, fresh, 0);
                position = position.wrapping_sub(1);
            }
        }
        _ => {}
    }
}

/// The aggregate over the states `from ..= to`, ascending.
fn fold(aggregation: Aggregation, before: &[Cell], child: Ref, from: u64, to: u64) -> Lanes {
    let (mut value, mut extent) = (Lanes::splat(identity(aggregation)), Extent::EMPTY);
    for at in from..=to {
        let next = number(before, child, at);
        value = gather(aggregation, value, next);
        if aggregation == Aggregation::Mean {
            extent = extent.with(next);
        }
    }
    finish(aggregation, value, to - from + 1, &extent)
}

/// The recurrence of the time until a truth: none if it holds, else one tick more than at the next
/// position, for ever after the horizon.
fn settle_time(
    track: &mut Track,
    (seconds, ticks): (&mut Numbers, &mut Numbers),
    before: &[Cell],
    child: Ref,
    mut at: u64,
    cx: &Context,
) {
    loop {
        let open = track.open(at, cx.now);
        let (next, later) = if at == cx.now {
            (cx.ending, Lanes::splat(f64::INFINITY))
        } else {
            let (t, f) = track.planes(at.wrapping_add(1));
            (t & !f, ticks.at(at.wrapping_add(1)))
        };
        let (t, f) = planes(before, child, at, cx.now);
        let fresh = open & (t | f & next);
        if fresh == 0 {
            return;
        }
        let mut count = Lanes::ZERO;
        let mut value = Lanes::ZERO;
        for lane in Mask(fresh & !t).iter() {
            count.0[lane] = later.0[lane] + 1.0;
            value.0[lane] =
                if count.0[lane] == f64::INFINITY { f64::INFINITY } else { cx.seconds(count.0[lane] as u64) };
        }
        ticks.store(at, fresh, count);
        seconds.store(at, fresh, value);
        track.settle(at, cx.now, fresh, 0);
        at = at.wrapping_sub(1);
    }
}
