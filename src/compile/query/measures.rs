//! Measures: what is asked of the distribution of traces.

use crate::base::tick::Tick;
use crate::compile::context::processes::Declared;
use crate::compile::context::{
    Context, Locals, Lowered, Reported,
    number::Number,
    symbols::{Meaning, ScopeId},
    typed::Typed,
    wording::bare,
};
use crate::compile::dimension::Dimension;
use crate::compile::lower::{form, logic, robustness};
use crate::compile::query::watched;
use crate::compile::study::{Column, MeasureKind};
use crate::logic::{Node, NodeId, Part, Relation, Root, Sought, Term, TermId, leaves, looks_ahead};
use crate::syntax::ast::{self, BinaryOp, Expr, ExprKind, Moment, ProcessItem};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::source::Span;

/// A measure lowered in one world.
pub(crate) struct Observed {
    /// What is observed.
    pub(crate) column: Column,
    /// Which number of its distribution.
    pub(crate) kind: MeasureKind,
    /// Whether it ranges up to the horizon.
    pub(crate) unbounded: bool,
}

/// The kind of a measure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum What {
    Probability,
    Expectation,
    Tail,
    Quantile,
    Curve,
}

impl What {
    /// Whether it is a number of a metric with a range.
    pub(crate) const fn has_range(self) -> bool {
        matches!(self, Self::Expectation | Self::Tail)
    }
}

/// The known properties of a measure that may have errors. The rest of its query is checked only against these.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sketch {
    pub(crate) what: What,
    /// The dimension of its values, thresholds and widths.
    pub(crate) dimension: Option<Dimension>,
    /// The range of an expectation, and its place.
    pub(crate) range: Option<((f64, f64), Span)>,
    /// The level of a quantile.
    pub(crate) level: Option<f64>,
}

impl Sketch {
    /// A probability, for which everything is known.
    pub(crate) const PROBABILITY: Self =
        Self { what: What::Probability, dimension: Some(Dimension::NONE), range: None, level: None };

    fn of(what: What, dimension: Option<Dimension>) -> Self {
        Self { what, dimension, range: None, level: None }
    }
}

/// A number in the dimension of a measure; in any dimension if that is unknown.
pub(crate) fn number_in(
    context: &mut Context<'_>,
    expr: &Expr,
    sketch: Sketch,
    locals: &Locals,
) -> Lowered<Number> {
    match sketch.dimension {
        Some(dimension) => context.number_of(expr, dimension, locals),
        None => context.number(expr, locals),
    }
}

/// A formula asked at the start of a trace.
pub(crate) fn formula_column(
    context: &mut Context<'_>,
    body: &Expr,
    scope: ScopeId,
) -> Lowered<(Column, bool)> {
    context.temporal = true;
    let typed = context.lower(body, &Locals::of(scope));
    context.temporal = false;
    let node = context.as_formula(typed?, body.span)?;
    if context.observed.overflown {
        return Err(Reported);
    }
    // What is wrong with a whole property is said where it is declared, however often it is asked about.
    let place = match &body.kind {
        ExprKind::Name(name) => match context.look_up(name, scope) {
            Some((_, Meaning::Property(formula))) => formula.span,
            _ => body.span,
        },
        _ => body.span,
    };
    let unbounded = watched::within_horizon(context, Part::Node(node), place)?;
    watched::watchable(context, Root::Formula(node), place)?;
    if !matches!(context.observed.tree.nodes[node.0 as usize], Node::Constant(_))
        && !reads_states(context, node)
    {
        let warning =
            Diagnostic::warning(Code::W0501, place, "the formula has the same value in every trial")
                .hint("no part of it depends on the trial");
        context.note(warning);
    }
    if let Node::Constant(value) = context.observed.tree.nodes[node.0 as usize] {
        let warning = Diagnostic::warning(Code::W0501, place, format!("the formula is always {value}"))
            .hint("no part of it depends on the trial");
        context.note(warning);
    }
    let text = context.text(body.span);
    Ok((Column { root: Root::Formula(node), text }, unbounded))
}

/// Warns of a formula without a temporal operator.
fn warn_of_first_state(context: &mut Context<'_>, node: NodeId, span: Span) {
    if is_still(context)
        || !reads_states(context, node)
        || looks_ahead(&context.observed.tree, Part::Node(node)).unwrap_or(true)
    {
        return;
    }
    let (text, bound) = (context.text(span), context.time.whole());
    let is_name = text.chars().all(|c| c.is_alphanumeric() || "_.".contains(c));
    let inner = match bare(&text) {
        _ if is_name => text,
        long if long.len() > 60 => "(…)".to_owned(),
        short => format!("({short})"),
    };
    let warning = Diagnostic::warning(Code::W0502, span, "the value of the first state is used")
        .hint(format!("write `G<={bound} {inner}` for all states, or `F<={bound} {inner}` for some state"));
    context.note(warning);
}

