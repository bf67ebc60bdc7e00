//! Formulas and metrics of bounded linear temporal logic (BLTL).
//!
//! Given-Wilson et al. 2017, equation (7), with intervals, weak until, release, and numbers of windows.
//! A tree holds both kinds of nodes; children stand before their parents.

use crate::base::tick::{Clock, Tick};
use std::hash::{Hash, Hasher};

/// Index of a truth value that the observer supplies for each state.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct AtomId(pub u32);

/// Index of a number that the observer supplies for each state.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct SignalId(pub u32);

/// Index of a formula node.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct NodeId(pub u32);

/// Index of a numeric node.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct TermId(pub u32);

/// The states `from ..= to` after the present one, both ends included. `to: None` ranges over the
/// states up to the horizon.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Window {
    /// First state.
    pub from: Tick,
    /// Last state.
    pub to: Option<Tick>,
}

/// A formula over the states from the present one on.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Node {
    /// The same everywhere.
    Constant(bool),
    /// A truth value of the present state.
    Atom(AtomId),
    /// Comparison of two numbers, false where a side is not a number.
    Compare(Relation, TermId, TermId),
    /// Not.
    Not(NodeId),
    /// All of them; true if there are none.
    And(Vec<NodeId>),
    /// Any of them; false if there are none.
    Or(Vec<NodeId>),
    /// It holds at some state of the window.
    Finally(Window, NodeId),
    /// It holds at every state of the window.
    Globally(Window, NodeId),
    /// The second holds at some state of the window, and the first at every state before that, from the
    /// present one on.
    Until(Window, NodeId, NodeId),
    /// Until, or the first holds at every state up to the end of the window.
    WeakUntil(Window, NodeId, NodeId),
    /// The second holds at every state of the window up to and including the first state at which the
    /// first holds (which counts from the present state on): not (not first until not second).
    Release(Window, NodeId, NodeId),
}

impl Node {
    /// The same operator over other formulas, in order.
    #[must_use]
    pub fn map(self, mut of: impl FnMut(NodeId) -> NodeId) -> Self {
        match self {
            Self::Constant(_) | Self::Atom(_) | Self::Compare(..) => self,
            Self::Not(x) => Self::Not(of(x)),
            Self::And(all) => Self::And(all.into_iter().map(of).collect()),
            Self::Or(all) => Self::Or(all.into_iter().map(of).collect()),
            Self::Finally(window, x) => Self::Finally(window, of(x)),
            Self::Globally(window, x) => Self::Globally(window, of(x)),
            Self::Until(window, p, q) => Self::Until(window, of(p), of(q)),
            Self::WeakUntil(window, p, q) => Self::WeakUntil(window, of(p), of(q)),
            Self::Release(window, p, q) => Self::Release(window, of(p), of(q)),
        }
    }
}

/// Relations of a comparison.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Relation {
    /// `<`
    Less,
    /// `<=`
    AtMost,
    /// `>`
    Greater,
    /// `>=`
    AtLeast,
    /// `==`
    Equal,
    /// `!=`
    Unequal,
}

impl Relation {
    /// Whether the relation holds; none holds of what is no number.
    #[inline(always)]
    pub fn holds(self, x: f64, y: f64) -> bool {
        match self {
            Self::Less => x < y,
            Self::AtMost => x <= y,
            Self::Greater => x > y,
            Self::AtLeast => x >= y,
            Self::Equal => x == y,
            Self::Unequal => !(x.is_nan() || y.is_nan()) && x != y,
        }
    }

    /// The margin of `x r y`: how far the sides may move before the comparison changes; none (NaN) if a side is none.
    #[inline]
    pub fn margin(self, x: f64, y: f64) -> f64 {
        // Two equal infinities are no distance apart.
        let less = |x: f64, y: f64| if x == y { 0.0 } else { x - y };
        match self {
            Self::Less | Self::AtMost => less(y, x),
            Self::Greater | Self::AtLeast => less(x, y),
            Self::Equal => -less(x, y).abs(),
            Self::Unequal => less(x, y).abs(),
        }
    }

