//! Checks and comparisons: claims, thresholds, tests, sides.

use crate::compile::context::{Context, Locals, Lowered, Reported, number::Number, symbols::ScopeId};
use crate::compile::query::{
    aims, bindings, clauses,
    compiler::Compiler,
    families::Allowance,
    measures::{self, Observed, Sketch, What},
    methods::{self, DEFAULT_ALPHA, DEFAULT_DELTA, Theta},
};
use crate::compile::study::{Ask, Column, Measure, MeasureKind, Target};
use crate::stats::procedures::{MEAN_RUNNING, TAIL_RUNNING};
use crate::syntax::ast::{self, BinaryOp, Binding, Clauses, Expr};
use crate::syntax::diagnostic::{About, Diagnostic};
use crate::syntax::source::Span;

/// A check: its claim, threshold and test.
pub(crate) fn check(
    compiler: &mut Compiler<'_>,
    site: usize,
    measure: &ast::Measure,
    relation: BinaryOp,
    threshold: &Expr,
    clauses: &Clauses,
    (family, claims): (Option<f64>, usize),
    scope: ScopeId,
) -> Lowered<(Ask, bool)> {
    let locals = Locals::of(scope);
    let context = &mut compiler.sites[site].context;
    // What is wrong with the measure, the threshold and the procedure is said at once.
    let (observed, sketch) = measures::measure(context, measure, scope);
    let bound = bound_of(context, relation, threshold, sketch, &locals);
    let allowance = Allowance { family, claims };
    let confidence = methods::delta(context, clauses, &locals);
    let width = methods::no_width(context, clauses, sketch.what);
    let test = match (sketch.what, &clauses.by) {
        (What::Expectation | What::Tail, None) => {
            let spec = if sketch.what == What::Tail { &TAIL_RUNNING } else { &MEAN_RUNNING };
            confidence.map(|stated| spec.with([allowance.claim_error(stated, DEFAULT_ALPHA)]))
        }
        (What::Expectation | What::Tail, Some(method)) => {
            let said = "a check of an expectation or a tail has only one procedure, without `by`";
            context.report(error!(E0603, method.span, "{said}"))
        }
        (What::Quantile, _) => {
            let level = match &measure.kind {
                ast::MeasureKind::Quantile(level) => level.span,
                _ => measure.span,
            };
            let theta = Theta { value: sketch.level, at: level, noun: "level" };
            methods::test(context, clauses, theta, allowance, &locals)
        }
        (What::Probability | What::Curve, _) => {
            let value = bound.ok().map(|bound| bound.value);
            let theta = Theta { value, at: threshold.span, noun: "threshold" };
            methods::test(context, clauses, theta, allowance, &locals)
        }
    };
    width?;
    let (bound, test) = (bound?, test?);
    // Where a confidence is stated, or comes from a family, it is also that of the interval.
    let beside = allowance.claim_error(confidence?, DEFAULT_DELTA);
    let context = &mut compiler.sites[site].context;
    let Claim { column, kind, at_least, or_equal, threshold, unbounded } =
        claim(context, observed?, relation, (bound, threshold.span))?;
    let column = compiler.column(site, column);
    let measure = Measure { target: Target { world: site, column }, kind };
    Ok((Ask::Check { measure, at_least, or_equal, threshold, test, beside }, unbounded))
}

/// That a measure is on one side of a threshold, as it is decided.
pub(crate) struct Claim {
    pub(crate) column: Column,
    pub(crate) kind: MeasureKind,
    pub(crate) at_least: bool,
    or_equal: bool,
    pub(crate) threshold: f64,
    unbounded: bool,
}

/// How a comparison of a measure is decided: that of a quantile as one of a probability.
pub(crate) fn claim(
    context: &mut Context<'_>,
    observed: Observed,
    relation: BinaryOp,
    (bound, at): (Number, Span),
) -> Lowered<Claim> {
    let mut at_least = matches!(relation, BinaryOp::AtLeast | BinaryOp::Greater);
    let or_equal = matches!(relation, BinaryOp::AtLeast | BinaryOp::AtMost);
    let Observed { column, kind, unbounded } = observed;
    let (column, kind, threshold) = match kind {
        // A quantile is at most x exactly if P(metric <= x) is at least its level. It is below x if
        // P(metric < x) is above its level, and not if that is below. So strictness goes with the side:
        // `<= x` and `> x` are settled by P(metric <= x), `< x` and `>= x` by P(metric < x).
        MeasureKind::Quantile { level, .. } => {
            let limit = (bound.value, at);
            let below = measures::below(context, &column, at_least != or_equal, limit, bound.dimension)?;
            at_least = !at_least;
            (below, MeasureKind::Probability, level)
        }
        kind => (column, kind, bound.value),
    };
    Ok(Claim { column, kind, at_least, or_equal, threshold, unbounded })
}

