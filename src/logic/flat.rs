//! Flat formulas: one window over what the present state alone decides.
//!
//! `F`, `G` and `U` at the top, over Boolean combinations of atoms and comparisons without windows of their own,
//! are all `not? (hold U[from, to] goal)`. Where the states are few, hold and goal are known for each state
//! beforehand, and a verdict is a look at two bits and the number of the state. It falls at the same state as
//! that of the general monitor (a test holds it).

use super::formula::{Node, NodeId, Term, TermId, Tree};
use super::monitor::Monitor;
use super::reach::{Part, children_first};
use crate::base::tick::{Clock, Tick};

/// A flat formula.
#[derive(Clone, Debug)]
pub struct Flat {
    /// Parts of what must be so up to the goal, children first; anything for `None`.
    hold: Option<Vec<Part>>,
    /// Parts of the goal, children first.
    goal: Vec<Part>,
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
        let monitor = |node| Monitor::formula(tree, node, horizon, clock).ok();
        if monitor(root)?.antecedents().next().is_some() {
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
        let parts = |node| {
            let parts = present_parts(tree, node)?;
            monitor(node).is_some_and(|m| m.constant().is_none()).then_some(parts)
        };
        let hold = match hold {
            Some(hold) => Some(parts(hold)?),
            None => None,
        };
        Some(Self {
            hold,
            goal: parts(goal)?,
            inverted,
            negated: negated ^ inverted,
            from: window.from.0,
            to: window.to.unwrap_or(horizon).0,
        })
    }

    /// What a state with these atoms and signals is for it. What is missing counts as false and as NaN.
    pub fn sort(&self, tree: &Tree, atoms: &[bool], signals: &[f64]) -> Sort {
        let (known, state) = (&mut Known::default(), (atoms, signals));
        Sort {
            hold: self.hold.as_ref().is_none_or(|parts| truth(tree, parts, state, known)),
            goal: truth(tree, &self.goal, state, known) ^ self.inverted,
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

/// The parts of a formula of the present state, children first; none where another state is asked about.
fn present_parts(tree: &Tree, node: NodeId) -> Option<Vec<Part>> {
    let parts = children_first(tree, Part::Node(node)).ok()?;
    let is_present = |part: &Part| match part {
        Part::Node(id) => matches!(
            tree.nodes[id.0 as usize],
            Node::Constant(_) | Node::Atom(_) | Node::Compare(..) | Node::Not(_) | Node::And(_) | Node::Or(_)
        ),
        Part::Term(id) => matches!(
            tree.terms[id.0 as usize],
            Term::Constant(_) | Term::Signal(_) | Term::Combine(..) | Term::Abs(_)
        ),
    };
    parts.iter().all(is_present).then_some(parts)
}

/// The truth of a formula of the present state, from its parts; each is looked at once, however often it is shared.
fn truth(tree: &Tree, parts: &[Part], (atoms, signals): (&[bool], &[f64]), known: &mut Known) -> bool {
    known.truths.resize(tree.nodes.len(), false);
    known.numbers.resize(tree.terms.len(), f64::NAN);
    let mut last = false;
    for part in parts {
        match part {
            Part::Node(id) => {
                let of = |id: &NodeId| known.truths[id.0 as usize];
                let number = |id: &TermId| known.numbers[id.0 as usize];
                last = match &tree.nodes[id.0 as usize] {
                    Node::Constant(constant) => *constant,
                    Node::Atom(atom) => atoms.get(atom.0 as usize).is_some_and(|atom| *atom),
                    Node::Compare(relation, a, b) => relation.holds(number(a), number(b)),
                    Node::Not(a) => !of(a),
                    Node::And(list) => list.iter().all(of),
                    Node::Or(list) => list.iter().any(of),
                    _ => false,
                };
                known.truths[id.0 as usize] = last;
            }
            Part::Term(id) => {
                let of = |id: &TermId| known.numbers[id.0 as usize];
                known.numbers[id.0 as usize] = match &tree.terms[id.0 as usize] {
                    Term::Constant(value) => *value,
                    Term::Signal(signal) => signals.get(signal.0 as usize).copied().unwrap_or(f64::NAN),
                    Term::Combine(operation, a, b) => operation.apply(of(a), of(b)),
                    Term::Abs(a) => of(a).abs(),
                    _ => f64::NAN,
                };
            }
        }
    }
    last
}

/// The known truth in one state, by the numbers of the parts.
#[derive(Default)]
struct Known {
    truths: Vec<bool>,
    numbers: Vec<f64>,
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
        let flat = Flat::of(&tree, always, Tick(9), Clock::Steps).unwrap();
        for atom in [false, true] {
            assert_eq!(flat.sort(&tree, &[atom], &[]), Sort { hold: true, goal: false });
        }
    }
}
