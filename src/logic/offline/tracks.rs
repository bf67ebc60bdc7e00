//! The truths and numbers of all slots at the states at which they are asked about, each in one pass.

use super::Recording;
use super::graph::{Graph, Slot};
use crate::base::tick::Tick;
use crate::logic::formula::{Aggregation, Operation, bracket};
use std::collections::VecDeque;
use std::ops::Range;

/// A truth: false.
pub(in crate::logic) const FALSE: u8 = 0;
/// A truth: open.
pub(in crate::logic) const OPEN: u8 = 1;
/// A truth: true.
pub(in crate::logic) const TRUE: u8 = 2;

/// No state.
const NEVER: u64 = u64::MAX;
/// Most states of all tracks together; beyond them nothing is evaluated.
const MOST_STATES: u64 = 1 << 26;
/// States between two looks at the clock.
const CLOCK_EVERY: u64 = 1 << 12;

/// A truth, or the other one.
pub(in crate::logic) fn turned(truth: u8, as_it_is: bool) -> u8 {
    if as_it_is { truth } else { TRUE - truth }
}

/// A truth that is not open.
pub(super) fn known(truth: u8) -> Option<bool> {
    (truth != OPEN).then_some(truth == TRUE)
}

fn truth(known: Option<bool>) -> u8 {
    known.map_or(OPEN, |known| if known { TRUE } else { FALSE })
}

/// The known values of a slot.
#[derive(Clone, Debug)]
pub(super) struct Track {
    /// The first state.
    from: u64,
    truths: Vec<u8>,
    numbers: Vec<Option<f64>>,
    /// At every state that was not seen: there nothing depends on the state.
    unseen: (u8, Option<f64>),
    seen: u64,
}

impl Track {
    pub(super) fn truth(&self, at: u64) -> u8 {
        if at >= self.seen {
            return self.unseen.0;
        }
        at.checked_sub(self.from).and_then(|k| self.truths.get(k as usize)).copied().unwrap_or(OPEN)
    }

    pub(super) fn number(&self, at: u64) -> Option<f64> {
        if at >= self.seen {
            return self.unseen.1;
        }
        at.checked_sub(self.from).and_then(|k| self.numbers.get(k as usize)).copied().flatten()
    }
}

/// The nearest states at which a truth is false, open and true, from a state that moves back.
pub(in crate::logic) struct Next {
    nearest: [u64; 3],
    reached: u64,
    unseen: u8,
    seen: u64,
}

impl Next {
    /// Behind the last state seen.
    pub(in crate::logic) fn new(seen: u64, unseen: u8) -> Self {
        let mut nearest = [NEVER; 3];
        nearest[unseen as usize] = seen;
        Self { nearest, reached: seen, unseen, seen }
    }

    /// Moves back to `at`.
    pub(in crate::logic) fn move_to(&mut self, at: u64, truth: impl Fn(u64) -> u8) {
        while self.reached > at {
            self.reached -= 1;
            self.nearest[truth(self.reached) as usize] = self.reached;
        }
    }

    /// The first state from `at` on with this truth; `at` is where it was moved to, or was not seen.
    pub(in crate::logic) fn first(&self, at: u64, truth: u8) -> u64 {
        match (at >= self.seen, truth == self.unseen) {
            (true, true) => at,
            (true, false) => NEVER,
            (false, _) => self.nearest[truth as usize],
        }
    }
}

/// Values from the last state to the first, in order of states.
pub(in crate::logic) fn backward<T>(states: Range<u64>, of: impl FnMut(u64) -> T) -> Vec<T> {
    let mut values: Vec<T> = states.rev().map(of).collect();
    values.reverse();
    values
}

/// The smallest or largest number of a window that moves back (a monotone queue); of equal ones the first.
pub(in crate::logic) struct Slide {
    queue: VecDeque<(u64, f64)>,
    reached: u64,
    operation: Operation,
}

impl Slide {
    /// Behind the last state seen.
    pub(in crate::logic) fn new(seen: u64, operation: Operation) -> Self {
        Self { queue: VecDeque::new(), reached: seen, operation }
    }

    /// That of the states `first ..= last`; what is no number does not count, and NaN is none.
    pub(in crate::logic) fn of(
        &mut self,
        (first, last): (u64, u64),
        mut number: impl FnMut(u64) -> f64,
    ) -> f64 {
        while self.reached > first {
            self.reached -= 1;
            let next = number(self.reached);
            if next.is_nan() {
                continue;
            }
            let wins = |later: f64| self.operation.apply(next, later).to_bits() == next.to_bits();
            while self.queue.front().is_some_and(|&(_, later)| wins(later)) {
                self.queue.pop_front();
            }
            self.queue.push_front((self.reached, next));
        }
        while self.queue.back().is_some_and(|&(k, _)| k > last) {
            self.queue.pop_back();
        }
        self.queue.back().map_or(f64::NAN, |&(_, number)| number)
    }
}

