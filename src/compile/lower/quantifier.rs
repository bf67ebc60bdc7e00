//! Quantifiers and folds over agents.
//!
//! Over states they become loops of the kernel's code. Over formulas they are written out, member by
//! member, because each member's formula is monitored on its own.

use crate::compile::context::{
    Context, Locals, Lowered, Reported,
    parts::{Form, Given, Part},
    phrase,
    typed::{Typed, as_number},
};
use crate::compile::dimension::Dimension;
use crate::compile::lower::{margins, mention, process_names};
use crate::logic::{Node, NodeId, Operation, Term, TermId};
use crate::model::{AgentId, Arithmetic, Bool, Fold, Num, Set, Who};
use crate::syntax::ast::{Aggregate, BinaryOp, Expr, ExprKind, Ident, Quantifier};
use crate::syntax::source::Span;

use std::sync::Arc;

/// The left side of an implication, as a condition of one state.
struct Case {
    truth: Bool,
    text: String,
    phrase: Option<Arc<Part>>,
}

pub(crate) fn lower_quantified(
    context: &mut Context<'_>,
    span: Span,
    quantifier: Quantifier,
    variable: &Ident,
    set: &Expr,
    body: &Expr,
    locals: &Locals,
) -> Lowered<Typed> {
    context.words.uses.bind(variable, locals.names.len());
    let members = match context.lower(set, locals) {
        Ok(Typed::Processes(process)) => {
            process_names::counted(context, process, set.span)?;
            return lower_over_processes(context, (quantifier, span), variable, process, body, locals);
        }
        members => members.and_then(|members| context.as_set(members, set.span)),
    };
    let place = set.span;
    let Ok(set) = members else {
        // Whoever they are, what is said of each is looked at.
        let mut inner = locals.clone();
        inner.bind_unknown(&variable.name);
        let _ = context.lower(body, &inner);
        return Err(Reported);
    };
    if context.temporal && mention::mentions_time(context, body, locals, variable) {
        return write_out(context, span, quantifier, variable, &set, body, locals);
    }
    let mut inner = locals.clone();
    inner.bind_person(variable, Who::Running(locals.running), context.temporal);
    inner.running += 1;
    let typed = context.lower(body, &inner)?;
    let phrase = typed.phrase();
    match quantifier {
        Quantifier::Forall => {
            let phrase = phrase.and_then(|one| phrase::phrase(context, span, Form::Each(set.clone(), one)));
            let all = Bool::Forall(set.clone(), Box::new(context.as_truth(typed, body.span)?));
            let watched = context.temporal && locals.running == 0;
            let Some(left) = (if watched { left_side(context, body, &inner)? } else { None }) else {
                return Ok(Typed::Truth(all, phrase));
            };
            // "Each a: if p then q" is "if some a has p, then each a: if p then q"; so the monitor sees whether
            // any agent ever had p.
            let some = someone(context, (variable, place, set), left, span);
            let some = context.atom_worded(some.truth, span, some.text, some.phrase.as_ref());
            if let Node::Atom(atom) = &context.observed.tree.nodes[some.0 as usize] {
                context.observed.texts.cases.insert(atom.0);
            }
            let (none, all) = (context.node(Node::Not(some)), context.atom(all, span, phrase.as_ref()));
            Ok(Typed::Formula(context.node(Node::Or(vec![none, all]))))
        }
        Quantifier::Exists => {
            let phrase =
                phrase.and_then(|one| phrase::phrase(context, span, Form::Someone(set.clone(), one)));
            Ok(Typed::Truth(Bool::Exists(set, Box::new(context.as_truth(typed, body.span)?)), phrase))
        }
        Quantifier::Count => {
            let truth = context.as_truth(typed, body.span)?;
            Ok(Typed::Num(Num::Count(set, Box::new(truth)), Dimension::NONE))
        }
        Quantifier::Fold(aggregate) => {
            let (num, dimension) = context.as_num(typed, body.span)?;
            Ok(Typed::Num(Num::Fold(fold(aggregate), set, Box::new(num)), dimension))
        }
    }
}

/// Where a condition of each is an implication, the condition that some of them has its left side.
fn left_side(context: &mut Context<'_>, body: &Expr, locals: &Locals) -> Lowered<Option<Case>> {
    match &body.kind {
        ExprKind::Binary(BinaryOp::Implies, left, _) => {
            let typed = context.lower(left, locals)?;
            let phrase = typed.phrase();
            let text = context.words(left.span);
            Ok(Some(Case { truth: context.as_truth(typed, left.span)?, text, phrase }))
        }
        ExprKind::Quantified { quantifier: Quantifier::Forall, variable, set, body } => {
            let place = set.span;
            let members = context.lower(set, locals)?;
            if matches!(members, Typed::Processes(_)) {
                return Ok(None);
            }
            let set = context.as_set(members, place)?;
            let mut inner = locals.clone();
            inner.bind_person(variable, Who::Running(locals.running), context.temporal);
            inner.running += 1;
            let left = left_side(context, body, &inner)?;
            Ok(left.map(|left| someone(context, (variable, place, set), left, body.span)))
        }
        _ => Ok(None),
    }
}