    /// The relation with its sides exchanged.
    pub fn flipped(self) -> Self {
        match self {
            Self::Less => Self::Greater,
            Self::AtMost => Self::AtLeast,
            Self::Greater => Self::Less,
            Self::AtLeast => Self::AtMost,
            Self::Equal | Self::Unequal => self,
        }
    }
}

/// Aggregates over a window.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Aggregation {
    /// Smallest.
    Min,
    /// Largest.
    Max,
    /// Sum over the states.
    Sum,
    /// Mean over the states.
    Mean,
    /// The first finite number, of numbers that stay once they are; infinite if there is none.
    First,
}

/// Arithmetic of two numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Operation {
    /// Sum.
    Add,
    /// Difference.
    Subtract,
    /// Product.
    Multiply,
    /// Quotient.
    Divide,
    /// Smaller.
    Min,
    /// Larger.
    Max,
}

impl Operation {
    /// The result; none (NaN) if a side is none, also of the smaller and the larger.
    #[inline(always)]
    pub fn apply(self, x: f64, y: f64) -> f64 {
        match self {
            Self::Add => x + y,
            Self::Subtract => x - y,
            Self::Multiply => x * y,
            Self::Divide => x / y,
            Self::Min => {
                if y < x || y.is_nan() {
                    y
                } else {
                    x
                }
            }
            Self::Max => {
                if y > x || y.is_nan() {
                    y
                } else {
                    x
                }
            }
        }
    }
}

/// A mean that rounding may have moved, brought back between the least and the greatest value that it averages; none (NaN)
/// if one is none.
#[inline(always)]
pub(super) fn bracket(mean: f64, least: f64, most: f64) -> f64 {
    Operation::Max.apply(Operation::Min.apply(mean, most), least)
}

/// The last tick, of those up to `most`, whose time is less than `c`, or at most; none where the first is too late.
pub(super) fn in_time(relation: Relation, c: f64, clock: Clock, most: u64) -> Option<u64> {
    last_tick(most, |ticks| relation.holds(clock.seconds(Tick(ticks)), c))
}

/// The last tick, of those up to `most`, that is in time, by bisection; none where the first is not.
pub(super) fn last_tick(most: u64, is_in_time: impl Fn(u64) -> bool) -> Option<u64> {
    let (mut count, mut beyond) = (0, most + 1);
    while count < beyond {
        let middle = count + (beyond - count) / 2;
        if is_in_time(middle) { count = middle + 1 } else { beyond = middle }
    }
    count.checked_sub(1)
}

/// A number of the states from the present one on.
#[derive(Clone, Debug, PartialEq)]
pub enum Term {
    /// The same everywhere.
    Constant(f64),
    /// A number of the present state.
    Signal(SignalId),
    /// Arithmetic.
    Combine(Operation, TermId, TermId),
    /// Magnitude.
    Abs(TermId),
    /// An aggregate over the states of a window.
    Window(Aggregation, Window, TermId),
    /// The number at the state so many ticks later.
    Later(Tick, TermId),
    /// The number at the last state, which is the one at the horizon.
    AtEnd(TermId),
    /// Seconds until the formula first holds, counted from the present state; infinite if it never does
    /// up to the horizon.
    TimeUntil(NodeId),
}

impl Term {
    /// The same operator over other numbers, in order.
    #[must_use]
    pub fn map(self, mut of: impl FnMut(TermId) -> TermId) -> Self {
        match self {
            Self::Constant(_) | Self::Signal(_) | Self::TimeUntil(_) => self,
            Self::Combine(operation, x, y) => Self::Combine(operation, of(x), of(y)),
            Self::Abs(x) => Self::Abs(of(x)),
            Self::Window(aggregation, window, x) => Self::Window(aggregation, window, of(x)),
            Self::Later(by, x) => Self::Later(by, of(x)),
            Self::AtEnd(x) => Self::AtEnd(of(x)),
        }
    }
}

