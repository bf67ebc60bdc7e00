//! Where the robustness of a formula comes from: the comparison and the state whose margin it is.
//!
//! The definition of Fainekos and Pappas (2009), unfolded over a recorded trial: "and" and "always" take the
//! smallest margin, "or" and "finally" the largest, "not" turns the sign. What was not seen has no margin here; the
//! monitor has ended the trial where it no longer mattered.

use super::formula::{Node, NodeId, Relation, Tree};
use super::offline::{Offline, Recording};
use crate::base::tick::Tick;
use std::collections::BTreeMap;

/// A margin and whose it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Critical {
    /// How far the comparison is from changing; negative where it is false.
    pub margin: f64,
    /// The comparison.
    pub leaf: NodeId,
    /// The state.
    pub at: Tick,
}

/// The comparison and the state that the robustness of `root` at state 0 comes from; the first of several.
pub fn critical(tree: &Tree, root: NodeId, recording: &Recording) -> Option<Critical> {
    let offline = Offline::new(tree, recording);
    let mut search = Search { offline: &offline, known: BTreeMap::new() };
    let found = search.at(root, 0)?;
    // Below an odd number of "not" the sign is turned; the comparison itself keeps its own.
    let own = search.leaf(found.leaf, found.at.0)?;
    Some(Critical { margin: own.margin, ..found })
}

struct Search<'a> {
    offline: &'a Offline<'a>,
    known: BTreeMap<(u32, u64), Option<Critical>>,
}

/// The smaller of two margins, or the larger; the first of equals.
fn pick(a: Option<Critical>, b: Option<Critical>, smallest: bool) -> Option<Critical> {
    match (a, b) {
        (Some(a), Some(b)) => {
            let better = if smallest { b.margin < a.margin } else { b.margin > a.margin };
            Some(if better { b } else { a })
        }
        (a, b) => a.or(b),
    }
}

fn turned(found: Option<Critical>) -> Option<Critical> {
    found.map(|found| Critical { margin: -found.margin, ..found })
}

impl Search<'_> {
    fn leaf(&self, id: NodeId, at: u64) -> Option<Critical> {
        let Node::Compare(relation, x, y) = &self.offline.tree.nodes[id.0 as usize] else { return None };
        let (x, y) = (self.offline.number(*x, at)?, self.offline.number(*y, at)?);
        let margin = match relation {
            Relation::Greater | Relation::AtLeast => x - y,
            Relation::Less | Relation::AtMost => y - x,
            Relation::Equal | Relation::Unequal => return None,
        };
        (!margin.is_nan()).then_some(Critical { margin, leaf: id, at: Tick(at) })
    }

    fn at(&mut self, id: NodeId, at: u64) -> Option<Critical> {
        if at >= self.offline.recording.seen {
            return None;
        }
        if let Some(known) = self.known.get(&(id.0, at)) {
            return *known;
        }
        let found = match self.offline.tree.nodes[id.0 as usize].clone() {
            Node::Constant(_) | Node::Atom(_) => None,
            Node::Compare(..) => self.leaf(id, at),
            Node::Not(x) => turned(self.at(x, at)),
            Node::And(list) => self.among(list.into_iter().map(|x| (x, at)), true),
            Node::Or(list) => self.among(list.into_iter().map(|x| (x, at)), false),
            Node::Finally(w, x) => self.among(self.offline.states(w, at).map(|k| (x, k)), false),
            Node::Globally(w, x) => self.among(self.offline.states(w, at).map(|k| (x, k)), true),
            Node::Until(w, p, q) => self.until(self.offline.states(w, at), (p, q), at, false),
            Node::Release(w, p, q) => turned(self.until(self.offline.states(w, at), (p, q), at, true)),
            Node::WeakUntil(w, p, q) => {
                let states = self.offline.states(w, at);
                let all = self.among((at..=*states.end()).map(|k| (p, k)), true);
                let reached = self.until(states, (p, q), at, false);
                pick(reached, all, false)
            }
        };
        self.known.insert((id.0, at), found);
        found
    }

    fn among(&mut self, parts: impl Iterator<Item = (NodeId, u64)>, smallest: bool) -> Option<Critical> {
        let seen = self.offline.recording.seen;
        let parts = parts.filter(|(_, at)| *at < seen);
        parts.fold(None, |best, (part, at)| pick(best, self.at(part, at), smallest))
    }

    /// The second at a state of the window and the first before it; `inverted`: of the opposites of both.
    fn until(
        &mut self,
        states: std::ops::RangeInclusive<u64>,
        (first, second): (NodeId, NodeId),
        at: u64,
        inverted: bool,
    ) -> Option<Critical> {
        let sign = |found| if inverted { turned(found) } else { found };
        let (mut best, mut before) = (None, None);
        for k in at..=*states.end() {
            if k >= self.offline.recording.seen {
                break;
            }
            if k >= *states.start() {
                let reached = sign(self.at(second, k));
                best = pick(best, pick(before, reached, true), false);
            }
            before = pick(before, sign(self.at(first, k)), true);
        }
        best
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::tick::Clock;
    use crate::logic::formula::{AtomId, SignalId, Term, Window};

    #[test]
    fn the_smallest_margin_of_always_and_the_largest_of_finally() {
        let mut tree = Tree::default();
        let x = tree.term(Term::Signal(SignalId(0)));
        let limit = tree.term(Term::Constant(0.5));
        let above = tree.node(Node::Compare(Relation::Greater, x, limit));
        let window = Window { from: Tick(0), to: Some(Tick(3)) };
        let always = tree.node(Node::Globally(window, above));
        let finally = tree.node(Node::Finally(window, above));
        let never = tree.node(Node::Not(finally));
        let until = tree.node(Node::Until(window, above, above));
        let atoms = |_: AtomId, _: u64| false;
        let signals = |_: SignalId, k: u64| [1.0, 0.75, 2.0, 0.75][k as usize];
        let recording =
            Recording { atoms: &atoms, signals: &signals, seen: 4, horizon: Tick(3), clock: Clock::Steps };
        let found = |root| critical(&tree, root, &recording);
        let of = |margin, at| Some(Critical { margin, leaf: above, at: Tick(at) });
        assert_eq!(found(always), of(0.25, 1));
        assert_eq!((found(finally), found(never)), (of(1.5, 2), of(1.5, 2)));
        assert_eq!(found(until), of(0.5, 0));
    }
}
