//! The definitions, written plainly: a signal is looked at as a row of places, of which the even ones are the instants
//! 0, 1, 2, … ticks and the odd ones the open intervals between them. Jumps, bounds and everything else
//! that can happen lie on whole ticks, so every truth is constant on every place, and unions of intervals
//! with open or closed ends are exactly the sets of places.
//!
//! Places from `seen` on are not known: Kleene's connectives say what is forced.

use smc::logic::{Aggregation, Node, NodeId, Relation, Term, TermId, Tree, Window};

/// The values from a tick on.
#[derive(Clone, Debug)]
pub(crate) struct Jump {
    pub(crate) at: u64,
    pub(crate) atoms: Vec<bool>,
    pub(crate) signals: Vec<f64>,
}

/// The first places of a trial, of which one second is one tick.
pub(crate) struct Signal<'a> {
    pub(crate) tree: &'a Tree,
    /// In order; of jumps at one time the last one counts. The first is at 0.
    pub(crate) jumps: &'a [Jump],
    /// In ticks.
    pub(crate) horizon: u64,
    pub(crate) seen: u64,
}

fn any(values: impl Iterator<Item = Option<bool>>) -> Option<bool> {
    let mut open = false;
    for value in values {
        match value {
            Some(true) => return Some(true),
            None => open = true,
            Some(false) => {}
        }
    }
    (!open).then_some(false)
}

fn all(values: impl Iterator<Item = Option<bool>>) -> Option<bool> {
    not(any(values.map(not)))
}

fn not(value: Option<bool>) -> Option<bool> {
    value.map(|value| !value)
}

/// An instant of a place: itself, or the middle of the interval.
fn time(place: u64) -> f64 {
    place as f64 / 2.0
}

