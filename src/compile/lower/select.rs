//! One of several values: the smallest, the largest, and `if`.

use crate::compile::context::{Context, Lowered, Reported, typed::Typed};
use crate::compile::dimension::Dimension;
use crate::logic::{Operation, Term};
use crate::model::{Arithmetic, Bool, Num};
use crate::syntax::ast::Ident;
use crate::syntax::source::Span;

/// An error where the smallest or largest of one value is asked for.
pub(crate) fn enough(
    context: &mut Context<'_>,
    (span, function): (Span, &Ident),
    given: usize,
) -> Lowered<()> {
    if given >= 2 {
        return Ok(());
    }
    context.report(error!(E0204, span, "`{}` needs at least two values", function.name;
        hint: "for a set write `{0}(… for a in crowd)`, for a time window `{0}<=10 s (…)`", function.name))
}

/// The smallest or the largest of some values.
pub(crate) fn extremum(
    context: &mut Context<'_>,
    operator: Arithmetic,
    values: Vec<(Typed, Span)>,
) -> Lowered<Typed> {
    let smallest = operator == Arithmetic::Min;
    let over_time = values.iter().any(|(typed, _)| matches!(typed, Typed::Term(..)));
    let mut joined: Option<(Typed, Dimension)> = None;
    for (typed, span) in values {
        let next = if over_time {
            let (term, dimension) = context.as_term(typed, span)?;
            (Typed::Term(term, dimension), dimension)
        } else if let Typed::Number(number) = typed {
            (Typed::Number(number), number.dimension)
        } else {
            let (num, dimension) = context.as_num(typed, span)?;
            (Typed::Num(num, dimension), dimension)
        };
        let Some((so_far, dimension)) = joined else {
            joined = Some(next);
            continue;
        };
        if dimension != next.1 {
            return context.wrong_dimension(span, dimension, next.1);
        }
        let both = match (so_far, next.0) {
            (Typed::Term(a, _), Typed::Term(b, _)) => {
                let operation = if smallest { Operation::Min } else { Operation::Max };
                Typed::Term(context.term(Term::Combine(operation, a, b)), dimension)
            }
            (Typed::Number(a), Typed::Number(b)) => {
                Typed::Number(if (a.value <= b.value) == smallest { a } else { b })
            }
            (a, b) => {
                let (a, b) = (context.as_num(a, span)?.0, context.as_num(b, span)?.0);
                Typed::Num(Num::Combine(operator, Box::new(a), Box::new(b)), dimension)
            }
        };
        joined = Some((both, dimension));
    }
    joined.map(|(typed, _)| typed).ok_or(Reported)
}

/// `if(condition, yes, no)`
pub(crate) fn choice(
    context: &mut Context<'_>,
    truth: Bool,
    (yes, yes_at): (Typed, Span),
    (no, no_at): (Typed, Span),
) -> Lowered<Typed> {
    if let (Bool::Constant(holds), Typed::Number(a), Typed::Number(b)) = (&truth, &yes, &no)
        && a.dimension == b.dimension
    {
        return Ok(Typed::Number(if *holds { *a } else { *b }));
    }
    let sides = (context.as_num(yes, yes_at), context.as_num(no, no_at));
    let ((a, da), (b, db)) = (sides.0?, sides.1?);
    if da != db {
        return context.wrong_dimension(no_at, da, db);
    }
    Ok(Typed::Num(Num::If(Box::new(truth), Box::new(a), Box::new(b)), da))
}
