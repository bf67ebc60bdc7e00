//! A formula over the first states of one recorded trial, evaluated from its definition.
//!
//! For replayed trials and explanations, where clarity matters more than speed: what is not known is open,
//! connectives are Kleene's, bounded operators are unfolded. The monitors do the same for eight running
//! trials at once.

use super::formula::{
    Aggregation, AtomId, Node, NodeId, Operation, Relation, SignalId, Term, TermId, Tree, Window,
};
use crate::base::tick::{Clock, Tick};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::ops::RangeInclusive;

/// A recorded trial. States are counted from 0.
pub struct Recording<'a> {
    /// Truth of an atom in a state.
    pub atoms: &'a dyn Fn(AtomId, u64) -> bool,
    /// A signal in a state.
    pub signals: &'a dyn Fn(SignalId, u64) -> f64,
    /// Number of states to look at.
    pub seen: u64,
    /// The last state that a trial has.
    pub horizon: Tick,
    /// The clock of the states.
    pub clock: Clock,
}

/// A tree over a recording. The tree must be one that a monitor accepts.
pub(super) struct Offline<'a> {
    pub(super) tree: &'a Tree,
    pub(super) recording: &'a Recording<'a>,
    truths: RefCell<BTreeMap<(u32, u64), Option<bool>>>,
    numbers: RefCell<BTreeMap<(u32, u64), Option<f64>>>,
}

/// How a comparison with a constant looks at the states of a window or of a time.
pub(super) enum States {
    /// It is true if it is at one of them.
    Any(RangeInclusive<u64>, TermId),
    /// It is true if it is at all of them.
    All(RangeInclusive<u64>, TermId),
    /// The formula holds (or, negated, does not) at one of them.
    Within(RangeInclusive<u64>, NodeId, bool),
    /// It looks at the present state's number.
    Number,
}

fn kleene_any(values: impl Iterator<Item = Option<bool>>) -> Option<bool> {
    let mut open = false;
    for value in values {
        match value {
            Some(true) => return Some(true),
            None => open = true,
            Some(false) => {}
        }
    }
    (!open).then_some(false)
}

fn not(value: Option<bool>) -> Option<bool> {
    value.map(|value| !value)
}

impl<'a> Offline<'a> {
    pub(super) fn new(tree: &'a Tree, recording: &'a Recording<'a>) -> Self {
        Self { tree, recording, truths: RefCell::default(), numbers: RefCell::default() }
    }

    /// The states of a window after `at`.
    pub(super) fn states(&self, window: Window, at: u64) -> RangeInclusive<u64> {
        at + window.from.0..=window.to.map_or(self.recording.horizon.0, |to| at + to.0)
    }

    /// A formula at a state, `None` while it is open.
    pub(super) fn truth(&self, id: NodeId, at: u64) -> Option<bool> {
        if let Some(&known) = self.truths.borrow().get(&(id.0, at)) {
            return known;
        }
        let found = match &self.tree.nodes[id.0 as usize] {
            Node::Constant(value) => Some(*value),
            Node::Atom(atom) => (at < self.recording.seen).then(|| (self.recording.atoms)(*atom, at)),
            Node::Compare(relation, x, y) => self.compare(*relation, *x, *y, at),
            Node::Not(x) => not(self.truth(*x, at)),
            Node::Or(parts) => kleene_any(parts.iter().map(|x| self.truth(*x, at))),
            Node::And(parts) => not(kleene_any(parts.iter().map(|x| not(self.truth(*x, at))))),
            Node::Finally(w, x) => kleene_any(self.states(*w, at).map(|k| self.truth(*x, k))),
            Node::Globally(w, x) => not(kleene_any(self.states(*w, at).map(|k| not(self.truth(*x, k))))),
            Node::Until(w, p, q) => self.until(*w, (*p, true), (*q, true), at, Some(false)),
            Node::Release(w, p, q) => not(self.until(*w, (*p, false), (*q, false), at, Some(false))),
            Node::WeakUntil(w, p, q) => {
                let last = self.truth(*p, *self.states(*w, at).end());
                self.until(*w, (*p, true), (*q, true), at, last)
            }
        };
        self.truths.borrow_mut().insert((id.0, at), found);
        found
    }

    /// Whether an operand has the value that it is asked for.
    fn is(&self, (id, value): (NodeId, bool), at: u64) -> Option<bool> {
        self.truth(id, at).map(|found| found == value)
    }

    /// By the recurrence from the last state backwards: the second, or the first and what comes next;
    /// after the last state, `end`.
    fn until(
        &self,
        window: Window,
        first: (NodeId, bool),
        second: (NodeId, bool),
        at: u64,
        end: Option<bool>,
    ) -> Option<bool> {
        let states = self.states(window, at);
        let mut next = end;
        for k in (at..=*states.end()).rev() {
            let goes_on = if k == *states.end() {
                next
            } else {
                not(kleene_any([not(self.is(first, k)), not(next)].into_iter()))
            };
            let reached = if k >= *states.start() { self.is(second, k) } else { Some(false) };
            next = kleene_any([reached, goes_on].into_iter());
        }
        next
    }