/// The tracks of all slots; empty ones, in which all is open, where there is no time or no room for them.
pub(super) fn tracks(graph: &Graph, recording: &Recording<'_>) -> Vec<Track> {
    let seen = recording.seen;
    let empty = Track { from: 0, truths: Vec::new(), numbers: Vec::new(), unseen: (OPEN, None), seen };
    let mut tracks: Vec<Track> = Vec::with_capacity(graph.slots.len());
    let states = |range: &(u64, u64)| range.1.saturating_add(1).min(seen).saturating_sub(range.0);
    let all = graph.ranges.iter().flatten().fold(0u64, |sum, range| sum.saturating_add(states(range)));
    let mut given_up = all > MOST_STATES;
    for (slot, range) in graph.slots.iter().zip(&graph.ranges) {
        given_up |= (recording.stop)();
        let Some(range) = range.filter(|_| !given_up) else {
            tracks.push(empty.clone());
            continue;
        };
        let work = Work { graph, tracks: &tracks, recording, lo: range.0, end: range.0 + states(&range) };
        let track = work.of(slot);
        tracks.push(track);
    }
    if given_up { vec![empty; graph.slots.len()] } else { tracks }
}

/// Any or all of some truths.
fn join(mut truths: impl Iterator<Item = u8>, any: bool) -> u8 {
    // Any hold where not all fail.
    let all = truths.try_fold(TRUE, |all, one| match turned(one, !any) {
        FALSE => Err(FALSE),
        one => Ok(all.min(one)),
    });
    turned(all.unwrap_or(FALSE), !any)
}

/// One slot at the states `lo .. end`.
struct Work<'g> {
    graph: &'g Graph,
    tracks: &'g [Track],
    recording: &'g Recording<'g>,
    lo: u64,
    end: u64,
}

