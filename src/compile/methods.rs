//! Procedures: from the text of a query and the documented defaults, never from the budget.

use super::dimension::Dimension;
use super::elaborator::{Elaborator, Locals, Lowered};
use super::nearest::nearest;
use super::study::{Estimator, MeasureKind, Ranking, Splitting, Test};
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
pub const DEFAULT_TRIALS: u64 = 1000;

/// Named numbers of a method, in order of their names here.
struct Arguments<'m, const N: usize> {
    method: &'m Method,
    values: [Option<(f64, Span)>; N],
}

impl Elaborator<'_> {
    fn arguments<'m, const N: usize>(
        &mut self,
        method: &'m Method,
        names: [&str; N],
        locals: &Locals,
    ) -> Lowered<Arguments<'m, N>> {
        let mut values = [None; N];
        let mut failed = false;
        for argument in &method.arguments {
            let Some(at) = names.iter().position(|n| *n == argument.name.name) else {
                let known = if N == 0 {
                    "it takes none".to_owned()
                } else {
                    format!("it takes {}", names.join(", "))
                };
                let hint = nearest(&argument.name.name, names.iter().copied())
                    .map_or(known, |n| format!("did you mean `{n}`?"));
                let error = Diagnostic::error(
                    "E0604",
                    argument.name.span,
                    format!("`{}` has no argument `{}`", method.name.name, argument.name.name),
                );
                self.note(error.hint(hint));
                failed = true;
                continue;
            };
            if let Some(first) = method.arguments.iter().find(|a| a.name.name == argument.name.name)
                && first.name.span != argument.name.span
            {
                let text = format!("`{}` is given twice", argument.name.name);
                let error = Diagnostic::error("E0604", argument.name.span, text);
                self.note(error.related(first.name.span, "first given here"));
                failed = true;
                continue;
            }
            match self.number_of(&argument.value, Dimension::NONE, locals) {
                Ok(number) => values[at] = Some((number.value, argument.value.span)),
                Err(_) => failed = true,
            }
        }
        if failed { Err(super::elaborator::Reported) } else { Ok(Arguments { method, values }) }
    }

    /// A probability of error in (0, 1).
    fn error_of(&mut self, value: Option<(f64, Span)>, default: f64, name: &str) -> Lowered<f64> {
        match value {
            None => Ok(default),
            Some((value, _)) if value > 0.0 && value < 1.0 => Ok(value),
            Some((value, span)) => self.report(Diagnostic::error(
                "E0604",
                span,
                format!("`{name}` is {value}, but lies between 0 and 1"),
            )),
        }
    }

    fn required<const N: usize>(
        &mut self,
        arguments: &Arguments<'_, N>,
        at: usize,
        name: &str,
    ) -> Lowered<(f64, Span)> {
        match arguments.values[at] {
            Some(found) => Ok(found),
            None => {
                let method = arguments.method;
                let error =
                    Diagnostic::error("E0604", method.span, format!("`{}` needs `{name}`", method.name.name));
                self.report(error)
            }
        }
    }

    /// One minus the confidence of a clause.
    pub(super) fn delta(&mut self, clauses: &Clauses, locals: &Locals) -> Lowered<Option<f64>> {
        let Some(expr) = &clauses.confidence else { return Ok(None) };
        self.confidence(expr, locals).map(Some)
    }

    /// One minus a confidence.
    pub(super) fn confidence(&mut self, expr: &Expr, locals: &Locals) -> Lowered<f64> {
        let number = self.number_of(expr, Dimension::NONE, locals)?;
        if number.value <= 0.0 || number.value >= 1.0 {
            let error = Diagnostic::error(
                "E0604",
                expr.span,
                format!("a confidence of {} is not between 0 and 1", number.value),
            )
            .hint("write `confidence 95 %` or `confidence 0.95`");
            return self.report(error);
        }
        // 1 - 0.95 is not 0.05 in doubles; the decimal is.
        let exact = number.exact.and_then(|c| crate::base::decimal::Decimal::ONE.sub(c));
        Ok(exact.map_or(1.0 - number.value, crate::base::decimal::Decimal::to_f64))
    }

    fn within(&mut self, clauses: &Clauses, dimension: Dimension, locals: &Locals) -> Lowered<Option<f64>> {
        let Some(expr) = &clauses.within else { return Ok(None) };
        let number = self.number_of(expr, dimension, locals)?;
        if number.value <= 0.0 {
            return self.report(Diagnostic::error("E0604", expr.span, "`within` must be positive"));
        }
        if dimension.is_none() && number.value >= 1.0 {
            return self.report(Diagnostic::error(
                "E0604",
                expr.span,
                "a probability lies between 0 and 1, so that `within` must be less than 1",
            ));
        }
        Ok(Some(number.value))
    }

    fn unknown_method<T>(&mut self, method: &Method, known: &[&str]) -> Lowered<T> {
        let name = &method.name.name;
        let error =
            Diagnostic::error("E0603", method.name.span, format!("there is no procedure `{name}` for this"));
        let hint = nearest(name, known.iter().copied())
            .map_or_else(|| format!("known here: {}", known.join(", ")), |n| format!("did you mean `{n}`?"));
        self.report(error.hint(hint))
    }

    /// The test of a check with its threshold.
    pub(super) fn test(
        &mut self,
        clauses: &Clauses,
        threshold: f64,
        at: Span,
        share: f64,
        locals: &Locals,
    ) -> Lowered<Test> {
        if let Some(within) = &clauses.within {
            let error = Diagnostic::error("E0607", within.span, "a check has no `within`")
                .hint("for an indifference region write `by sprt(indifference = 0.01)`");
            return self.report(error);
        }
        let error = self.delta(clauses, locals)?.unwrap_or(DEFAULT_ALPHA) * share;
        let Some(method) = &clauses.by else { return Ok(Test::EProcess { alpha: error, beta: error }) };
        let name = method.name.name.as_str();
        match name {
            "sprt" | "sprt2" | "plan" => {
                let arguments = self.arguments(method, ["alpha", "beta", "indifference"], locals)?;
                let alpha = self.error_of(arguments.values[0], error, "alpha");
                let beta = self.error_of(arguments.values[1], error, "beta");
                let (indifference, span) = self.required(&arguments, 2, "indifference")?;
                let (alpha, beta) = (alpha?, beta?);
                self.region(threshold, indifference, at, span)?;
                Ok(match name {
                    "sprt" => Test::Sprt { alpha, beta, indifference },
                    "sprt2" => Test::Sprt2 { alpha, beta, indifference },
                    _ => Test::Plan { alpha, beta, indifference },
                })
            }
            "eprocess" => {
                let arguments = self.arguments(method, ["alpha", "beta"], locals)?;
                let alpha = self.error_of(arguments.values[0], error, "alpha")?;
                let beta = self.error_of(arguments.values[1], error, "beta")?;
                Ok(Test::EProcess { alpha, beta })
            }
            "three_way" => {
                let arguments = self.arguments(method, ["alpha", "indifference"], locals)?;
                let alpha = self.error_of(arguments.values[0], error, "alpha")?;
                let (indifference, span) = self.required(&arguments, 1, "indifference")?;
                self.region(threshold, indifference, at, span)?;
                Ok(Test::ThreeWay { alpha, indifference })
            }
            _ => self.unknown_method(method, &["sprt", "sprt2", "plan", "eprocess", "three_way"]),
        }
    }

    /// The indifference region must lie inside (0, 1).
    fn region(&mut self, theta: f64, indifference: f64, at: Span, span: Span) -> Lowered<()> {
        let (low, high) = (theta - indifference, theta + indifference);
        if indifference > 0.0 && low > 0.0 && high < 1.0 {
            return Ok(());
        }
        let round = |x: f64| (x * 1e12).round() / 1e12;
        let error = Diagnostic::error(
            "E0602",
            span,
            format!("the indifference region {} to {} must lie inside (0, 1)", round(low), round(high)),
        )
        .related(at, "around this threshold")
        .hint("choose a smaller indifference, or leave the region out: the default test needs none");
        self.report(error)
    }

    /// The estimator of a measure; `share` is this query's part of the joint error.
    pub(super) fn estimator(
        &mut self,
        clauses: &Clauses,
        kind: &MeasureKind,
        share: f64,
        locals: &Locals,
    ) -> Lowered<Estimator> {
        let dimension = match kind {
            MeasureKind::Probability => Dimension::NONE,
            MeasureKind::Expectation { dimension, .. } | MeasureKind::Quantile { dimension, .. } => {
                *dimension
            }
        };
        let within = self.within(clauses, dimension, locals)?;
        let delta = self.delta(clauses, locals)?.unwrap_or(DEFAULT_DELTA) * share;
        let quantile = matches!(kind, MeasureKind::Quantile { .. });
        if let (true, Some(expr)) = (quantile, &clauses.within) {
            let error =
                Diagnostic::error("E0607", expr.span, "a quantile takes a number of trials, not a width")
                    .hint(
                        "write `by fixed(trials = 2000)`; the interval follows from the order of the values",
                    );
            return self.report(error);
        }
        let probability = matches!(kind, MeasureKind::Probability);
        let Some(method) = &clauses.by else {
            return Ok(match (within, probability) {
                (Some(epsilon), _) => Estimator::Default { epsilon, delta },
                (None, true) => Estimator::Default { epsilon: DEFAULT_EPSILON, delta },
                (None, false) => Estimator::Fixed { trials: DEFAULT_TRIALS, delta },
            });
        };
        let name = method.name.name.as_str();
        if name == "fixed" || name == "clopper_pearson" || (quantile && name == "dkw") {
            let arguments = self.arguments(method, ["trials", "delta"], locals)?;
            let (trials, span) = self.required(&arguments, 0, "trials")?;
            let delta = self.error_of(arguments.values[1], delta, "delta")?;
            if trials < 1.0 || trials.fract() != 0.0 || trials > 1e12 {
                return self.report(Diagnostic::error(
                    "E0604",
                    span,
                    "`trials` must be a whole, positive number",
                ));
            }
            let trials = trials as u64;
            return Ok(match name {
                "dkw" => Estimator::Band { trials, delta },
                _ => Estimator::Fixed { trials, delta },
            });
        }
        if probability && (name == "splitting" || name == "fixed_effort") {
            return self.splitting(clauses, method, delta, locals);
        }
        let known: &[&str] = if probability {
            &[
                "okamoto",
                "massart",
                "spending",
                "clopper_pearson",
                "fixed",
                "gbas",
                "splitting",
                "fixed_effort",
            ]
        } else if quantile {
            &["fixed", "dkw"]
        } else {
            &["okamoto", "fixed"]
        };
        if !known.contains(&name) {
            return self.unknown_method(method, known);
        }
        let arguments = self.arguments(method, ["epsilon", "delta"], locals)?;
        let delta = self.error_of(arguments.values[1], delta, "delta")?;
        let epsilon = match (arguments.values[0], within) {
            (Some((epsilon, span)), None) => {
                if epsilon <= 0.0 || (probability && epsilon >= 1.0) {
                    return self.report(Diagnostic::error(
                        "E0604",
                        span,
                        format!("`epsilon` is {epsilon}, but lies between 0 and 1"),
                    ));
                }
                epsilon
            }
            (None, Some(epsilon)) => epsilon,
            (Some((_, span)), Some(_)) => {
                return self.report(Diagnostic::error(
                    "E0604",
                    span,
                    "the width is given twice: by `within` and by `epsilon`",
                ));
            }
            (None, None) => {
                let error = Diagnostic::error("E0604", method.span, format!("`{name}` needs `epsilon`"));
                return self.report(error);
            }
        };
        Ok(match name {
            "okamoto" => Estimator::Okamoto { epsilon, delta },
            "massart" => Estimator::Massart { epsilon, delta },
            "spending" => Estimator::Spending { epsilon, delta },
            _ => Estimator::Relative { epsilon, delta },
        })
    }

    /// Importance splitting; the column of its level is not known yet.
    fn splitting(
        &mut self,
        clauses: &Clauses,
        method: &Method,
        delta: f64,
        locals: &Locals,
    ) -> Lowered<Estimator> {
        if let Some(within) = &clauses.within {
            let error = Diagnostic::error("E0607", within.span, "splitting promises no width").hint(
                "choose the number of `replicas` and of `runs`; the interval follows from how they scatter",
            );
            return self.report(error);
        }
        let adaptive = method.name.name == "splitting";
        let arguments = self.arguments(method, ["replicas", "runs", "plain", "delta", "kill"], locals)?;
        let replicas = self.whole_in(arguments.values[0], "replicas", (10, 1_000_000), 1000)?;
        let runs = self.whole_in(arguments.values[1], "runs", (2, 1000), 20)?;
        let plain = self.whole_in(arguments.values[2], "plain", (100, 1_000_000_000), replicas * runs / 2)?;
        let delta = self.error_of(arguments.values[3], delta, "delta")?;
        let kill = self.whole_in(arguments.values[4], "kill", (1, replicas - 1), (replicas / 10).max(1))?;
        Ok(Estimator::Splitting(Splitting { adaptive, replicas, runs, kill, plain, delta, level: 0 }))
    }

    /// A whole number in a range.
    fn whole_in(
        &mut self,
        value: Option<(f64, Span)>,
        name: &str,
        (low, high): (u64, u64),
        default: u64,
    ) -> Lowered<u64> {
        match value {
            None => Ok(default),
            Some((value, _)) if value.fract() == 0.0 && value >= low as f64 && value <= high as f64 => {
                Ok(value as u64)
            }
            Some((value, span)) => self.report(Diagnostic::error(
                "E0604",
                span,
                format!("`{name}` is {value}, but is a whole number from {low} to {high}"),
            )),
        }
    }

    /// Half width, if any, and error of a comparison.
    pub(super) fn comparison_clauses(
        &mut self,
        clauses: &Clauses,
        dimension: Dimension,
        share: f64,
        locals: &Locals,
    ) -> Lowered<(Option<f64>, f64)> {
        if let Some(method) = &clauses.by {
            return self.report(Diagnostic::error(
                "E0603",
                method.span,
                "a comparison has one procedure only",
            ));
        }
        let within = self.within(clauses, dimension, locals)?;
        let delta = self.delta(clauses, locals)?.unwrap_or(DEFAULT_DELTA) * share;
        Ok((within, delta))
    }

    /// Loss, error and procedure of a ranking.
    pub(super) fn ranking(
        &mut self,
        clauses: &Clauses,
        dimension: Dimension,
        share: f64,
        locals: &Locals,
    ) -> Lowered<(f64, f64, Ranking)> {
        let within = self.within(clauses, dimension, locals)?;
        let delta = self.delta(clauses, locals)?.unwrap_or(DEFAULT_DELTA) * share;
        let Some(method) = &clauses.by else {
            return Ok((within.unwrap_or(DEFAULT_LOSS), delta, Ranking::Betting));
        };
        let ranking = match method.name.name.as_str() {
            "okamoto" => Ranking::Okamoto,
            "betting" => Ranking::Betting,
            "one_challenger" => Ranking::OneChallenger,
            _ => return self.unknown_method(method, &["betting", "one_challenger", "okamoto"]),
        };
        let arguments = self.arguments(method, ["epsilon", "delta"], locals)?;
        let delta = self.error_of(arguments.values[1], delta, "delta")?;
        let epsilon = self.error_of(arguments.values[0], within.unwrap_or(DEFAULT_LOSS), "epsilon")?;
        Ok((epsilon, delta, ranking))
    }
}
