//! How far into a trial a formula looks: the order of its parts, and the last state that each of them is
//! asked about.

use super::formula::{
    AtomId, Node, NodeId, Relation, SignalId, Term, TermId, Tree, Window, in_time, last_tick,
};
use super::invalid::Invalid;
use crate::base::tick::{Clock, Tick};
use std::collections::BTreeSet;

/// Most levels of a formula: 256 levels of the language and what they are lowered to.
pub(super) const DEEPEST: u64 = 1024;

/// A part of a tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// A formula.
    Node(NodeId),
    /// A number.
    Term(TermId),
}

impl Part {
    /// Its place among all parts of a tree, formulas first.
    pub(super) fn place(self, tree: &Tree) -> usize {
        match self {
            Self::Node(id) => id.0 as usize,
            Self::Term(id) => tree.nodes.len() + id.0 as usize,
        }
    }
}

/// Where a part is asked about, seen from the part above it.
#[derive(Clone, Copy, Debug)]
pub(super) enum Ask {
    /// In the same state.
    Here,
    /// In the states of a window.
    Within(Window),
    /// From the present state to the last one of a window.
    Until(Option<Tick>),
    /// From the present state to the last but one of a window: nothing depends on the left operand of
    /// an until in the last state.
    Before(Option<Tick>),
    /// At the horizon.
    AtEnd,
}

/// The parts directly below one part.
pub(super) fn below(tree: &Tree, part: Part) -> Result<Vec<(Part, Ask)>, Invalid> {
    let node = |id: &NodeId, ask| (Part::Node(*id), ask);
    let term = |id: &TermId, ask| (Part::Term(*id), ask);
    Ok(match part {
        Part::Node(id) => match tree.nodes.get(id.0 as usize).ok_or(Invalid::Malformed)? {
            Node::Constant(_) | Node::Atom(_) => Vec::new(),
            Node::Compare(_, x, y) => vec![term(x, Ask::Here), term(y, Ask::Here)],
            Node::Not(x) => vec![node(x, Ask::Here)],
            Node::And(all) | Node::Or(all) => all.iter().map(|x| node(x, Ask::Here)).collect(),
            Node::Finally(w, x) | Node::Globally(w, x) => vec![node(x, Ask::Within(*w))],
            Node::Until(w, p, q) | Node::Release(w, p, q) => {
                vec![node(q, Ask::Within(*w)), node(p, Ask::Before(w.to))]
            }
            Node::WeakUntil(w, p, q) => vec![node(q, Ask::Within(*w)), node(p, Ask::Until(w.to))],
        },
        Part::Term(id) => match tree.terms.get(id.0 as usize).ok_or(Invalid::Malformed)? {
            Term::Constant(_) | Term::Signal(_) => Vec::new(),
            Term::Combine(_, x, y) => vec![term(x, Ask::Here), term(y, Ask::Here)],
            Term::Abs(x) => vec![term(x, Ask::Here)],
            Term::Window(_, w, x) => vec![term(x, Ask::Within(*w))],
            Term::Later(k, x) => vec![term(x, Ask::Within(Window { from: *k, to: Some(*k) }))],
            Term::AtEnd(x) => vec![term(x, Ask::AtEnd)],
            Term::TimeUntil(x) => vec![node(x, Ask::Within(Window { from: Tick(0), to: None }))],
        },
    })
}

/// Of a comparison of a time until something with a constant: that something, and the window in which it is asked about,
/// as it is by `F<=c`; no window where the constant alone decides.
fn timed(tree: &Tree, part: Part, clock: Clock) -> Option<(NodeId, Option<Window>)> {
    /// No bound is beyond.
    const FAR: u64 = 1 << 41;
    let Part::Node(id) = part else { return None };
    let Node::Compare(relation, x, y) = &tree.nodes[id.0 as usize] else { return None };
    let term = |id: &TermId| &tree.terms[id.0 as usize];
    let (goal, c, relation) = match (term(x), term(y)) {
        (Term::TimeUntil(goal), Term::Constant(c)) => (*goal, *c, *relation),
        (Term::Constant(c), Term::TimeUntil(goal)) => (*goal, *c, relation.flipped()),
        _ => return None,
    };
    let strictly = match relation {
        Relation::AtMost | Relation::Greater => false,
        Relation::Less | Relation::AtLeast => true,
        Relation::Equal | Relation::Unequal => return None,
    };
    if !c.is_finite() {
        return None;
    }
    // Of states the last one in time counts; in continuous time all up to the constant do, which is the nearest tick, as that of a
    // bound is.
    let last = if clock.is_jumps() {
        let is_in = |ticks: u64| clock.seconds(Tick(2 * ticks + 1)) / 2.0 < c;
        (c >= 0.0).then(|| last_tick(FAR - 1, is_in).map_or(0, |last| last + 1))
    } else {
        in_time(if strictly { Relation::Less } else { Relation::AtMost }, c, clock, FAR - 1)
    };
    Some((goal, last.map(|last| Window { from: Tick(0), to: Some(Tick(last)) })))
}

