//! Why a trial satisfies or violates a formula: the atoms and comparisons, each with the states at which
//! it had a value, that together force the verdict whatever the rest of the trial is.

use super::formula::{Node, NodeId, Relation, TermId, Tree, Window};
use super::invalid::Invalid;
use super::offline::{Offline, Recording, States};
use super::reach::{Part, last_state};
use crate::base::tick::Tick;
use std::collections::{BTreeMap, BTreeSet};

/// An atom or comparison had this value at all states `from ..= to`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reason {
    /// The atom or comparison.
    pub leaf: NodeId,
    /// Its value there.
    pub value: bool,
    /// First state.
    pub from: Tick,
    /// Last state.
    pub to: Tick,
}

/// The verdict of a recorded trial, and what decided it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Explanation {
    /// The verdict, `None` if the states seen leave it open.
    pub verdict: Option<bool>,
    /// What decided it, by leaf and then by time; empty while it is open, and for a formula that does not
    /// depend on any state. Of several possible explanations the earliest states are taken.
    pub reasons: Vec<Reason>,
}

/// Explains the verdict on `root` at state 0 by the states of a recording; give it those up to the state
/// at which the monitor decided.
///
/// # Errors
/// When the formula cannot be monitored with the recording's horizon.
pub fn explain(tree: &Tree, root: NodeId, recording: &Recording) -> Result<Explanation, Invalid> {
    let (needed, _) = last_state(tree, Part::Node(root), Some(recording.horizon))?;
    if needed > recording.horizon {
        return Err(Invalid::BeyondHorizon { needed: needed.0, horizon: recording.horizon.0 });
    }
    let offline = Offline::new(tree, recording);
    let verdict = offline.truth(root, 0);
    let reasons = if verdict.is_some() { explain_at(&offline, root, 0) } else { Vec::new() };
    Ok(Explanation { verdict, reasons })
}

/// What forces the truth of a formula, which is known, at a state.
pub(super) fn explain_at(offline: &Offline<'_>, root: NodeId, at: u64) -> Vec<Reason> {
    let mut witness = Witness { offline, seen: BTreeSet::new(), leaves: BTreeMap::new() };
    witness.formula(root, at);
    let mut reasons: Vec<Reason> = Vec::new();
    for ((leaf, at), value) in witness.leaves {
        match reasons.last_mut() {
            Some(last) if last.leaf.0 == leaf && last.value == value && last.to.0 + 1 == at => {
                last.to = Tick(at);
            }
            _ => reasons.push(Reason { leaf: NodeId(leaf), value, from: Tick(at), to: Tick(at) }),
        }
    }
    reasons
}

struct Witness<'a> {
    offline: &'a Offline<'a>,
    seen: BTreeSet<(u32, u64)>,
    leaves: BTreeMap<(u32, u64), bool>,
}

