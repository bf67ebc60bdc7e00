//! Where the robustness of a formula comes from: the comparison and the state whose margin it is.
//!
//! The definition of Fainekos and Pappas (2009) over a recorded trial: "and" and "always" take the smallest margin, "or"
//! and "finally" the largest, "not" turns the sign. What was not seen has no margin here; the monitor has ended the
//! trial where it no longer mattered. Margins are found from the last state to the first, each once (the smallest and
//! largest of windows with a queue as Lemire's, 2006; an until with a bound is one without and a finally with it, as
//! Donzé, Ferrère and Maler, 2013, have it); then the way down from the root follows the margin that it has.

use super::formula::{NodeId, Operation, Relation, Tree};
use super::offline::{Offline, Recording, Slide, Slot, backward};
use crate::base::tick::Tick;

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
    let offline = Offline::measured(tree, root, recording).ok()?;
    let root = offline.slot(root)?;
    let mut margins = Margins { offline: &offline, of: Vec::with_capacity(root + 1) };
    for slot in 0..=root {
        if (recording.stop)() {
            return None;
        }
        let made = margins.all(slot);
        margins.of.push(made);
    }
    margins.follow(root, 0)
}

/// The margins of all slots at the states seen at which they are asked about; what is no number is none.
struct Margins<'a> {
    offline: &'a Offline<'a>,
    of: Vec<Vec<f64>>,
}

/// The smaller of two margins, or the larger; the first of equals, and the other where one is none.
fn pick(a: f64, b: f64, smallest: bool) -> f64 {
    if a.is_nan() || (if smallest { b < a } else { b > a }) { b } else { a }
}

/// A margin, or that of the opposite.
fn turned(margin: f64, as_it_is: bool) -> f64 {
    if as_it_is { margin } else { -margin }
}

impl Margins<'_> {
    fn at(&self, slot: usize, at: u64) -> f64 {
        let (from, _) = self.offline.range(slot);
        at.checked_sub(from).and_then(|k| self.of[slot].get(k as usize)).copied().unwrap_or(f64::NAN)
    }

    fn leaf(&self, (relation, x, y): (Relation, usize, usize), at: u64) -> f64 {
        let Some((x, y)) = self.offline.value(x, at).zip(self.offline.value(y, at)) else { return f64::NAN };
        match relation.margin(x, y) {
            _ if matches!(relation, Relation::Equal | Relation::Unequal) => f64::NAN,
            // Of what is no number nothing holds.
            margin if margin.is_nan() => f64::NEG_INFINITY,
            margin => margin,
        }
    }

    /// The margins of a slot; those below it are known.
    fn all(&self, slot: usize) -> Vec<f64> {
        let (from, count) = self.offline.range(slot);
        let states = from..from + count as u64;
        match &self.offline.slots()[slot] {
            Slot::Fixed(truth) => states.map(|_| turned(f64::INFINITY, *truth)).collect(),
            Slot::Compare(relation, x, y) => states.map(|k| self.leaf((*relation, *x, *y), k)).collect(),
            Slot::Not(x) => states.map(|k| -self.at(*x, k)).collect(),
            Slot::Join { parts, any } => states
                .map(|k| parts.iter().fold(f64::NAN, |best, part| pick(best, self.at(*part, k), !any)))
                .collect(),
            Slot::Window { from, to, of, any } => {
                let mut queue =
                    Slide::new(self.offline.seen(), if *any { Operation::Max } else { Operation::Min });
                backward(states, |at| {
                    let window = (at.saturating_add(*from), self.offline.end(at, *to));
                    queue.of(window, |k| self.at(*of, k))
                })
            }
            Slot::Until { from, to, first, second, weak, value } => {
                let hold = |k| turned(self.at(first.0, k), first.1);
                let goal = |k| turned(self.at(second.0, k), second.1);
                let seen = self.offline.seen();
                let mut least = Slide::new(seen, Operation::Min);
                let mut all = Slide::new(seen, Operation::Min);
                let mut most = Slide::new(seen, Operation::Max);
                // Without a bound, from the state `reached` on.
                let (mut until, mut reached) = (f64::NEG_INFINITY, seen);
                backward(states, |at| {
                    let (begin, last) = (at.saturating_add(*from), self.offline.end(at, *to));
                    while reached > begin {
                        reached -= 1;
                        until = pick(goal(reached), pick(hold(reached), until, true), false);
                    }
                    let before = match begin.checked_sub(1).filter(|end| *end >= at) {
                        Some(end) => least.of((at, end), hold),
                        None => f64::NAN,
                    };
                    let mut best = pick(pick(before, most.of((begin, last), goal), true), until, true);
                    if *weak {
                        best = pick(best, all.of((at, last), hold), false);
                    }
                    turned(best, *value)
                })
            }
            // Truths without a margin, and numbers.
            _ => Vec::new(),
        }
    }

    /// Down to the comparison that has the margin of a slot at a state.
    fn follow(&self, mut slot: usize, mut at: u64) -> Option<Critical> {
        loop {
            let margin = self.at(slot, at);
            let has = |part: usize, k: u64, sought: f64| self.at(part, k) == sought;
            match &self.offline.slots()[slot] {
                Slot::Compare(..) => {
                    let leaf = self.offline.leaf(slot)?;
                    return (!margin.is_nan()).then_some(Critical { margin, leaf, at: Tick(at) });
                }
                Slot::Not(x) => slot = *x,
                Slot::Join { parts, .. } => slot = *parts.iter().find(|part| has(**part, at, margin))?,
                Slot::Window { from, to, of, .. } => {
                    let last = self.offline.end(at, *to).min(self.offline.seen());
                    at = (at.saturating_add(*from)..=last).find(|k| has(*of, *k, margin))?;
                    slot = *of;
                }
                Slot::Until { to, first, second, value, .. } => {
                    let last = self.offline.end(at, *to).min(self.offline.seen());
                    // The margin is one of those of both sides at the states up to the end.
                    let sides = [first, second];
                    let sought = |side: &(usize, bool)| turned(turned(margin, *value), side.1);
                    let found = (at..=last).find_map(|k| {
                        sides.into_iter().find(|side| has(side.0, k, sought(side))).map(|side| (side.0, k))
                    });
                    (slot, at) = found?;
                }
                _ => return None,
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::tick::Clock;
    use crate::logic::formula::{AtomId, Node, SignalId, Term, Window};

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
        let recording = Recording {
            atoms: &atoms,
            signals: &signals,
            seen: 4,
            horizon: Tick(3),
            clock: Clock::Steps,
            stop: &|| false,
        };
        let found = |root| critical(&tree, root, &recording);
        let of = |margin, at| Some(Critical { margin, leaf: above, at: Tick(at) });
        assert_eq!(found(always), of(0.25, 1));
        assert_eq!((found(finally), found(never)), (of(1.5, 2), of(1.5, 2)));
        assert_eq!(found(until), of(0.5, 0));
    }
}