/// Whether nothing ever changes: nobody is there, and no process has a command. All states are the first one; a program of one
/// step tells just that.
fn is_still(context: &Context<'_>) -> bool {
    let is_command = |item: &ProcessItem| matches!(item, ProcessItem::Command(_));
    let changes = |process: &Declared<'_>| {
        process.decl.items.iter().any(is_command) || process.is_played && context.time.horizon > Tick(1)
    };
    context.roster.agent_names.is_empty() && !context.processes.iter().any(changes)
}

/// Whether a formula reads any state. One that is refused for its shape counts as if it did.
fn reads_states(context: &Context<'_>, node: NodeId) -> bool {
    leaves(&context.observed.tree, &[Part::Node(node)])
        .map_or(true, |(atoms, signals)| !(atoms.is_empty() && signals.is_empty()))
}

/// A metric read at the start of a trace.
fn metric(context: &mut Context<'_>, body: &Expr, scope: ScopeId) -> Lowered<(TermId, Dimension, bool)> {
    let locals = Locals::of(scope);
    let (inner, moment) = match &body.kind {
        ExprKind::At(inner, moment) => (&**inner, Some(moment)),
        _ => (body, None),
    };
    context.temporal = true;
    let typed = context.lower(inner, &locals);
    let at = match moment {
        Some(Moment::Time(time)) => context.time(time, &locals).map(Some),
        _ => Ok(None),
    };
    context.temporal = false;
    let typed = typed?;
    let of_state = matches!(typed, Typed::Num(..));
    let (mut term, dimension) = context.as_term(typed, inner.span)?;
    match (moment, at?) {
        (Some(Moment::Time(_)), Some(Some(tick))) => term = context.term(Term::Later(tick, term)),
        (Some(_), _) => term = context.term(Term::AtEnd(term)),
        (None, _) if of_state && !is_still(context) => {
            let warning = Diagnostic::warning(Code::W0502, body.span, "the value of the first state is used")
                .hint("write `… at end`, `… at 5 s`, or an aggregate such as `max<=10 s (…)`");
            context.note(warning);
        }
        (None, _) => {}
    }
    let unbounded = watched::within_horizon(context, Part::Term(term), body.span)?;
    watched::watchable(context, Root::Metric(term), body.span)?;
    Ok((term, dimension, unbounded))
}

/// The formula inside `robustness(…)`, if that is what an expression is.
fn inside_robustness<'e>(context: &Context<'_>, body: &'e Expr, scope: ScopeId) -> Option<&'e Expr> {
    match &body.kind {
        ExprKind::Call { function, arguments }
            if function.name == "robustness" && context.look_up("robustness", scope).is_none() =>
        {
            match arguments.as_slice() {
                [formula] => Some(formula),
                _ => None,
            }
        }
        _ => None,
    }
}

/// The source of a metric, before its use is known.
pub(crate) fn metric_root(
    context: &mut Context<'_>,
    body: &Expr,
    scope: ScopeId,
) -> Lowered<(Root, Dimension, bool)> {
    let Some(formula) = inside_robustness(context, body, scope) else {
        let (term, dimension, unbounded) = metric(context, body, scope)?;
        return Ok((Root::Metric(term), dimension, unbounded));
    };
    let (node, dimension, unbounded) = robustness_of(context, formula, scope)?;
    Ok((Root::Robustness(node, Sought::Value), dimension, unbounded))
}

/// A formula with its margins.
fn robustness_of(
    context: &mut Context<'_>,
    formula: &Expr,
    scope: ScopeId,
) -> Lowered<(NodeId, Dimension, bool)> {
    let (node, dimension) = robustness::robustness(context, formula.span, |this| {
        this.temporal = true;
        let typed = this.lower(formula, &Locals::of(scope));
        this.temporal = false;
        this.as_formula(typed?, formula.span)
    })?;
    warn_of_first_state(context, node, formula.span);
    let unbounded = watched::within_horizon(context, Part::Node(node), formula.span)?;
    watched::watchable(context, Root::Robustness(node, Sought::Value), formula.span)?;
    Ok((node, dimension, unbounded))
}

/// The robustness of the formula of a probability, as a level for splitting.
pub(crate) fn level(context: &mut Context<'_>, measure: &ast::Measure, scope: ScopeId) -> Lowered<Column> {
    let (node, ..) = robustness_of(context, &measure.body, scope)?;
    let text = context.text(measure.body.span);
    Ok(Column { root: Root::Robustness(node, Sought::Value), text })
}

