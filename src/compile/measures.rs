//! Measures: what is asked of the distribution of traces.

use super::dimension::Dimension;
use super::elaborator::{Elaborator, Locals, Lowered, Reported};
use super::number::Number;
use super::observed::bare;
use super::study::{Column, MeasureKind};
use super::symbols::{Meaning, ScopeId};
use super::told::Told;
use super::typed::Typed;
use crate::base::tick::Clock;
use crate::logic::{
    Invalid, Monitor, Node, NodeId, Part, Relation, Robustness, SignalMonitor, SignalRobustness, Term,
    TermId, leaves, looks_ahead, reach,
};
use crate::logic::{Root, Sought};
use crate::syntax::ast::{self, BinaryOp, Expr, ExprKind, Moment};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::source::Span;

/// A measure lowered in one world.
pub(super) struct Observed {
    /// What is observed.
    pub(super) column: Column,
    /// Which number of its distribution.
    pub(super) kind: MeasureKind,
    /// Whether it ranges up to the horizon.
    pub(super) unbounded: bool,
}

/// The kind of a measure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum What {
    Probability,
    Expectation,
    Quantile,
}

/// The known properties of a measure that may have errors. The rest of its query is checked only against these.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sketch {
    pub(super) what: What,
    /// The dimension of its values, thresholds and widths.
    pub(super) dimension: Option<Dimension>,
    /// The range of an expectation, and its place.
    pub(super) range: Option<((f64, f64), Span)>,
    /// The level of a quantile.
    pub(super) level: Option<f64>,
}

impl Sketch {
    /// A probability, for which everything is known.
    pub(super) const PROBABILITY: Self =
        Self { what: What::Probability, dimension: Some(Dimension::NONE), range: None, level: None };

    fn of(what: What, dimension: Option<Dimension>) -> Self {
        Self { what, dimension, range: None, level: None }
    }
}

