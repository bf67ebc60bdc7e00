//! Clauses of comparisons and rankings: width, error and procedure.

use crate::compile::context::{Context, Locals, Lowered, Reported};
use crate::compile::query::{
    arguments,
    bounds::{self, WIDEST},
    families::Allowance,
    measures::Sketch,
    methods::{self, DEFAULT_DELTA, DEFAULT_LOSS, Stated, stated},
};
use crate::stats::procedures::BETTING;
use crate::stats::spec::Serves;
use crate::stats::{Chosen, Spec};
use crate::syntax::ast::{Clauses, Method};
use crate::syntax::source::Span;

/// Half width, if any, and error of a comparison.
pub(crate) fn comparison_clauses(
    context: &mut Context<'_>,
    clauses: &Clauses,
    sketch: Sketch,
    allowance: Allowance,
    locals: &Locals,
) -> Lowered<(Option<f64>, f64)> {
    let procedure = match &clauses.by {
        Some(method) => {
            let said = "a comparison has one procedure only";
            context.report(error!(E0603, method.span, "{said}"))
        }
        None => Ok(()),
    };
    let within = methods::within(context, clauses, sketch, locals);
    let width = match (&clauses.within, within) {
        // The difference ranges over twice as much.
        (Some(expr), Ok(Some(epsilon))) => {
            bounds::width(context, (epsilon, expr.span), sketch, 2.0 * WIDEST).map(Some)
        }
        (_, within) => within,
    };
    let delta = methods::delta(context, clauses, locals);
    procedure?;
    Ok((width?, allowance.claim_error(delta?, DEFAULT_DELTA)))
}

/// Loss, error and procedure of a ranking by a measure.
pub(crate) fn ranking(
    context: &mut Context<'_>,
    clauses: &Clauses,
    (sketch, measured): (Sketch, Span),
    allowance: Allowance,
    locals: &Locals,
) -> Lowered<Chosen> {
    let within = methods::within(context, clauses, sketch, locals);
    let confidence = methods::delta(context, clauses, locals);
    let delta = allowance.claim_error(confidence.unwrap_or(None), DEFAULT_DELTA);
    let (procedure, width) = match &clauses.by {
        None => (Ok((&BETTING, delta)), stated(clauses, within)),
        Some(method) => ranking_by(context, (clauses, method), sketch, (within, delta), allowance, locals),
    };
    let epsilon = width.and_then(|width| loss(context, width, sketch, measured));
    let (ranking, delta) = procedure?;
    confidence?;
    Ok(ranking.with([epsilon?, delta]))
}

/// The procedure of a ranking and its error, and the width that is stated.
fn ranking_by(
    context: &mut Context<'_>,
    (clauses, method): (&Clauses, &Method),
    sketch: Sketch,
    (within, delta): (Lowered<Option<f64>>, f64),
    allowance: Allowance,
    locals: &Locals,
) -> (Lowered<(&'static Spec, f64)>, Stated) {
    let ranking = methods::procedure(context, method, Serves::Ranking, locals);
    if ranking.is_err() && !method.arguments.is_empty() {
        // The arguments of an unknown procedure are unknown, including the width.
        let width = if clauses.within.is_some() { stated(clauses, within) } else { Err(Reported) };
        return (Err(Reported), width);
    }
    let known = ranking.unwrap_or(&BETTING).arguments;
    let arguments = arguments::arguments(context, (clauses, method), known, sketch, locals);
    let delta = arguments::claimed(context, arguments.values[1], delta, allowance);
    let (width, sound) =
        (arguments::width_of(context, clauses, within, arguments.values[0]), arguments.sound());
    // What lacks is perhaps what is misspelt.
    let width = width.and_then(|width| if width.is_none() { sound.map(|()| width) } else { Ok(width) });
    let found = ranking.and_then(|ranking| Ok((ranking, delta?)));
    (found.and_then(|found| sound.map(|()| found)), width)
}

/// How much worse than the best a choice may be.
pub(crate) fn loss(
    context: &mut Context<'_>,
    width: Option<(f64, Span)>,
    sketch: Sketch,
    measured: Span,
) -> Lowered<f64> {
    let (epsilon, at) = match (width, sketch.dimension) {
        (Some(found), _) => found,
        // Only the user can say which difference in metres does not matter.
        (None, Some(dimension)) if !dimension.is_none() => {
            let error = error!(E0604, measured, "how much worse may a choice be?").formal();
            return context
                .report(error.hint(format!("say what does not matter, in {dimension}: `within …`")));
        }
        (None, Some(_)) => (DEFAULT_LOSS, measured),
        (None, None) => return Err(Reported),
    };
    bounds::width(context, (epsilon, at), sketch, 2.0 * WIDEST)
}
