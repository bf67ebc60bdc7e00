//! From which state to which a formula or metric can look at each of its atoms and signals.
//!
//! Bounds add up on the way down to a leaf. A value that is missing in a state outside of that range is missed by
//! nobody.

use super::formula::{Node, NodeId, Term, TermId, Tree};
use super::invalid::Invalid;
use super::reach::{Ask, Part, below, children_first};
use crate::base::tick::Tick;

/// First and last states.
type Span = (u64, u64);

/// The states in which atoms and signals are looked at; those of other formulas are not.
#[derive(Clone, Debug, Default)]
pub struct Needs {
    atoms: Vec<Option<Span>>,
    signals: Vec<Option<Span>>,
}

/// A span that holds another one too.
fn widen(span: &mut Option<Span>, more: Span) {
    let (from, to) = span.unwrap_or(more);
    *span = Some((from.min(more.0), to.max(more.1)));
}

/// Whether a tick lies in the span of a place.
fn holds(spans: &[Option<Span>], place: usize, tick: u64) -> bool {
    spans.get(place).copied().flatten().is_some_and(|(from, to)| from <= tick && tick <= to)
}

impl Needs {
    /// Adds those of a formula that is asked about at state 0.
    pub fn add_formula(&mut self, tree: &Tree, root: NodeId, horizon: Tick) -> Result<(), Invalid> {
        self.add(tree, Part::Node(root), horizon.0)
    }

    /// Adds those of a metric that is asked about at state 0.
    pub fn add_metric(&mut self, tree: &Tree, root: TermId, horizon: Tick) -> Result<(), Invalid> {
        self.add(tree, Part::Term(root), horizon.0)
    }

    /// Whether an atom is looked at in the state of a tick.
    pub fn atom(&self, atom: usize, tick: u64) -> bool {
        holds(&self.atoms, atom, tick)
    }

    /// Whether a signal is looked at in the state of a tick.
    pub fn signal(&self, signal: usize, tick: u64) -> bool {
        holds(&self.signals, signal, tick)
    }

    fn add(&mut self, tree: &Tree, root: Part, horizon: u64) -> Result<(), Invalid> {
        let slot = |part: Part| part.place(tree);
        let mut asked: Vec<Option<Span>> = vec![None; tree.nodes.len() + tree.terms.len()];
        asked[slot(root)] = Some((0, 0));
        // Parents first: the span of a part is known before its own parts are looked at.
        for part in children_first(tree, root)?.into_iter().rev() {
            let Some((from, to)) = asked[slot(part)] else { continue };
            let after = |bound: Option<Tick>| bound.map_or(horizon, |k| to.saturating_add(k.0).min(horizon));
            for (child, ask) in below(tree, part)? {
                let span = match ask {
                    Ask::Here => (from, to),
                    Ask::Within(window) => (from.saturating_add(window.from.0), after(window.to)),
                    Ask::Until(bound) => (from, after(bound)),
                    Ask::Before(bound) => (from, after(bound).saturating_sub(1).max(from)),
                    Ask::AtEnd => (horizon, horizon),
                };
                widen(&mut asked[slot(child)], span);
            }
            match part {
                Part::Node(id) => {
                    if let Node::Atom(atom) = &tree.nodes[id.0 as usize] {
                        note(&mut self.atoms, atom.0 as usize, (from, to));
                    }
                }
                Part::Term(id) => {
                    if let Term::Signal(signal) = &tree.terms[id.0 as usize] {
                        note(&mut self.signals, signal.0 as usize, (from, to));
                    }
                }
            }
        }
        Ok(())
    }
}

fn note(spans: &mut Vec<Option<Span>>, place: usize, span: Span) {
    if spans.len() <= place {
        spans.resize(place + 1, None);
    }
    widen(&mut spans[place], span);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::logic::{Aggregation, AtomId, SignalId, Window};

    fn window(from: u64, to: u64) -> Window {
        Window { from: Tick(from), to: Some(Tick(to)) }
    }

    #[test]
    fn bounds_add_up_on_the_way_down() {
        let mut tree = Tree::default();
        let p = tree.node(Node::Atom(AtomId(0)));
        let q = tree.node(Node::Atom(AtomId(2)));
        let late = tree.node(Node::Finally(window(3, 5), p));
        let until = tree.node(Node::Until(window(2, 4), late, q));
        let mut needs = Needs::default();
        needs.add_formula(&tree, until, Tick(100)).unwrap();
        // The left side from now on to the last state but one of the window, and three to five states later.
        let seen = |atom| (0..=100).filter(|&k| needs.atom(atom, k)).collect::<Vec<u64>>();
        assert_eq!(seen(0), (3..=8).collect::<Vec<_>>());
        assert!(seen(1).is_empty());
        assert_eq!(seen(2), [2, 3, 4]);
        assert!(!needs.signal(0, 0));
    }

    #[test]
    fn what_is_asked_at_the_end_or_up_to_the_horizon_ends_there() {
        let mut tree = Tree::default();
        let s = tree.term(Term::Signal(SignalId(1)));
        let end = tree.term(Term::AtEnd(s));
        let mut needs = Needs::default();
        needs.add_metric(&tree, end, Tick(9)).unwrap();
        assert_eq!((0..20).filter(|&k| needs.signal(1, k)).collect::<Vec<_>>(), [9]);
        let all = tree.term(Term::Window(Aggregation::Mean, Window { from: Tick(7), to: None }, s));
        needs.add_metric(&tree, all, Tick(9)).unwrap();
        assert_eq!((0..20).filter(|&k| needs.signal(1, k)).collect::<Vec<_>>(), [7, 8, 9]);
    }
}