impl Witness<'_> {
    /// Adds what forces the truth of a formula, which is known.
    fn formula(&mut self, id: NodeId, at: u64) {
        if !self.seen.insert((id.0, at)) {
            return;
        }
        let Some(value) = self.offline.truth(id, at) else { return };
        match &self.offline.tree.nodes[id.0 as usize] {
            Node::Constant(_) => {}
            Node::Atom(_) => {
                self.leaves.insert((id.0, at), value);
            }
            Node::Compare(relation, x, y) => self.comparison(id, (*relation, *x, *y), at, value),
            Node::Not(x) => self.formula(*x, at),
            Node::Or(parts) => self.parts(parts.iter().map(|x| (*x, at)), value, value),
            Node::And(parts) => self.parts(parts.iter().map(|x| (*x, at)), value, !value),
            Node::Finally(w, x) => {
                self.parts(self.offline.states(*w, at).map(|k| (*x, k)), value, value);
            }
            Node::Globally(w, x) => {
                self.parts(self.offline.states(*w, at).map(|k| (*x, k)), value, !value);
            }
            Node::Until(w, p, q) => self.until(*w, (*p, true), (*q, true), at, value),
            Node::Release(w, p, q) => self.until(*w, (*p, false), (*q, false), at, !value),
            Node::WeakUntil(w, p, q) => {
                let mut states = at..=*self.offline.states(*w, at).end();
                if value && states.all(|k| self.offline.truth(*p, k) == Some(true)) {
                    self.parts((at..=*states.end()).map(|k| (*p, k)), true, false);
                } else {
                    self.until(*w, (*p, true), (*q, true), at, value);
                }
            }
        }
    }

    /// One part of that value is enough (the first), or all are needed.
    fn parts(&mut self, parts: impl Iterator<Item = (NodeId, u64)>, value: bool, one: bool) {
        for (part, at) in parts {
            if !one || self.offline.truth(part, at) == Some(value) {
                self.formula(part, at);
                if one {
                    return;
                }
            }
        }
    }

    fn until(&mut self, w: Window, first: (NodeId, bool), second: (NodeId, bool), at: u64, value: bool) {
        let states = self.offline.states(w, at);
        let (from, end) = (*states.start(), *states.end());
        let is = |(id, asked): (NodeId, bool), k, value| self.offline.truth(id, k) == Some(asked == value);
        if value {
            // The second at some state, the first at all before it.
            let Some(reached) = (from..=end).find(|&k| is(second, k, true)) else { return };
            self.formula(second.0, reached);
            for k in at..reached {
                self.formula(first.0, k);
            }
        } else {
            // The first fails, and the second at every state of the window until then.
            let failed = (at..=end).find(|&k| is(first, k, false));
            if let Some(failed) = failed {
                self.formula(first.0, failed);
            }
            for k in from..=failed.unwrap_or(end) {
                self.formula(second.0, k);
            }
        }
    }

    fn comparison(&mut self, id: NodeId, (relation, x, y): (Relation, TermId, TermId), at: u64, value: bool) {
        match (self.offline.constant(x), self.offline.constant(y)) {
            (Some(_), Some(_)) => {}
            (None, Some(c)) => self.against(id, relation, (x, c), at, value),
            (Some(c), None) => self.against(id, relation.flipped(), (y, c), at, value),
            (None, None) => {
                self.leaves.insert((id.0, at), value);
            }
        }
    }

    /// A comparison of an extreme of a window or of a time is explained by the states that decided it.
    fn against(&mut self, id: NodeId, relation: Relation, (x, c): (TermId, f64), at: u64, value: bool) {
        let offline = self.offline;
        let (states, x, one) = match offline.looks_at(relation, x, c, at) {
            States::Any(states, x) => (states, x, value),
            States::All(states, x) => (states, x, !value),
            States::Within(states, goal, positive) => {
                let reached = value == positive;
                self.parts(states.map(|k| (goal, k)), reached, reached);
                return;
            }
            States::Number => {
                self.leaves.insert((id.0, at), value);
                return;
            }
        };
        for k in states {
            if !one || offline.against(relation, x, c, k) == Some(value) {
                self.against(id, relation, (x, c), k, value);
                if one {
                    return;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::tick::Clock;
    use crate::logic::formula::{Aggregation, AtomId, SignalId, Term};

    fn window(from: u64, to: u64) -> Window {
        Window { from: Tick(from), to: Some(Tick(to)) }
    }

    fn recording<'a>(
        atoms: &'a dyn Fn(AtomId, u64) -> bool,
        signals: &'a dyn Fn(SignalId, u64) -> f64,
        seen: u64,
    ) -> Recording<'a> {
        Recording { atoms, signals, seen, horizon: Tick(20), clock: Clock::Steps }
    }

    #[test]
    fn a_violated_globally_names_the_first_state_without() {
        let mut tree = Tree::default();
        let p = tree.node(Node::Atom(AtomId(0)));
        let root = tree.node(Node::Globally(window(0, 10), p));
        let (atoms, signals) = (|_, k| k < 4, |_, _| 0.0);
        let found = explain(&tree, root, &recording(&atoms, &signals, 5)).unwrap();
        let reason = Reason { leaf: p, value: false, from: Tick(4), to: Tick(4) };
        assert_eq!(found, Explanation { verdict: Some(false), reasons: vec![reason] });
        let open = explain(&tree, root, &recording(&atoms, &signals, 4)).unwrap();
        assert_eq!(open, Explanation { verdict: None, reasons: vec![] });
    }

    #[test]
    fn an_until_names_both_operands() {
        let mut tree = Tree::default();
        let p = tree.node(Node::Atom(AtomId(0)));
        let q = tree.node(Node::Atom(AtomId(1)));
        let root = tree.node(Node::Until(window(0, 10), p, q));
        let signals = |_, _| 0.0;
        let reached = |atom: AtomId, k| if atom.0 == 0 { true } else { k == 3 };
        let found = explain(&tree, root, &recording(&reached, &signals, 4)).unwrap();
        assert_eq!(
            found.reasons,
            [
                Reason { leaf: p, value: true, from: Tick(0), to: Tick(2) },
                Reason { leaf: q, value: true, from: Tick(3), to: Tick(3) }
            ]
        );
        let broken = |atom: AtomId, k| atom.0 == 0 && k != 2;
        let found = explain(&tree, root, &recording(&broken, &signals, 3)).unwrap();
        assert_eq!(
            found.reasons,
            [
                Reason { leaf: p, value: false, from: Tick(2), to: Tick(2) },
                Reason { leaf: q, value: false, from: Tick(0), to: Tick(2) }
            ]
        );
    }

    #[test]
    fn a_comparison_of_a_smallest_number_names_the_state() {
        let mut tree = Tree::default();
        let gap = tree.term(Term::Signal(SignalId(0)));
        let least = tree.term(Term::Window(Aggregation::Min, window(0, 10), gap));
        let limit = tree.term(Term::Constant(0.5));
        let root = tree.node(Node::Compare(Relation::Greater, least, limit));
        let atoms = |_, _| false;
        let signals = |_, k| 1.0 - 0.1 * k as f64;
        let found = explain(&tree, root, &recording(&atoms, &signals, 7)).unwrap();
        let reason = Reason { leaf: root, value: false, from: Tick(5), to: Tick(5) };
        assert_eq!(found, Explanation { verdict: Some(false), reasons: vec![reason] });
    }
}