/// The condition that a member of a set has the left side. It is not in the source, so its text is made here.
fn someone(
    context: &Context<'_>,
    (variable, place, set): (&Ident, Span, Set),
    left: Case,
    span: Span,
) -> Case {
    let text = format!("exists {} in {}: {}", variable.name, context.words(place), left.text);
    let someone = left.phrase.map(|one| Form::Someone(set.clone(), one));
    let phrase = someone.and_then(|shape| phrase::unwritten(context, span, shape, &text));
    Case { truth: Bool::Exists(set, Box::new(left.truth)), text, phrase }
}

/// Over copies of a process everything is written out.
fn lower_over_processes(
    context: &mut Context<'_>,
    (quantifier, span): (Quantifier, Span),
    variable: &Ident,
    process: u32,
    body: &Expr,
    locals: &Locals,
) -> Lowered<Typed> {
    let formulas = quantifier == Quantifier::Count
        && context.temporal
        && mention::mentions_time(context, body, locals, variable);
    let mut each = Vec::new();
    for copy in process_names::copies(context, process) {
        let mut inner = locals.clone();
        if let Typed::Process { process, copy } = copy {
            let label = process_names::copy_label(context, (process, copy));
            inner.give(label.map(Given::Copy));
        }
        inner.bind(&variable.name, copy);
        each.push(if formulas {
            margins::inside_a_formula(context, |this| this.lower(body, &inner))?
        } else {
            context.lower(body, &inner)?
        });
    }
    let over_time = each.iter().any(|typed| matches!(typed, Typed::Formula(_) | Typed::Term(..)));
    match quantifier {
        Quantifier::Forall | Quantifier::Exists if over_time => {
            let nodes: Lowered<Vec<_>> =
                each.into_iter().map(|typed| context.as_formula(typed, body.span)).collect();
            let nodes = nodes?;
            let all = quantifier == Quantifier::Forall;
            Ok(Typed::Formula(context.node(if all { Node::And(nodes) } else { Node::Or(nodes) })))
        }
        Quantifier::Forall | Quantifier::Exists => {
            let phrases: Option<Vec<_>> = each.iter().map(Typed::phrase).collect();
            let truths: Lowered<Vec<Bool>> =
                each.into_iter().map(|typed| context.as_truth(typed, body.span)).collect();
            let truths = truths?;
            let all = quantifier == Quantifier::Forall;
            // Conditions without parts are those of the whole; whose they are is found all the same.
            let phrases = phrases.filter(|list| !list.iter().all(|one| one.is_plain()));
            let shape = |list| if all { Form::All(list) } else { Form::Any(list) };
            let phrase = phrases.and_then(|list| phrase::phrase(context, span, shape(list)));
            Ok(Typed::Truth(if all { Bool::And(truths) } else { Bool::Or(truths) }, phrase))
        }
        Quantifier::Count if formulas => {
            let nodes: Lowered<Vec<_>> =
                each.into_iter().map(|typed| context.as_formula(typed, body.span)).collect();
            Ok(Typed::Tally(nodes?))
        }
        Quantifier::Count => {
            let mut sum = Num::Constant(0.0);
            for typed in each {
                let one = as_number(context.as_truth(typed, body.span)?);
                sum = Num::Combine(Arithmetic::Add, Box::new(sum), Box::new(one));
            }
            Ok(Typed::Num(sum, Dimension::NONE))
        }
        Quantifier::Fold(aggregate) if over_time => fold_terms(context, aggregate, each, body.span),
        Quantifier::Fold(aggregate) => {
            let count = each.len() as f64;
            let mut joined: Option<(Num, Dimension)> = None;
            for typed in each {
                let (num, dimension) = context.as_num(typed, body.span)?;
                let operator = match aggregate {
                    Aggregate::Min => Arithmetic::Min,
                    Aggregate::Max => Arithmetic::Max,
                    Aggregate::Sum | Aggregate::Mean => Arithmetic::Add,
                };
                joined = Some(match joined {
                    None => (num, dimension),
                    Some((so_far, _)) => (Num::Combine(operator, Box::new(so_far), Box::new(num)), dimension),
                });
            }
            let (joined, dimension) = joined.unwrap_or((Num::Constant(0.0), Dimension::NONE));
            let joined = if aggregate == Aggregate::Mean {
                Num::Combine(Arithmetic::Divide, Box::new(joined), Box::new(Num::Constant(count)))
            } else {
                joined
            };
            Ok(Typed::Num(joined, dimension))
        }
    }
}

