//! What there is to evaluate: parts of a tree as slots, and the states at which each is asked about.
//!
//! A comparison of an extreme of a window, or of a time, with a constant is one of the states in the window: it becomes
//! a window over a comparison of one state, as in the monitors.

use super::Recording;
use crate::logic::formula::{
    Aggregation, AtomId, Node, NodeId, Operation, Relation, SignalId, Term, TermId, Tree, Window, in_time,
};
use crate::logic::invalid::Invalid;
use crate::logic::reach::{Part, children_first};

/// A part; others are named by their slots.
#[derive(Clone, Debug)]
pub(in crate::logic) enum Slot {
    /// The same everywhere.
    Fixed(bool),
    /// A truth value of the state.
    Atom(AtomId),
    /// A comparison of two numbers.
    Compare(Relation, usize, usize),
    /// Not.
    Not(usize),
    /// Any (`any`) or all of some.
    Join { parts: Vec<usize>, any: bool },
    /// Any or all states of a window, up to the horizon.
    Window { from: u64, to: Option<u64>, of: usize, any: bool },
    /// The second has its value at some state of the window and the first has its own at all states before; `weak`: or the
    /// first has it up to the end of the window. Then the truth is `value`.
    Until { from: u64, to: Option<u64>, first: (usize, bool), second: (usize, bool), weak: bool, value: bool },
    /// A number that is the same everywhere.
    Number(f64),
    /// A number of the state.
    Signal(SignalId),
    /// Arithmetic.
    Combine(Operation, usize, usize),
    /// Magnitude.
    Abs(usize),
    /// An aggregate over a window.
    Aggregate { aggregation: Aggregation, from: u64, to: Option<u64>, of: usize },
    /// A number so many states later.
    Later(u64, usize),
    /// A number at the horizon.
    AtEnd(usize),
    /// Seconds until a formula holds.
    Time(usize),
}

/// All slots, children first.
pub(super) struct Graph {
    pub(super) slots: Vec<Slot>,
    /// The atom or comparison whose truth a slot is.
    pub(super) leaves: Vec<Option<NodeId>>,
    /// The first and the last state at which each is asked about.
    pub(super) ranges: Vec<Option<(u64, u64)>>,
    /// The slots of formulas and numbers.
    pub(super) nodes: Vec<Option<usize>>,
    pub(super) terms: Vec<Option<usize>>,
    /// The value of each number that is the same everywhere.
    pub(super) constants: Vec<Option<f64>>,
    horizon: u64,
    /// Whether a comparison of constants is one of each state.
    margins: bool,
}

/// The graph of a part that is asked about at the state `at`.
pub(super) fn graph(
    tree: &Tree,
    root: Part,
    at: u64,
    recording: &Recording<'_>,
    margins: bool,
) -> Result<Graph, Invalid> {
    let mut graph = Graph {
        slots: Vec::new(),
        leaves: Vec::new(),
        ranges: Vec::new(),
        nodes: vec![None; tree.nodes.len()],
        terms: vec![None; tree.terms.len()],
        constants: vec![None; tree.terms.len()],
        horizon: recording.horizon.0,
        margins,
    };
    for part in children_first(tree, root)? {
        match part {
            Part::Node(id) => {
                let slot = graph.formula(tree, id, recording)?;
                graph.nodes[id.0 as usize] = Some(slot);
            }
            Part::Term(id) => {
                let slot = graph.number(tree, id)?;
                graph.terms[id.0 as usize] = Some(slot);
            }
        }
    }
    let root = match root {
        Part::Node(id) => graph.of(id)?,
        Part::Term(id) => graph.of_term(id)?,
    };
    graph.spread(root, at);
    Ok(graph)
}

impl Graph {
    fn push(&mut self, slot: Slot, leaf: Option<NodeId>) -> usize {
        self.slots.push(slot);
        self.leaves.push(leaf);
        self.ranges.push(None);
        self.slots.len() - 1
    }

    fn of(&self, id: NodeId) -> Result<usize, Invalid> {
        self.nodes[id.0 as usize].ok_or(Invalid::Malformed)
    }

