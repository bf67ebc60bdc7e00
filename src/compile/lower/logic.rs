//! Connectives, comparisons, membership.

use crate::base::tick::Clock;
use crate::compile::context::{
    Context, Locals, Lowered, Reported,
    clock::Told,
    parts::{Form, Part},
    phrase,
    typed::Typed,
};
use crate::compile::dimension::Dimension;
use crate::compile::lower::{form, margins, process_names, tally};
use crate::logic::{Aggregation, Node, NodeId, Relation, Term, TermId};
use crate::model::{Bool, Comparison, Num, Place};
use crate::syntax::ast::{BinaryOp, Expr};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::source::Span;
use std::sync::Arc;

/// `!p`
pub(crate) fn not(context: &mut Context<'_>, span: Span, typed: Typed, operand: Span) -> Lowered<Typed> {
    match typed {
        Typed::Truth(truth, phrase) => {
            let phrase = phrase.and_then(|phrase| phrase::phrase(context, span, Form::Not(phrase)));
            Ok(Typed::Truth(negated(truth), phrase))
        }
        Typed::Formula(node) => Ok(Typed::Formula(context.node(Node::Not(node)))),
        found => context.mismatch(operand, "a condition", &found),
    }
}

/// `&`, `|`, `=>`, `<=>`
pub(crate) fn connect(
    context: &mut Context<'_>,
    (op, span): (BinaryOp, Span),
    mut a: (Typed, Span),
    mut b: (Typed, Span),
    locals: &Locals,
) -> Lowered<Typed> {
    // An implication of a formula stays visible to the monitor, which counts how often it was triggered.
    let monitored = context.temporal && locals.running == 0 && op == BinaryOp::Implies;
    let states = matches!((&a.0, &b.0), (Typed::Truth(..), Typed::Truth(..))) && !monitored;
    if states {
        let phrases = (a.0.take_phrase(), b.0.take_phrase());
        let phrase = connected(context, op, span, phrases, a.1);
        let (a, b) = (context.as_truth(a.0, a.1)?, context.as_truth(b.0, b.1)?);
        let truth = match op {
            BinaryOp::And => all_of(a, b),
            BinaryOp::Or => any_of(a, b),
            BinaryOp::Implies => any_of(negated(a), b),
            _ => iff(a, b),
        };
        return Ok(Typed::Truth(truth, phrase));
    }
    if let (Typed::Truth(when, _), Typed::Truth(then, phrase)) = (&a.0, &b.0)
        && then.may_lack_value()
    {
        // `a => b` is `a => (!a | b)`: where the guard is false, undefined values of the rest do not matter.
        let phrase = connected(context, BinaryOp::Implies, b.1, (a.0.phrase(), phrase.clone()), a.1);
        b.0 = Typed::Truth(any_of(negated(when.clone()), then.clone()), phrase);
    }
    let sides = (context.as_formula(a.0, a.1), context.as_formula(b.0, b.1));
    let (a, b) = (sides.0?, sides.1?);
    Ok(Typed::Formula(match op {
        BinaryOp::And => context.node(Node::And(vec![a, b])),
        BinaryOp::Or => context.node(Node::Or(vec![a, b])),
        BinaryOp::Implies => {
            let not = context.node(Node::Not(a));
            context.node(Node::Or(vec![not, b]))
        }
        _ => both_or_neither(context, a, b),
    }))
}

/// How a connection of two conditions is written. What is the same everywhere is no part of it.
fn connected(
    context: &Context<'_>,
    op: BinaryOp,
    span: Span,
    sides: (Option<Arc<Part>>, Option<Arc<Part>>),
    left: Span,
) -> Option<Arc<Part>> {
    let sides = match (op, sides) {
        (BinaryOp::Iff, (a, b)) => return phrase::phrase(context, span, Form::Both(a?, b?)),
        (BinaryOp::Implies, (a, b)) => {
            let sides = [a.and_then(|a| phrase::phrase(context, left, Form::Not(a))), b];
            let list: Vec<_> = sides.into_iter().flatten().collect();
            return if list.is_empty() { None } else { phrase::phrase(context, span, Form::Any(list)) };
        }
        (_, sides) => sides,
    };
    let list: Vec<_> = [sides.0, sides.1].into_iter().flatten().collect();
    if list.is_empty() { None } else { phrase::chained(context, span, op == BinaryOp::And, list) }
}

/// Both formulas or neither.
pub(crate) fn both_or_neither(context: &mut Context<'_>, a: NodeId, b: NodeId) -> NodeId {
    let (not_a, not_b) = (context.node(Node::Not(a)), context.node(Node::Not(b)));
    let both = context.node(Node::And(vec![a, b]));
    let neither = context.node(Node::And(vec![not_a, not_b]));
    context.node(Node::Or(vec![both, neither]))
}