impl Work<'_> {
    fn truth(&self, slot: usize, at: u64) -> u8 {
        self.tracks[slot].truth(at)
    }

    fn number(&self, slot: usize, at: u64) -> Option<f64> {
        self.tracks[slot].number(at)
    }

    fn pair(&self, x: usize, y: usize, at: u64) -> Option<(f64, f64)> {
        self.number(x, at).zip(self.number(y, at))
    }

    fn next(&self, slot: usize, as_it_is: bool) -> Next {
        Next::new(self.recording.seen, turned(self.tracks[slot].unseen.0, as_it_is))
    }

    /// The values of a slot. All states that were not seen are as the first of them is.
    fn of(&self, slot: &Slot) -> Track {
        let is_seen = |k: u64| k < self.recording.seen;
        match slot {
            Slot::Fixed(value) => self.truths(|_| truth(Some(*value))),
            Slot::Atom(atom) => self.truths(|k| truth(is_seen(k).then(|| (self.recording.atoms)(*atom, k)))),
            Slot::Compare(relation, x, y) => {
                self.truths(|k| truth(self.pair(*x, *y, k).map(|(x, y)| relation.holds(x, y))))
            }
            Slot::Not(x) => self.truths(|k| turned(self.truth(*x, k), false)),
            Slot::Join { parts, any } => self.truths(|k| join(parts.iter().map(|x| self.truth(*x, k)), *any)),
            Slot::Window { from, to, of, any } => self.window(*from, *to, *of, *any),
            Slot::Until { from, to, first, second, weak, value } => {
                self.until((*from, *to), *first, *second, (*weak, *value))
            }
            Slot::Number(value) => self.numbers(|_| Some(*value)),
            Slot::Signal(signal) => {
                self.numbers(|k| is_seen(k).then(|| (self.recording.signals)(*signal, k)))
            }
            Slot::Combine(operation, x, y) => {
                self.numbers(|k| self.pair(*x, *y, k).map(|(x, y)| operation.apply(x, y)))
            }
            Slot::Abs(x) => self.numbers(|k| self.number(*x, k).map(f64::abs)),
            Slot::Later(by, x) => self.numbers(|k| self.number(*x, k.saturating_add(*by))),
            Slot::AtEnd(x) => self.numbers(|_| self.number(*x, self.recording.horizon.0)),
            Slot::Time(goal) => self.times(*goal),
            Slot::Aggregate { aggregation, from, to, of } => match aggregation {
                Aggregation::Min | Aggregation::First => self.extremes(*from, *to, *of, Operation::Min),
                Aggregation::Max => self.extremes(*from, *to, *of, Operation::Max),
                Aggregation::Sum => self.sums(*from, *to, *of, false),
                Aggregation::Mean => self.sums(*from, *to, *of, true),
            },
        }
    }

    /// Truths from behind the last state seen to the first state.
    fn truths(&self, mut of: impl FnMut(u64) -> u8) -> Track {
        let Recording { seen, .. } = *self.recording;
        let unseen = (of(seen), None);
        let truths = backward(self.lo..self.end, of);
        Track { from: self.lo, truths, numbers: Vec::new(), unseen, seen }
    }

    /// Numbers from behind the last state seen to the first state.
    fn numbers(&self, mut of: impl FnMut(u64) -> Option<f64>) -> Track {
        let Recording { seen, .. } = *self.recording;
        let unseen = (OPEN, of(seen));
        let numbers = backward(self.lo..self.end, of);
        Track { from: self.lo, truths: Vec::new(), numbers, unseen, seen }
    }

    fn window(&self, from: u64, to: Option<u64>, of: usize, any: bool) -> Track {
        // All hold where none fails.
        let mut next = self.next(of, any);
        self.truths(|at| {
            let (first, last) = (at.saturating_add(from), self.graph.end(at, to));
            next.move_to(first, |k| turned(self.truth(of, k), any));
            let found = [TRUE, OPEN].into_iter().find(|truth| next.first(first, *truth) <= last);
            turned(found.unwrap_or(FALSE), any)
        })
    }

    /// At most so true: the second somewhere in the window and the first before. For each of "true" and "not false", the
    /// first state that fails and the first that reaches say it.
    fn until(
        &self,
        (from, to): (u64, Option<u64>),
        first: (usize, bool),
        second: (usize, bool),
        (weak, value): (bool, bool),
    ) -> Track {
        let (mut hold, mut goal) = (self.next(first.0, first.1), self.next(second.0, second.1));
        self.truths(|at| {
            let (begin, last) = (at.saturating_add(from), self.graph.end(at, to));
            hold.move_to(at, |k| turned(self.truth(first.0, k), first.1));
            goal.move_to(begin, |k| turned(self.truth(second.0, k), second.1));
            let fails = hold.first(at, FALSE);
            let unsure = fails.min(hold.first(at, OPEN));
            let reached = goal.first(begin, TRUE);
            let perhaps = reached.min(goal.first(begin, OPEN));
            let so =
                |reached: u64, fails: u64| (reached <= last && reached <= fails) || (weak && fails > last);
            let truth = if so(reached, unsure) {
                TRUE
            } else if so(perhaps, fails) {
                OPEN
            } else {
                FALSE
            };
            turned(truth, value)
        })
    }

    fn times(&self, goal: usize) -> Track {
        let mut next = self.next(goal, true);
        let horizon = self.recording.horizon.0;
        self.numbers(|at| {
            next.move_to(at, |k| self.truth(goal, k));
            let (reached, open) = (next.first(at, TRUE), next.first(at, OPEN));
            if reached.min(open) > horizon {
                Some(f64::INFINITY)
            } else {
                (reached < open).then(|| self.recording.clock.seconds(Tick(reached - at)))
            }
        })
    }

    /// Smallest or largest numbers of a sliding window. What is no number wins.
    fn extremes(&self, from: u64, to: Option<u64>, of: usize, operation: Operation) -> Track {
        let mut slide = Slide::new(self.recording.seen, operation);
        let (mut open, mut nothing) = (NEVER, NEVER);
        self.numbers(|at| {
            let (first, last) = (at.saturating_add(from), self.graph.end(at, to));
            let best = slide.of((first, last), |k| {
                let number = self.number(of, k);
                match number {
                    None => open = k,
                    Some(value) if value.is_nan() => nothing = k,
                    Some(_) => {}
                }
                number.unwrap_or(f64::NAN)
            });
            if last >= self.recording.seen || open <= last {
                None
            } else if nothing <= last {
                Some(f64::NAN)
            } else {
                (!best.is_nan()).then_some(best)
            }
        })
    }

    /// Sums are added up state by state, as the monitors do it.
    fn sums(&self, from: u64, to: Option<u64>, of: usize, mean: bool) -> Track {
        let (mut work, mut given_up) = (0u64, false);
        self.numbers(|at| {
            let (first, last) = (at.saturating_add(from), self.graph.end(at, to));
            if last >= self.recording.seen || first > last || given_up {
                return None;
            }
            let mut sum = self.number(of, first)?;
            let (mut least, mut most) = (sum, sum);
            for k in first + 1..=last {
                let next = self.number(of, k)?;
                sum += next;
                (least, most) = (Operation::Min.apply(least, next), Operation::Max.apply(most, next));
            }
            let count = last - first + 1;
            work += count;
            if work >= CLOCK_EVERY {
                work = 0;
                given_up = (self.recording.stop)();
            }
            Some(if mean { bracket(sum / count as f64, least, most) } else { sum })
        })
    }
}
