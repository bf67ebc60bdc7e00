//! The definition, written down plainly: what a formula or number is at a position of a trace of which
//! some first states have been seen. What is not known is open; connectives are Kleene's, bounded
//! operators are unfolded. Nothing is remembered, nothing is clever.

use smc::base::tick::Tick;
use smc::logic::{
    Aggregation, AtomId, Node, NodeId, Operation, Relation, SignalId, Term, TermId, Tree, Window,
};

/// A trace and how much of it has been seen.
pub(crate) struct Prefix<'a> {
    pub(crate) tree: &'a Tree,
    /// Truth of each atom in each state.
    pub(crate) atoms: &'a [Vec<bool>],
    /// Each signal in each state.
    pub(crate) signals: &'a [Vec<f64>],
    /// Number of states seen.
    pub(crate) seen: u64,
    pub(crate) horizon: u64,
    pub(crate) seconds: f64,
    /// If given, no other atoms are known than these at these states.
    pub(crate) known: Option<&'a dyn Fn(u32, u64) -> bool>,
}

/// All true, some false, else open.
fn all(values: impl Iterator<Item = Option<bool>>) -> Option<bool> {
    let mut result = Some(true);
    for value in values {
        match value {
            Some(false) => return Some(false),
            None => result = None,
            Some(true) => {}
        }
    }
    result
}

fn any(values: impl Iterator<Item = Option<bool>>) -> Option<bool> {
    all(values.map(|value| value.map(|v| !v))).map(|v| !v)
}

pub(crate) fn related(relation: Relation, x: f64, y: f64) -> bool {
    match relation {
        Relation::Less => x < y,
        Relation::AtMost => x <= y,
        Relation::Greater => x > y,
        Relation::AtLeast => x >= y,
        Relation::Equal => x == y,
        Relation::Unequal => x != y && !x.is_nan() && !y.is_nan(),
    }
}

fn mirrored(relation: Relation) -> Relation {
    match relation {
        Relation::Less => Relation::Greater,
        Relation::AtMost => Relation::AtLeast,
        Relation::Greater => Relation::Less,
        Relation::AtLeast => Relation::AtMost,
        same => same,
    }
}

impl Prefix<'_> {
    fn states(&self, window: Window, at: u64) -> std::ops::RangeInclusive<u64> {
        at + window.from.0..=window.to.map_or(self.horizon, |to| at + to.0)
    }

    pub(crate) fn truth(&self, node: NodeId, at: u64) -> Option<bool> {
        match &self.tree.nodes[node.0 as usize] {
            Node::Constant(value) => Some(*value),
            Node::Atom(AtomId(k)) => {
                let known = at < self.seen && self.known.is_none_or(|known| known(*k, at));
                known.then(|| self.atoms[*k as usize][at as usize])
            }
            Node::Compare(relation, x, y) => self.compare(*relation, *x, *y, at),
            Node::Not(x) => self.truth(*x, at).map(|v| !v),
            Node::And(parts) => all(parts.iter().map(|x| self.truth(*x, at))),
            Node::Or(parts) => any(parts.iter().map(|x| self.truth(*x, at))),
            Node::Finally(w, x) => any(self.states(*w, at).map(|k| self.truth(*x, k))),
            Node::Globally(w, x) => all(self.states(*w, at).map(|k| self.truth(*x, k))),
            Node::Until(w, p, q) => self.until(*w, |k| self.truth(*p, k), |k| self.truth(*q, k), at),
            Node::WeakUntil(w, p, q) => {
                let end = *self.states(*w, at).end();
                let always = all((at..=end).map(|k| self.truth(*p, k)));
                any([self.until(*w, |k| self.truth(*p, k), |k| self.truth(*q, k), at), always].into_iter())
            }
            Node::Release(w, p, q) => {
                let not = |x: Option<bool>| x.map(|v| !v);
                not(self.until(*w, |k| not(self.truth(*p, k)), |k| not(self.truth(*q, k)), at))
            }
        }
    }

    fn until(
        &self,
        w: Window,
        first: impl Fn(u64) -> Option<bool>,
        second: impl Fn(u64) -> Option<bool>,
        at: u64,
    ) -> Option<bool> {
        any(self.states(w, at).map(|k| all(std::iter::once(second(k)).chain((at..k).map(&first)))))
    }

    /// What does not depend on any state.
    fn constant(&self, term: TermId) -> Option<f64> {
        match &self.tree.terms[term.0 as usize] {
            Term::Constant(value) => Some(*value),
            Term::Combine(operation, x, y) => {
                Some(combined(*operation, self.constant(*x)?, self.constant(*y)?))
            }
            Term::Abs(x) => self.constant(*x).map(f64::abs),
            Term::Later(_, x) | Term::AtEnd(x) => self.constant(*x),
            _ => None,
        }
    }

    fn compare(&self, relation: Relation, x: TermId, y: TermId, at: u64) -> Option<bool> {
        match (self.constant(x), self.constant(y)) {
            (None, Some(c)) => self.against(relation, x, c, at),
            (Some(c), None) => self.against(mirrored(relation), y, c, at),
            _ => Some(related(relation, self.number(x, at)?, self.number(y, at)?)),
        }
    }

    /// Comparisons of extremes of windows and of times with a constant look at each state.
    fn against(&self, relation: Relation, x: TermId, c: f64, at: u64) -> Option<bool> {
        use Relation::{AtLeast, AtMost, Greater, Less};
        if let Some(x) = self.constant(x) {
            return Some(related(relation, x, c));
        }
        match (&self.tree.terms[x.0 as usize], relation) {
            (Term::Later(by, x), _) => self.against(relation, *x, c, at + by.0),
            (Term::Window(Aggregation::Min, w, x), Less | AtMost)
            | (Term::Window(Aggregation::Max, w, x), Greater | AtLeast) => {
                any(self.states(*w, at).map(|k| self.against(relation, *x, c, k)))
            }
            (Term::Window(Aggregation::Min, w, x), Greater | AtLeast)
            | (Term::Window(Aggregation::Max, w, x), Less | AtMost) => {
                all(self.states(*w, at).map(|k| self.against(relation, *x, c, k)))
            }
            (Term::TimeUntil(goal), Less | AtMost) => {
                let in_time = |k: u64| related(relation, (k - at) as f64 * self.seconds, c);
                let never = related(relation, f64::INFINITY, c);
                any((at..=self.horizon)
                    .filter(|k| in_time(*k))
                    .map(|k| self.truth(*goal, k))
                    .chain(never.then_some(Some(true))))
            }
            (Term::TimeUntil(_), Greater) => self.against(AtMost, x, c, at).map(|v| !v),
            (Term::TimeUntil(_), AtLeast) => self.against(Less, x, c, at).map(|v| !v),
            _ => Some(related(relation, self.number(x, at)?, c)),
        }
    }

    pub(crate) fn number(&self, term: TermId, at: u64) -> Option<f64> {
        if let Some(value) = self.constant(term) {
            return Some(value);
        }
        match &self.tree.terms[term.0 as usize] {
            Term::Constant(value) => Some(*value),
            Term::Signal(SignalId(k)) => (at < self.seen).then(|| self.signals[*k as usize][at as usize]),
            Term::Combine(operation, x, y) => {
                Some(combined(*operation, self.number(*x, at)?, self.number(*y, at)?))
            }
            Term::Abs(x) => self.number(*x, at).map(f64::abs),
            Term::Window(Aggregation::First, w, x) => {
                let finite = |k: u64| self.number(*x, k).filter(|v| v.is_finite());
                let states = self.states(*w, at);
                let is_complete = *states.end() < self.seen;
                states
                    .take_while(|k| *k < self.seen)
                    .find_map(finite)
                    .or(is_complete.then_some(f64::INFINITY))
            }
            Term::Window(aggregation, w, x) => {
                let states = self.states(*w, at);
                // A window is complete when its last state has been seen.
                if *states.end() >= self.seen {
                    return None;
                }
                let count = states.clone().count();
                let numbers: Option<Vec<f64>> = states.map(|k| self.number(*x, k)).collect();
                let numbers = numbers?;
                let reduced = |by: Aggregation| {
                    numbers.iter().copied().reduce(|a, b| match by {
                        Aggregation::Min | Aggregation::First => combined(Operation::Min, a, b),
                        Aggregation::Max => combined(Operation::Max, a, b),
                        Aggregation::Sum | Aggregation::Mean => a + b,
                    })
                };
                let value = reduced(*aggregation)?;
                if *aggregation == Aggregation::Mean {
                    // A mean lies between the least and the greatest value that it averages.
                    let below = combined(Operation::Min, value / count as f64, reduced(Aggregation::Max)?);
                    return Some(combined(Operation::Max, below, reduced(Aggregation::Min)?));
                }
                Some(value)
            }
            Term::Later(Tick(by), x) => self.number(*x, at + by),
            Term::AtEnd(x) => self.number(*x, self.horizon),
            Term::TimeUntil(goal) => {
                for k in at..=self.horizon {
                    if self.truth(*goal, k)? {
                        return Some((k - at) as f64 * self.seconds);
                    }
                }
                Some(f64::INFINITY)
            }
        }
    }
}