/// A comparison of numbers, or of a count of formulas with a number.
pub(crate) fn compared(
    context: &mut Context<'_>,
    op: BinaryOp,
    (left, a): (&Expr, Lowered<Typed>),
    (right, b): (&Expr, Lowered<Typed>),
    locals: &Locals,
) -> Lowered<Typed> {
    let (a, b) = match (a, b) {
        (Ok(a), Ok(b)) => (a, b),
        (Err(_), Ok(found)) => return misfit(context, (left, None), (right, Some(&found)), locals),
        (Ok(found), Err(_)) => return misfit(context, (left, Some(&found)), (right, None), locals),
        (Err(reported), Err(_)) => return Err(reported),
    };
    let margin = !matches!(op, BinaryOp::Equal | BinaryOp::Unequal);
    let whole = left.span.to(right.span);
    let a = if matches!(a, Typed::Infinity) { infinite(&b) } else { a };
    let b = if matches!(b, Typed::Infinity) { infinite(&a) } else { b };
    let span = Span { end: right.span.end, ..left.span };
    if !margin {
        margins::note_equality(context, op, (left.span, right.span), (&a, &b));
    }
    match (&a, &b) {
        (Typed::Agent(_), Typed::Agent(_)) => {
            let error =
                error!(E0305, whole, "`{}` compares two agents, not two numbers", context.text(whole));
            let other = context.text(right.span);
            return context.report(error.hint(format!(
                    "the set of all agents except `{other}` is `others({other})`: write `forall a in others({other}): …`"
                )));
        }
        (Typed::Tally(formulas), Typed::Number(bound)) if bound.dimension.is_none() => {
            return Ok(Typed::Formula(tally::tally(
                context,
                formulas,
                relation(comparison(op)),
                bound.value,
                span,
            )?));
        }
        (Typed::Number(bound), Typed::Tally(formulas)) if bound.dimension.is_none() => {
            return Ok(Typed::Formula(tally::tally(
                context,
                formulas,
                relation(comparison(op)).flipped(),
                bound.value,
                span,
            )?));
        }
        _ => {}
    }
    if matches!(a, Typed::Term(..)) || matches!(b, Typed::Term(..)) {
        let sides = (context.as_term(a, left.span), context.as_term(b, right.span));
        let ((a, da), (b, db)) = (sides.0?, sides.1?);
        if da != db {
            return context.wrong_dimension(right.span, da, db);
        }
        // The margin of a time until something is that of the something.
        let time = |term: TermId| matches!(context.observed.tree.terms[term.0 as usize], Term::TimeUntil(_));
        if margin && !time(a) && !time(b) {
            margins::note_margin(context, da, whole);
        }
        within_a_trial(context, (a, b), whole)?;
        let text = context.words(span);
        let relation = relation(comparison(op));
        if let Some(node) = extreme_is(context, (relation, a, b), &text, da) {
            return Ok(Typed::Formula(node));
        }
        return Ok(Typed::Formula(context.comparison((relation, a, b), text, da)));
    }
    if [&a, &b].iter().all(|side| matches!(side, Typed::Vector(..) | Typed::Point(..))) {
        return context.report(error!(E0305, whole, "vectors cannot be compared";
                hint: "compare their `distance` or their components: `x(position(a))`"));
    }
    let sides = (context.as_num(a, left.span), context.as_num(b, right.span));
    let ((a, da), (b, db)) = (sides.0?, sides.1?);
    if da != db {
        return context.wrong_dimension(right.span, da, db);
    }
    // A condition that only parameters decide has a margin, too.
    let measured = margin && context.margins.as_ref().is_some_and(|margins| margins.inside == 0);
    if let (Num::Constant(a), Num::Constant(b), false) = (&a, &b, measured) {
        return Ok(Typed::truth(Bool::Constant(comparison(op).of(*a, *b))));
    }
    if measured {
        margins::note_margin(context, da, whole);
    }
    if !margin
        && let Some(name) =
            process_names::real_in(context, &a).or_else(|| process_names::real_in(context, &b))
    {
        let said = format!("`{name}` is a rounded real number, but is compared for equality");
        let warning = Diagnostic::warning(Code::W0503, whole, said)
                .hint("compare with `<` or `>`, or within a tolerance: `abs(x - 0.3) < 1e-9`; for whole numbers declare a range: `var x: 0 .. 10 = 0`");
        context.note(warning);
    }
    Ok(Typed::truth(Bool::Compare(comparison(op), Box::new(a), Box::new(b))))
}