    fn of_term(&self, id: TermId) -> Result<usize, Invalid> {
        self.terms[id.0 as usize].ok_or(Invalid::Malformed)
    }

    fn formula(&mut self, tree: &Tree, id: NodeId, recording: &Recording<'_>) -> Result<usize, Invalid> {
        let ends = |w: &Window| (w.from.0, w.to.map(|to| to.0));
        let slot = match &tree.nodes[id.0 as usize] {
            Node::Constant(value) => Slot::Fixed(*value),
            Node::Atom(atom) => return Ok(self.push(Slot::Atom(*atom), Some(id))),
            Node::Compare(relation, x, y) => return self.compare(tree, id, (*relation, *x, *y), recording),
            Node::Not(x) => Slot::Not(self.of(*x)?),
            Node::Or(parts) | Node::And(parts) => {
                let any = matches!(tree.nodes[id.0 as usize], Node::Or(_));
                Slot::Join { parts: parts.iter().map(|x| self.of(*x)).collect::<Result<_, _>>()?, any }
            }
            Node::Finally(w, x) | Node::Globally(w, x) => {
                let any = matches!(tree.nodes[id.0 as usize], Node::Finally(..));
                let (from, to) = ends(w);
                Slot::Window { from, to, of: self.of(*x)?, any }
            }
            Node::Until(w, p, q) | Node::WeakUntil(w, p, q) | Node::Release(w, p, q) => {
                let value = !matches!(tree.nodes[id.0 as usize], Node::Release(..));
                let weak = matches!(tree.nodes[id.0 as usize], Node::WeakUntil(..));
                let (from, to) = ends(w);
                let (first, second) = ((self.of(*p)?, value), (self.of(*q)?, value));
                Slot::Until { from, to, first, second, weak, value }
            }
        };
        Ok(self.push(slot, None))
    }

    fn number(&mut self, tree: &Tree, id: TermId) -> Result<usize, Invalid> {
        let k = id.0 as usize;
        let constant = tree.constant(id, |x| self.constants[x.0 as usize]);
        self.constants[k] = constant;
        let slot = match (&tree.terms[k], constant) {
            (_, Some(value)) => Slot::Number(value),
            (Term::Constant(value), None) => Slot::Number(*value),
            (Term::Signal(signal), _) => Slot::Signal(*signal),
            (Term::Combine(operation, x, y), _) => {
                Slot::Combine(*operation, self.of_term(*x)?, self.of_term(*y)?)
            }
            (Term::Abs(x), _) => Slot::Abs(self.of_term(*x)?),
            (Term::Window(aggregation, w, x), _) => Slot::Aggregate {
                aggregation: *aggregation,
                from: w.from.0,
                to: w.to.map(|to| to.0),
                of: self.of_term(*x)?,
            },
            (Term::Later(by, x), _) => Slot::Later(by.0, self.of_term(*x)?),
            (Term::AtEnd(x), _) => Slot::AtEnd(self.of_term(*x)?),
            (Term::TimeUntil(goal), _) => Slot::Time(self.of(*goal)?),
        };
        Ok(self.push(slot, None))
    }

    fn compare(
        &mut self,
        tree: &Tree,
        id: NodeId,
        (relation, x, y): (Relation, TermId, TermId),
        recording: &Recording<'_>,
    ) -> Result<usize, Invalid> {
        match (self.constants[x.0 as usize], self.constants[y.0 as usize]) {
            (Some(a), Some(b)) if !self.margins => Ok(self.push(Slot::Fixed(relation.holds(a, b)), None)),
            (None, Some(c)) => self.against(tree, id, (relation, x, c), recording),
            (Some(c), None) => self.against(tree, id, (relation.flipped(), y, c), recording),
            _ => {
                let (x, y) = (self.of_term(x)?, self.of_term(y)?);
                Ok(self.push(Slot::Compare(relation, x, y), Some(id)))
            }
        }
    }

