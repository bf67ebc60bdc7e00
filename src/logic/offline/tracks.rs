//! The truths and numbers of all slots at the states at which they are asked about, each in one pass.

use super::Recording;
use super::graph::{Graph, Slot};
use crate::base::tick::Tick;
use crate::logic::formula::{Aggregation, Operation, bracket};
use std::collections::VecDeque;

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
        let mut track = Track { from: range.0, unseen: unseen(slot, &tracks, recording), ..empty.clone() };
        let work = Work { graph, tracks: &tracks, recording, lo: range.0, end: range.0 + states(&range) };
        work.fill(slot, &mut track);
        tracks.push(track);
    }
    if given_up { vec![empty; graph.slots.len()] } else { tracks }
}

/// A slot at a state that was not seen, where all that was not seen is alike.
fn unseen(slot: &Slot, tracks: &[Track], recording: &Recording<'_>) -> (u8, Option<f64>) {
    let of = |slot: &usize| tracks[*slot].unseen;
    let number = |value: Option<f64>| (OPEN, value);
    match slot {
        Slot::Fixed(value) => (truth(Some(*value)), None),
        Slot::Atom(_) | Slot::Signal(_) | Slot::Aggregate { .. } => (OPEN, None),
        Slot::Compare(relation, x, y) => {
            (truth(of(x).1.zip(of(y).1).map(|(x, y)| relation.holds(x, y))), None)
        }
        Slot::Not(x) => (turned(of(x).0, false), None),
        Slot::Join { parts, any } => (join(parts.iter().map(|x| of(x).0), *any), None),
        Slot::Window { of: x, .. } => (of(x).0, None),
        Slot::Until { from, to, first, second, weak, value } => {
            let (p, q) = (turned(of(&first.0).0, first.1), turned(of(&second.0).0, second.1));
            let mut reached = if *weak { q.max(p) } else { q };
            if *to != Some(*from) {
                reached = q.max(p.min(reached));
            }
            if *from > 0 {
                reached = p.min(reached);
            }
            (turned(reached, *value), None)
        }
        Slot::Number(value) => number(Some(*value)),
        Slot::Combine(operation, x, y) => number(of(x).1.zip(of(y).1).map(|(x, y)| operation.apply(x, y))),
        Slot::Abs(x) => number(of(x).1.map(f64::abs)),
        Slot::Later(_, x) => number(of(x).1),
        Slot::AtEnd(x) => number(tracks[*x].number(recording.horizon.0)),
        Slot::Time(x) => number(match of(x).0 {
            FALSE => Some(f64::INFINITY),
            TRUE => Some(0.0),
            _ => None,
        }),
    }
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

    fn next(&self, slot: usize, as_it_is: bool) -> Next {
        Next::new(self.recording.seen, turned(self.tracks[slot].unseen.0, as_it_is))
    }

    fn fill(&self, slot: &Slot, track: &mut Track) {
        let states = self.lo..self.end;
        match slot {
            Slot::Fixed(value) => track.truths = states.map(|_| truth(Some(*value))).collect(),
            Slot::Atom(atom) => {
                track.truths = states.map(|k| truth(Some((self.recording.atoms)(*atom, k)))).collect();
            }
            Slot::Compare(relation, x, y) => {
                let compare =
                    |k| truth(self.number(*x, k).zip(self.number(*y, k)).map(|(x, y)| relation.holds(x, y)));
                track.truths = states.map(compare).collect();
            }
            Slot::Not(x) => track.truths = states.map(|k| turned(self.truth(*x, k), false)).collect(),
            Slot::Join { parts, any } => {
                track.truths = states.map(|k| join(parts.iter().map(|x| self.truth(*x, k)), *any)).collect();
            }
            Slot::Window { from, to, of, any } => track.truths = self.window(*from, *to, *of, *any),
            Slot::Until { .. } => track.truths = self.until(slot),
            Slot::Number(value) => track.numbers = states.map(|_| Some(*value)).collect(),
            Slot::Signal(signal) => {
                track.numbers = states.map(|k| Some((self.recording.signals)(*signal, k))).collect();
            }
            Slot::Combine(operation, x, y) => {
                let combine =
                    |k| self.number(*x, k).zip(self.number(*y, k)).map(|(x, y)| operation.apply(x, y));
                track.numbers = states.map(combine).collect();
            }
            Slot::Abs(x) => track.numbers = states.map(|k| self.number(*x, k).map(f64::abs)).collect(),
            Slot::Later(by, x) => {
                track.numbers = states.map(|k| self.number(*x, k.saturating_add(*by))).collect();
            }
            Slot::AtEnd(x) => {
                let last = self.number(*x, self.recording.horizon.0);
                track.numbers = states.map(|_| last).collect();
            }
            Slot::Time(goal) => track.numbers = self.times(*goal),
            Slot::Aggregate { aggregation, from, to, of } => {
                track.numbers = match aggregation {
                    Aggregation::Min | Aggregation::First => self.extremes(*from, *to, *of, Operation::Min),
                    Aggregation::Max => self.extremes(*from, *to, *of, Operation::Max),
                    Aggregation::Sum => self.sums(*from, *to, *of, false),
                    Aggregation::Mean => self.sums(*from, *to, *of, true),
                }
            }
        }
    }

    /// Values from the last state to the first, in order of states.
    fn backward<T>(&self, mut of: impl FnMut(u64) -> T) -> Vec<T> {
        let mut values: Vec<T> = (self.lo..self.end).rev().map(&mut of).collect();
        values.reverse();
        values
    }

    fn window(&self, from: u64, to: Option<u64>, of: usize, any: bool) -> Vec<u8> {
        // All hold where none fails.
        let mut next = self.next(of, any);
        self.backward(|at| {
            let (first, last) = (at.saturating_add(from), self.graph.end(at, to));
            next.move_to(first, |k| turned(self.truth(of, k), any));
            let found = [TRUE, OPEN].into_iter().find(|truth| next.first(first, *truth) <= last);
            turned(found.unwrap_or(FALSE), any)
        })
    }

    /// At most so true: the second somewhere in the window and the first before. For each of "true" and "not false", the
    /// first state that fails and the first that reaches say it.
    fn until(&self, slot: &Slot) -> Vec<u8> {
        let Slot::Until { from, to, first, second, weak, value } = slot else { return Vec::new() };
        let (mut hold, mut goal) = (self.next(first.0, first.1), self.next(second.0, second.1));
        self.backward(|at| {
            let (begin, last) = (at.saturating_add(*from), self.graph.end(at, *to));
            hold.move_to(at, |k| turned(self.truth(first.0, k), first.1));
            goal.move_to(begin, |k| turned(self.truth(second.0, k), second.1));
            let fails = hold.first(at, FALSE);
            let unsure = fails.min(hold.first(at, OPEN));
            let reached = goal.first(begin, TRUE);
            let perhaps = reached.min(goal.first(begin, OPEN));
            let so =
                |reached: u64, fails: u64| (reached <= last && reached <= fails) || (*weak && fails > last);
            let truth = if so(reached, unsure) {
                TRUE
            } else if so(perhaps, fails) {
                OPEN
            } else {
                FALSE
            };
            turned(truth, *value)
        })
    }

    fn times(&self, goal: usize) -> Vec<Option<f64>> {
        let mut next = self.next(goal, true);
        let horizon = self.recording.horizon.0;
        self.backward(|at| {
            next.move_to(at, |k| self.truth(goal, k));
            let (reached, open) = (next.first(at, TRUE), next.first(at, OPEN));
            if reached.min(open) > horizon {
                Some(f64::INFINITY)
            } else {
                (reached < open).then(|| self.recording.clock.seconds(Tick(reached - at)))
            }
        })
    }

    /// Smallest or largest numbers of a sliding window (a monotone queue). What is no number wins, of equal numbers the
    /// first.
    fn extremes(&self, from: u64, to: Option<u64>, of: usize, operation: Operation) -> Vec<Option<f64>> {
        let mut queue: VecDeque<(u64, f64)> = VecDeque::new();
        let (mut open, mut nothing) = (NEVER, NEVER);
        let mut reached = self.recording.seen;
        self.backward(|at| {
            let (first, last) = (at.saturating_add(from), self.graph.end(at, to));
            while reached > first {
                reached -= 1;
                match self.number(of, reached) {
                    None => open = reached,
                    Some(value) if value.is_nan() => nothing = reached,
                    Some(value) => {
                        while queue.front().is_some_and(|&(_, later)| {
                            operation.apply(value, later).to_bits() == value.to_bits()
                        }) {
                            queue.pop_front();
                        }
                        queue.push_front((reached, value));
                    }
                }
            }
            while queue.back().is_some_and(|&(k, _)| k > last) {
                queue.pop_back();
            }
            if last >= self.recording.seen || open <= last {
                None
            } else if nothing <= last {
                Some(f64::NAN)
            } else {
                queue.back().map(|&(_, value)| value)
            }
        })
    }

    /// Sums are added up state by state, as the monitors do it.
    fn sums(&self, from: u64, to: Option<u64>, of: usize, mean: bool) -> Vec<Option<f64>> {
        let (mut work, mut given_up) = (0u64, false);
        self.backward(|at| {
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
