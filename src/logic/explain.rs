//! Why a trial satisfies or violates a formula: the atoms and comparisons, each with the states at which
//! it had a value, that together force the verdict whatever the rest of the trial is.

use super::formula::{AtomId, Node, NodeId, Tree};
use super::invalid::Invalid;
use super::offline::{FALSE, OPEN, Offline, Recording, Slot, TRUE, turned};
use super::reach::{Part, below, last_state};
use crate::base::tick::{Clock, Tick};
use std::collections::BTreeSet;

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
    let (needed, _) = last_state(tree, Part::Node(root), Some(recording.horizon), recording.clock)?;
    if needed > recording.horizon {
        return Err(Invalid::BeyondHorizon { needed: needed.0, horizon: recording.horizon.0 });
    }
    let offline = Offline::new(tree, Part::Node(root), 0, recording)?;
    let verdict = offline.truth(root, 0);
    let reasons = if verdict.is_some() { explain_at(&offline, root, 0) } else { Vec::new() };
    Ok(Explanation { verdict, reasons })
}

/// The atoms that can matter to the truth of a formula: not those inside parts that constants alone decide. `None` if they
/// decide all of it.
///
/// # Errors
/// When the tree is malformed or too deep.
pub fn open_atoms(
    tree: &Tree,
    root: NodeId,
    horizon: Tick,
    clock: Clock,
) -> Result<Option<BTreeSet<AtomId>>, Invalid> {
    let (atoms, signals, stop) = (|_, _| false, |_, _| f64::NAN, || false);
    let nothing = Recording { atoms: &atoms, signals: &signals, seen: 0, horizon, clock, stop: &stop };
    let offline = Offline::new(tree, Part::Node(root), 0, &nothing)?;
    let (mut open, mut known, mut next) = (BTreeSet::new(), BTreeSet::new(), vec![Part::Node(root)]);
    while let Some(part) = next.pop() {
        let (key, decided) = match part {
            Part::Node(id) => ((false, id.0), offline.truth(id, 0).is_some()),
            Part::Term(id) => ((true, id.0), false),
        };
        if decided || !known.insert(key) {
            continue;
        }
        if let Part::Node(id) = part
            && let Node::Atom(atom) = &tree.nodes[id.0 as usize]
        {
            open.insert(*atom);
        }
        next.extend(below(tree, part)?.into_iter().map(|(child, _)| child));
    }
    Ok((!known.is_empty()).then_some(open))
}

/// The reasons of the known truth of a formula at a state.
pub(super) fn explain_at(offline: &Offline<'_>, root: NodeId, at: u64) -> Vec<Reason> {
    let Some(root) = offline.slot(root) else { return Vec::new() };
    let mut demand = Demand { offline, changes: vec![Vec::new(); root + 1] };
    let mut leaves: Vec<(NodeId, Vec<(u64, bool)>)> = Vec::new();
    demand.ask(root, at, at);
    // Parents stand behind their children.
    for slot in (0..=root).rev() {
        let states = demand.states(slot);
        if states.is_empty() {
            continue;
        }
        if let Some(leaf) = offline.leaf(slot) {
            let values = states.iter().map(|&at| (at, offline.look(slot, at) == TRUE));
            leaves.push((leaf, values.collect()));
        } else {
            demand.pass_on(slot, &states);
        }
    }
    leaves.sort_by_key(|(leaf, _)| leaf.0);
    let mut reasons: Vec<Reason> = Vec::new();
    for (leaf, values) in leaves {
        for (at, value) in values {
            match reasons.last_mut() {
                Some(last) if last.leaf == leaf && last.value == value && last.to.0 + 1 == at => {
                    last.to = Tick(at);
                }
                _ => reasons.push(Reason { leaf, value, from: Tick(at), to: Tick(at) }),
            }
        }
    }
    reasons
}

/// The states at which the truth of each slot is needed. Of stretches only their ends are noted, so that wide windows
/// cost no more than narrow ones.
struct Demand<'a> {
    offline: &'a Offline<'a>,
    /// How many more stretches there are than at the state before.
    changes: Vec<Vec<i64>>,
}