/// A comparison: its sides, width and error; and the world of the first side.
pub(crate) fn compare<'a>(
    compiler: &mut Compiler<'a>,
    site: usize,
    measure: &ast::Measure,
    [first, second]: [&'a [Binding]; 2],
    clauses: &Clauses,
    family: Option<f64>,
    scope: ScopeId,
) -> Lowered<(Ask, bool, usize)> {
    for binding in first.iter().chain(second) {
        if let Some(common) = clauses.under.iter().find(|common| common.name.name == binding.name.name) {
            let text = format!("`{}` is set twice", binding.name.name);
            let error = error!(E0210, binding.name.span, "{text}")
                .about(About::Name(binding.name.name.clone()))
                .related(common.name.span, "set here for both sides")
                .hint("remove one of them");
            compiler.sites[site].context.note(error);
        }
    }
    // What `under` sets at the end of the query holds for both sides.
    let common = compiler.sites[site].settings.clone();
    let sides = (
        bindings::under(compiler, first, scope, site, &common),
        bindings::under(compiler, second, scope, site, &common),
    );
    // Where one side cannot be set up, the other one stands for both; where neither can, what they have in common.
    let (one, two) = match &sides {
        (Ok((one, _)), Ok((two, _))) => (*one, *two),
        (Ok((one, _)), Err(_)) => (*one, *one),
        (Err(_), Ok((two, _))) => (*two, *two),
        (Err(_), Err(_)) => (site, site),
    };
    let context = &compiler.sites[site].context;
    let (before, failures) = (context.sink.diagnostics.len(), context.names.failures());
    let ((a, sketch), (b, _)) =
        (compiler.measured(one, measure, scope), compiler.measured(two, measure, scope));
    let context = &mut compiler.sites[site].context;
    if sides.0.is_err() && sides.1.is_err() {
        context.keep_sure(before);
        context.names.forget_but_circles(&failures);
    }
    let allowance = Allowance { family, claims: 1 };
    let quantile = sketch.what == What::Quantile;
    let comparable = if quantile {
        let error = error!(E0607, measure.span, "`compare` does not accept quantiles";
                hint: "compare `P(metric <= bound)`, or estimate both");
        context.report(error)
    } else {
        Ok(())
    };
    let clauses = clauses::comparison_clauses(context, clauses, sketch, allowance, &Locals::of(scope));
    let (Ok((_, first_settings)), Ok((_, second_settings))) = sides else { return Err(Reported) };
    let settings = [first_settings, second_settings];
    let ((a, unbounded), (b, _)) = (a?, b?);
    comparable?;
    if matches!(a.kind, MeasureKind::Expectation { .. }) && a.kind != b.kind {
        let error = unlike(measure, "both sides of a comparison need", [&a.kind, &b.kind], &settings);
        return compiler.sites[site].context.report(error);
    }
    let (within, delta) = clauses?;
    Ok((Ask::Compare { first: a, second: b, settings, within, delta }, unbounded, one))
}

/// The threshold of a measure: a number in its unit, between 0 and 1 if it is a probability and within the range
/// of an expectation.
pub(crate) fn bound_of(
    context: &mut Context<'_>,
    relation: BinaryOp,
    threshold: &Expr,
    sketch: Sketch,
    locals: &Locals,
) -> Lowered<Number> {
    // Without a metric the unit of the threshold is unknown.
    let bound = measures::number_in(context, threshold, sketch, locals)?;
    let theta = bound.value;
    if sketch.what == What::Probability && (theta <= 0.0 || theta >= 1.0) {
        let hint = if theta > 1.0 && theta <= 100.0 {
            format!("write a percentage with its sign: `{theta} %`")
        } else {
            let near = if theta <= 0.0 { 0.001 } else { 0.999 };
            let sign = aims::sign(relation);
            format!(
                "no number of trials can show that an event is certain or impossible; write `{sign} {near}`"
            )
        };
        return context.report(error!(E0601, threshold.span, "the threshold of a probability must be between 0 and 1 (got {theta})";
                hint: "{hint}"));
    }
    if let Some(((low, high), range)) = sketch.range
        && (theta <= low || theta >= high)
    {
        let said = "the threshold is outside the range of the metric";
        return context.report(error!(E0601, threshold.span, "{said}").hanging_on(range));
    }
    Ok(bound)
}

/// The error of a comparison or ranking of which two sides have ranges, or units, of their own.
pub(crate) fn unlike(
    measure: &ast::Measure,
    need: &str,
    kinds: [&MeasureKind; 2],
    settings: &[Vec<(String, String)>; 2],
) -> Diagnostic {
    let side = |kind: &MeasureKind, settings: &[(String, String)]| {
        let range = match kind {
            MeasureKind::Expectation { range, dimension, .. } => {
                let unit = if dimension.is_none() { String::new() } else { format!(" {dimension}") };
                format!("{}{unit} .. {}{unit}", range.0, range.1)
            }
            _ => "none".to_owned(),
        };
        let settings: Vec<String> =
            settings.iter().map(|(name, value)| format!("{name} = {value}")).collect();
        format!("{range} with {}", settings.join(", "))
    };
    let (first, second) = (side(kinds[0], &settings[0]), side(kinds[1], &settings[1]));
    let place = measure.range.as_ref().map_or(measure.span, |(low, high)| low.span.to(high.span));
    error!(E0605, place, "{need} the same range ({first}, {second})";
        hint: "write a range that depends on none of the parameters that differ")
}
