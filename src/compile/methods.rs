//! Procedures: from the text of a query and the documented defaults, never from the budget.

use super::arguments::Arguments;
use super::bounds::WIDEST;
use super::dimension::Dimension;
use super::elaborator::{Elaborator, Locals, Lowered};
use super::families::Allowance;
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
pub const PLANNED_TRIALS: u64 = 1000;

/// Both, where neither failed: what is wrong with each is said before this is asked.
fn both<A, B>(a: Lowered<A>, b: Lowered<B>) -> Lowered<(A, B)> {
    Ok((a?, b?))
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
            let error = Diagnostic::error(
                "E0604",
                expr.span,
                format!("a confidence of {} does not lie above 50 % and below 100 %", number.value),
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
        allowance: Allowance,
        locals: &Locals,
    ) -> Lowered<Test> {
        if let Some(within) = &clauses.within {
            let error = Diagnostic::error("E0607", within.span, "a check has no `within`")
                .hint("for an indifference region write `by sprt(indifference = 0.01)`");
            return self.report(error);
        }
        let error = allowance.error(self.delta(clauses, locals)?, DEFAULT_ALPHA);
        let Some(method) = &clauses.by else { return Ok(Test::EProcess { alpha: error, beta: error }) };
        let name = method.name.name.as_str();
        match name {
            "sprt" | "sprt2" | "plan" => {
                let arguments = self.arguments(
                    (clauses, method),
                    ["alpha", "beta", "indifference"],
                    Dimension::NONE,
                    locals,
                );
                let alpha = self.error_of(arguments.values[0], error, "alpha");
                let beta = self.error_of(arguments.values[1], error, "beta");
                let region = self.region(&arguments, 2, threshold, at);
                let ((alpha, beta), (indifference, span)) = both(both(alpha, beta), region)?;
                arguments.sound()?;
                let least = match name {
                    "sprt2" => 1e-5,
                    "plan" => 5e-4,
                    _ => 0.0,
                };
                if indifference < least {
                    let said =
                        format!("`indifference` is {indifference}, but is at least {least} with `{name}`");
                    let error = Diagnostic::error("E0604", span, said);
                    return self.report(error.hint("`sprt`, and the default test, know no such limit"));
                }
                Ok(match name {
                    "sprt" => Test::Sprt { alpha, beta, indifference },
                    "sprt2" => Test::Sprt2 { alpha, beta, indifference },
                    _ => Test::Plan { alpha, beta, indifference },
                })
            }
            "eprocess" => {
                let arguments = self.arguments((clauses, method), ["alpha", "beta"], Dimension::NONE, locals);
                let alpha = self.error_of(arguments.values[0], error, "alpha");
                let beta = self.error_of(arguments.values[1], error, "beta");
                let (alpha, beta) = both(alpha, beta)?;
                arguments.sound()?;
                Ok(Test::EProcess { alpha, beta })
            }
            "three_way" => {
                let arguments =
                    self.arguments((clauses, method), ["alpha", "indifference"], Dimension::NONE, locals);
                let alpha = self.error_of(arguments.values[0], error, "alpha");
                let region = self.region(&arguments, 1, threshold, at);
                let (alpha, (indifference, _)) = both(alpha, region)?;
                arguments.sound()?;
                Ok(Test::ThreeWay { alpha, indifference })
            }
            _ => self.unknown_method(method, &["sprt", "sprt2", "plan", "eprocess", "three_way"]),
        }
    }

    /// The indifference around a threshold, which is an argument of a method, and where; its region must lie inside
    /// (0, 1).
    fn region<const N: usize>(
        &mut self,
        arguments: &Arguments<'_, N>,
        argument: usize,
        theta: f64,
        at: Span,
    ) -> Lowered<(f64, Span)> {
        let (indifference, span) = self.required(arguments, argument, "indifference")?;
        let (low, high) = (theta - indifference, theta + indifference);
        if indifference > 0.0 && low > 0.0 && high < 1.0 && low < theta && theta < high {
            return Ok((indifference, span));
        }
        if indifference <= 0.0 {
            let error =
                Diagnostic::error("E0602", span, format!("`indifference` is {indifference}, but is above 0"));
            return self.report(error.hint("leave the region out: the default test needs none"));
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

    /// The estimator of a measure.
    pub(super) fn estimator(
        &mut self,
        clauses: &Clauses,
        kind: &MeasureKind,
        allowance: Allowance,
        locals: &Locals,
    ) -> Lowered<Estimator> {
        let dimension = match kind {
            MeasureKind::Probability => Dimension::NONE,
            MeasureKind::Expectation { dimension, .. } | MeasureKind::Quantile { dimension, .. } => {
                *dimension
            }
        };
        let within = self.within(clauses, dimension, locals);
        let confidence = self.delta(clauses, locals);
        if let (Ok(Some(epsilon)), Some(expr), None) = (&within, &clauses.within, &clauses.by)
            && confidence.is_err()
        {
            let _ = self.width((*epsilon, expr.span), kind, WIDEST);
        }
        let (within, confidence) = both(within, confidence)?;
        let delta = allowance.error(confidence, DEFAULT_DELTA);
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
            if let (Some(expr), Some(epsilon)) = (&clauses.within, within) {
                self.width((epsilon, expr.span), kind, WIDEST)?;
            }
            return Ok(match (within, probability) {
                (Some(epsilon), _) => Estimator::Default { epsilon, delta },
                (None, true) => Estimator::Default { epsilon: DEFAULT_EPSILON, delta },
                (None, false) => Estimator::Fixed { trials: PLANNED_TRIALS, delta },
            });
        };
        let name = method.name.name.as_str();
        let of_trials = match name {
            "fixed" => true,
            // Its interval is that of a share.
            "clopper_pearson" => probability,
            "dkw" => quantile,
            _ => false,
        };
        if of_trials {
            if let Some(expr) = &clauses.within {
                let said = "a number of trials that is fixed promises no width";
                let error = Diagnostic::error("E0607", expr.span, said);
                return self.report(
                    error.hint("leave out `by` and the trials follow from the width, or leave out `within`"),
                );
            }
            let arguments = self.arguments((clauses, method), ["trials", "delta"], Dimension::NONE, locals);
            let trials = self.required(&arguments, 0, "trials");
            let delta = self.claimed(arguments.values[1], delta, allowance);
            let ((trials, span), delta) = both(trials, delta)?;
            arguments.sound()?;
            // The values of a quantile are kept.
            let most = if quantile { 1e9 } else { 1e12 };
            if trials < 1.0 || trials.fract() != 0.0 || trials > most {
                return self.report(Diagnostic::error(
                    "E0604",
                    span,
                    format!("`trials` must be a whole number from 1 to {most:e}"),
                ));
            }
            let trials = trials as u64;
            return Ok(match name {
                "dkw" => Estimator::Band { trials, delta },
                _ => Estimator::Fixed { trials, delta },
            });
        }
        if probability && (name == "splitting" || name == "fixed_effort") {
            return self.splitting(clauses, method, (delta, allowance), locals);
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
        let arguments = self.arguments((clauses, method), ["epsilon", "delta"], dimension, locals);
        let delta = self.claimed(arguments.values[1], delta, allowance);
        let width = self.width_of(clauses, within, &arguments);
        let Some((epsilon, span)) = width? else {
            delta?;
            arguments.sound()?;
            let error = Diagnostic::error("E0604", method.span, format!("`{name}` needs `epsilon`"));
            return self.report(error);
        };
        if name == "gbas" {
            // A relative error has no scale.
            if !(1e-4..=0.999).contains(&epsilon) {
                let said = format!("a relative error of {epsilon} is not between 0.0001 and 0.999");
                return self.report(Diagnostic::error("E0604", span, said));
            }
        } else {
            self.width((epsilon, span), kind, WIDEST)?;
        }
        let delta = delta?;
        arguments.sound()?;
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
        (delta, allowance): (f64, Allowance),
        locals: &Locals,
    ) -> Lowered<Estimator> {
        if let Some(within) = &clauses.within {
            let error = Diagnostic::error("E0607", within.span, "splitting promises no width").hint(
                "choose the number of `replicas` and of `runs`; the interval follows from how they scatter",
            );
            return self.report(error);
        }
        let adaptive = method.name.name == "splitting";
        let arguments = self.arguments(
            (clauses, method),
            ["replicas", "runs", "plain", "delta", "kill"],
            Dimension::NONE,
            locals,
        );
        let replicas = self.whole_in(arguments.values[0], "replicas", (10, 1_000_000), 1000)?;
        let runs = self.whole_in(arguments.values[1], "runs", (2, 1000), 20)?;
        let plain = self.whole_in(arguments.values[2], "plain", (100, 1_000_000_000), replicas * runs / 2)?;
        let delta = self.claimed(arguments.values[3], delta, allowance)?;
        let kill = self.whole_in(arguments.values[4], "kill", (1, replicas - 1), (replicas / 10).max(1))?;
        arguments.sound()?;
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
        kind: &MeasureKind,
        dimension: Dimension,
        allowance: Allowance,
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
        if let (Some(expr), Some(epsilon)) = (&clauses.within, within) {
            // The difference ranges over twice as much.
            self.width((epsilon, expr.span), kind, 2.0 * WIDEST)?;
        }
        let delta = allowance.error(self.delta(clauses, locals)?, DEFAULT_DELTA);
        Ok((within, delta))
    }

    /// Loss, error and procedure of a ranking by a measure.
    pub(super) fn ranking(
        &mut self,
        clauses: &Clauses,
        (kind, measured): (&MeasureKind, Span),
        dimension: Dimension,
        allowance: Allowance,
        locals: &Locals,
    ) -> Lowered<(f64, f64, Ranking)> {
        let within = self.within(clauses, dimension, locals)?;
        let delta = allowance.error(self.delta(clauses, locals)?, DEFAULT_DELTA);
        let mut width = clauses.within.as_ref().zip(within).map(|(expr, loss)| (loss, expr.span));
        let mut procedure = (Ranking::Betting, delta);
        if let Some(method) = &clauses.by {
            let ranking = match method.name.name.as_str() {
                "okamoto" => Ranking::Okamoto,
                "betting" => Ranking::Betting,
                "one_challenger" => Ranking::OneChallenger,
                _ => return self.unknown_method(method, &["betting", "one_challenger", "okamoto"]),
            };
            let arguments = self.arguments((clauses, method), ["epsilon", "delta"], dimension, locals);
            procedure = (ranking, self.claimed(arguments.values[1], delta, allowance)?);
            width = self.width_of(clauses, within, &arguments)?;
            arguments.sound()?;
        }
        let (epsilon, at) = match width {
            Some(found) => found,
            // What does not matter in metres nobody knows but who asks.
            None if !dimension.is_none() => {
                let error = Diagnostic::error("E0604", measured, "how much worse may a choice be?");
                return self
                    .report(error.hint(format!("say what does not matter, in {dimension}: `within …`")));
            }
            None => (DEFAULT_LOSS, measured),
        };
        let epsilon = self.width((epsilon, at), kind, 2.0 * WIDEST)?;
        Ok((epsilon, procedure.1, procedure.0))
    }

    /// The error that a procedure states, as far as it is for one claim.
    fn claimed(&mut self, value: Option<(f64, Span)>, default: f64, allowance: Allowance) -> Lowered<f64> {
        let stated = self.error_of(value, default, "delta")?;
        Ok(if value.is_some() { allowance.of(stated) } else { stated })
    }

    /// The width that a query names, by `within` or by `epsilon` and not by both, and where.
    fn width_of<const N: usize>(
        &mut self,
        clauses: &Clauses,
        within: Option<f64>,
        arguments: &Arguments<'_, N>,
    ) -> Lowered<Option<(f64, Span)>> {
        match (arguments.values[0], clauses.within.as_ref().zip(within)) {
            (Some((_, span)), Some(_)) => self.report(Diagnostic::error(
                "E0604",
                span,
                "the width is given twice: by `within` and by `epsilon`",
            )),
            (Some(found), None) => Ok(Some(found)),
            (None, within) => Ok(within.map(|(expr, epsilon)| (epsilon, expr.span))),
        }
    }
}
