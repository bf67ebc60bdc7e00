//! Parts of the present state alone, parts that are the same everywhere, and questions that need no cells.

use super::super::direct::{Direct, Probe, Question};
use super::super::present::Code;
use super::Builder;
use crate::base::tick::Tick;
use crate::logic::formula::{Aggregation, Node, NodeId, Relation, Term, TermId, Window};
use crate::logic::reach::Part;

impl Builder<'_> {
    /// Notes whether a part is the same everywhere, or is one of the present state alone. Children come
    /// first.
    pub(super) fn note(&mut self, part: Part) {
        match part {
            Part::Node(id) => {
                let k = id.0 as usize;
                self.node_constants[k] = self.constant(id);
                if self.node_constants[k].is_none() {
                    self.node_slots[k] = self.node_code(id).map(|code| self.present.add(code));
                }
            }
            Part::Term(id) => {
                let k = id.0 as usize;
                self.term_constants[k] = self.constant_number(id);
                let code = match self.term_constants[k] {
                    Some(value) => Some(Code::Number(value)),
                    None => self.term_code(id),
                };
                self.term_slots[k] = code.map(|code| self.present.add(code));
            }
        }
    }

    fn constant(&self, id: NodeId) -> Option<bool> {
        let of = |id: &NodeId| self.node_constants[id.0 as usize];
        match &self.tree.nodes[id.0 as usize] {
            Node::Constant(truth) => Some(*truth),
            Node::Compare(relation, x, y) if !self.margins => {
                Some(relation.holds(self.term_constants[x.0 as usize]?, self.term_constants[y.0 as usize]?))
            }
            Node::Not(x) => of(x).map(|truth| !truth),
            Node::And(all) if all.iter().any(|x| of(x) == Some(false)) => Some(false),
            Node::And(all) => all.iter().all(|x| of(x) == Some(true)).then_some(true),
            Node::Or(all) if all.iter().any(|x| of(x) == Some(true)) => Some(true),
            Node::Or(all) => all.iter().all(|x| of(x) == Some(false)).then_some(false),
            _ => None,
        }
    }

    fn constant_number(&self, id: TermId) -> Option<f64> {
        let of = |id: &TermId| self.term_constants[id.0 as usize];
        match &self.tree.terms[id.0 as usize] {
            Term::Constant(value) => Some(*value),
            Term::Combine(operation, x, y) => Some(operation.apply(of(x)?, of(y)?)),
            Term::Abs(x) => of(x).map(f64::abs),
            Term::Later(_, x) | Term::AtEnd(x) => of(x),
            Term::Signal(_) | Term::Window(..) | Term::TimeUntil(_) => None,
        }
    }

    fn node_code(&self, id: NodeId) -> Option<Code> {
        let slot = |id: &NodeId| self.node_slots[id.0 as usize];
        let all = |parts: &[NodeId]| {
            let open = parts.iter().filter(|x| self.node_constants[x.0 as usize].is_none());
            open.map(slot).collect::<Option<Box<[usize]>>>()
        };
        match &self.tree.nodes[id.0 as usize] {
            Node::Atom(atom) => Some(Code::Atom(atom.0 as usize)),
            // Its margin is known in states to come.
            Node::Compare(_, x, y)
                if self.margins
                    && [x, y].map(|x| self.term_constants[x.0 as usize]).iter().all(Option::is_some) =>
            {
                None
            }
            Node::Compare(relation, x, y) => {
                Some(Code::Compare(*relation, self.term_slots[x.0 as usize]?, self.term_slots[y.0 as usize]?))
            }
            Node::Not(x) => slot(x).map(Code::Not),
            Node::And(parts) => all(parts).map(Code::All),
            Node::Or(parts) => all(parts).map(Code::Any),
            _ => None,
        }
    }

    fn term_code(&self, id: TermId) -> Option<Code> {
        let slot = |id: &TermId| self.term_slots[id.0 as usize];
        match &self.tree.terms[id.0 as usize] {
            Term::Signal(signal) => Some(Code::Signal(signal.0 as usize)),
            Term::Combine(operation, x, y) => Some(Code::Combine(*operation, slot(x)?, slot(y)?)),
            Term::Abs(x) => slot(x).map(Code::Abs),
            _ => None,
        }
    }

    /// A comparison of a number of the present state with a constant.
    pub(super) fn compare_now(&mut self, relation: Relation, x: TermId, c: f64) -> Option<usize> {
        let slot = self.term_slots[x.0 as usize]?;
        let key = (relation as u8, x.0, c.to_bits());
        if let Some(&known) = self.known_comparisons.get(&key) {
            return Some(known);
        }
        let constant = self.present.add(Code::Number(c));
        let made = self.present.add(Code::Compare(relation, slot, constant));
        self.known_comparisons.insert(key, made);
        Some(made)
    }

    /// A question at the start of the trial about present states.
    pub(super) fn direct(&self, root: Part) -> Option<Direct> {
        let (question, window) = match root {
            Part::Node(mut id) => {
                let mut negated = false;
                while let (None, Node::Not(x)) = (self.probe(id), &self.tree.nodes[id.0 as usize]) {
                    (id, negated) = (*x, !negated);
                }
                let until = |first, second, weak, turned: bool| {
                    Some(Question::Until { first, second, weak, negated: negated != turned })
                };
                let not = |probe: Probe| Probe { negated: !probe.negated, ..probe };
                match (self.probe(id), &self.tree.nodes[id.0 as usize]) {
                    (Some(now), _) => {
                        (until(None, now, false, false)?, Window { from: Tick(0), to: Some(Tick(0)) })
                    }
                    (None, Node::Finally(w, x)) => (until(None, self.probe(*x)?, false, false)?, *w),
                    (None, Node::Globally(w, x)) => (until(None, not(self.probe(*x)?), false, true)?, *w),
                    (None, Node::Until(w, p, q)) => {
                        (until(Some(self.probe(*p)?), self.probe(*q)?, false, false)?, *w)
                    }
                    (None, Node::WeakUntil(w, p, q)) => {
                        (until(Some(self.probe(*p)?), self.probe(*q)?, true, false)?, *w)
                    }
                    (None, Node::Release(w, p, q)) => {
                        (until(Some(not(self.probe(*p)?)), not(self.probe(*q)?), false, true)?, *w)
                    }
                    _ => return None,
                }
            }
            Part::Term(id) => match &self.tree.terms[id.0 as usize] {
                Term::Window(Aggregation::Sum, ..) => return None,
                // Known at once.
                Term::Window(_, _, x) if self.term_constants[x.0 as usize].is_some() => return None,
                Term::Window(aggregation, w, x) => {
                    (Question::Fold { aggregation: *aggregation, of: self.term_slots[x.0 as usize]? }, *w)
                }
                Term::TimeUntil(x) => {
                    (Question::Time { goal: self.probe(*x)? }, Window { from: Tick(0), to: None })
                }
                _ => return None,
            },
        };
        let (from, to) = (self.scale.exact(window.from), window.to.map(|to| self.scale.exact(to)));
        Some(Direct::new(question, (from, to.unwrap_or(self.scale.horizon())), self.scale))
    }

    fn probe(&self, id: NodeId) -> Option<Probe> {
        self.node_slots[id.0 as usize].map(|slot| Probe { slot, negated: false })
    }
}
