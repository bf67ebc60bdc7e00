//! Procedures: from the text of a query and the documented defaults, never from the budget.

use super::arguments::Setting;
use super::bounds::WIDEST;
use super::dimension::Dimension;
use super::elaborator::{Elaborator, Locals, Lowered};
use super::families::Allowance;
use super::measures::{Sketch, What};
use super::nearest::nearest;
use crate::stats::procedures::{EPROCESS, MEAN_FIXED, MEAN_WITHIN, PROBABILITY_WITHIN, QUANTILE_FIXED};
use crate::stats::spec::{Kind, Make, Serves};
use crate::stats::{Chosen, Spec, splitting};
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
pub(super) struct Theta {
    /// Unless something is wrong with it.
    pub(super) value: Option<f64>,
    pub(super) at: Span,
    /// Its kind: a threshold, or the level of a quantile.
    pub(super) noun: &'static str,
}

/// The width that a query states, if it does, and where.
pub(super) type Stated = Lowered<Option<(f64, Span)>>;

/// The width of `within`.
pub(super) fn stated(clauses: &Clauses, within: Lowered<Option<f64>>) -> Stated {
    within.map(|within| clauses.within.as_ref().zip(within).map(|(expr, width)| (width, expr.span)))
}

impl Elaborator<'_> {
    /// One minus the confidence of a clause.
    pub(super) fn delta(&mut self, clauses: &Clauses, locals: &Locals) -> Lowered<Option<f64>> {
        let Some(expr) = &clauses.confidence else { return Ok(None) };
        self.confidence(expr, locals).map(Some)
    }

    /// One minus a confidence.
    pub(super) fn confidence(&mut self, expr: &Expr, locals: &Locals) -> Lowered<f64> {
        let number = self.number_of(expr, Dimension::NONE, locals)?;
        if number.value <= 0.5 || number.value >= 1.0 {
            return self.report(error!(E0604, expr.span, "the confidence must be above 50 % and below 100 % (got {})", number.value;
                hint: "write `confidence 95 %` or `confidence 0.95`"));
        }
        // 1 - 0.95 is not 0.05 in doubles; the decimal is.
        let exact = number.exact.and_then(|c| crate::base::decimal::Decimal::ONE.sub(c));
        Ok(exact.map_or(1.0 - number.value, crate::base::decimal::Decimal::to_f64))
    }

    pub(super) fn within(
        &mut self,
        clauses: &Clauses,
        sketch: Sketch,
        locals: &Locals,
    ) -> Lowered<Option<f64>> {
        let Some(expr) = &clauses.within else { return Ok(None) };
        let number = self.number_in(expr, sketch, locals)?;
        if number.value <= 0.0 {
            return self.report(error!(E0604, expr.span, "`within` must be positive"));
        }
        Ok(Some(number.value))
    }

    /// The procedure that a method names.
    pub(super) fn procedure(
        &mut self,
        method: &Method,
        serves: Serves,
        locals: &Locals,
    ) -> Lowered<&'static Spec> {
        let name = &method.name.name;
        if let Some(spec) = Spec::find(name, serves) {
            return Ok(spec);
        }
        for argument in &method.arguments {
            let _ = self.number(&argument.value, locals);
        }
        let error = error!(E0603, method.name.span, "the procedure `{name}` is not available for this query");
        let known: Vec<&str> = Spec::names(serves).collect();
        let hint = nearest(name, known.iter().copied()).map_or_else(
            || format!("the procedures are {}", known.join(", ")),
            |n| format!("did you mean `{n}`?"),
        );
        self.report(error.hint(hint))
    }

    /// That a check states no width.
    pub(super) fn no_width(&mut self, clauses: &Clauses, what: What) -> Lowered<()> {
        let Some(within) = &clauses.within else { return Ok(()) };
        let error = error!(E0607, within.span, "a check has no `within`");
        self.report(if what == What::Expectation {
            error.hint("remove `within`: the check stops as soon as the interval of the mean is on one side of the threshold")
        } else {
            error.hint("remove `within`; for an indifference region write `by sprt(indifference = 0.01)`")
        })
    }

    /// The test of a check, around what it decides about.
    pub(super) fn test(
        &mut self,
        clauses: &Clauses,
        theta: Theta,
        allowance: Allowance,
        locals: &Locals,
    ) -> Lowered<Chosen> {
        let confidence = self.delta(clauses, locals);
        let error = allowance.error(confidence.unwrap_or(None), DEFAULT_ALPHA);
        let test = match &clauses.by {
            None => Ok(EPROCESS.with([error, error])),
            Some(method) => self.procedure(method, Serves::Check, locals).and_then(|spec| {
                let (sketch, within) = (Sketch::PROBABILITY, Ok(None));
                let setting = Setting { sketch, theta: Some(theta), error, allowance, within, locals };
                self.chosen((clauses, method), spec, &setting)
            }),
        };
        confidence?;
        test
    }

    /// The estimator of a measure.
    pub(super) fn estimator(
        &mut self,
        clauses: &Clauses,
        sketch: Sketch,
        allowance: Allowance,
        locals: &Locals,
    ) -> Lowered<Chosen> {
        let within = self.within(clauses, sketch, locals);
        let confidence = self.delta(clauses, locals);
        let error = allowance.error(confidence.unwrap_or(None), DEFAULT_DELTA);
        let serves = match sketch.what {
            What::Probability => Serves::Probability,
            What::Expectation => Serves::Expectation,
            What::Quantile => Serves::Quantile,
        };
        let misplaced = match &clauses.within {
            Some(expr) if serves == Serves::Quantile => self
                .report(error!(E0607, expr.span, "a quantile has a number of trials, not a width";
                    hint: "write `by fixed(trials = 2000)`; the values determine the width")),
            _ => Ok(()),
        };
        let estimator = match &clauses.by {
            Some(method) => self.procedure(method, serves, locals).and_then(|spec| {
                let misplaced = if misplaced.is_ok() { self.no_promise(clauses, spec) } else { misplaced };
                let setting = Setting { sketch, theta: None, error, allowance, within, locals };
                let chosen = self.chosen((clauses, method), spec, &setting)?;
                self.few_paths(method, &chosen)?;
                misplaced.map(|()| chosen)
            }),
            None => self.default_estimator(clauses, sketch, (within, error)),
        };
        confidence?;
        misplaced?;
        estimator
    }

    fn default_estimator(
        &mut self,
        clauses: &Clauses,
        sketch: Sketch,
        (within, delta): (Lowered<Option<f64>>, f64),
    ) -> Lowered<Chosen> {
        let within = within?;
        if let (Some(expr), Some(epsilon)) = (&clauses.within, within) {
            self.width((epsilon, expr.span), sketch, WIDEST)?;
        }
        let trials = PLANNED_TRIALS as f64;
        Ok(match (sketch.what, within) {
            (What::Probability, within) => {
                PROBABILITY_WITHIN.with([within.unwrap_or(DEFAULT_EPSILON), delta])
            }
            (What::Expectation, Some(epsilon)) => MEAN_WITHIN.with([epsilon, delta]),
            (What::Expectation, None) => MEAN_FIXED.with([trials, delta]),
            (What::Quantile, _) => QUANTILE_FIXED.with([trials, delta]),
        })
    }

    /// That a procedure which promises no width has no `within`.
    fn no_promise(&mut self, clauses: &Clauses, spec: &Spec) -> Lowered<()> {
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
        self.report(error!(E0607, within.span, "{said}"; hint: "{hint}"))
    }

    /// That all paths of splitting fit into memory.
    fn few_paths(&mut self, method: &Method, chosen: &Chosen) -> Lowered<()> {
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
        self.report(error.hint(format!("each run has one path for each replica: write `replicas = {fewer}`")))
    }
}