/// Whether a part looks at other states than the one in which it is asked about.
///
/// # Errors
/// When the tree is malformed or too deep.
pub fn looks_ahead(tree: &Tree, root: Part) -> Result<bool, Invalid> {
    for part in children_first(tree, root)? {
        if below(tree, part)?.iter().any(|(_, ask)| !matches!(ask, Ask::Here)) {
            return Ok(true);
        }
    }
    Ok(false)
}

/// All parts below `root` and itself, children first.
pub(super) fn children_first(tree: &Tree, root: Part) -> Result<Vec<Part>, Invalid> {
    const NEW: u8 = 0;
    const OPEN: u8 = 1;
    let slot = |part: Part| part.place(tree);
    // 0: not seen, 1: being visited (meeting it again is a circle), 2 + n: done, n levels below it.
    let mut state = vec![0u64; tree.nodes.len() + tree.terms.len()];
    let mut order = Vec::new();
    let mut path = vec![(root, below(tree, root)?, 0usize)];
    state[slot(root)] = u64::from(OPEN);
    while let Some((part, parts, next)) = path.last_mut() {
        if let Some(&(child, _)) = parts.get(*next) {
            *next += 1;
            let inner = below(tree, child)?;
            if state[slot(child)] == u64::from(NEW) {
                state[slot(child)] = u64::from(OPEN);
                path.push((child, inner, 0));
            } else if state[slot(child)] == u64::from(OPEN) {
                return Err(Invalid::Malformed);
            }
        } else {
            let levels = parts.iter().map(|(child, _)| state[slot(*child)] - 1).max().unwrap_or(0);
            if levels >= DEEPEST {
                return Err(Invalid::TooDeep { depth: levels + 1, limit: DEEPEST });
            }
            state[slot(*part)] = 2 + levels;
            order.push(*part);
            path.pop();
        }
    }
    Ok(order)
}

/// Where parts are asked about at last, in ticks.
pub(super) struct Asked {
    /// Of each formula, then of each number, the first and the last tick; `None` where nothing asks.
    parts: Vec<Option<(u64, u64)>>,
    /// Number of formulas.
    nodes: usize,
    /// The last tick that is looked at through bounds alone.
    pub(super) last: u64,
    /// Whether some part ranges up to the horizon.
    pub(super) to_horizon: bool,
}

impl Asked {
    /// The first and the last tick at which a part is asked about.
    pub(super) fn of(&self, part: Part) -> Option<(u64, u64)> {
        match part {
            Part::Node(id) => self.parts[id.0 as usize],
            Part::Term(id) => self.parts[self.nodes + id.0 as usize],
        }
    }
}

