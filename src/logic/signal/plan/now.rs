//! Parts of the present state alone, parts that are the same everywhere, and questions that need no cells.

use super::super::direct::{Direct, Probe, Question};
use super::Builder;
use crate::base::tick::Tick;
use crate::logic::formula::{Aggregation, Node, NodeId, Relation, Term, TermId, Window};
use crate::logic::present::Code;
use crate::logic::reach::Part;

impl Builder<'_> {
    /// A comparison of a number of the present state with a constant.
    pub(super) fn compare_now(&mut self, relation: Relation, x: TermId, c: f64) -> Option<usize> {
        let slot = self.parts.term_slots[x.0 as usize]?;
        let key = (relation as u8, x.0, c.to_bits());
        if let Some(&known) = self.known_comparisons.get(&key) {
            return Some(known);
        }
        let constant = self.parts.present.add(Code::Number(c));
        let made = self.parts.present.add(Code::Compare(relation, slot, constant));
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
                let (first, second, weak, turned, window) =
                    match (self.probe(id), &self.tree.nodes[id.0 as usize]) {
                        (Some(_), _) => (None, id, false, false, Window { from: Tick(0), to: Some(Tick(0)) }),
                        (None, Node::Finally(w, x)) => (None, *x, false, false, *w),
                        (None, Node::Globally(w, x)) => (None, *x, false, true, *w),
                        (None, Node::Until(w, p, q)) => (Some(*p), *q, false, false, *w),
                        (None, Node::WeakUntil(w, p, q)) => (Some(*p), *q, true, false, *w),
                        (None, Node::Release(w, p, q)) => (Some(*p), *q, false, true, *w),
                        _ => return None,
                    };
                let probe = |id| self.probe(id).map(|probe| Probe { negated: turned, ..probe });
                let first = match first {
                    Some(first) => Some(probe(first)?),
                    None => None,
                };
                let second = probe(second)?;
                (Question::Until { first, second, weak, negated: negated != turned }, window)
            }
            Part::Term(id) => match &self.tree.terms[id.0 as usize] {
                Term::Window(Aggregation::Sum, ..) => return None,
                // Known at once.
                Term::Window(_, _, x) if self.parts.term_constants[x.0 as usize].is_some() => return None,
                Term::Window(aggregation, w, x) => (
                    Question::Fold { aggregation: *aggregation, of: self.parts.term_slots[x.0 as usize]? },
                    *w,
                ),
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
        self.parts.node_slots[id.0 as usize].map(|slot| Probe { slot, negated: false })
    }
}
