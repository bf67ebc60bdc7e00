//! Where a number of a recorded trial comes from: the value, and the states whose signals or formulas gave it.
//!
//! A smallest or largest number of a window comes from the first state that has it, a time until a formula
//! from the state at which it holds, an arithmetic result from both sides. Sums and means come from all
//! states of their window, so from none in particular.

use super::explain::{Reason, explain_at};
use super::formula::{Aggregation, Node, NodeId, Operation, SignalId, Term, TermId, Tree};
use super::offline::{Offline, Recording};
use super::reach::Part;
use crate::base::tick::Tick;
use std::collections::BTreeSet;

/// A state that gave a number its value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Source {
    /// A signal had the value there.
    Signal {
        /// Which.
        signal: SignalId,
        /// The state.
        at: Tick,
        /// Its value.
        value: f64,
    },
    /// An atom or comparison closed the formula that a time was counted to.
    Formula(Reason),
}

/// The value of a number at a state, `None` where the states seen leave it open, and where it comes from.
pub fn sources(tree: &Tree, root: TermId, at: Tick, recording: &Recording) -> (Option<f64>, Vec<Source>) {
    let Ok(offline) = Offline::new(tree, Part::Term(root), at.0, recording) else {
        return (None, Vec::new());
    };
    let value = offline.number(root, at.0);
    let mut walk = Walk { offline: &offline, met: BTreeSet::new(), found: Vec::new() };
    if value.is_some() {
        walk.term(root, at.0);
    }
    (value, walk.found)
}

/// Where both sides of a comparison come from that was a reason at a state. A comparison of an extreme with
/// a constant is decided at single states of the window, so there it is the number of that state.
pub fn sides(tree: &Tree, leaf: NodeId, at: Tick, recording: &Recording) -> Vec<Source> {
    let Some(Node::Compare(_, x, y)) = tree.nodes.get(leaf.0 as usize) else { return Vec::new() };
    let mut found = Vec::new();
    for (side, other) in [(*x, *y), (*y, *x)] {
        let constant = Offline::new(tree, Part::Term(other), at.0, recording)
            .is_ok_and(|offline| offline.constant(other).is_some());
        found.extend(sources(tree, if constant { within(tree, side) } else { side }, at, recording).1);
    }
    found
}

/// The number inside extremes and later states.
fn within(tree: &Tree, mut id: TermId) -> TermId {
    while let Term::Later(_, x)
    | Term::Window(Aggregation::Min | Aggregation::Max | Aggregation::First, _, x) =
        &tree.terms[id.0 as usize]
    {
        id = *x;
    }
    id
}

/// From a number down to the signals and formulas that gave it its value.
struct Walk<'a> {
    offline: &'a Offline<'a>,
    /// Numbers that were met, by the state.
    met: BTreeSet<(u32, u64)>,
    found: Vec<Source>,
}

impl Walk<'_> {
    fn term(&mut self, id: TermId, at: u64) {
        if !self.met.insert((id.0, at)) {
            return;
        }
        let offline = self.offline;
        match &offline.tree.terms[id.0 as usize] {
            Term::Constant(_) | Term::Window(Aggregation::Sum | Aggregation::Mean, ..) => {}
            Term::Signal(signal) => {
                if let Some(value) = offline.number(id, at) {
                    self.found.push(Source::Signal { signal: *signal, at: Tick(at), value });
                }
            }
            Term::Combine(operation @ (Operation::Min | Operation::Max), x, y) => {
                if let (Some(a), Some(b)) = (offline.number(*x, at), offline.number(*y, at)) {
                    let first = operation.apply(a, b).to_bits() == a.to_bits();
                    self.term(if first { *x } else { *y }, at);
                }
            }
            Term::Combine(_, x, y) => {
                self.term(*x, at);
                self.term(*y, at);
            }
            Term::Abs(x) => self.term(*x, at),
            Term::Window(Aggregation::Min | Aggregation::Max | Aggregation::First, window, x) => {
                let extreme = offline.number(id, at);
                let mut states = at + window.from.0..=offline.end(at, window.to.map(|to| to.0));
                if let Some(state) = states.find(|k| offline.number(*x, *k) == extreme) {
                    self.term(*x, state);
                }
            }
            Term::Later(by, x) => self.term(*x, at + by.0),
            Term::AtEnd(x) => self.term(*x, offline.recording.horizon.0),
            Term::TimeUntil(goal) => {
                let horizon = offline.recording.horizon.0;
                let reached = (at..=horizon).find(|k| offline.truth(*goal, *k) == Some(true));
                // Of what forces the goal there, what comes last closes the case.
                let reasons = reached.map(|k| explain_at(offline, *goal, k)).unwrap_or_default();
                let last = reasons.into_iter().max_by_key(|reason| (reason.to, reason.from));
                self.found.extend(last.map(Source::Formula));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::tick::Clock;
    use crate::logic::formula::{AtomId, Window};

    fn window(from: u64, to: u64) -> Window {
        Window { from: Tick(from), to: Some(Tick(to)) }
    }

    #[test]
    fn a_smallest_number_comes_from_its_first_state() {
        let mut tree = Tree::default();
        let gap = tree.term(Term::Signal(SignalId(0)));
        let least = tree.term(Term::Window(Aggregation::Min, window(0, 6), gap));
        let (atoms, signals) =
            (|_: AtomId, _| false, |_, k: u64| [5.0, 3.0, 4.0, 3.0, 9.0, 9.0, 9.0][k as usize]);
        let recording = Recording {
            atoms: &atoms,
            signals: &signals,
            seen: 7,
            horizon: Tick(6),
            clock: Clock::Steps,
            stop: &|| false,
        };
        let source = Source::Signal { signal: SignalId(0), at: Tick(1), value: 3.0 };
        assert_eq!(sources(&tree, least, Tick(0), &recording), (Some(3.0), vec![source]));
        let early = Recording { seen: 6, ..recording };
        assert_eq!(sources(&tree, least, Tick(0), &early), (None, vec![]));
    }

    #[test]
    fn a_time_comes_from_what_closed_its_formula() {
        let mut tree = Tree::default();
        let goal = tree.node(Node::Atom(AtomId(0)));
        let time = tree.term(Term::TimeUntil(goal));
        let (atoms, signals) = (|_: AtomId, k| k >= 3, |_, _| 0.0);
        let recording = Recording {
            atoms: &atoms,
            signals: &signals,
            seen: 4,
            horizon: Tick(9),
            clock: Clock::Steps,
            stop: &|| false,
        };
        let reason = Reason { leaf: goal, value: true, from: Tick(3), to: Tick(3) };
        assert_eq!(sources(&tree, time, Tick(0), &recording), (Some(3.0), vec![Source::Formula(reason)]));
    }
}