/// Where the parts below `root`, asked about at tick 0, are asked about. With a horizon, parts below one that ranges up to
/// it are asked about there too, so that a bound looks beyond it. In continuous time the left operand of an until is asked
/// about up to just before the end of its window, which is a tick further than the last state before it.
pub(super) fn asked(tree: &Tree, root: Part, horizon: Option<Tick>, clock: Clock) -> Result<Asked, Invalid> {
    let dense = clock.is_jumps();
    let order = children_first(tree, root)?;
    let slot = |part: Part| part.place(tree);
    let end = |at: u64| horizon.map_or(at, |horizon| horizon.0.max(at));
    let mut parts: Vec<Option<(u64, u64)>> = vec![None; tree.nodes.len() + tree.terms.len()];
    parts[slot(root)] = Some((0, 0));
    let (mut last, mut to_horizon) = (0, false);
    for part in order.into_iter().rev() {
        let Some((from, at)) = parts[slot(part)] else { continue };
        last = last.max(at);
        let children = match timed(tree, part, clock) {
            Some((goal, window)) => {
                window.map(|window| (Part::Node(goal), Ask::Within(window))).into_iter().collect()
            }
            None => below(tree, part)?,
        };
        for (child, ask) in children {
            let earliest = match ask {
                Ask::Within(window) => from.saturating_add(window.from.0),
                Ask::AtEnd => end(from),
                Ask::Here | Ask::Until(_) | Ask::Before(_) => from,
            };
            let latest = match ask {
                Ask::Here => Some(at),
                Ask::Within(Window { from, to: Some(to) }) => {
                    if to < from {
                        return Err(Invalid::EmptyWindow { from: from.0, to: to.0 });
                    }
                    Some(at.saturating_add(to.0))
                }
                Ask::Within(Window { from, to: None }) => {
                    last = last.max(at.saturating_add(from.0));
                    Some(end(at))
                }
                Ask::Until(Some(to)) => Some(at.saturating_add(to.0)),
                Ask::Before(Some(to)) if dense => (to.0 > 0).then(|| at.saturating_add(to.0)),
                Ask::Before(Some(to)) => (to.0 > 0).then(|| at.saturating_add(to.0 - 1)),
                Ask::Before(None) if !dense => Some(horizon.map_or(at, |h| h.0.saturating_sub(1).max(at))),
                Ask::Until(None) | Ask::Before(None) | Ask::AtEnd => Some(end(at)),
            };
            to_horizon |= matches!(
                ask,
                Ask::Within(Window { to: None, .. }) | Ask::Until(None) | Ask::Before(None) | Ask::AtEnd
            );
            if let Some(latest) = latest {
                let known = &mut parts[slot(child)];
                let (first, last) = known.unwrap_or((earliest, latest));
                *known = Some((first.min(earliest), last.max(latest)));
            }
        }
    }
    Ok(Asked { parts, nodes: tree.nodes.len(), last, to_horizon })
}

/// The last state that `root`, asked about at state 0, looks at through bounds alone, and whether some
/// part ranges up to the horizon.
pub(super) fn last_state(
    tree: &Tree,
    root: Part,
    horizon: Option<Tick>,
    clock: Clock,
) -> Result<(Tick, bool), Invalid> {
    asked(tree, root, horizon, clock).map(|asked| (Tick(asked.last), asked.to_horizon))
}

/// How far a formula or metric looks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reach {
    /// The last tick that it needs, whatever the horizon: nothing can be decided where that is beyond the horizon.
    pub ticks: u64,
    /// Whether a part of it ranges up to the horizon.
    pub unbounded: bool,
}

/// How far a part, asked about at the start of a trial, looks.
///
/// # Errors
/// When a window is empty, or the tree is malformed or too deep.
pub fn reach(tree: &Tree, root: Part, horizon: Tick, clock: Clock) -> Result<Reach, Invalid> {
    let asked = asked(tree, root, Some(horizon), clock)?;
    Ok(Reach { ticks: asked.last, unbounded: asked.to_horizon })
}