    /// A comparison with a constant looks at the states of a window or of a time one by one.
    fn against(
        &mut self,
        tree: &Tree,
        id: NodeId,
        (relation, x, c): (Relation, TermId, f64),
        recording: &Recording<'_>,
    ) -> Result<usize, Invalid> {
        use Relation::{AtLeast, AtMost, Greater, Less};
        if let (Some(x), false) = (self.constants[x.0 as usize], self.margins) {
            return Ok(self.push(Slot::Fixed(relation.holds(x, c)), None));
        }
        let Some((w, x, any)) = tree.within(relation, x) else {
            return match (&tree.terms[x.0 as usize], relation) {
                (Term::TimeUntil(goal), Less | AtMost) if !c.is_nan() => {
                    self.in_time(relation, *goal, c, recording)
                }
                (Term::TimeUntil(goal), Greater | AtLeast) if !c.is_nan() => {
                    let within = if relation == Greater { AtMost } else { Less };
                    let slot = self.in_time(within, *goal, c, recording)?;
                    Ok(self.push(Slot::Not(slot), None))
                }
                _ => {
                    let (x, c) = (self.of_term(x)?, self.push(Slot::Number(c), None));
                    Ok(self.push(Slot::Compare(relation, x, c), Some(id)))
                }
            };
        };
        let of = self.against(tree, id, (relation, x, c), recording)?;
        Ok(self.push(Slot::Window { from: w.from.0, to: w.to.map(|to| to.0), of, any }, None))
    }

    /// The time until a goal is less than `c` seconds, or at most: finally, within the states that are in time.
    fn in_time(
        &mut self,
        within: Relation,
        goal: NodeId,
        c: f64,
        recording: &Recording<'_>,
    ) -> Result<usize, Invalid> {
        if within.holds(f64::INFINITY, c) {
            return Ok(self.push(Slot::Fixed(true), None));
        }
        let of = self.of(goal)?;
        let slot = match in_time(within, c, recording.clock, self.horizon) {
            None => Slot::Fixed(false),
            to => Slot::Window { from: 0, to, of, any: true },
        };
        Ok(self.push(slot, None))
    }

    /// The last state of a window, which ends at the horizon.
    pub(super) fn end(&self, at: u64, to: Option<u64>) -> u64 {
        to.map_or(self.horizon, |to| at.saturating_add(to).min(self.horizon))
    }

    /// Where all slots are asked about, if `root` is at the state `at`.
    fn spread(&mut self, root: usize, at: u64) {
        self.ranges[root] = Some((at, at));
        for slot in (0..=root).rev() {
            let Some((lo, hi)) = self.ranges[slot] else { continue };
            let window = |from: u64, to| (lo.saturating_add(from), self.end(hi, to));
            let asked: Vec<(usize, (u64, u64))> = match &self.slots[slot] {
                Slot::Fixed(_) | Slot::Atom(_) | Slot::Number(_) | Slot::Signal(_) => Vec::new(),
                Slot::Compare(_, x, y) | Slot::Combine(_, x, y) => vec![(*x, (lo, hi)), (*y, (lo, hi))],
                Slot::Not(x) | Slot::Abs(x) => vec![(*x, (lo, hi))],
                Slot::Join { parts, .. } => parts.iter().map(|x| (*x, (lo, hi))).collect(),
                Slot::Window { from, to, of, .. } | Slot::Aggregate { from, to, of, .. } => {
                    vec![(*of, window(*from, *to))]
                }
                Slot::Until { from, to, first, second, .. } => {
                    vec![(first.0, window(0, *to)), (second.0, window(*from, *to))]
                }
                Slot::Later(by, x) => vec![(*x, window(*by, Some(*by)))],
                Slot::AtEnd(x) => vec![(*x, (self.horizon, self.horizon))],
                Slot::Time(x) => vec![(*x, (lo, self.horizon))],
            };
            for (child, (lo, hi)) in asked {
                let range = &mut self.ranges[child];
                *range = Some(range.map_or((lo, hi), |(a, b)| (a.min(lo), b.max(hi))));
            }
        }
    }
}
