//! Procedures: from the text of a query and the documented defaults, never from the budget.

use crate::compile::context::{Context, Locals, Lowered};
use crate::compile::dimension::Dimension;
use crate::compile::nearest::nearest;
use crate::compile::query::{
    arguments::{self, Setting},
    bounds::{self, WIDEST},
    families::Allowance,
    measures::{self, Sketch, What},
};
use crate::stats::procedures::{
    CURVE_FIXED, EPROCESS, MEAN_FIXED, MEAN_WITHIN, PROBABILITY_WITHIN, QUANTILE_FIXED, TAIL_FIXED,
    TAIL_WITHIN,
};
use crate::stats::spec::{Kind, Make, Serves};
use crate::stats::{Chosen, Spec, okamoto, splitting};
use crate::syntax::ast::{Clauses, Expr, Method};
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::source::Span;

/// Error probability of either side of a check, unless it says otherwise.
pub const DEFAULT_ALPHA: f64 = 0.01;
/// Error probability of estimates, comparisons and rankings, unless they say otherwise.
pub const DEFAULT_DELTA: f64 = 0.05;
/// Half width of the interval of a probability, unless it says otherwise.
pub const DEFAULT_EPSILON: f64 = 0.01;
/// Loss that does not matter to a ranking, unless it says otherwise.
pub const DEFAULT_LOSS: f64 = 0.02;
/// Trials of an expectation, a quantile or a comparison that names no half width.
pub const PLANNED_TRIALS: u64 = 1000;

/// Bytes that one path of splitting takes, about, and most paths at once.
const BYTES_OF_A_PATH: u64 = 400;
const MOST_PATHS: u64 = 5_000_000;

/// The probability that a test decides about.
#[derive(Clone, Copy)]
pub(crate) struct Theta {
    /// Unless something is wrong with it.
    pub(crate) value: Option<f64>,
    pub(crate) at: Span,
    /// Its kind: a threshold, or the level of a quantile.
    pub(crate) noun: &'static str,
}

/// The width that a query states, if it does, and where.
pub(crate) type Stated = Lowered<Option<(f64, Span)>>;

/// The width of `within`.
pub(crate) fn stated(clauses: &Clauses, within: Lowered<Option<f64>>) -> Stated {
    within.map(|within| clauses.within.as_ref().zip(within).map(|(expr, width)| (width, expr.span)))
}

/// One minus the confidence of a clause.
pub(crate) fn delta(context: &mut Context<'_>, clauses: &Clauses, locals: &Locals) -> Lowered<Option<f64>> {
    let Some(expr) = &clauses.confidence else { return Ok(None) };
    confidence(context, expr, locals).map(Some)
}

/// One minus a confidence.
pub(crate) fn confidence(context: &mut Context<'_>, expr: &Expr, locals: &Locals) -> Lowered<f64> {
    let number = context.number_of(expr, Dimension::NONE, locals)?;
    if number.value <= 0.5 || number.value >= 1.0 {
        return context.report(error!(E0604, expr.span, "the confidence must be above 50 % and below 100 % (got {})", number.value;
                hint: "write `confidence 95 %` or `confidence 0.95`"));
    }
    // 1 - 0.95 is not 0.05 in doubles; the decimal is.
    let exact = number.exact.and_then(|c| crate::base::decimal::Decimal::ONE.sub(c));
    Ok(exact.map_or(1.0 - number.value, crate::base::decimal::Decimal::to_f64))
}

pub(crate) fn within(
    context: &mut Context<'_>,
    clauses: &Clauses,
    sketch: Sketch,
    locals: &Locals,
) -> Lowered<Option<f64>> {
    clauses.within.as_ref().map(|expr| positive(context, expr, sketch, locals)).transpose()
}

/// A width in the unit of a measure.
pub(crate) fn positive(
    context: &mut Context<'_>,
    expr: &Expr,
    sketch: Sketch,
    locals: &Locals,
) -> Lowered<f64> {
    let number = measures::number_in(context, expr, sketch, locals)?;
    if number.value <= 0.0 {
        return context.report(error!(E0604, expr.span, "`within` must be positive"));
    }
    Ok(number.value)
}

/// The procedure that a method names.
pub(crate) fn procedure(
    context: &mut Context<'_>,
    method: &Method,
    serves: Serves,
    locals: &Locals,
) -> Lowered<&'static Spec> {
    let name = &method.name.name;
    if let Some(spec) = Spec::find(name, serves) {
        return Ok(spec);
    }
    for argument in &method.arguments {
        let _ = context.number(&argument.value, locals);
    }
    let error = error!(E0603, method.name.span, "the procedure `{name}` is not available for this query");
    let known: Vec<&str> = Spec::names(serves).collect();
    let hint = nearest(name, known.iter().copied()).map_or_else(
        || format!("the procedures are {}", known.join(", ")),
        |n| format!("did you mean `{n}`?"),
    );
    context.report(error.hint(hint).knowing(known))
}

/// That a check states no width.
pub(crate) fn no_width(context: &mut Context<'_>, clauses: &Clauses, what: What) -> Lowered<()> {
    let Some(within) = &clauses.within else { return Ok(()) };
    let error = error!(E0607, within.span, "a check has no `within`");
    context.report(if what.has_range() {
            error.hint("remove `within`: the check stops as soon as the interval of the mean is on one side of the threshold")
        } else {
            error.hint("remove `within`; for an indifference region write `by sprt(indifference = 0.01)`")
        })
}