/// The atoms and signals that some parts of a tree read.
///
/// # Errors
/// When the tree is malformed or too deep.
pub fn leaves(tree: &Tree, roots: &[Part]) -> Result<(BTreeSet<AtomId>, BTreeSet<SignalId>), Invalid> {
    let (mut atoms, mut signals) = (BTreeSet::new(), BTreeSet::new());
    for &root in roots {
        for part in children_first(tree, root)? {
            match part {
                Part::Node(id) => {
                    if let Node::Atom(atom) = &tree.nodes[id.0 as usize] {
                        atoms.insert(*atom);
                    }
                }
                Part::Term(id) => {
                    if let Term::Signal(signal) = &tree.terms[id.0 as usize] {
                        signals.insert(*signal);
                    }
                }
            }
        }
    }
    Ok((atoms, signals))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::decimal::Decimal;
    use crate::logic::formula::AtomId;

    fn window(from: u64, to: Option<u64>) -> Window {
        Window { from: Tick(from), to: to.map(Tick) }
    }

    #[test]
    fn bounds_add_up_along_the_deepest_path() {
        let mut tree = Tree::default();
        let a = tree.node(Node::Atom(AtomId(0)));
        let inner = tree.node(Node::Finally(window(1, Some(4)), a));
        let outer = tree.node(Node::Globally(window(0, Some(10)), inner));
        assert_eq!(last_state(&tree, Part::Node(outer), None, Clock::Steps), Ok((Tick(14), false)));
        let until = tree.node(Node::Until(window(0, Some(3)), inner, a));
        assert_eq!(
            last_state(&tree, Part::Node(until), None, Clock::Steps),
            Ok((Tick(6), false)),
            "nothing depends on the left operand of an until in its last state"
        );
    }

    #[test]
    fn the_left_operand_of_an_until_is_not_needed_in_its_last_state() {
        let mut tree = Tree::default();
        let q = tree.node(Node::Atom(AtomId(0)));
        let next = tree.node(Node::Finally(window(1, Some(1)), q));
        let endless = tree.node(Node::Until(window(0, None), next, q));
        let states = reach(&tree, Part::Node(endless), Tick(9), Clock::Steps);
        assert_eq!(states, Ok(Reach { ticks: 9, unbounded: true }));
        let dense = asked(&tree, Part::Node(endless), Some(Tick(9)), Clock::Jumps(Decimal::ONE)).unwrap();
        assert_eq!(dense.last, 10, "it is asked about up to the very end of continuous time");
        let weak = tree.node(Node::WeakUntil(window(0, None), next, q));
        let states = reach(&tree, Part::Node(weak), Tick(9), Clock::Steps);
        assert_eq!(states, Ok(Reach { ticks: 10, unbounded: true }));
    }

    #[test]
    fn a_time_that_is_compared_is_asked_about_as_far_as_finally_is() {
        let mut tree = Tree::default();
        let p = tree.node(Node::Atom(AtomId(0)));
        let goal = tree.node(Node::Finally(window(0, Some(2)), p));
        let time = tree.term(Term::TimeUntil(goal));
        let second = |text: &str| Clock::Stepped(Decimal::parse(text).unwrap());
        for (relation, clock, c, last) in [
            (Relation::AtMost, Clock::Steps, 1.0, 3),
            (Relation::Less, Clock::Steps, 1.0, 2),
            (Relation::AtLeast, Clock::Steps, 1.5, 3),
            (Relation::Greater, second("0.1"), 0.3, 5),
            (Relation::AtMost, Clock::Jumps(Decimal::ONE), 1.0, 3),
            (Relation::Less, Clock::Jumps(Decimal::ONE), 1.75, 4),
            (Relation::AtMost, Clock::Jumps(Decimal::ONE), 1.25, 3),
            (Relation::Less, Clock::Steps, 0.0, 0),
            (Relation::AtMost, Clock::Steps, -1.0, 0),
            (Relation::AtMost, Clock::Steps, f64::INFINITY, 11),
            (Relation::Equal, Clock::Steps, 1.0, 11),
        ] {
            let limit = tree.term(Term::Constant(c));
            for node in [Node::Compare(relation, time, limit), Node::Compare(relation.flipped(), limit, time)]
            {
                let root = tree.node(node);
                let found = reach(&tree, Part::Node(root), Tick(9), clock).unwrap();
                assert_eq!(found, Reach { ticks: last, unbounded: last == 11 }, "{relation:?} {c}");
            }
        }
    }

    #[test]
    fn leaves_of_shared_parts_are_met_once() {
        let mut tree = Tree::default();
        let mut x = tree.node(Node::Atom(AtomId(3)));
        for _ in 0..400 {
            x = tree.node(Node::And(vec![x, x]));
        }
        let (atoms, signals) = leaves(&tree, &[Part::Node(x)]).unwrap();
        assert_eq!((atoms, signals), (BTreeSet::from([AtomId(3)]), BTreeSet::new()));
    }

    #[test]
    fn circles_and_missing_parts_are_found() {
        let mut tree = Tree::default();
        let a = tree.node(Node::Not(NodeId(1)));
        tree.node(Node::Not(a));
        assert_eq!(last_state(&tree, Part::Node(a), None, Clock::Steps), Err(Invalid::Malformed));
        assert_eq!(last_state(&tree, Part::Node(NodeId(9)), None, Clock::Steps), Err(Invalid::Malformed));
        let empty = tree.node(Node::Finally(window(3, Some(2)), NodeId(4)));
        tree.node(Node::Constant(true));
        let _ = empty;
        assert_eq!(
            last_state(&tree, Part::Node(NodeId(2)), None, Clock::Steps),
            Err(Invalid::Malformed),
            "a child that does not exist"
        );
    }

    #[test]
    fn shared_parts_do_not_cost_exponential_time() {
        let mut tree = Tree::default();
        let mut x = tree.node(Node::Atom(AtomId(0)));
        for _ in 0..500 {
            x = tree.node(Node::And(vec![x, x]));
        }
        assert_eq!(last_state(&tree, Part::Node(x), None, Clock::Steps), Ok((Tick(0), false)));
        for _ in 0..600 {
            x = tree.node(Node::Not(x));
        }
        assert!(matches!(last_state(&tree, Part::Node(x), None, Clock::Steps), Err(Invalid::TooDeep { .. })));
    }
}