    /// A number that does not depend on any state.
    pub(super) fn constant(&self, id: TermId) -> Option<f64> {
        match &self.tree.terms[id.0 as usize] {
            Term::Constant(value) => Some(*value),
            Term::Combine(operation, x, y) => Some(operation.apply(self.constant(*x)?, self.constant(*y)?)),
            Term::Abs(x) => self.constant(*x).map(f64::abs),
            Term::Later(_, x) | Term::AtEnd(x) => self.constant(*x),
            Term::Signal(_) | Term::Window(..) | Term::TimeUntil(_) => None,
        }
    }

    fn compare(&self, relation: Relation, x: TermId, y: TermId, at: u64) -> Option<bool> {
        match (self.constant(x), self.constant(y)) {
            (None, Some(c)) => self.against(relation, x, c, at),
            (Some(c), None) => self.against(relation.flipped(), y, c, at),
            _ => Some(relation.holds(self.number(x, at)?, self.number(y, at)?)),
        }
    }

    /// Which states a comparison with a constant looks at.
    pub(super) fn looks_at(&self, relation: Relation, x: TermId, c: f64, at: u64) -> States {
        use Aggregation::{Max, Min};
        use Relation::{AtLeast, AtMost, Greater, Less};
        match (&self.tree.terms[x.0 as usize], relation) {
            (Term::Later(by, x), _) => States::Any(at + by.0..=at + by.0, *x),
            (Term::Window(Min, w, x), Less | AtMost) | (Term::Window(Max, w, x), Greater | AtLeast) => {
                States::Any(self.states(*w, at), *x)
            }
            (Term::Window(Min, w, x), Greater | AtLeast) | (Term::Window(Max, w, x), Less | AtMost) => {
                States::All(self.states(*w, at), *x)
            }
            (Term::TimeUntil(goal), Less | AtMost | Greater | AtLeast) if c.is_finite() => {
                let positive = matches!(relation, Less | AtMost);
                let within = match relation {
                    Greater => AtMost,
                    AtLeast => Less,
                    same => same,
                };
                let horizon = self.recording.horizon.0;
                let seconds = |k: u64| self.recording.clock.seconds(Tick(k - at));
                let count = (at..=horizon).take_while(|&k| within.holds(seconds(k), c)).count() as u64;
                // An empty range where not even the present state is in time.
                let states = if count == 0 { at + 1..=at } else { at..=at + count - 1 };
                States::Within(states, *goal, positive)
            }
            _ => States::Number,
        }
    }

    /// A comparison with a constant.
    pub(super) fn against(&self, relation: Relation, x: TermId, c: f64, at: u64) -> Option<bool> {
        if let Some(x) = self.constant(x) {
            return Some(relation.holds(x, c));
        }
        match self.looks_at(relation, x, c, at) {
            States::Any(mut states, x) => {
                kleene_any(states.by_ref().map(|k| self.against(relation, x, c, k)))
            }
            States::All(states, x) => not(kleene_any(states.map(|k| not(self.against(relation, x, c, k))))),
            States::Within(states, goal, positive) => {
                let within = kleene_any(states.map(|k| self.truth(goal, k)));
                if positive { within } else { not(within) }
            }
            States::Number => Some(relation.holds(self.number(x, at)?, c)),
        }
    }

    /// A number at a state, `None` while it is open.
    pub(super) fn number(&self, id: TermId, at: u64) -> Option<f64> {
        if let Some(value) = self.constant(id) {
            return Some(value);
        }
        if let Some(&known) = self.numbers.borrow().get(&(id.0, at)) {
            return known;
        }
        let found = match &self.tree.terms[id.0 as usize] {
            Term::Constant(value) => Some(*value),
            Term::Signal(signal) => (at < self.recording.seen).then(|| (self.recording.signals)(*signal, at)),
            Term::Combine(operation, x, y) => {
                self.number(*x, at).zip(self.number(*y, at)).map(|(x, y)| operation.apply(x, y))
            }
            Term::Abs(x) => self.number(*x, at).map(f64::abs),
            Term::Window(aggregation, w, x) => self.aggregate(*aggregation, self.states(*w, at), *x),
            Term::Later(by, x) => self.number(*x, at + by.0),
            Term::AtEnd(x) => self.number(*x, self.recording.horizon.0),
            Term::TimeUntil(goal) => {
                let mut time = Some(f64::INFINITY);
                for k in at..=self.recording.horizon.0 {
                    match self.truth(*goal, k) {
                        Some(false) => continue,
                        Some(true) => time = Some(self.recording.clock.seconds(Tick(k - at))),
                        None => time = None,
                    }
                    break;
                }
                time
            }
        };
        self.numbers.borrow_mut().insert((id.0, at), found);
        found
    }

    fn aggregate(&self, aggregation: Aggregation, states: RangeInclusive<u64>, x: TermId) -> Option<f64> {
        if *states.end() >= self.recording.seen {
            return None;
        }
        let count = states.end() - states.start() + 1;
        let mut result: Option<f64> = None;
        for k in states {
            let next = self.number(x, k)?;
            result = Some(result.map_or(next, |so_far| match aggregation {
                Aggregation::Min => Operation::Min.apply(so_far, next),
                Aggregation::Max => Operation::Max.apply(so_far, next),
                Aggregation::Sum | Aggregation::Mean => so_far + next,
            }));
        }
        if aggregation == Aggregation::Mean { result.map(|sum| sum / count as f64) } else { result }
    }
}