/// That the least or greatest of some values is, or is not, a number: as two comparisons, each of which may be settled by
/// one value. Such a formula has no margin, so not where that is asked for.
fn extreme_is(
    context: &mut Context<'_>,
    (relation, a, b): (Relation, TermId, TermId),
    text: &str,
    dimension: Dimension,
) -> Option<NodeId> {
    let is_equal = match relation {
        Relation::Equal => true,
        Relation::Unequal => false,
        _ => return None,
    };
    let terms = &context.observed.tree.terms;
    let is_extreme = |term: TermId| {
        matches!(terms[term.0 as usize], Term::Window(Aggregation::Min | Aggregation::Max, ..))
    };
    let is_constant = |term: TermId| matches!(terms[term.0 as usize], Term::Constant(_));
    let suits = is_extreme(a) && is_constant(b) || is_constant(a) && is_extreme(b);
    if !suits || context.margins.is_some() {
        return None;
    }
    let relations =
        if is_equal { [Relation::AtLeast, Relation::AtMost] } else { [Relation::Greater, Relation::Less] };
    let sides = relations.map(|relation| context.comparison((relation, a, b), text.to_owned(), dimension));
    let sides = sides.to_vec();
    Some(context.node(if is_equal { Node::And(sides) } else { Node::Or(sides) }))
}

/// An error where the time until something is compared with one that no trial reaches: of what has not happened by the
/// horizon it is unknown whether it takes so long.
pub(crate) fn within_a_trial(context: &mut Context<'_>, sides: (TermId, TermId), span: Span) -> Lowered<()> {
    // Horizons that are no decimals are kept to ten digits.
    let end = context.time.clock.seconds(context.time.horizon) * (1.0 + 1e-9);
    let terms = &context.observed.tree.terms;
    let limit = |time: TermId, limit: TermId| match (&terms[time.0 as usize], &terms[limit.0 as usize]) {
        (Term::TimeUntil(_), Term::Constant(limit)) if end < *limit && limit.is_finite() => Some(*limit),
        _ => None,
    };
    let Some(limit) = limit(sides.0, sides.1).or_else(|| limit(sides.1, sides.0)) else { return Ok(()) };
    if context.sink.told < Told::Whole {
        return Ok(());
    }
    let unit = if context.time.clock == Clock::Steps { "steps" } else { "s" };
    context.report(
        error!(E0502, span, "the formula needs {limit} {unit}, but the horizon is {}", context.time.whole();
            hint: "set `horizon = {limit} {unit}` in the scenario, or compare with a smaller number"),
    )
}

/// Something is wrong with one of two sides that ought to have one dimension. That they have not is told as well, as
/// far as the form of that side tells its dimension.
pub(crate) fn misfit<T>(
    context: &mut Context<'_>,
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
        a.map_or_else(|| form::gist(context, left, locals), known),
        b.map_or_else(|| form::gist(context, right, locals), known),
    );
    match dimensions {
        (Some(expected), Some(found)) if expected != found => {
            context.wrong_dimension(right.span, expected, found)
        }
        _ => Err(Reported),
    }
}

/// `a in exit`
pub(crate) fn membership(
    context: &mut Context<'_>,
    (who, left): (Typed, Span),
    (region, right): (Typed, Span),
) -> Lowered<Typed> {
    let region = match region {
        Typed::Region(region) => Ok(region),
        found => context.mismatch(right, "a region", &found),
    };
    let place = context.as_place(who, left);
    let region = region?;
    match place? {
        Place::Agent(who) => Ok(Typed::truth(Bool::In(who, region))),
        place @ (Place::Point(..) | Place::Centroid(_)) => {
            let distance = Num::Distance(place, Place::Region(region));
            let zero = Box::new(Num::Constant(0.0));
            Ok(Typed::truth(Bool::Compare(Comparison::AtMost, Box::new(distance), zero)))
        }
        Place::Region(id) => context.mismatch(left, "an agent or a point", &Typed::Region(id)),
        Place::Barrier(id) => context.mismatch(left, "an agent or a point", &Typed::Barrier(id)),
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

pub(crate) fn all_of(a: Bool, b: Bool) -> Bool {
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

pub(crate) fn any_of(a: Bool, b: Bool) -> Bool {
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
pub(crate) fn relation(comparison: Comparison) -> Relation {
    match comparison {
        Comparison::Less => Relation::Less,
        Comparison::AtMost => Relation::AtMost,
        Comparison::Greater => Relation::Greater,
        Comparison::AtLeast => Relation::AtLeast,
        Comparison::Equal => Relation::Equal,
        Comparison::Unequal => Relation::Unequal,
    }
}
