//! Connectives, comparisons, membership.

use super::super::dimension::Dimension;
use super::super::elaborator::{Elaborator, Locals, Lowered, Reported};
use super::super::study::{Form, Part};
use super::super::told::Told;
use super::super::typed::Typed;
use crate::base::tick::Clock;
use crate::logic::{Aggregation, Node, NodeId, Relation, Term, TermId};
use crate::model::{Bool, Comparison, Num, Place};
use crate::syntax::ast::{BinaryOp, Expr, ExprKind};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::source::Span;
use std::sync::Arc;

impl Elaborator<'_> {
    pub(super) fn lower_not(&mut self, span: Span, operand: &Expr, locals: &Locals) -> Lowered<Typed> {
        match self.lower(operand, locals)? {
            Typed::Truth(truth, phrase) => {
                let phrase = phrase.and_then(|phrase| self.phrase(span, Form::Not(phrase)));
                Ok(Typed::Truth(negated(truth), phrase))
            }
            Typed::Formula(node) => Ok(Typed::Formula(self.node(Node::Not(node)))),
            found => self.mismatch(operand.span, "a condition", &found),
        }
    }

    pub(super) fn lower_binary(
        &mut self,
        expr: &Expr,
        op: BinaryOp,
        left: &Expr,
        right: &Expr,
        locals: &Locals,
    ) -> Lowered<Typed> {
        match op {
            BinaryOp::Plus | BinaryOp::Minus | BinaryOp::Times | BinaryOp::Over | BinaryOp::Power => {
                self.lower_arithmetic(expr.span, op, left, right, locals)
            }
            BinaryOp::In => self.lower_in(left, right, locals),
            BinaryOp::And | BinaryOp::Or | BinaryOp::Implies | BinaryOp::Iff => {
                let sides = (self.lower(left, locals), self.lower(right, locals));
                self.connect((op, expr.span), (sides.0?, left.span), (sides.1?, right.span), locals)
            }
            _ => self.lower_comparison(op, left, right, locals),
        }
    }

    fn connect(
        &mut self,
        (op, span): (BinaryOp, Span),
        mut a: (Typed, Span),
        mut b: (Typed, Span),
        locals: &Locals,
    ) -> Lowered<Typed> {
        // An implication of a formula stays visible to the monitor, which counts how often it was triggered.
        let monitored = self.temporal && locals.running == 0 && op == BinaryOp::Implies;
        let states = matches!((&a.0, &b.0), (Typed::Truth(..), Typed::Truth(..))) && !monitored;
        if states {
            let phrases = (a.0.take_phrase(), b.0.take_phrase());
            let phrase = self.connected(op, span, phrases, a.1);
            let (a, b) = (self.as_truth(a.0, a.1)?, self.as_truth(b.0, b.1)?);
            let truth = match op {
                BinaryOp::And => all(a, b),
                BinaryOp::Or => any(a, b),
                BinaryOp::Implies => any(negated(a), b),
                _ => iff(a, b),
            };
            return Ok(Typed::Truth(truth, phrase));
        }
        if let (Typed::Truth(when, _), Typed::Truth(then, phrase)) = (&a.0, &b.0)
            && then.may_lack_value()
        {
            // `a => b` is `a => (!a | b)`: where the guard is false, undefined values of the rest do not matter.
            let phrase = self.connected(BinaryOp::Implies, b.1, (a.0.phrase(), phrase.clone()), a.1);
            b.0 = Typed::Truth(any(negated(when.clone()), then.clone()), phrase);
        }
        let sides = (self.as_formula(a.0, a.1), self.as_formula(b.0, b.1));
        let (a, b) = (sides.0?, sides.1?);
        Ok(Typed::Formula(match op {
            BinaryOp::And => self.node(Node::And(vec![a, b])),
            BinaryOp::Or => self.node(Node::Or(vec![a, b])),
            BinaryOp::Implies => {
                let not = self.node(Node::Not(a));
                self.node(Node::Or(vec![not, b]))
            }
            _ => self.iff(a, b),
        }))
    }

    /// How a connection of two conditions is written. What is the same everywhere is no part of it.
    fn connected(
        &self,
        op: BinaryOp,
        span: Span,
        sides: (Option<Arc<Part>>, Option<Arc<Part>>),
        left: Span,
    ) -> Option<Arc<Part>> {
        let sides = match (op, sides) {
            (BinaryOp::Iff, (a, b)) => return self.phrase(span, Form::Both(a?, b?)),
            (BinaryOp::Implies, (a, b)) => {
                let sides = [a.and_then(|a| self.phrase(left, Form::Not(a))), b];
                let list: Vec<_> = sides.into_iter().flatten().collect();
                return if list.is_empty() { None } else { self.phrase(span, Form::Any(list)) };
            }
            (_, sides) => sides,
        };
        let list: Vec<_> = [sides.0, sides.1].into_iter().flatten().collect();
        if list.is_empty() { None } else { self.chained(span, op == BinaryOp::And, list) }
    }

    /// Both formulas or neither.
    pub(in super::super) fn iff(&mut self, a: NodeId, b: NodeId) -> NodeId {
        let (not_a, not_b) = (self.node(Node::Not(a)), self.node(Node::Not(b)));
        let both = self.node(Node::And(vec![a, b]));
        let neither = self.node(Node::And(vec![not_a, not_b]));
        self.node(Node::Or(vec![both, neither]))
    }

    fn lower_comparison(
        &mut self,
        op: BinaryOp,
        left: &Expr,
        right: &Expr,
        locals: &Locals,
    ) -> Lowered<Typed> {
        if let Some(equal) = match op {
            BinaryOp::Equal => Some(Comparison::Equal),
            BinaryOp::Unequal => Some(Comparison::Unequal),
            _ => None,
        } && let Some(compared) = self.lower_mode_comparison(equal, left, right, locals)
        {
            return compared;
        }
        if let Some(misread) = self.misread_comparison(left, right, locals) {
            return misread;
        }
        let sides = self.inside_a_number(|this| {
            let a = this.lower(left, locals);
            // `a.phone == looking` without such a behaviour: the state is unknown with it.
            let state = matches!(op, BinaryOp::Equal | BinaryOp::Unequal)
                && matches!((&left.kind, &right.kind), (ExprKind::Member(..), ExprKind::Name(_)));
            if a.is_err() && state { (a, Err(Reported)) } else { (a, this.lower(right, locals)) }
        });
        let (a, b) = match sides {
            (Ok(a), Ok(b)) => (a, b),
            (Err(_), Ok(found)) => return self.misfit((left, None), (right, Some(&found)), locals),
            (Ok(found), Err(_)) => return self.misfit((left, Some(&found)), (right, None), locals),
            (Err(reported), Err(_)) => return Err(reported),
        };
        let margin = !matches!(op, BinaryOp::Equal | BinaryOp::Unequal);
        let whole = left.span.to(right.span);
        let a = if matches!(a, Typed::Infinity) { infinite(&b) } else { a };
        let b = if matches!(b, Typed::Infinity) { infinite(&a) } else { b };
        let span = Span { end: right.span.end, ..left.span };
        if !margin {
            self.note_equality(op, (left.span, right.span), (&a, &b));
        }
        match (&a, &b) {
            (Typed::Agent(_), Typed::Agent(_)) => {
                let error =
                    error!(E0305, whole, "`{}` compares two agents, not two numbers", self.text(whole));
                let other = self.text(right.span);
                return self.report(error.hint(format!(
                    "the set of all agents except `{other}` is `others({other})`: write `forall a in others({other}): …`"
                )));
            }
            (Typed::Tally(formulas), Typed::Number(bound)) if bound.dimension.is_none() => {
                return Ok(Typed::Formula(self.tally(
                    formulas,
                    relation(comparison(op)),
                    bound.value,
                    span,
                )?));
            }
            (Typed::Number(bound), Typed::Tally(formulas)) if bound.dimension.is_none() => {
                return Ok(Typed::Formula(self.tally(
                    formulas,
                    relation(comparison(op)).flipped(),
                    bound.value,
                    span,
                )?));
            }
            _ => {}
        }
        if matches!(a, Typed::Term(..)) || matches!(b, Typed::Term(..)) {
            let sides = (self.as_term(a, left.span), self.as_term(b, right.span));
            let ((a, da), (b, db)) = (sides.0?, sides.1?);
            if da != db {
                return self.wrong_dimension(right.span, da, db);
            }
            // The margin of a time until something is that of the something.
            let time = |term: TermId| matches!(self.tree.terms[term.0 as usize], Term::TimeUntil(_));
            if margin && !time(a) && !time(b) {
                self.note_margin(da, whole);
            }
            self.within_a_trial((a, b), whole)?;
            let text = self.words(span);
            let relation = relation(comparison(op));
            if let Some(node) = self.extreme_is((relation, a, b), &text, da) {
                return Ok(Typed::Formula(node));
            }
            return Ok(Typed::Formula(self.comparison((relation, a, b), text, da)));
        }
        if [&a, &b].iter().all(|side| matches!(side, Typed::Vector(..) | Typed::Point(..))) {
            return self.report(error!(E0305, whole, "vectors cannot be compared";
                hint: "compare their `distance` or their components: `x(position(a))`"));
        }
        let sides = (self.as_num(a, left.span), self.as_num(b, right.span));
        let ((a, da), (b, db)) = (sides.0?, sides.1?);
        if da != db {
            return self.wrong_dimension(right.span, da, db);
        }
        // A condition that only parameters decide has a margin, too.
        let measured = margin && self.margins.as_ref().is_some_and(|margins| margins.inside == 0);
        if let (Num::Constant(a), Num::Constant(b), false) = (&a, &b, measured) {
            return Ok(Typed::truth(Bool::Constant(comparison(op).of(*a, *b))));
        }
        if measured {
            self.note_margin(da, whole);
        }
        if !margin && let Some(name) = self.real_in(&a).or_else(|| self.real_in(&b)) {
            let said = format!("`{name}` is a rounded real number, but is compared for equality");
            let warning = Diagnostic::warning(Code::W0503, whole, said)
                .hint("compare with `<` or `>`, or within a tolerance: `abs(x - 0.3) < 1e-9`; for whole numbers declare a range: `var x: 0 .. 10 = 0`");
            self.note(warning);
        }
        Ok(Typed::truth(Bool::Compare(comparison(op), Box::new(a), Box::new(b))))
    }

    /// That the least or greatest of some values is, or is not, a number: as two comparisons, each of which may be settled by
    /// one value. Such a formula has no margin, so not where that is asked for.
    fn extreme_is(
        &mut self,
        (relation, a, b): (Relation, TermId, TermId),
        text: &str,
        dimension: Dimension,
    ) -> Option<NodeId> {
        let is_equal = match relation {
            Relation::Equal => true,
            Relation::Unequal => false,
            _ => return None,
        };
        let terms = &self.tree.terms;
        let is_extreme = |term: TermId| {
            matches!(terms[term.0 as usize], Term::Window(Aggregation::Min | Aggregation::Max, ..))
        };
        let is_constant = |term: TermId| matches!(terms[term.0 as usize], Term::Constant(_));
        let suits = is_extreme(a) && is_constant(b) || is_constant(a) && is_extreme(b);
        if !suits || self.margins.is_some() {
            return None;
        }
        let relations = if is_equal {
            [Relation::AtLeast, Relation::AtMost]
        } else {
            [Relation::Greater, Relation::Less]
        };
        let sides = relations.map(|relation| self.comparison((relation, a, b), text.to_owned(), dimension));
        let sides = sides.to_vec();
        Some(self.node(if is_equal { Node::And(sides) } else { Node::Or(sides) }))
    }

    /// An error where the time until something is compared with one that no trial reaches: of what has not happened by the
    /// horizon it is unknown whether it takes so long.
    pub(in crate::compile) fn within_a_trial(&mut self, sides: (TermId, TermId), span: Span) -> Lowered<()> {
        // Horizons that are no decimals are kept to ten digits.
        let end = self.clock.seconds(self.horizon) * (1.0 + 1e-9);
        let terms = &self.tree.terms;
        let limit = |time: TermId, limit: TermId| match (&terms[time.0 as usize], &terms[limit.0 as usize]) {
            (Term::TimeUntil(_), Term::Constant(limit)) if end < *limit && limit.is_finite() => Some(*limit),
            _ => None,
        };
        let Some(limit) = limit(sides.0, sides.1).or_else(|| limit(sides.1, sides.0)) else { return Ok(()) };
        if self.told < Told::Whole {
            return Ok(());
        }
        let unit = if self.clock == Clock::Steps { "steps" } else { "s" };
        self.report(error!(E0502, span, "the formula needs {limit} {unit}, but the horizon is {}", self.duration(self.horizon.0);
            hint: "set `horizon = {limit} {unit}` in the scenario, or compare with a smaller number"))
    }

    /// Something is wrong with one of two sides that ought to have one dimension. That they have not is told as well, as
    /// far as the form of that side tells its dimension.
    pub(super) fn misfit<T>(
        &mut self,
        (left, a): (&Expr, Option<&Typed>),
        (right, b): (&Expr, Option<&Typed>),
        locals: &Locals,
    ) -> Lowered<T> {
        let known = |typed: &Typed| match typed {
            Typed::Number(number) => Some(number.dimension),
            Typed::Num(_, dimension) | Typed::Term(_, dimension) => Some(*dimension),
            _ => None,
        };
        let dimensions = (
            a.map_or_else(|| self.gist(left, locals), known),
            b.map_or_else(|| self.gist(right, locals), known),
        );
        match dimensions {
            (Some(expected), Some(found)) if expected != found => {
                self.wrong_dimension(right.span, expected, found)
            }
            _ => Err(Reported),
        }
    }

    /// Lowers numbers: conditions inside them (of a count, of an `if`) are no conditions of the formula.
    fn inside_a_number<T>(&mut self, lower: impl FnOnce(&mut Self) -> T) -> T {
        if let Some(margins) = &mut self.margins {
            margins.inside += 1;
        }
        let lowered = lower(self);
        if let Some(margins) = &mut self.margins {
            margins.inside -= 1;
        }
        lowered
    }

    /// Lowers formulas that a number is made of: their conditions are those of the formula around it.
    pub(super) fn inside_a_formula<T>(&mut self, lower: impl FnOnce(&mut Self) -> T) -> T {
        let inside = self.margins.as_mut().map(|margins| std::mem::take(&mut margins.inside));
        let lowered = lower(self);
        if let (Some(margins), Some(inside)) = (&mut self.margins, inside) {
            margins.inside = inside;
        }
        lowered
    }

    fn lower_in(&mut self, left: &Expr, right: &Expr, locals: &Locals) -> Lowered<Typed> {
        self.note_margin(Dimension::LENGTH, left.span.to(right.span));
        let sides = (self.lower(left, locals), self.lower(right, locals));
        let (who, region) = (sides.0?, sides.1?);
        let region = match region {
            Typed::Region(region) => Ok(region),
            found => self.mismatch(right.span, "a region", &found),
        };
        let place = self.as_place(who, left.span);
        let region = region?;
        match place? {
            Place::Agent(who) => Ok(Typed::truth(Bool::In(who, region))),
            place @ (Place::Point(..) | Place::Centroid(_)) => {
                let distance = Num::Distance(place, Place::Region(region));
                let zero = Box::new(Num::Constant(0.0));
                Ok(Typed::truth(Bool::Compare(Comparison::AtMost, Box::new(distance), zero)))
            }
            Place::Region(id) => self.mismatch(left.span, "an agent or a point", &Typed::Region(id)),
            Place::Barrier(id) => self.mismatch(left.span, "an agent or a point", &Typed::Barrier(id)),
        }
    }
}