impl Signal<'_> {
    fn state(&self, place: u64) -> Option<&Jump> {
        let known = place < self.seen;
        known.then(|| self.jumps.iter().rfind(|jump| jump.at <= place / 2).expect("the first is at 0"))
    }

    fn window(&self, w: Window, place: u64) -> std::ops::RangeInclusive<u64> {
        place + 2 * w.from.0..=w.to.map_or(2 * self.horizon, |to| place + 2 * to.0)
    }

    pub(crate) fn truth(&self, id: NodeId, at: u64) -> Option<bool> {
        match &self.tree.nodes[id.0 as usize] {
            Node::Constant(truth) => Some(*truth),
            Node::Atom(atom) => self.state(at).map(|state| state.atoms[atom.0 as usize]),
            Node::Compare(relation, x, y) => self.compare(*relation, *x, *y, at),
            Node::Not(x) => not(self.truth(*x, at)),
            Node::And(parts) => all(parts.iter().map(|x| self.truth(*x, at))),
            Node::Or(parts) => any(parts.iter().map(|x| self.truth(*x, at))),
            Node::Finally(w, x) => any(self.window(*w, at).map(|k| self.truth(*x, k))),
            Node::Globally(w, x) => all(self.window(*w, at).map(|k| self.truth(*x, k))),
            Node::Until(w, p, q) => self.until(*w, (*p, true), (*q, true), at),
            Node::Release(w, p, q) => not(self.until(*w, (*p, false), (*q, false), at)),
            Node::WeakUntil(w, p, q) => {
                let until = self.until(*w, (*p, true), (*q, true), at);
                let mut end = at..=*self.window(*w, at).end();
                any([until, all(end.by_ref().map(|k| self.truth(*p, k)))].into_iter())
            }
        }
    }

    fn until(&self, w: Window, p: (NodeId, bool), q: (NodeId, bool), at: u64) -> Option<bool> {
        let is = |(id, truth): (NodeId, bool), k| self.truth(id, k).map(|found| found == truth);
        any(self.window(w, at).map(|goal| {
            // Strictly inside an interval that begins later, some of it lies before the goal.
            let before = if goal % 2 == 1 && goal > at { at..goal + 1 } else { at..goal };
            let mut before = before.map(|k| is(p, k));
            all([is(q, goal), all(before.by_ref())].into_iter())
        }))
    }

    fn constant(&self, id: TermId) -> Option<f64> {
        match &self.tree.terms[id.0 as usize] {
            Term::Constant(value) => Some(*value),
            Term::Combine(operation, x, y) => Some(operation.apply(self.constant(*x)?, self.constant(*y)?)),
            Term::Abs(x) => self.constant(*x).map(f64::abs),
            Term::Later(_, x) | Term::AtEnd(x) => self.constant(*x),
            _ => None,
        }
    }

    fn compare(&self, relation: Relation, x: TermId, y: TermId, at: u64) -> Option<bool> {
        match (self.constant(x), self.constant(y)) {
            (None, Some(c)) => self.against(relation, x, c, at),
            (Some(c), None) => self.against(relation.flipped(), y, c, at),
            _ => Some(relation.holds(self.number(x, at)?, self.number(y, at)?)),
        }
    }

    /// A comparison with a constant: extremes and times moment by moment.
    fn against(&self, relation: Relation, x: TermId, c: f64, at: u64) -> Option<bool> {
        use Relation::{AtLeast, AtMost, Equal, Greater, Less, Unequal};
        if let Some(x) = self.constant(x) {
            return Some(relation.holds(x, c));
        }
        let each = |w: Window, x: TermId| self.window(w, at).map(move |k| self.against(relation, x, c, k));
        match (&self.tree.terms[x.0 as usize], relation) {
            (Term::Later(by, x), _) => self.against(relation, *x, c, at + 2 * by.0),
            (Term::AtEnd(x), _) => self.against(relation, *x, c, 2 * self.horizon),
            (Term::Window(Aggregation::Min, w, x), Less | AtMost)
            | (Term::Window(Aggregation::Max, w, x), Greater | AtLeast) => any(each(*w, *x)),
            (Term::Window(Aggregation::Min, w, x), Greater | AtLeast)
            | (Term::Window(Aggregation::Max, w, x), Less | AtMost) => all(each(*w, *x)),
            (Term::Window(Aggregation::Mean, w, of), _) => {
                let parts = self.parts(*w, *of, at)?;
                let excess = parts.iter().map(|(value, length)| (value - c, *length));
                let whole = |(excess, length): (f64, u64)| {
                    excess
                        .is_finite()
                        .then_some((excess * (1_u128 << 90) as f64) as i128 * i128::from(length))
                };
                // Whole numbers of the last bit of any decimal here, so that the sign is exact.
                match excess.map(whole).sum::<Option<i128>>() {
                    Some(sum) => Some(relation.holds(sum.signum() as f64, 0.0)),
                    None => Some(relation.holds(self.number(x, at)?, c)),
                }
            }
            (Term::TimeUntil(goal), _) => {
                let within = |relation: Relation| {
                    let mut late = (at..=2 * self.horizon).filter(|&k| {
                        let wait = if k == at { 0.0 } else { time(k - k % 2) - time(at) };
                        relation.holds(wait, c)
                    });
                    any(late.by_ref().map(|k| self.truth(*goal, k)))
                };
                match relation {
                    Less | AtMost => within(relation),
                    Greater => not(within(AtMost)),
                    AtLeast => not(within(Less)),
                    Equal => all([within(AtMost), not(within(Less))].into_iter()),
                    Unequal => any([not(within(AtMost)), within(Less)].into_iter()),
                }
            }
            _ => Some(relation.holds(self.number(x, at)?, c)),
        }
    }

    /// The values of a window and for how many half ticks each lasts; of a window of one instant, the value there.
    fn parts(&self, w: Window, x: TermId, at: u64) -> Option<Vec<(f64, u64)>> {
        let places = self.window(w, at);
        let (first, last) = (*places.start(), *places.end());
        let values: Option<Vec<f64>> = places.clone().map(|k| self.number(x, k)).collect();
        // An interval counts as far as it lies between the ends.
        let length = |k: u64| if k % 2 == 1 { (k + 1).min(last) - (k - 1).max(first) } else { 0 };
        let alone = |k: u64| if first == last { 1 } else { length(k) };
        let parts = places.zip(values?).map(|(k, value)| (value, alone(k)));
        Some(parts.filter(|part| part.1 > 0).collect())
    }

    pub(crate) fn number(&self, id: TermId, at: u64) -> Option<f64> {
        match &self.tree.terms[id.0 as usize] {
            Term::Constant(value) => Some(*value),
            Term::Signal(signal) => self.state(at).map(|state| state.signals[signal.0 as usize]),
            Term::Combine(operation, x, y) => {
                let known = self.constant(id);
                known.or_else(|| Some(operation.apply(self.number(*x, at)?, self.number(*y, at)?)))
            }
            Term::Abs(x) => self.number(*x, at).map(f64::abs),
            Term::Later(by, x) => self.number(*x, at + 2 * by.0),
            Term::AtEnd(x) => self.number(*x, 2 * self.horizon),
            Term::TimeUntil(goal) => {
                for k in at..=2 * self.horizon {
                    if self.truth(*goal, k)? {
                        return Some(if k == at { 0.0 } else { time(k - k % 2) - time(at) });
                    }
                }
                Some(f64::INFINITY)
            }
            Term::Window(Aggregation::Mean, w, x) => {
                let parts = self.parts(*w, *x, at)?;
                let (sum, time) = parts.iter().fold((0.0, 0), |(sum, time), (value, length)| {
                    (sum + value * *length as f64, time + length)
                });
                let least = parts.iter().map(|part| part.0).fold(f64::INFINITY, f64::min);
                let most = parts.iter().map(|part| part.0).fold(f64::NEG_INFINITY, f64::max);
                Some((sum / time as f64).min(most).max(least))
            }
            Term::Window(aggregation, w, x) => {
                let values: Option<Vec<f64>> = self.window(*w, at).map(|k| self.number(*x, k)).collect();
                let values = values?;
                Some(match aggregation {
                    Aggregation::Min | Aggregation::First => values.into_iter().reduce(f64::min)?,
                    Aggregation::Max => values.into_iter().reduce(f64::max)?,
                    Aggregation::Sum | Aggregation::Mean => panic!("no sum in continuous time"),
                })
            }
        }
    }
}
