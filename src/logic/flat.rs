//! Flat formulas: one window over what the present state alone decides.
//!
//! `F`, `G` and `U` at the top, over Boolean combinations of atoms and comparisons without windows of their own,
//! are all `not? (hold U[from, to] goal)`. Where the states are few, hold and goal are known for each state
//! beforehand, and a verdict is a look at two bits and the number of the state. It falls at the same state as
//! that of the general monitor (a test holds it).

use super::formula::{Node, NodeId, Term, TermId, Tree, Window};
use super::monitor::Monitor;
use crate::base::tick::{Clock, Tick};

/// A flat formula.
#[derive(Clone, Debug)]
pub struct Flat {
    /// What must be so up to the goal; anything for `None`.
    hold: Option<NodeId>,
    goal: NodeId,
    /// The goal counts negated: `G a` is not (true U not a).
    inverted: bool,
    negated: bool,
    /// First and last state at which the goal counts.
    from: u64,
    to: u64,
}

/// Atoms and signals of one state.
pub trait Present {
    /// Truth of an atom.
    fn atom(&self, atom: usize) -> bool;
    /// Value of a signal.
    fn signal(&self, signal: usize) -> f64;
}

/// What a state is for a flat formula.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sort {
    /// What must be so up to the goal is so.
    pub hold: bool,
    /// The goal is reached.
    pub goal: bool,
}

impl Flat {
    /// The flat form of a formula, if it has one in which neither goal nor hold folds to a constant and no
    /// implication is watched.
    pub fn of(tree: &Tree, root: NodeId, horizon: Tick, clock: Clock) -> Option<Self> {
        let monitor = |node| Monitor::formula(tree, node, horizon, clock).ok();
        if monitor(root)?.antecedents().next().is_some() {
            return None;
        }
        let (node, negated) = match &tree.nodes[root.0 as usize] {
            Node::Not(inner) => (&tree.nodes[inner.0 as usize], true),
            node => (node, false),
        };
        let flat = |window: &Window, hold, goal, inverted| Self {
            hold,
            goal,
            inverted,
            negated: negated ^ inverted,
            from: window.from.0,
            to: window.to.unwrap_or(horizon).0,
        };
        let flat = match node {
            Node::Finally(window, goal) => flat(window, None, *goal, false),
            Node::Globally(window, goal) => flat(window, None, *goal, true),
            Node::Until(window, hold, goal) => flat(window, Some(*hold), *goal, false),
            _ => return None,
        };
        let parts = flat.hold.into_iter().chain([flat.goal]);
        let varies = |node| is_present(tree, node) && monitor(node).is_some_and(|m| m.constant().is_none());
        parts.into_iter().all(varies).then_some(flat)
    }

    /// What a state is for it.
    pub fn sort(&self, tree: &Tree, state: &impl Present) -> Sort {
        Sort {
            hold: self.hold.is_none_or(|node| truth(tree, node, state)),
            goal: truth(tree, self.goal, state) ^ self.inverted,
        }
    }

    /// Whether to reach the goal makes it false.
    pub fn is_negated(&self) -> bool {
        self.negated
    }

    /// Whether the goal counts at the state with this number.
    pub fn has_begun(&self, at: u64) -> bool {
        at >= self.from
    }

    /// Whether nothing counts after the state with this number.
    pub fn is_over(&self, at: u64) -> bool {
        at >= self.to
    }

    /// Where the verdict falls if from the state with this number on all are of this sort.
    pub fn settled(&self, sort: Sort, at: u64) -> u64 {
        match sort {
            Sort { hold: false, .. } => at,
            Sort { goal: true, .. } => at.max(self.from).min(self.to),
            Sort { .. } => at.max(self.to),
        }
    }

    /// The verdict at the state with this number, if it falls there and did not fall before.
    #[inline(always)]
    pub fn verdict(&self, sort: Sort, at: u64) -> Option<bool> {
        let reached = sort.goal && at >= self.from;
        (reached || !sort.hold || at >= self.to).then_some(reached ^ self.negated)
    }
}

/// Whether the present state alone decides a formula.
fn is_present(tree: &Tree, node: NodeId) -> bool {
    match &tree.nodes[node.0 as usize] {
        Node::Constant(_) | Node::Atom(_) => true,
        Node::Compare(_, a, b) => [a, b].iter().all(|term| is_present_term(tree, **term)),
        Node::Not(a) => is_present(tree, *a),
        Node::And(list) | Node::Or(list) => list.iter().all(|&part| is_present(tree, part)),
        _ => false,
    }
}

fn is_present_term(tree: &Tree, term: TermId) -> bool {
    match &tree.terms[term.0 as usize] {
        Term::Constant(_) | Term::Signal(_) => true,
        Term::Combine(_, a, b) => is_present_term(tree, *a) && is_present_term(tree, *b),
        Term::Abs(a) => is_present_term(tree, *a),
        _ => false,
    }
}

/// The truth of a formula of the present state; false for others.
fn truth(tree: &Tree, node: NodeId, state: &impl Present) -> bool {
    match &tree.nodes[node.0 as usize] {
        Node::Constant(constant) => *constant,
        Node::Atom(atom) => state.atom(atom.0 as usize),
        Node::Compare(relation, a, b) => relation.holds(number(tree, *a, state), number(tree, *b, state)),
        Node::Not(a) => !truth(tree, *a, state),
        Node::And(list) => list.iter().all(|&part| truth(tree, part, state)),
        Node::Or(list) => list.iter().any(|&part| truth(tree, part, state)),
        _ => false,
    }
}

/// The value of a number of the present state; none for others.
fn number(tree: &Tree, term: TermId, state: &impl Present) -> f64 {
    match &tree.terms[term.0 as usize] {
        Term::Constant(value) => *value,
        Term::Signal(signal) => state.signal(signal.0 as usize),
        Term::Combine(operation, a, b) => operation.apply(number(tree, *a, state), number(tree, *b, state)),
        Term::Abs(a) => number(tree, *a, state).abs(),
        _ => f64::NAN,
    }
}
