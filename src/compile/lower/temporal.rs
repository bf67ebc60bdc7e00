//! Temporal operators and windows over the states of a trace.

use crate::base::tick::Tick;
use crate::compile::context::{Context, Locals, Lowered, typed::Typed};
use crate::logic::{Aggregation, Node, NodeId, Term, Window};
use crate::syntax::ast::expression::{Temporal, TemporalPair};
use crate::syntax::ast::{Aggregate, Bound};
use crate::syntax::source::Span;

/// From the present state on.
pub(crate) const ALWAYS: Window = Window { from: Tick(0), to: None };

/// An error where a formula over time is not allowed.
pub(crate) fn check_allowed(context: &mut Context<'_>, span: Span, locals: &Locals) -> Lowered<()> {
    if locals.running > 0 {
        return context
            .report(error!(E0504, span, "a temporal formula is not allowed inside a fold over agents"));
    }
    if !context.temporal {
        let error = error!(E0504, span, "temporal operators are allowed only in property files");
        return context.report(error);
    }
    Ok(())
}

/// `F`, `G`, `X` of a formula.
pub(crate) fn operator(
    context: &mut Context<'_>,
    (span, op): (Span, Temporal),
    (bound, window): (Option<&Bound>, Window),
    body: NodeId,
) -> Lowered<Typed> {
    let node = match op {
        Temporal::Finally => Node::Finally(window, body),
        Temporal::Globally => Node::Globally(window, body),
        Temporal::Next => {
            if context.time.clock.is_jumps() {
                let error = error!(E0507, span, "`X` is not available in continuous time";
                    hint: "write `F[a, b]`, or set a `step` in the scenario");
                return context.report(error);
            }
            // X<=k p: p at exactly the k-th state, as in the paper; X p is X<=1.
            let at = match (bound, window.to) {
                (None, _) => Tick(1),
                (Some(Bound::Interval(start, end)), _) => {
                    let place = start.span.to(end.span);
                    let error = error!(E0503, place, "`X` needs one time, not an interval";
                        hint: "`X<=0.5 s p` means p at exactly 0.5 s; for an interval write `F[a, b]` or `G[a, b]`");
                    return context.report(error.formal());
                }
                (Some(_), Some(to)) => to,
                (Some(_), None) => {
                    return context.report(error!(E0503, span, "`X` needs a finite time"));
                }
            };
            Node::Finally(Window { from: at, to: Some(at) }, body)
        }
    };
    Ok(Typed::Formula(context.node(node)))
}

/// `U`, `R`, `W` of two formulas.
pub(crate) fn pair(
    context: &mut Context<'_>,
    op: TemporalPair,
    window: Window,
    (left, right): (NodeId, NodeId),
) -> Typed {
    Typed::Formula(context.node(match op {
        TemporalPair::Until => Node::Until(window, left, right),
        TemporalPair::Release => Node::Release(window, left, right),
        TemporalPair::WeakUntil => Node::WeakUntil(window, left, right),
    }))
}

/// An error where an aggregate over time has no meaning under this clock.
pub(crate) fn check_aggregate(context: &mut Context<'_>, span: Span, aggregate: Aggregate) -> Lowered<()> {
    if aggregate == Aggregate::Sum && context.time.clock.is_jumps() {
        let error = error!(E0508, span, "`sum` over time is not available in continuous time";
            hint: "write `mean`, the time average");
        return context.report(error);
    }
    Ok(())
}

/// An aggregate of a number over a window.
pub(crate) fn aggregated(
    context: &mut Context<'_>,
    aggregate: Aggregate,
    window: Lowered<Window>,
    (typed, span): (Typed, Span),
) -> Lowered<Typed> {
    let (term, dimension) = context.as_term(typed, span)?;
    let aggregation = match aggregate {
        Aggregate::Min => Aggregation::Min,
        Aggregate::Max => Aggregation::Max,
        Aggregate::Sum => Aggregation::Sum,
        Aggregate::Mean => Aggregation::Mean,
    };
    Ok(Typed::Term(context.term(Term::Window(aggregation, window?, term)), dimension))
}

/// The window between two times.
pub(crate) fn interval(
    context: &mut Context<'_>,
    (from, to): (Lowered<Option<Tick>>, Lowered<Option<Tick>>),
    (start, end): (Span, Span),
) -> Lowered<Window> {
    let Some(from) = from? else {
        return context.report(error!(E0503, start, "the start of an interval must be finite"));
    };
    let to = to?;
    if to.is_some_and(|to| to < from) {
        return context.report(error!(E0503, start.to(end), "the interval ends before it starts"));
    }
    Ok(Window { from, to })
}