impl Hash for Term {
    fn hash<H: Hasher>(&self, state: &mut H) {
        std::mem::discriminant(self).hash(state);
        match self {
            // The two zeros are equal.
            Self::Constant(value) => (value + 0.0).to_bits().hash(state),
            Self::Signal(signal) => signal.hash(state),
            Self::Combine(operation, x, y) => (operation, x, y).hash(state),
            Self::Abs(x) | Self::AtEnd(x) => x.hash(state),
            Self::Window(aggregation, window, x) => (aggregation, window, x).hash(state),
            Self::Later(by, x) => (by, x).hash(state),
            Self::TimeUntil(goal) => goal.hash(state),
        }
    }
}

/// A formula or metric with all its parts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tree {
    /// Formula nodes; children before parents.
    pub nodes: Vec<Node>,
    /// Numeric nodes; children before parents.
    pub terms: Vec<Term>,
}

impl Tree {
    /// The value of a number that is the same everywhere; `of` has the values of its operands.
    pub(super) fn constant(&self, id: TermId, of: impl Fn(&TermId) -> Option<f64>) -> Option<f64> {
        match &self.terms[id.0 as usize] {
            Term::Constant(value) => Some(*value),
            Term::Combine(operation, x, y) => Some(operation.apply(of(x)?, of(y)?)),
            Term::Abs(x) => of(x).map(f64::abs),
            Term::Later(_, x) | Term::AtEnd(x) => of(x),
            Term::Signal(_) | Term::Window(..) | Term::TimeUntil(_) => None,
        }
    }

    /// The left side of an implication: `a => b` is lowered to `!a | b`.
    pub(super) fn antecedent(&self, id: NodeId) -> Option<NodeId> {
        let Node::Or(parts) = &self.nodes[id.0 as usize] else { return None };
        let [first, _] = parts.as_slice() else { return None };
        let Node::Not(antecedent) = self.nodes[first.0 as usize] else { return None };
        Some(antecedent)
    }

    /// A comparison of an extreme of a window, or of a later number, with a constant is one of the number inside: at some
    /// state of the window, or (false) at all.
    pub(super) fn within(&self, relation: Relation, x: TermId) -> Option<(Window, TermId, bool)> {
        let is_upper = matches!(relation, Relation::Less | Relation::AtMost);
        let is_lower = matches!(relation, Relation::Greater | Relation::AtLeast);
        match &self.terms[x.0 as usize] {
            Term::Later(by, x) => Some((Window { from: *by, to: Some(*by) }, *x, true)),
            Term::Window(Aggregation::Min, w, x) if is_upper || is_lower => Some((*w, *x, is_upper)),
            Term::Window(Aggregation::Max, w, x) if is_upper || is_lower => Some((*w, *x, is_lower)),
            _ => None,
        }
    }

    /// Whether a number is a time until something, or made of one.
    pub fn is_time_until(&self, term: TermId) -> bool {
        match &self.terms[term.0 as usize] {
            Term::TimeUntil(_) => true,
            Term::Constant(_) | Term::Signal(_) => false,
            Term::Combine(_, a, b) => self.is_time_until(*a) || self.is_time_until(*b),
            Term::Abs(a) | Term::Window(_, _, a) | Term::Later(_, a) | Term::AtEnd(a) => {
                self.is_time_until(*a)
            }
        }
    }

    /// Adds a formula node.
    pub fn node(&mut self, node: Node) -> NodeId {
        self.nodes.push(node);
        NodeId(self.nodes.len() as u32 - 1)
    }

    /// Adds a numeric node.
    pub fn term(&mut self, term: Term) -> TermId {
        self.terms.push(term);
        TermId(self.terms.len() as u32 - 1)
    }
}