/// One formula or term for each member.
fn write_out(
    context: &mut Context<'_>,
    span: Span,
    quantifier: Quantifier,
    variable: &Ident,
    set: &Set,
    body: &Expr,
    locals: &Locals,
) -> Lowered<Typed> {
    let left_out = match set.except {
        Some(Who::Agent(id)) => Some(id),
        Some(Who::Running(_)) => {
            return context.report(error!(
                E0504,
                span, "a temporal formula cannot be quantified inside a fold over agents"
            ));
        }
        None => None,
    };
    let members: Vec<AgentId> = set.members.iter().copied().filter(|id| Some(*id) != left_out).collect();
    let mut each = Vec::with_capacity(members.len());
    for &id in &members {
        let mut inner = locals.clone();
        inner.bind_person(variable, Who::Agent(id), context.temporal);
        each.push(if quantifier == Quantifier::Count {
            margins::inside_a_formula(context, |this| this.lower(body, &inner))?
        } else {
            context.lower(body, &inner)?
        });
    }
    if each.is_empty() && !context.roster.agent_names.is_empty() {
        // Over an empty set the body is lowered for any agent, to report its errors and to get the unit of the fold.
        let mut inner = locals.clone();
        inner.bind(&variable.name, Typed::Agent(Who::Agent(AgentId(0))));
        let having = context.conducts.having.clone();
        context.conducts.stand_in();
        let typed = context.lower(body, &inner);
        context.conducts.having = having;
        let typed = typed?;
        if let Quantifier::Fold(aggregate) = quantifier {
            let (_, dimension) = context.as_term(typed, body.span)?;
            return Ok(Typed::Term(empty_fold(context, aggregate), dimension));
        }
    }
    match quantifier {
        Quantifier::Forall | Quantifier::Exists => {
            let nodes = of_those_present(context, quantifier, each, &members, body.span)?;
            let all = quantifier == Quantifier::Forall;
            // Over an empty set `forall` is true and `exists` false.
            Ok(Typed::Formula(context.node(match nodes.is_empty() {
                true => Node::Constant(all),
                false if all => Node::And(nodes),
                false => Node::Or(nodes),
            })))
        }
        Quantifier::Count => {
            Ok(Typed::Tally(of_those_present(context, quantifier, each, &members, body.span)?))
        }
        Quantifier::Fold(_) if members.iter().any(|id| context.roster.passing.contains(id)) => context
            .report(
                error!(E0504, span, "aggregates over time cannot be folded over agents that arrive or leave";
                    hint: "fold the values of each state: `min<=10 s (min(… for a in doors))`"),
            ),
        Quantifier::Fold(aggregate) => fold_terms(context, aggregate, each, body.span),
    }
}

/// Over an empty set the minimum is infinite, the maximum minus infinite, the sum 0, and the mean undefined.
fn empty_fold(context: &mut Context<'_>, aggregate: Aggregate) -> TermId {
    context.term(Term::Constant(match aggregate {
        Aggregate::Min => f64::INFINITY,
        Aggregate::Max => f64::NEG_INFINITY,
        Aggregate::Sum => 0.0,
        Aggregate::Mean => f64::NAN,
    }))
}

/// A formula of each member, where only who is present at the state at which it is asked counts.
fn of_those_present(
    context: &mut Context<'_>,
    quantifier: Quantifier,
    each: Vec<Typed>,
    members: &[AgentId],
    span: Span,
) -> Lowered<Vec<NodeId>> {
    let mut nodes = Vec::with_capacity(members.len());
    for (typed, &id) in each.into_iter().zip(members) {
        let node = context.as_formula(typed, span)?;
        if !context.roster.passing.contains(&id) {
            nodes.push(node);
            continue;
        }
        let present = context.presence_of(id, span);
        nodes.push(if quantifier == Quantifier::Forall {
            let absent = context.node(Node::Not(present));
            context.node(Node::Or(vec![absent, node]))
        } else {
            context.node(Node::And(vec![present, node]))
        });
    }
    Ok(nodes)
}

fn fold_terms(
    context: &mut Context<'_>,
    aggregate: Aggregate,
    each: Vec<Typed>,
    span: Span,
) -> Lowered<Typed> {
    let count = each.len();
    let operation = match aggregate {
        Aggregate::Min => Operation::Min,
        Aggregate::Max => Operation::Max,
        Aggregate::Sum | Aggregate::Mean => Operation::Add,
    };
    let mut dimension = Dimension::NONE;
    let mut joined = None;
    for typed in each {
        let (term, d) = context.as_term(typed, span)?;
        dimension = d;
        joined = Some(match joined {
            None => term,
            Some(so_far) => context.term(Term::Combine(operation, so_far, term)),
        });
    }
    let Some(joined) = joined else {
        return Ok(Typed::Term(empty_fold(context, aggregate), dimension));
    };
    if aggregate == Aggregate::Mean {
        let count = context.term(Term::Constant(count as f64));
        return Ok(Typed::Term(context.term(Term::Combine(Operation::Divide, joined, count)), dimension));
    }
    Ok(Typed::Term(joined, dimension))
}

fn fold(aggregate: Aggregate) -> Fold {
    match aggregate {
        Aggregate::Min => Fold::Min,
        Aggregate::Max => Fold::Max,
        Aggregate::Sum => Fold::Sum,
        Aggregate::Mean => Fold::Mean,
    }
}
