//! Curves: a probability as a function of the bound of its outermost operator, `P(F<=t p)` for t in a range.
//!
//! `F<=t p` holds exactly if the time until p is at most t, and `G<=t p` if the time until !p is above t. So all points of a
//! curve come from one time of each trial, and the band around its distribution function holds for all of them at once.

use crate::compile::context::{Context, Locals, Lowered, Reported, number::Number, symbols::ScopeId};
use crate::compile::query::{
    compiler::Compiler,
    families::Allowance,
    measures::{self, Sketch, What},
    methods,
};
use crate::compile::study::{Ask, Column, Measure, MeasureKind, Target};
use crate::syntax::ast::{self, Bound, Clauses, Expr, ExprKind, Ident, Temporal, UnaryOp, Values};

/// Most points of a curve.
const MOST_POINTS: f64 = 1000.0;

/// An estimate of a curve.
pub(crate) fn curve(
    compiler: &mut Compiler<'_>,
    site: usize,
    (measure, name, values): (&ast::Measure, &Ident, &Values),
    clauses: &Clauses,
    family: Option<f64>,
    scope: ScopeId,
) -> Lowered<(Ask, bool)> {
    let locals = Locals::of(scope);
    let context = &mut compiler.sites[site].context;
    let times = times(context, values, &locals);
    let sketch = Sketch { what: What::Curve, ..Sketch::PROBABILITY };
    let allowance = Allowance { family, claims: 1 };
    let estimator = methods::estimator(context, clauses, sketch, allowance, &locals);
    let (goal, falls) = goal(context, measure, name)?;
    let Values::Range { to: Expr { span: last, .. }, .. } = values else { return Err(Reported) };
    let (last, inner) = (*last, context.text(goal.span));
    let until = Expr {
        kind: ExprKind::Call {
            function: Ident { name: "time_until".to_owned(), span: measure.body.span },
            arguments: vec![goal],
        },
        span: measure.body.span,
    };
    let (root, dimension, _) = measures::metric_root(context, &until, scope)?;
    let times = times?;
    if times.last().is_some_and(|end| *end > context.time.clock.seconds(context.time.horizon) + 1e-9) {
        let horizon = context.time.whole();
        return context.report(error!(E0502, last, "the curve ends beyond the horizon, which is {horizon}";
            hint: "set a longer horizon in the scenario, or end the curve at {horizon}"));
    }
    let text = context.text(measure.body.span);
    let column = compiler.column(site, Column { root, text });
    let end = compiler.sites[site].context.text(last);
    let end = format!("P({}<={end} {inner})", if falls { 'G' } else { 'F' });
    let kind = MeasureKind::Curve { times, falls, dimension, name: name.name.clone(), last: end };
    let measure = Measure { target: Target { world: site, column }, kind };
    Ok((Ask::Estimate { measure, estimator: estimator?, level: None }, false))
}

/// The formula whose first truth decides, and whether the probability falls with the bound.
fn goal(context: &mut Context<'_>, measure: &ast::Measure, name: &Ident) -> Lowered<(Expr, bool)> {
    let bound = &name.name;
    if matches!(measure.kind, ast::MeasureKind::Probability)
        && let ExprKind::Temporal(operator, Some(Bound::AtMost(end)), inner) = &measure.body.kind
        && matches!(&end.kind, ExprKind::Name(own) if own == bound)
    {
        match operator {
            Temporal::Finally => return Ok(((**inner).clone(), false)),
            Temporal::Globally => {
                let not = ExprKind::Unary(UnaryOp::Not, inner.clone());
                return Ok((Expr { kind: not, span: inner.span }, true));
            }
            Temporal::Next => {}
        }
    }
    context.report(error!(E0609, measure.span, "a curve needs a formula whose outermost operator is bounded by `{bound}`";
        hint: "write `P(F<={bound} (…))` or `P(G<={bound} (…))`"))
}

/// The bounds, ascending.
fn times(context: &mut Context<'_>, values: &Values, locals: &Locals) -> Lowered<Vec<f64>> {
    let Values::Range { from, to, by, log } = values else { return Err(Reported) };
    let dimension = context.time.dimension();
    let mut number = |expr: &Expr| context.number_of(expr, dimension, locals);
    let (first, last, step) = (number(from), number(to), number(by));
    let (first, last, step) = (first?, last?, step?);
    if *log {
        return context.report(
            error!(E0609, by.span, "the points of a curve have equal distances"; hint: "leave `log` out"),
        );
    }
    if first.value < 0.0 {
        return context.report(error!(E0609, from.span, "a curve begins at 0 or later"));
    }
    if step.value <= 0.0 || last.value < first.value {
        let place = if step.value <= 0.0 { by.span } else { to.span };
        return context.report(error!(
            E0609,
            place, "the bounds must go up from the first to the last by a positive step"
        ));
    }
    let count = ((last.value - first.value) / step.value + 1e-9).floor();
    if count >= MOST_POINTS {
        return context.report(
            error!(E0609, by.span, "a curve has at most {MOST_POINTS} points"; hint: "write a larger step"),
        );
    }
    // Each from the first, in decimals where they are: three tenths of a second are 0.3 s.
    let point = |k: i64| step.times(Number::whole(k)).map_or(first, |way| first.plus(way)).value;
    Ok((0..=count as i64).map(point).collect())
}