/// Infinity in the dimension of the other side.
fn infinite(other: &Typed) -> Typed {
    let dimension = match other {
        Typed::Number(n) => n.dimension,
        Typed::Num(_, dimension) | Typed::Term(_, dimension) => *dimension,
        _ => Dimension::NONE,
    };
    Typed::Num(Num::Constant(f64::INFINITY), dimension)
}

fn negated(truth: Bool) -> Bool {
    match truth {
        Bool::Constant(value) => Bool::Constant(!value),
        Bool::Not(inner) => *inner,
        other => Bool::Not(Box::new(other)),
    }
}

pub(super) fn all(a: Bool, b: Bool) -> Bool {
    match (a, b) {
        (Bool::Constant(true), b) => b,
        (a, Bool::Constant(true)) => a,
        (Bool::Constant(false), _) | (_, Bool::Constant(false)) => Bool::Constant(false),
        (Bool::And(mut list), b) => {
            list.push(b);
            Bool::And(list)
        }
        (a, b) => Bool::And(vec![a, b]),
    }
}

pub(super) fn any(a: Bool, b: Bool) -> Bool {
    match (a, b) {
        (Bool::Constant(false), b) => b,
        (a, Bool::Constant(false)) => a,
        (Bool::Constant(true), _) | (_, Bool::Constant(true)) => Bool::Constant(true),
        (Bool::Or(mut list), b) => {
            list.push(b);
            Bool::Or(list)
        }
        (a, b) => Bool::Or(vec![a, b]),
    }
}

/// Both or neither.
fn iff(a: Bool, b: Bool) -> Bool {
    match (a, b) {
        (Bool::Constant(true), other) | (other, Bool::Constant(true)) => other,
        (Bool::Constant(false), other) | (other, Bool::Constant(false)) => negated(other),
        (a, b) => Bool::Iff(Box::new(a), Box::new(b)),
    }
}

fn comparison(op: BinaryOp) -> Comparison {
    match op {
        BinaryOp::Less => Comparison::Less,
        BinaryOp::AtMost => Comparison::AtMost,
        BinaryOp::Greater => Comparison::Greater,
        BinaryOp::AtLeast => Comparison::AtLeast,
        BinaryOp::Equal => Comparison::Equal,
        _ => Comparison::Unequal,
    }
}

/// The relation of formulas that a comparison of a state is.
pub(in super::super) fn relation(comparison: Comparison) -> Relation {
    match comparison {
        Comparison::Less => Relation::Less,
        Comparison::AtMost => Relation::AtMost,
        Comparison::Greater => Relation::Greater,
        Comparison::AtLeast => Relation::AtLeast,
        Comparison::Equal => Relation::Equal,
        Comparison::Unequal => Relation::Unequal,
    }
}