fn combined(operation: Operation, x: f64, y: f64) -> f64 {
    match operation {
        Operation::Add => x + y,
        Operation::Subtract => x - y,
        Operation::Multiply => x * y,
        Operation::Divide => x / y,
        _ if x.is_nan() || y.is_nan() => f64::NAN,
        Operation::Min => {
            if y < x {
                y
            } else {
                x
            }
        }
        Operation::Max => {
            if y > x {
                y
            } else {
                x
            }
        }
    }
}

/// What a formula of a whole trace is, two-valued and without unfolding anything: a second definition.
pub(crate) fn holds(tree: &Tree, node: NodeId, atoms: &[Vec<bool>], at: u64, horizon: u64) -> bool {
    let is = |x: &NodeId, k: u64| holds(tree, *x, atoms, k, horizon);
    let end = |w: &Window| w.to.map_or(horizon, |to| at + to.0);
    match &tree.nodes[node.0 as usize] {
        Node::Constant(value) => *value,
        Node::Atom(AtomId(k)) => atoms[*k as usize][at as usize],
        Node::Compare(..) => unreachable!("truth of atoms alone"),
        Node::Not(x) => !is(x, at),
        Node::And(parts) => parts.iter().all(|x| is(x, at)),
        Node::Or(parts) => parts.iter().any(|x| is(x, at)),
        Node::Finally(w, x) => (at + w.from.0..=end(w)).any(|k| is(x, k)),
        Node::Globally(w, x) => (at + w.from.0..=end(w)).all(|k| is(x, k)),
        Node::Until(w, p, q) | Node::WeakUntil(w, p, q) => {
            for k in at..=end(w) {
                if k >= at + w.from.0 && is(q, k) {
                    return true;
                }
                if k < end(w) && !is(p, k) {
                    return false;
                }
            }
            matches!(&tree.nodes[node.0 as usize], Node::WeakUntil(..)) && is(p, end(w))
        }
        Node::Release(w, p, q) => {
            for k in at..=end(w) {
                if k >= at + w.from.0 && !is(q, k) {
                    return false;
                }
                if k < end(w) && is(p, k) {
                    return true;
                }
            }
            true
        }
    }
}