/// `robustness(…) >= 0.2 m` as what is asked of a trace, if a condition is one.
fn robust_enough(context: &mut Context<'_>, body: &Expr, scope: ScopeId) -> Option<Lowered<(Column, bool)>> {
    let ExprKind::Binary(op, left, right) = &body.kind else { return None };
    let relation = match op {
        BinaryOp::Less => Relation::Less,
        BinaryOp::AtMost => Relation::AtMost,
        BinaryOp::Greater => Relation::Greater,
        BinaryOp::AtLeast => Relation::AtLeast,
        _ => return None,
    };
    let (formula, bound, relation) =
        match (inside_robustness(context, left, scope), inside_robustness(context, right, scope)) {
            (Some(formula), None) => (formula, right, relation),
            (None, Some(formula)) => (formula, left, relation.flipped()),
            _ => return None,
        };
    let robust = robustness_of(context, formula, scope);
    let dimension = robust.as_ref().ok().map(|(_, dimension, _)| *dimension);
    let bound = number_in(context, bound, Sketch::of(What::Expectation, dimension), &Locals::of(scope));
    Some(robust.and_then(|(node, _, unbounded)| {
        let bound = bound?.value;
        let text = context.text(body.span);
        Ok((Column { root: Root::Robustness(node, Sought::Compared(relation, bound)), text }, unbounded))
    }))
}

/// A measure, and what is known of it where something is wrong with it; a quantile or expectation has the dimension of
/// its metric.
pub(crate) fn measure(
    context: &mut Context<'_>,
    measure: &ast::Measure,
    scope: ScopeId,
) -> (Lowered<Observed>, Sketch) {
    (context.observed.atoms_before, context.observed.overflown) = (context.observed.atoms.len(), false);
    let (observed, sketch) = match &measure.kind {
        ast::MeasureKind::Probability => {
            let formula = match robust_enough(context, &measure.body, scope) {
                Some(robust) => robust,
                None => formula_column(context, &measure.body, scope),
            };
            if let Ok((Column { root: Root::Formula(node), .. }, _)) = &formula {
                warn_of_first_state(context, *node, measure.body.span);
            }
            let observed = formula.map(|(column, unbounded)| Observed {
                column,
                kind: MeasureKind::Probability,
                unbounded,
            });
            (observed, Sketch::PROBABILITY)
        }
        ast::MeasureKind::Expectation => expectation(context, measure, None, scope),
        ast::MeasureKind::Tail(level) => {
            let known = level_of(context, level, "a tail", scope);
            let (observed, sketch) = expectation(context, measure, known.ok(), scope);
            (known.and(observed), Sketch { what: What::Tail, ..sketch })
        }
        ast::MeasureKind::Quantile(level) => quantile(context, measure, level, scope),
    };
    match &measure.range {
        Some((low, _)) if !sketch.what.has_range() => {
            let error = error!(E0605, low.span, "only an expectation or a tail has a range");
            (context.report(error), sketch)
        }
        _ => (observed, sketch),
    }
}

fn expectation(
    context: &mut Context<'_>,
    measure: &ast::Measure,
    level: Option<f64>,
    scope: ScopeId,
) -> (Lowered<Observed>, Sketch) {
    let metric = metric_root(context, &measure.body, scope);
    let dimension = dimension_of(context, &metric, &measure.body, scope);
    let sketch = Sketch::of(What::Expectation, dimension);
    let range = match &measure.range {
        Some((low, high)) => range(context, (low, high), sketch, &Locals::of(scope)),
        // What is no number is perhaps meant as a formula, which has no range.
        None if metric.is_err() && is_refused_as_a_whole(context, &measure.body) => Err(Reported),
        None => {
            let unit = dimension.filter(|d| !d.is_none()).map_or_else(String::new, |d| format!(" {d}"));
            let (noun, letter) = match measure.kind {
                ast::MeasureKind::Tail(_) => ("a tail", "CVaR"),
                _ => ("an expectation", "E"),
            };
            let error = error!(E0605, measure.span, "{noun} needs the range of its metric";
                        hint: "write the range of its values: `{letter}(…) in 0{unit} .. 10{unit}`; values outside are clipped and counted");
            context.report(error)
        }
    };
    let written = measure.range.as_ref().map(|(low, high)| low.span.to(high.span));
    let sketch = Sketch { range: range.ok().zip(written).filter(|_| dimension.is_some()), ..sketch };
    let text = context.text(measure.body.span);
    let observed = metric.and_then(|(root, dimension, unbounded)| {
        let range = range?;
        let root = match root {
            Root::Robustness(node, _) => Root::Robustness(node, Sought::Clipped(range.0, range.1)),
            root => root,
        };
        let kind = MeasureKind::Expectation { range, dimension, level };
        Ok(Observed { column: Column { root, text }, kind, unbounded })
    });
    (observed, sketch)
}

