//! When the atoms of a formula held in a trial.

use crate::engine::trials::prepared::PreparedWorld;
use crate::logic::Root;
use crate::logic::{Node, NodeId, Relation, SignalId, Term, TermId, Tree};
use std::collections::BTreeSet;

/// An atom and when it held.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize)]
pub struct Bar {
    /// As it was written.
    pub text: String,
    /// Times at which its truth changed, beginning with that at which it became true; s, or steps where steps have no
    /// length. False before the first one.
    pub changes: Vec<f64>,
}

impl Bar {
    /// What it is from a time on.
    fn see(&mut self, time: f64, holds: bool) {
        if holds == self.changes.len().is_multiple_of(2) {
            self.changes.push(time);
        }
    }
}

/// Where the truth of a bar is read.
#[derive(Clone, Copy, Debug)]
enum Place {
    /// A truth value of the state.
    Atom(usize),
    /// A comparison of numbers of the state.
    Compare(Relation, TermId, TermId),
}

/// The bars of one column.
#[derive(Debug)]
pub(super) struct Bars<'p> {
    tree: &'p Tree,
    places: Vec<Place>,
    pub(super) list: Vec<Bar>,
}

impl<'p> Bars<'p> {
    /// Those of the atoms that were written, in the order of their numbers, and then of comparisons.
    pub(super) fn of(prepared: &'p PreparedWorld, column: usize) -> Self {
        let texts = &prepared.texts;
        let mut bars = Self { tree: &prepared.tree, places: Vec::new(), list: Vec::new() };
        for atom in prepared.atoms_of(column) {
            let text = texts.atoms.get(atom).filter(|_| !texts.implied.contains(&(atom as u32)));
            bars.add(text, Place::Atom(atom));
        }
        let root = match prepared.columns[column] {
            Root::Formula(node) | Root::Robustness(node, _) => Some(node),
            Root::Metric(_) => None,
        };
        for node in root.map(|root| reached(&prepared.tree, root)).unwrap_or_default() {
            if let Node::Compare(relation, x, y) = prepared.tree.nodes[node.0 as usize]
                && [x, y].iter().all(|side| number(&prepared.tree, *side, &|_| 0.0).is_some())
            {
                let text = texts.comparisons.get(&node.0).map(|(text, _)| text);
                bars.add(text, Place::Compare(relation, x, y));
            }
        }
        bars
    }

    fn add(&mut self, text: Option<&String>, place: Place) {
        if let Some(text) = text.filter(|text| !text.is_empty()) {
            self.places.push(place);
            self.list.push(Bar { text: text.clone(), changes: Vec::new() });
        }
    }

    /// What holds from a time on.
    pub(super) fn see(&mut self, time: f64, atom: impl Fn(usize) -> bool, signal: impl Fn(usize) -> f64) {
        for (place, bar) in self.places.iter().zip(&mut self.list) {
            let holds = match place {
                Place::Atom(atom_number) => atom(*atom_number),
                Place::Compare(relation, x, y) => {
                    let value = |side| number(self.tree, side, &|id: SignalId| signal(id.0 as usize));
                    value(*x).zip(value(*y)).is_some_and(|(x, y)| relation.holds(x, y))
                }
            };
            bar.see(time, holds);
        }
    }
}

/// A number of one state; `None` where it is one of several states.
fn number(tree: &Tree, term: TermId, signal: &impl Fn(SignalId) -> f64) -> Option<f64> {
    let of = |term: TermId| number(tree, term, signal);
    match tree.terms.get(term.0 as usize)? {
        Term::Constant(value) => Some(*value),
        Term::Signal(id) => Some(signal(*id)),
        Term::Combine(operation, x, y) => Some(operation.apply(of(*x)?, of(*y)?)),
        Term::Abs(x) => Some(of(*x)?.abs()),
        Term::Window(..) | Term::Later(..) | Term::AtEnd(_) | Term::TimeUntil(_) => None,
    }
}

/// The nodes of a formula, by their numbers.
fn reached(tree: &Tree, root: NodeId) -> Vec<NodeId> {
    let (mut met, mut open) = (BTreeSet::new(), vec![root]);
    while let Some(node) = open.pop() {
        if !met.insert(node.0) {
            continue;
        }
        match tree.nodes.get(node.0 as usize) {
            Some(Node::Not(a) | Node::Finally(_, a) | Node::Globally(_, a)) => open.push(*a),
            Some(Node::And(list) | Node::Or(list)) => open.extend(list),
            Some(Node::Until(_, a, b) | Node::WeakUntil(_, a, b) | Node::Release(_, a, b)) => {
                open.extend([*a, *b]);
            }
            Some(Node::Constant(_) | Node::Atom(_) | Node::Compare(..)) | None => {}
        }
    }
    met.into_iter().map(NodeId).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bar_keeps_the_changes_alone() {
        let mut bar = Bar::default();
        for (time, holds) in [(0.0, false), (0.1, true), (0.2, true), (0.3, false), (0.4, true)] {
            bar.see(time, holds);
        }
        assert_eq!(bar.changes, [0.1, 0.3, 0.4]);
    }
}
