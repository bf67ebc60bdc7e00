//! How far into a trace formulas look.

use crate::base::tick::Tick;
use crate::logic::{Node, NodeId, Term, TermId, Tree, Window};

/// How far a formula or metric looks from the state at which it is asked.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Reach {
    /// Ticks that must follow, whatever the horizon.
    pub(super) ticks: u64,
    /// Whether a part of it ranges up to the horizon.
    pub(super) unbounded: bool,
}

impl Reach {
    fn join(self, other: Self) -> Self {
        Self { ticks: self.ticks.max(other.ticks), unbounded: self.unbounded || other.unbounded }
    }

    /// What is asked at every state up to the horizon looks beyond it as soon as it looks ahead at all.
    fn at_every_state(self, from: u64, horizon: Tick) -> Self {
        let ticks = if self.ticks > 0 { horizon.0.saturating_add(self.ticks) } else { from };
        Self { ticks, unbounded: true }
    }

    fn over(self, window: &Window, horizon: Tick) -> Self {
        match window.to {
            Some(to) => Self { ticks: self.ticks.saturating_add(to.0), ..self },
            None => self.at_every_state(window.from.0, horizon),
        }
    }
}

/// The reach of every node of a tree, computed once from the leaves up.
pub(super) struct Reaches<'t> {
    tree: &'t Tree,
    horizon: Tick,
    nodes: Vec<Option<Reach>>,
    terms: Vec<Option<Reach>>,
}

impl<'t> Reaches<'t> {
    /// Nothing computed yet.
    pub(super) fn new(tree: &'t Tree, horizon: Tick) -> Self {
        Self { tree, horizon, nodes: vec![None; tree.nodes.len()], terms: vec![None; tree.terms.len()] }
    }

    /// The reach of a formula.
    pub(super) fn node(&mut self, id: NodeId) -> Reach {
        let at = id.0 as usize;
        if let Some(known) = self.nodes[at] {
            return known;
        }
        let reach = match &self.tree.nodes[at] {
            Node::Constant(_) | Node::Atom(_) => Reach::default(),
            Node::Compare(_, a, b) => self.term(*a).join(self.term(*b)),
            Node::Not(a) => self.node(*a),
            Node::And(list) | Node::Or(list) => {
                list.iter().fold(Reach::default(), |reach, id| reach.join(self.node(*id)))
            }
            Node::Finally(window, a) | Node::Globally(window, a) => self.node(*a).over(window, self.horizon),
            Node::Until(window, a, b) | Node::WeakUntil(window, a, b) | Node::Release(window, a, b) => {
                self.node(*a).join(self.node(*b)).over(window, self.horizon)
            }
        };
        self.nodes[at] = Some(reach);
        reach
    }

    /// The reach of a metric.
    pub(super) fn term(&mut self, id: TermId) -> Reach {
        let at = id.0 as usize;
        if let Some(known) = self.terms[at] {
            return known;
        }
        let reach = match &self.tree.terms[at] {
            Term::Constant(_) | Term::Signal(_) => Reach::default(),
            Term::Combine(_, a, b) => self.term(*a).join(self.term(*b)),
            Term::Abs(a) => self.term(*a),
            Term::Window(_, window, a) => self.term(*a).over(window, self.horizon),
            Term::Later(ticks, a) => {
                let inner = self.term(*a);
                Reach { ticks: inner.ticks.saturating_add(ticks.0), ..inner }
            }
            Term::AtEnd(a) => self.term(*a).at_every_state(0, self.horizon),
            Term::TimeUntil(node) => self.node(*node).at_every_state(0, self.horizon),
        };
        self.terms[at] = Some(reach);
        reach
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::logic::AtomId;

    fn within(ticks: u64) -> Window {
        Window { from: Tick(0), to: Some(Tick(ticks)) }
    }

    #[test]
    fn nested_bounds_add_up() {
        let mut tree = Tree::default();
        let atom = tree.node(Node::Atom(AtomId(0)));
        let inner = tree.node(Node::Finally(within(5), atom));
        let outer = tree.node(Node::Globally(within(10), inner));
        assert_eq!(Reaches::new(&tree, Tick(100)).node(outer), Reach { ticks: 15, unbounded: false });
    }

    #[test]
    fn a_bound_inside_an_unbounded_operator_looks_beyond_the_horizon() {
        let mut tree = Tree::default();
        let atom = tree.node(Node::Atom(AtomId(0)));
        let always = Window { from: Tick(0), to: None };
        let inner = tree.node(Node::Finally(within(5), atom));
        let bad = tree.node(Node::Globally(always, inner));
        let eventually = tree.node(Node::Finally(always, atom));
        let good = tree.node(Node::Globally(always, eventually));
        let mut reaches = Reaches::new(&tree, Tick(100));
        assert_eq!(reaches.node(bad).ticks, 105);
        assert_eq!(reaches.node(good), Reach { ticks: 0, unbounded: true });
    }
}
