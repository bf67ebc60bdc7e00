//! The formula of a robustness, rewritten so that each of its conditions is a number compared with a bound.

use crate::base::tick::Clock;
use crate::compile::context::{
    Context, Lowered, Reported,
    observed::Margins,
    parts::{Form, Part},
};
use crate::compile::dimension::Dimension;
use crate::compile::lower::{
    logic::{self, relation},
    margin,
};
use crate::logic::{Invalid, Node, NodeId, Relation, Robustness, SignalRobustness, Term, TermId};
use crate::model::{Bool, Comparison, Num};
use crate::syntax::source::Span;
use std::collections::BTreeMap;

/// The formula whose conditions have margins, and their dimension. `lower` lowers the formula itself.
pub(crate) fn robustness(
    context: &mut Context<'_>,
    span: Span,
    lower: impl FnOnce(&mut Context<'_>) -> Lowered<NodeId>,
) -> Lowered<(NodeId, Dimension)> {
    let outer = context.margins.replace(Margins::default());
    let node = lower(context);
    let margins = std::mem::replace(&mut context.margins, outer).unwrap_or_default();
    let node = node?;
    if margins.mixed {
        return Err(Reported);
    }
    let Some((dimension, _)) = margins.first else {
        if let Some((place, instead)) = margins.equality {
            let title = format!(
                "`{}` has no margin, because `==` and `!=` are only true or false",
                context.text(place)
            );
            return context.report(error!(E0610, place, "{title}"; hint: "{instead}"));
        }
        return context.report(error!(E0610, span, "no condition in this formula has a margin";
                hint: "comparisons with `<`, `<=`, `>`, `>=`, contacts and regions have a margin"));
    };
    let node = Rewriting {
        context,
        dimension,
        span,
        text: String::new(),
        nodes: BTreeMap::new(),
        terms: BTreeMap::new(),
    }
    .node(node);
    let made = match context.time.clock {
        Clock::Jumps(tick) => {
            SignalRobustness::new(&context.observed.tree, node, context.time.horizon, tick).err()
        }
        clock => Robustness::new(&context.observed.tree, node, context.time.horizon, clock).err(),
    };
    match made {
        Some(Invalid::NoMargin | Invalid::MovingNumber) => {
            let error = error!(E0610, span, "a condition in this formula has no margin")
                .label("this compares an aggregate of several states")
                .hint("compare in each state, or compare the smallest or largest value: `min<=5 s (x) > c`");
            context.report(error)
        }
        // A bound beyond the horizon is said by whoever asks how far the formula looks.
        _ => Ok((node, dimension)),
    }
}

/// Rewrites a formula so that all its conditions are comparisons of numbers.
struct Rewriting<'e, 'a> {
    context: &'e mut Context<'a>,
    dimension: Dimension,
    span: Span,
    /// The condition that is rewritten, as written.
    text: String,
    nodes: BTreeMap<u32, NodeId>,
    terms: BTreeMap<u32, TermId>,
}

impl Rewriting<'_, '_> {
    fn node(&mut self, id: NodeId) -> NodeId {
        if let Some(known) = self.nodes.get(&id.0) {
            return *known;
        }
        let made = match self.context.observed.tree.nodes[id.0 as usize].clone() {
            Node::Atom(atom) => {
                let truth = self.context.observed.atoms[atom.0 as usize].clone();
                let text = self.context.observed.texts.atoms.get(atom.0 as usize).cloned();
                self.text = text.unwrap_or_default();
                match self.context.observed.texts.parts.get(&atom.0).cloned() {
                    Some(part) => self.part(&part),
                    None => self.condition(&truth),
                }
            }
            Node::Compare(relation, a, b) => {
                let (a, b) = (self.term(a), self.term(b));
                let text = self.context.observed.texts.comparisons.get(&id.0).map(|(text, _)| text.clone());
                self.text = text.unwrap_or_default();
                self.comparison(relation, a, b)
            }
            node => {
                let node = node.map(|part| self.node(part));
                self.context.node(node)
            }
        };
        self.nodes.insert(id.0, made);
        made
    }

    fn term(&mut self, id: TermId) -> TermId {
        if let Some(known) = self.terms.get(&id.0) {
            return *known;
        }
        let made = match self.context.observed.tree.terms[id.0 as usize].clone() {
            Term::Constant(_) | Term::Signal(_) => id,
            Term::TimeUntil(node) => {
                let node = self.node(node);
                self.context.term(Term::TimeUntil(node))
            }
            term => {
                let term = term.map(|part| self.term(part));
                self.context.term(term)
            }
        };
        self.terms.insert(id.0, made);
        made
    }

    /// A comparison that stands for a condition, and is named as it was written.
    fn comparison(&mut self, relation: Relation, a: TermId, b: TermId) -> NodeId {
        self.context.comparison((relation, a, b), self.text.clone(), self.dimension)
    }

    fn number(&mut self, num: &Num) -> TermId {
        self.context.signal(num.clone(), self.dimension, self.span)
    }

    /// The same of a condition whose parts are known: each is named as it was written.
    fn part(&mut self, part: &Part) -> NodeId {
        match &part.form {
            Form::Named(inner) => self.part(inner),
            Form::Not(inner) => {
                let inner = self.part(inner);
                self.context.node(Node::Not(inner))
            }
            Form::All(list) | Form::Any(list) => {
                let all = matches!(part.form, Form::All(_));
                let list = list.iter().map(|one| self.part(one)).collect();
                self.context.node(if all { Node::And(list) } else { Node::Or(list) })
            }
            Form::Both(a, b) => {
                let (a, b) = (self.part(a), self.part(b));
                logic::both_or_neither(self.context, a, b)
            }
            Form::Plain(_) | Form::Each(..) | Form::Someone(..) => {
                self.text = self.context.said_of(part);
                self.condition(&part.truth())
            }
        }
    }

    /// A condition of one state as a formula of comparisons.
    fn condition(&mut self, truth: &Bool) -> NodeId {
        match truth {
            Bool::Constant(value) => self.context.node(Node::Constant(*value)),
            Bool::Not(inner) => {
                let inner = self.condition(inner);
                self.context.node(Node::Not(inner))
            }
            Bool::And(list) | Bool::Or(list) => {
                let all = matches!(truth, Bool::And(_));
                let list = list.iter().map(|one| self.condition(one)).collect();
                self.context.node(if all { Node::And(list) } else { Node::Or(list) })
            }
            Bool::Iff(a, b) => {
                let (a, b) = (self.condition(a), self.condition(b));
                logic::both_or_neither(self.context, a, b)
            }
            // Who has not come in yet has no numbers: then the truth decides.
            _ if self.context.roster.coming => {
                let margin = margin::margin(truth);
                let same = (Box::new(margin.clone()), Box::new(margin.clone()));
                let is_number = Bool::Compare(Comparison::Equal, same.0, same.1);
                let margin =
                    Num::If(Box::new(is_number), Box::new(margin), Box::new(margin::infinite(truth)));
                let (margin, zero) = (self.number(&margin), self.context.term(Term::Constant(0.0)));
                self.comparison(Relation::Greater, margin, zero)
            }
            Bool::Compare(comparison, a, b)
                if !matches!(comparison, Comparison::Equal | Comparison::Unequal)
                    && margin::depth(truth).is_none() =>
            {
                let (a, b) = (self.number(a), self.number(b));
                self.comparison(relation(*comparison), a, b)
            }
            _ => {
                let margin = self.number(&margin::margin(truth));
                let zero = self.context.term(Term::Constant(0.0));
                self.comparison(Relation::Greater, margin, zero)
            }
        }
    }
}