/// The test of a check, around what it decides about.
pub(crate) fn test(
    context: &mut Context<'_>,
    clauses: &Clauses,
    theta: Theta,
    allowance: Allowance,
    locals: &Locals,
) -> Lowered<Chosen> {
    let confidence = delta(context, clauses, locals);
    let error = allowance.claim_error(confidence.unwrap_or(None), DEFAULT_ALPHA);
    let test = match &clauses.by {
        None => Ok(EPROCESS.with([error, error])),
        Some(method) => procedure(context, method, Serves::Check, locals).and_then(|spec| {
            let (sketch, within) = (Sketch::PROBABILITY, Ok(None));
            let setting = Setting { sketch, theta: Some(theta), error, allowance, within, locals };
            arguments::chosen(context, (clauses, method), spec, &setting)
        }),
    };
    confidence?;
    test
}

/// The estimator of a measure.
pub(crate) fn estimator(
    context: &mut Context<'_>,
    clauses: &Clauses,
    sketch: Sketch,
    allowance: Allowance,
    locals: &Locals,
) -> Lowered<Chosen> {
    let within = within(context, clauses, sketch, locals);
    let confidence = delta(context, clauses, locals);
    let error = allowance.claim_error(confidence.unwrap_or(None), DEFAULT_DELTA);
    let serves = match sketch.what {
        What::Probability => Serves::Probability,
        What::Expectation => Serves::Expectation,
        What::Tail => Serves::Tail,
        What::Quantile => Serves::Quantile,
        What::Curve => Serves::Curve,
    };
    let misplaced = match &clauses.within {
        Some(expr) if serves == Serves::Quantile => context
            .report(error!(E0607, expr.span, "a quantile has a number of trials, not a width";
                    hint: "write `by fixed(trials = 2000)`; the values determine the width")),
        _ => Ok(()),
    };
    let estimator = match &clauses.by {
        Some(method) => procedure(context, method, serves, locals).and_then(|spec| {
            let misplaced = if misplaced.is_ok() { no_promise(context, clauses, spec) } else { misplaced };
            let setting = Setting { sketch, theta: None, error, allowance, within, locals };
            let chosen = arguments::chosen(context, (clauses, method), spec, &setting)?;
            few_paths(context, method, &chosen)?;
            misplaced.map(|()| chosen)
        }),
        None => default_estimator(context, clauses, sketch, (within, error)),
    };
    confidence?;
    misplaced?;
    estimator
}

fn default_estimator(
    context: &mut Context<'_>,
    clauses: &Clauses,
    sketch: Sketch,
    (within, delta): (Lowered<Option<f64>>, f64),
) -> Lowered<Chosen> {
    let within = within?;
    if let (Some(expr), Some(epsilon)) = (&clauses.within, within) {
        bounds::width(context, (epsilon, expr.span), sketch, WIDEST)?;
    }
    let trials = PLANNED_TRIALS as f64;
    Ok(match (sketch.what, within) {
        (What::Probability, within) => PROBABILITY_WITHIN.with([within.unwrap_or(DEFAULT_EPSILON), delta]),
        (What::Expectation, Some(epsilon)) => MEAN_WITHIN.with([epsilon, delta]),
        (What::Expectation, None) => MEAN_FIXED.with([trials, delta]),
        (What::Tail, Some(epsilon)) => TAIL_WITHIN.with([epsilon, delta]),
        (What::Tail, None) => TAIL_FIXED.with([trials, delta]),
        (What::Quantile, _) => QUANTILE_FIXED.with([trials, delta]),
        // The band is as wide as Okamoto's interval.
        (What::Curve, within) => {
            let size = within.map_or(trials, |epsilon| okamoto::size(epsilon, delta) as f64);
            CURVE_FIXED.with([size, delta])
        }
    })
}

/// That a procedure which promises no width has no `within`.
fn no_promise(context: &mut Context<'_>, clauses: &Clauses, spec: &Spec) -> Lowered<()> {
    let Some(within) = &clauses.within else { return Ok(()) };
    let (said, hint) = match spec.make {
        Make::Splitting { .. } => (
            "splitting cannot guarantee a width",
            "remove `within` and choose `replicas` and `runs`; their scatter determines the width",
        ),
        _ if spec.arguments.iter().any(|argument| matches!(argument.kind, Kind::Trials(_))) => (
            "a fixed number of trials cannot guarantee a width",
            "remove `by`, then the width determines the number of trials, or remove `within`",
        ),
        _ => return Ok(()),
    };
    context.report(error!(E0607, within.span, "{said}"; hint: "{hint}"))
}

/// That all paths of splitting fit into memory.
fn few_paths(context: &mut Context<'_>, method: &Method, chosen: &Chosen) -> Lowered<()> {
    let Some(rule) = splitting::Rule::of(chosen) else { return Ok(()) };
    let paths = rule.replicas * rule.runs;
    if paths <= MOST_PATHS {
        return Ok(());
    }
    let gigabytes = |paths: u64| (paths * BYTES_OF_A_PATH) as f64 / 1e9;
    let (taken, limit) = (gigabytes(paths), gigabytes(MOST_PATHS));
    let said = format!("{paths} paths need {taken:.1} GB of memory; the limit is {limit:.1} GB");
    let error = error!(E0923, method.span, "{said}");
    let given = method.arguments.iter().find(|argument| argument.name.name == "replicas");
    let error = given.map(|one| one.value.span).into_iter().fold(error, Diagnostic::hanging_on);
    let fewer = MOST_PATHS / rule.runs;
    context.report(error.hint(format!("each run has one path for each replica: write `replicas = {fewer}`")))
}