/// The dimension of a metric, also where something is wrong with it, as far as its form tells.
fn dimension_of(
    context: &Context<'_>,
    metric: &Lowered<(Root, Dimension, bool)>,
    body: &Expr,
    scope: ScopeId,
) -> Option<Dimension> {
    match metric {
        Ok((_, dimension, _)) => Some(*dimension),
        Err(Reported) => form::gist(context, body, &Locals::of(scope)),
    }
}

/// The range of an expectation.
fn range(
    context: &mut Context<'_>,
    (low, high): (&Expr, &Expr),
    sketch: Sketch,
    locals: &Locals,
) -> Lowered<(f64, f64)> {
    let Ok(least) = number_in(context, low, sketch, locals) else {
        // That the other end has the same wrong unit need not be said.
        return match (context.number(low, locals), context.number(high, locals), sketch.dimension) {
            (Ok(low), Ok(most), Some(dimension))
                if most.dimension != dimension && most.dimension != low.dimension =>
            {
                context.wrong_dimension(high.span, dimension, most.dimension)
            }
            _ => Err(Reported),
        };
    };
    let expected = Sketch { dimension: Some(least.dimension), ..sketch };
    let most = number_in(context, high, expected, locals)?;
    if least.value >= most.value {
        return context.report(error!(E0605, low.span.to(high.span), "the range is empty"));
    }
    Ok((least.value, most.value))
}

/// Whether it was said of an expression that it is of another kind than what is wanted.
fn is_refused_as_a_whole(context: &Context<'_>, body: &Expr) -> bool {
    let at = |d: &Diagnostic| d.place.as_ref().map(|place| place.span);
    context.sink.diagnostics.iter().any(|d| d.code == Code::E0305 && at(d) == Some(body.span))
}

/// A level between 0 and 1.
fn level_of(context: &mut Context<'_>, level: &Expr, noun: &str, scope: ScopeId) -> Lowered<f64> {
    let number = context.number_of(level, Dimension::NONE, &Locals::of(scope))?;
    if number.value > 0.0 && number.value < 1.0 {
        return Ok(number.value);
    }
    context.report(error!(E0601, level.span, "the level of {noun} must be between 0 and 1"))
}

fn quantile(
    context: &mut Context<'_>,
    measure: &ast::Measure,
    level: &Expr,
    scope: ScopeId,
) -> (Lowered<Observed>, Sketch) {
    if matches!(measure.body.kind, ExprKind::Quantity(_))
        && matches!(level.kind, ExprKind::Call { .. } | ExprKind::Window(..))
    {
        // `Q(time_until(safe), 0.95)`
        let (metric, number) = (context.text(level.span), context.text(measure.body.span));
        let error = error!(E0601, level.span, "the first argument of a quantile is its level";
                    hint: "write `Q({number}, {metric})`");
        return (context.report(error), Sketch::of(What::Quantile, None));
    }
    let number = level_of(context, level, "a quantile", scope);
    let metric = metric_root(context, &measure.body, scope);
    let dimension = dimension_of(context, &metric, &measure.body, scope);
    let sketch = Sketch { level: number.ok(), ..Sketch::of(What::Quantile, dimension) };
    let text = context.text(measure.body.span);
    let observed = metric.and_then(|(root, dimension, unbounded)| {
        let kind = MeasureKind::Quantile { level: number?, dimension };
        Ok(Observed { column: Column { root, text }, kind, unbounded })
    });
    (observed, sketch)
}

/// `metric <= bound` or `metric < bound` as a formula, for checks of quantiles.
pub(crate) fn below(
    context: &mut Context<'_>,
    column: &Column,
    or_equal: bool,
    (bound, at): (f64, Span),
    dimension: Dimension,
) -> Lowered<Column> {
    let relation = if or_equal { Relation::AtMost } else { Relation::Less };
    let sign = if or_equal { "<=" } else { "<" };
    let shown = if dimension.is_none() { bound.to_string() } else { format!("{bound} {dimension}") };
    let text = format!("{} {sign} {shown}", column.text);
    let term = match column.root {
        Root::Metric(term) => term,
        Root::Robustness(node, _) => {
            let root = Root::Robustness(node, Sought::Compared(relation, bound));
            return Ok(Column { root, text });
        }
        Root::Formula(_) => return Ok(column.clone()),
    };
    let limit = context.term(Term::Constant(bound));
    logic::within_a_trial(context, (term, limit), at)?;
    let node = context.comparison((relation, term, limit), text, dimension);
    Ok(Column { root: Root::Formula(node), text: column.text.clone() })
}