impl Elaborator<'_> {
    /// A number in the dimension of a measure; in any dimension if that is unknown.
    pub(super) fn number_in(&mut self, expr: &Expr, sketch: Sketch, locals: &Locals) -> Lowered<Number> {
        match sketch.dimension {
            Some(dimension) => self.number_of(expr, dimension, locals),
            None => self.number(expr, locals),
        }
    }

    /// A formula asked at the start of a trace.
    pub(super) fn formula_column(&mut self, body: &Expr, scope: ScopeId) -> Lowered<(Column, bool)> {
        self.temporal = true;
        let typed = self.lower(body, &Locals::of(scope));
        self.temporal = false;
        let node = self.as_formula(typed?, body.span)?;
        if self.overflown {
            return Err(Reported);
        }
        // What is wrong with a whole property is said where it is declared, however often it is asked about.
        let place = match &body.kind {
            ExprKind::Name(name) => match self.find(name, scope) {
                Some((_, Meaning::Property(formula))) => formula.span,
                _ => body.span,
            },
            _ => body.span,
        };
        let unbounded = self.within_horizon(Part::Node(node), place)?;
        self.watchable(Root::Formula(node), place)?;
        if !matches!(self.tree.nodes[node.0 as usize], Node::Constant(_)) && !self.reads_states(node) {
            let warning =
                Diagnostic::warning(Code::W0501, place, "the formula has the same value in every trial")
                    .hint("no part of it depends on the trial");
            self.note(warning);
        }
        if let Node::Constant(value) = self.tree.nodes[node.0 as usize] {
            let warning = Diagnostic::warning(Code::W0501, place, format!("the formula is always {value}"))
                .hint("no part of it depends on the trial");
            self.note(warning);
        }
        let text = self.text(body.span);
        Ok((Column { root: Root::Formula(node), text }, unbounded))
    }

    /// Warns of a formula without a temporal operator.
    fn warn_of_first_state(&mut self, node: NodeId, span: Span) {
        if !self.reads_states(node) || looks_ahead(&self.tree, Part::Node(node)).unwrap_or(true) {
            return;
        }
        let (text, bound) = (self.text(span), self.duration(self.horizon.0));
        let is_name = text.chars().all(|c| c.is_alphanumeric() || "_.".contains(c));
        let inner = match bare(&text) {
            _ if is_name => text,
            long if long.len() > 60 => "(…)".to_owned(),
            short => format!("({short})"),
        };
        let warning = Diagnostic::warning(Code::W0502, span, "the value of the first state is used").hint(
            format!("write `G<={bound} {inner}` for all states, or `F<={bound} {inner}` for some state"),
        );
        self.note(warning);
    }

    /// Whether a formula reads any state. One that is refused for its shape counts as if it did.
    fn reads_states(&self, node: NodeId) -> bool {
        leaves(&self.tree, &[Part::Node(node)])
            .map_or(true, |(atoms, signals)| !(atoms.is_empty() && signals.is_empty()))
    }

    /// A metric read at the start of a trace.
    fn metric(&mut self, body: &Expr, scope: ScopeId) -> Lowered<(TermId, Dimension, bool)> {
        let locals = Locals::of(scope);
        let (inner, moment) = match &body.kind {
            ExprKind::At(inner, moment) => (&**inner, Some(moment)),
            _ => (body, None),
        };
        self.temporal = true;
        let typed = self.lower(inner, &locals);
        let at = match moment {
            Some(Moment::Time(time)) => self.time(time, &locals).map(Some),
            _ => Ok(None),
        };
        self.temporal = false;
        let typed = typed?;
        let of_state = matches!(typed, Typed::Num(..));
        let (mut term, dimension) = self.as_term(typed, inner.span)?;
        match (moment, at?) {
            (Some(Moment::Time(_)), Some(Some(tick))) => term = self.term(Term::Later(tick, term)),
            (Some(_), _) => term = self.term(Term::AtEnd(term)),
            (None, _) if of_state => {
                let warning =
                    Diagnostic::warning(Code::W0502, body.span, "the value of the first state is used")
                        .hint("write `… at end`, `… at 5 s`, or an aggregate such as `max<=10 s (…)`");
                self.note(warning);
            }
            (None, _) => {}
        }
        let unbounded = self.within_horizon(Part::Term(term), body.span)?;
        self.watchable(Root::Metric(term), body.span)?;
        Ok((term, dimension, unbounded))
    }

    /// The formula inside `robustness(…)`, if that is what an expression is.
    fn inside_robustness<'e>(&self, body: &'e Expr, scope: ScopeId) -> Option<&'e Expr> {
        match &body.kind {
            ExprKind::Call { function, arguments }
                if function.name == "robustness" && self.find("robustness", scope).is_none() =>
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
    fn metric_root(&mut self, body: &Expr, scope: ScopeId) -> Lowered<(Root, Dimension, bool)> {
        let Some(formula) = self.inside_robustness(body, scope) else {
            let (term, dimension, unbounded) = self.metric(body, scope)?;
            return Ok((Root::Metric(term), dimension, unbounded));
        };
        let (node, dimension, unbounded) = self.robustness_of(formula, scope)?;
        Ok((Root::Robustness(node, Sought::Value), dimension, unbounded))
    }

    /// A formula with its margins.
    fn robustness_of(&mut self, formula: &Expr, scope: ScopeId) -> Lowered<(NodeId, Dimension, bool)> {
        let (node, dimension) = self.robustness(formula.span, |this| {
            this.temporal = true;
            let typed = this.lower(formula, &Locals::of(scope));
            this.temporal = false;
            this.as_formula(typed?, formula.span)
        })?;
        self.warn_of_first_state(node, formula.span);
        let unbounded = self.within_horizon(Part::Node(node), formula.span)?;
        self.watchable(Root::Robustness(node, Sought::Value), formula.span)?;
        Ok((node, dimension, unbounded))
    }

    /// The robustness of the formula of a probability, as a level for splitting.
    pub(super) fn level(&mut self, measure: &ast::Measure, scope: ScopeId) -> Lowered<Column> {
        let (node, ..) = self.robustness_of(&measure.body, scope)?;
        let text = self.text(measure.body.span);
        Ok(Column { root: Root::Robustness(node, Sought::Value), text })
    }

    /// `robustness(…) >= 0.2 m` as what is asked of a trace, if a condition is one.
    fn robust_enough(&mut self, body: &Expr, scope: ScopeId) -> Option<Lowered<(Column, bool)>> {
        let ExprKind::Binary(op, left, right) = &body.kind else { return None };
        let relation = match op {
            BinaryOp::Less => Relation::Less,
            BinaryOp::AtMost => Relation::AtMost,
            BinaryOp::Greater => Relation::Greater,
            BinaryOp::AtLeast => Relation::AtLeast,
            _ => return None,
        };
        let (formula, bound, relation) =
            match (self.inside_robustness(left, scope), self.inside_robustness(right, scope)) {
                (Some(formula), None) => (formula, right, relation),
                (None, Some(formula)) => (formula, left, relation.flipped()),
                _ => return None,
            };
        let robust = self.robustness_of(formula, scope);
        let dimension = robust.as_ref().ok().map(|(_, dimension, _)| *dimension);
        let bound = self.number_in(bound, Sketch::of(What::Expectation, dimension), &Locals::of(scope));
        Some(robust.and_then(|(node, _, unbounded)| {
            let bound = bound?.value;
            let text = self.text(body.span);
            Ok((Column { root: Root::Robustness(node, Sought::Compared(relation, bound)), text }, unbounded))
        }))
    }

    /// A measure, and what is known of it where something is wrong with it; a quantile or expectation has the dimension of
    /// its metric.
    pub(super) fn measure(&mut self, measure: &ast::Measure, scope: ScopeId) -> (Lowered<Observed>, Sketch) {
        (self.atoms_before, self.overflown) = (self.atoms.len(), false);
        let (observed, sketch) = match &measure.kind {
            ast::MeasureKind::Probability => {
                let formula = match self.robust_enough(&measure.body, scope) {
                    Some(robust) => robust,
                    None => self.formula_column(&measure.body, scope),
                };
                if let Ok((Column { root: Root::Formula(node), .. }, _)) = &formula {
                    self.warn_of_first_state(*node, measure.body.span);
                }
                let observed = formula.map(|(column, unbounded)| Observed {
                    column,
                    kind: MeasureKind::Probability,
                    unbounded,
                });
                (observed, Sketch::PROBABILITY)
            }
            ast::MeasureKind::Expectation => self.expectation(measure, scope),
            ast::MeasureKind::Quantile(level) => self.quantile(measure, level, scope),
        };
        match &measure.range {
            Some((low, _)) if !matches!(measure.kind, ast::MeasureKind::Expectation) => {
                let error = error!(E0605, low.span, "only an expectation has a range");
                (self.report(error), sketch)
            }
            _ => (observed, sketch),
        }
    }

    fn expectation(&mut self, measure: &ast::Measure, scope: ScopeId) -> (Lowered<Observed>, Sketch) {
        let metric = self.metric_root(&measure.body, scope);
        let dimension = self.dimension_of(&metric, &measure.body, scope);
        let sketch = Sketch::of(What::Expectation, dimension);
        let range = match &measure.range {
            Some((low, high)) => self.range((low, high), sketch, &Locals::of(scope)),
            // What is no number is perhaps meant as a formula, which has no range.
            None if metric.is_err() && self.is_refused_as_a_whole(&measure.body) => Err(Reported),
            None => {
                let unit = dimension.filter(|d| !d.is_none()).map_or_else(String::new, |d| format!(" {d}"));
                let error = error!(E0605, measure.span, "an expectation needs the range of its metric";
                        hint: "write the range of its values: `E(…) in 0{unit} .. 10{unit}`; values outside are clipped and counted");
                self.report(error)
            }
        };
        let written = measure.range.as_ref().map(|(low, high)| low.span.to(high.span));
        let sketch = Sketch { range: range.ok().zip(written).filter(|_| dimension.is_some()), ..sketch };
        let text = self.text(measure.body.span);
        let observed = metric.and_then(|(root, dimension, unbounded)| {
            let range = range?;
            let root = match root {
                Root::Robustness(node, _) => Root::Robustness(node, Sought::Clipped(range.0, range.1)),
                root => root,
            };
            let kind = MeasureKind::Expectation { range, dimension };
            Ok(Observed { column: Column { root, text }, kind, unbounded })
        });
        (observed, sketch)
    }

    /// The dimension of a metric, also where something is wrong with it, as far as its form tells.
    fn dimension_of(
        &self,
        metric: &Lowered<(Root, Dimension, bool)>,
        body: &Expr,
        scope: ScopeId,
    ) -> Option<Dimension> {
        match metric {
            Ok((_, dimension, _)) => Some(*dimension),
            Err(Reported) => self.gist(body, &Locals::of(scope)),
        }
    }

    /// The range of an expectation.
    fn range(&mut self, (low, high): (&Expr, &Expr), sketch: Sketch, locals: &Locals) -> Lowered<(f64, f64)> {
        let Ok(least) = self.number_in(low, sketch, locals) else {
            // That the other end has the same wrong unit need not be said.
            return match (self.number(low, locals), self.number(high, locals), sketch.dimension) {
                (Ok(low), Ok(most), Some(dimension))
                    if most.dimension != dimension && most.dimension != low.dimension =>
                {
                    self.wrong_dimension(high.span, dimension, most.dimension)
                }
                _ => Err(Reported),
            };
        };
        let expected = Sketch { dimension: Some(least.dimension), ..sketch };
        let most = self.number_in(high, expected, locals)?;
        if least.value >= most.value {
            return self.report(error!(E0605, low.span.to(high.span), "the range is empty"));
        }
        Ok((least.value, most.value))
    }

    /// Whether it was said of an expression that it is of another kind than what is wanted.
    fn is_refused_as_a_whole(&self, body: &Expr) -> bool {
        let at = |d: &Diagnostic| d.place.as_ref().map(|place| place.span);
        self.diagnostics.iter().any(|d| d.code == Code::E0305 && at(d) == Some(body.span))
    }

    fn quantile(
        &mut self,
        measure: &ast::Measure,
        level: &Expr,
        scope: ScopeId,
    ) -> (Lowered<Observed>, Sketch) {
        if matches!(measure.body.kind, ExprKind::Quantity(_))
            && matches!(level.kind, ExprKind::Call { .. } | ExprKind::Window(..))
        {
            // `Q(time_until(safe), 0.95)`
            let (metric, number) = (self.text(level.span), self.text(measure.body.span));
            let error = error!(E0601, level.span, "the first argument of a quantile is its level";
                    hint: "write `Q({number}, {metric})`");
            return (self.report(error), Sketch::of(What::Quantile, None));
        }
        let number = self.number_of(level, Dimension::NONE, &Locals::of(scope)).and_then(|number| {
            if number.value > 0.0 && number.value < 1.0 {
                return Ok(number.value);
            }
            let said = "the level of a quantile must be between 0 and 1";
            self.report(error!(E0601, level.span, "{said}"))
        });
        let metric = self.metric_root(&measure.body, scope);
        let dimension = self.dimension_of(&metric, &measure.body, scope);
        let sketch = Sketch { level: number.ok(), ..Sketch::of(What::Quantile, dimension) };
        let text = self.text(measure.body.span);
        let observed = metric.and_then(|(root, dimension, unbounded)| {
            let kind = MeasureKind::Quantile { level: number?, dimension };
            Ok(Observed { column: Column { root, text }, kind, unbounded })
        });
        (observed, sketch)
    }

    /// `metric <= bound` or `metric < bound` as a formula, for checks of quantiles.
    pub(super) fn below(
        &mut self,
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
        let limit = self.term(Term::Constant(bound));
        self.within_a_trial((term, limit), at)?;
        let node = self.comparison((relation, term, limit), text, dimension);
        Ok(Column { root: Root::Formula(node), text: column.text.clone() })
    }

    /// Whether there is a monitor for it.
    fn watchable(&mut self, root: Root, span: Span) -> Lowered<()> {
        let (tree, horizon, clock) = (&self.tree, self.horizon, self.clock);
        let made = match (clock, root) {
            // Bounds between ticks are not right yet.
            (Clock::Jumps(_), _) if !self.between.is_empty() => None,
            (Clock::Jumps(tick), Root::Formula(node)) => {
                SignalMonitor::formula(tree, node, horizon, tick).err()
            }
            (Clock::Jumps(tick), Root::Metric(term)) => {
                SignalMonitor::metric(tree, term, horizon, tick).err()
            }
            (Clock::Jumps(tick), Root::Robustness(node, _)) => {
                SignalRobustness::new(tree, node, horizon, tick).err()
            }
            (_, Root::Formula(node)) => Monitor::formula(tree, node, horizon, clock).err(),
            (_, Root::Metric(term)) => Monitor::metric(tree, term, horizon, clock).err(),
            (_, Root::Robustness(node, _)) => Robustness::new(tree, node, horizon, clock).err(),
        };
        match made {
            None => Ok(()),
            Some(reason @ (Invalid::TooLarge { .. } | Invalid::TooMany { .. })) => {
                let hint = if matches!(reason, Invalid::TooMany { .. }) {
                    "write a bound for the sum or mean, or evaluate it in fewer states"
                } else {
                    "use a longer step, shorter windows, or fewer nested windows"
                };
                self.report(error!(E0509, span, "{}", reason.to_string(); hint: "{hint}"))
            }
            // The horizon is unknown.
            Some(Invalid::BeyondHorizon { .. }) if self.told < Told::Whole => Ok(()),
            Some(reason @ Invalid::BeyondHorizon { .. }) => {
                self.report(error!(E0502, span, "{}", reason.to_string()))
            }
            Some(reason) => {
                let code = if clock.is_jumps() { Code::E0508 } else { Code::E0504 };
                self.report(Diagnostic::error(code, span, reason.to_string()))
            }
        }
    }

    /// Whether a part ranges up to the horizon; an error where it looks beyond.
    fn within_horizon(&mut self, part: Part, span: Span) -> Lowered<bool> {
        let reach = match reach(&self.tree, part, self.horizon, self.clock) {
            Ok(reach) => reach,
            Err(reason) => return self.report(error!(E0504, span, "{}", reason.to_string())),
        };
        if reach.ticks <= self.horizon.0 || self.told < Told::Whole {
            return Ok(reach.unbounded);
        }
        let (needed, horizon) = (self.duration(reach.ticks), self.duration(self.horizon.0));
        let mut error = error!(E0502, span, "the formula needs {needed}, but the horizon is {horizon}");
        // One that begins beyond has no bounded one inside to blame.
        let begins = match part {
            Part::Node(node) => match &self.tree.nodes[node.0 as usize] {
                Node::Finally(window, _) | Node::Globally(window, _) => window.from.0 >= reach.ticks,
                _ => false,
            },
            Part::Term(_) => false,
        };
        error = if reach.unbounded && !begins {
            error.hint("an operator without a bound, including `time_until`, evaluates its operand up to the horizon, and the bounded operator inside extends beyond it; write a bound for the outer operator, or use a condition of one state inside")
        } else {
            error.hint(format!("set `horizon = {needed}` in the scenario, or shorten the bounds"))
        };
        if !self.hangs_on_parameters(span) {
            error = self.clock_at.iter().copied().fold(error.formal(), Diagnostic::hanging_on);
        }
        self.report(error)
    }

    /// A number of ticks in words.
    pub(super) fn duration(&self, ticks: u64) -> String {
        match self.clock {
            Clock::Stepped(_) | Clock::Jumps(_) => {
                let seconds = self.clock.seconds(crate::base::tick::Tick(ticks));
                format!("{} s", (seconds * 1e9).round() / 1e9)
            }
            Clock::Steps if ticks == 1 => "1 step".to_owned(),
            Clock::Steps => format!("{ticks} steps"),
        }
    }
}