impl Demand<'_> {
    /// The truth of a slot is needed at the states `from ..= to` that were seen.
    fn ask(&mut self, slot: usize, from: u64, to: u64) {
        let (lo, count) = self.offline.range(slot);
        let (from, to) = (from.max(lo) - lo, to.saturating_add(1).saturating_sub(lo).min(count as u64));
        if from >= to {
            return;
        }
        let changes = &mut self.changes[slot];
        changes.resize(count + 1, 0);
        changes[from as usize] += 1;
        changes[to as usize] -= 1;
    }

    /// The states at which a slot is needed and known, ascending.
    fn states(&mut self, slot: usize) -> Vec<u64> {
        let changes = std::mem::take(&mut self.changes[slot]);
        let lo = self.offline.range(slot).0;
        let mut stretches = 0;
        let needed = changes.iter().enumerate().filter_map(|(k, change)| {
            stretches += change;
            (stretches > 0).then_some(lo + k as u64)
        });
        needed.filter(|&at| self.offline.look(slot, at) != OPEN).collect()
    }

    /// What forces a slot at these states is needed of its parts: of several possible ones the earliest.
    fn pass_on(&mut self, slot: usize, states: &[u64]) {
        let offline = self.offline;
        let back = states.iter().rev().map(|&at| (at, offline.look(slot, at)));
        match &offline.slots()[slot] {
            Slot::Not(x) => back.for_each(|(at, _)| self.ask(*x, at, at)),
            Slot::Join { parts, any } => {
                for (at, value) in back {
                    // One part is enough, or all are needed.
                    if (value == TRUE) == *any {
                        let part = parts.iter().find(|part| offline.look(**part, at) == value);
                        if let Some(part) = part {
                            self.ask(*part, at, at);
                        }
                    } else {
                        for part in parts {
                            self.ask(*part, at, at);
                        }
                    }
                }
            }
            Slot::Window { from, to, of, any } => {
                let mut next = offline.next(*of);
                for (at, value) in back {
                    let (first, last) = (at.saturating_add(*from), offline.end(at, *to));
                    next.move_to(first, |k| offline.look(*of, k));
                    if (value == TRUE) == *any {
                        let one = next.first(first, value);
                        self.ask(*of, one, one.min(last));
                    } else {
                        self.ask(*of, first, last);
                    }
                }
            }
            Slot::Until { from, to, first, second, weak, value } => {
                let (mut hold, mut goal) = (offline.next(first.0), offline.next(second.0));
                let truth = |asked: bool, so: bool| if asked == so { TRUE } else { FALSE };
                for (at, found) in back {
                    let (begin, last) = (at.saturating_add(*from), offline.end(at, *to));
                    hold.move_to(at, |k| offline.look(first.0, k));
                    goal.move_to(begin, |k| offline.look(second.0, k));
                    let fails = hold.first(at, truth(first.1, false));
                    let holds = fails.min(hold.first(at, OPEN)) > last;
                    match turned(found, *value) == TRUE {
                        true if *weak && holds => self.ask(first.0, at, last),
                        true => {
                            // The second at some state, the first at all before it.
                            let reached = goal.first(begin, truth(second.1, true));
                            self.ask(second.0, reached, reached.min(last));
                            if reached > at && reached <= last {
                                self.ask(first.0, at, reached - 1);
                            }
                        }
                        false => {
                            // The first fails, and the second at every state of the window until then. Nothing depends on
                            // the first at the last state, but for the weak one.
                            let fails = if *weak || fails < last { fails } else { u64::MAX };
                            self.ask(first.0, fails, fails.min(last));
                            self.ask(second.0, begin, fails.min(last));
                        }
                    }
                }
            }
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::tick::Clock;
    use crate::logic::formula::{Aggregation, AtomId, Node, Relation, SignalId, Term, Window};

    #[test]
    fn what_constants_decide_is_not_open() {
        let mut tree = Tree::default();
        let [p, q] = [0, 1].map(|k| tree.node(Node::Atom(AtomId(k))));
        let no = tree.node(Node::Constant(false));
        let (never, not) = (tree.node(Node::And(vec![p, no])), tree.node(Node::Not(no)));
        let soon = tree.node(Node::Finally(window(0, 2), p));
        let vacuous = tree.node(Node::Or(vec![not, soon]));
        let all = tree.node(Node::Globally(window(0, 3), vacuous));
        let open = |root| open_atoms(&tree, root, Tick(9), Clock::Steps).unwrap();
        assert_eq!((open(all), open(never)), (None, None));
        assert_eq!(open(soon), Some(BTreeSet::from([AtomId(0)])));
        let mut more = tree.clone();
        let either = more.node(Node::Or(vec![never, q]));
        let found = open_atoms(&more, either, Tick(9), Clock::Steps).unwrap();
        assert_eq!(found, Some(BTreeSet::from([AtomId(1)])));
    }

    fn window(from: u64, to: u64) -> Window {
        Window { from: Tick(from), to: Some(Tick(to)) }
    }

    fn recording<'a>(
        atoms: &'a dyn Fn(AtomId, u64) -> bool,
        signals: &'a dyn Fn(SignalId, u64) -> f64,
        seen: u64,
    ) -> Recording<'a> {
        Recording { atoms, signals, seen, horizon: Tick(20), clock: Clock::Steps, stop: &|| false }
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
    fn an_until_does_not_depend_on_its_first_operand_at_the_last_state() {
        let mut tree = Tree::default();
        let p = tree.node(Node::Atom(AtomId(0)));
        let q = tree.node(Node::Atom(AtomId(1)));
        let root = tree.node(Node::Until(window(0, 3), p, q));
        let never = |atom: AtomId, k| atom.0 == 0 && k < 3;
        let found = explain(&tree, root, &recording(&never, &|_, _| 0.0, 4)).unwrap();
        let reason = Reason { leaf: q, value: false, from: Tick(0), to: Tick(3) };
        assert_eq!(found, Explanation { verdict: Some(false), reasons: vec![reason] });
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
