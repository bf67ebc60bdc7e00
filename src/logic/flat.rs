//! Flat formulas: one window over what the present state alone decides.
//!
//! `F`, `G` and `U` at the top, over Boolean combinations of atoms and comparisons without windows of their own,
//! are all `not? (hold U[from, to] goal)`. Where the states are few, hold and goal are known for each state
//! beforehand, and a verdict is a look at two bits and the number of the state. It falls at the same state as
//! that of the general monitor (a test holds it).

use super::formula::{Node, NodeId, Tree};
use super::monitor::Monitor;
use super::present::{Parts, Present};
use super::reach::{Part, children_first};
use crate::base::tick::{Clock, Tick};

/// A flat formula.
#[derive(Clone, Debug)]
pub struct Flat {
    present: Present,
    /// Where the code has what must be so up to the goal; anything for `None`.
    hold: Option<usize>,
    /// Where it has the goal.
    goal: usize,
    /// The goal counts negated: `G a` is not (true U not a).
    inverted: bool,
    negated: bool,
    /// First and last state at which the goal counts.
    from: u64,
    to: u64,
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
        let monitor = Monitor::formula(tree, root, horizon, clock).ok()?;
        if monitor.antecedents().next().is_some() {
            return None;
        }
        let (node, negated) = match &tree.nodes[root.0 as usize] {
            Node::Not(inner) => (&tree.nodes[inner.0 as usize], true),
            node => (node, false),
        };
        let (window, hold, goal, inverted) = match node {
            Node::Finally(window, goal) => (window, None, *goal, false),
            Node::Globally(window, goal) => (window, None, *goal, true),
            Node::Until(window, hold, goal) => (window, Some(*hold), *goal, false),
            _ => return None,
        };
        let mut parts = Parts::new(tree, false);
        for part in children_first(tree, Part::Node(root)).ok()? {
            parts.note(part);
        }
        let slot = |id: NodeId| parts.node_slots[id.0 as usize];
        let hold = match hold {
            Some(hold) => Some(slot(hold)?),
            None => None,
        };
        let goal = slot(goal)?;
        Some(Self {
            present: parts.present,
            hold,
            goal,
            inverted,
            negated: negated ^ inverted,
            from: window.from.0,
            to: window.to.unwrap_or(horizon).0,
        })
    }

    /// What a state with these atoms and signals is for it. What is missing counts as false and as NaN.
    pub fn sort(&mut self, atoms: &[bool], signals: &[f64]) -> Sort {
        self.present.read(atoms, signals);
        Sort {
            hold: self.hold.is_none_or(|hold| self.present.truth(hold)),
            goal: self.present.truth(self.goal) ^ self.inverted,
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::logic::formula::{AtomId, Window};

    #[test]
    fn shared_parts_do_not_cost_exponential_time() {
        let mut tree = Tree::default();
        let mut x = tree.node(Node::Atom(AtomId(0)));
        for _ in 0..200 {
            let not = tree.node(Node::Not(x));
            let (both, neither) = (tree.node(Node::And(vec![x, x])), tree.node(Node::And(vec![not, not])));
            x = tree.node(Node::Or(vec![both, neither]));
        }
        let always = tree.node(Node::Globally(Window { from: Tick(0), to: Some(Tick(9)) }, x));
        // x <=> x is always so, which nobody looks for: it is a goal like any other.
        let mut flat = Flat::of(&tree, always, Tick(9), Clock::Steps).unwrap();
        for atom in [false, true] {
            assert_eq!(flat.sort(&[atom], &[]), Sort { hold: true, goal: false });
        }
    }
}
