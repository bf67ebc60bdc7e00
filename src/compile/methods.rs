//! Procedures: from the text of a query and the documented defaults, never from the budget.

use super::arguments::Arguments;
use super::bounds::WIDEST;
use super::dimension::Dimension;
use super::elaborator::{Elaborator, Locals, Lowered};
use super::families::Allowance;
use super::measures::{Sketch, What};
use super::nearest::nearest;
use super::study::{Estimator, Splitting, Test};
use crate::syntax::ast::{Clauses, Expr, Method};
use crate::syntax::codes::Code;
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

/// Fewest plain trials beside splitting.
const LEAST_PLAIN: u64 = 100;

/// Bytes that one path of splitting takes, about, and most paths at once.
const BYTES_OF_A_PATH: u64 = 400;
const MOST_PATHS: u64 = 5_000_000;

/// Both, where neither failed: what is wrong with each is said before this is asked.
pub(super) fn both<A, B>(a: Lowered<A>, b: Lowered<B>) -> Lowered<(A, B)> {
    Ok((a?, b?))
}

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
            let error = Diagnostic::error(
                Code::E0604,
                expr.span,
                format!("the confidence must be above 50 % and below 100 % (got {})", number.value),
            )
            .hint("write `confidence 95 %` or `confidence 0.95`");
            return self.report(error);
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
            return self.report(Diagnostic::error(Code::E0604, expr.span, "`within` must be positive"));
        }
        Ok(Some(number.value))
    }

    pub(super) fn unknown_method<T>(
        &mut self,
        method: &Method,
        known: &[&str],
        locals: &Locals,
    ) -> Lowered<T> {
        for argument in &method.arguments {
            let _ = self.number(&argument.value, locals);
        }
        let name = &method.name.name;
        let error = Diagnostic::error(
            Code::E0603,
            method.name.span,
            format!("the procedure `{name}` is not available for this query"),
        );
        let hint = nearest(name, known.iter().copied()).map_or_else(
            || format!("the procedures are {}", known.join(", ")),
            |n| format!("did you mean `{n}`?"),
        );
        self.report(error.hint(hint))
    }

    /// That a check states no width.
    pub(super) fn no_width(&mut self, clauses: &Clauses, what: What) -> Lowered<()> {
        let Some(within) = &clauses.within else { return Ok(()) };
        let error = Diagnostic::error(Code::E0607, within.span, "a check has no `within`");
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
    ) -> Lowered<Test> {
        let confidence = self.delta(clauses, locals);
        let error = allowance.error(confidence.unwrap_or(None), DEFAULT_ALPHA);
        let test = match &clauses.by {
            None => Ok(Test::EProcess { alpha: error, beta: error }),
            Some(method) => self.test_by((clauses, method), theta, error, locals),
        };
        confidence?;
        test
    }

    fn test_by(
        &mut self,
        (clauses, method): (&Clauses, &Method),
        theta: Theta,
        error: f64,
        locals: &Locals,
    ) -> Lowered<Test> {
        let name = method.name.name.as_str();
        match name {
            "sprt" | "sprt2" | "plan" => {
                let arguments = self.arguments(
                    (clauses, method),
                    ["alpha", "beta", "indifference"],
                    Sketch::PROBABILITY,
                    locals,
                );
                let alpha = self.error_of(arguments.values[0], error, "alpha");
                let beta = self.error_of(arguments.values[1], error, "beta");
                let region = self.region(&arguments, 2, theta);
                let ((alpha, beta), (indifference, span)) = both(both(alpha, beta), region)?;
                arguments.sound()?;
                let least = match name {
                    "sprt2" => 1e-5,
                    "plan" => 5e-4,
                    _ => 0.0,
                };
                if indifference < least {
                    let said =
                        format!("`indifference` must be at least {least} with `{name}` (got {indifference})");
                    let error = Diagnostic::error(Code::E0604, span, said);
                    return self.report(error.hint("`sprt` and the default test have no such limit"));
                }
                Ok(match name {
                    "sprt" => Test::Sprt { alpha, beta, indifference },
                    "sprt2" => Test::Sprt2 { alpha, beta, indifference },
                    _ => Test::Plan { alpha, beta, indifference },
                })
            }
            "eprocess" => {
                let arguments =
                    self.arguments((clauses, method), ["alpha", "beta"], Sketch::PROBABILITY, locals);
                let alpha = self.error_of(arguments.values[0], error, "alpha");
                let beta = self.error_of(arguments.values[1], error, "beta");
                let (alpha, beta) = both(alpha, beta)?;
                arguments.sound()?;
                Ok(Test::EProcess { alpha, beta })
            }
            "three_way" => {
                let arguments =
                    self.arguments((clauses, method), ["alpha", "indifference"], Sketch::PROBABILITY, locals);
                let alpha = self.error_of(arguments.values[0], error, "alpha");
                let region = self.region(&arguments, 1, theta);
                let (alpha, (indifference, _)) = both(alpha, region)?;
                arguments.sound()?;
                Ok(Test::ThreeWay { alpha, indifference })
            }
            _ => self.unknown_method(method, &["sprt", "sprt2", "plan", "eprocess", "three_way"], locals),
        }
    }

    /// The indifference around a threshold, which is an argument of a method, and where; its region must lie inside
    /// (0, 1).
    fn region<const N: usize>(
        &mut self,
        arguments: &Arguments<'_, N>,
        argument: usize,
        Theta { value, at, noun }: Theta,
    ) -> Lowered<(f64, Span)> {
        let (indifference, span) = self.required(arguments, argument, "indifference")?;
        if indifference <= 0.0 {
            let error = Diagnostic::error(
                Code::E0602,
                span,
                format!("`indifference` must be positive (got {indifference})"),
            );
            return self.report(error.hint("remove the region: the default test needs none"));
        }
        // Around what is no threshold nothing is asked of it.
        let Some(theta) = value else { return Ok((indifference, span)) };
        let (low, high) = (theta - indifference, theta + indifference);
        if low > 0.0 && high < 1.0 && low < theta && theta < high {
            return Ok((indifference, span));
        }
        let round = |x: f64| (x * 1e12).round() / 1e12;
        let error = Diagnostic::error(
            Code::E0602,
            span,
            format!("the indifference region {} to {} must be inside (0, 1)", round(low), round(high)),
        )
        .hanging_on(at)
        .related(at, format!("around this {noun}"))
        .hint("write a smaller indifference, or remove the region: the default test needs none");
        self.report(error)
    }

    /// The estimator of a measure.
    pub(super) fn estimator(
        &mut self,
        clauses: &Clauses,
        sketch: Sketch,
        allowance: Allowance,
        locals: &Locals,
    ) -> Lowered<Estimator> {
        let within = self.within(clauses, sketch, locals);
        let confidence = self.delta(clauses, locals);
        let delta = allowance.error(confidence.unwrap_or(None), DEFAULT_DELTA);
        let quantile = sketch.what == What::Quantile;
        let misplaced = match &clauses.within {
            Some(expr) if quantile => {
                let error = Diagnostic::error(
                    Code::E0607,
                    expr.span,
                    "a quantile has a number of trials, not a width",
                );
                self.report(error.hint("write `by fixed(trials = 2000)`; the values determine the width"))
            }
            _ => Ok(()),
        };
        let estimator = match &clauses.by {
            Some(method) => self.estimator_by((clauses, method), sketch, (within, delta), allowance, locals),
            None => self.default_estimator(clauses, sketch, (within, delta)),
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
    ) -> Lowered<Estimator> {
        let within = within?;
        if let (Some(expr), Some(epsilon)) = (&clauses.within, within) {
            self.width((epsilon, expr.span), sketch, WIDEST)?;
        }
        Ok(match (within, sketch.what) {
            (Some(epsilon), _) => Estimator::Default { epsilon, delta },
            (None, What::Probability) => Estimator::Default { epsilon: DEFAULT_EPSILON, delta },
            (None, _) => Estimator::Fixed { trials: PLANNED_TRIALS, delta },
        })
    }

    fn estimator_by(
        &mut self,
        (clauses, method): (&Clauses, &Method),
        sketch: Sketch,
        (within, delta): (Lowered<Option<f64>>, f64),
        allowance: Allowance,
        locals: &Locals,
    ) -> Lowered<Estimator> {
        let (probability, quantile) = (sketch.what == What::Probability, sketch.what == What::Quantile);
        let name = method.name.name.as_str();
        let of_trials = match name {
            "fixed" => true,
            // Its interval is that of a share.
            "clopper_pearson" => probability,
            "dkw" => quantile,
            _ => false,
        };
        if of_trials {
            return self.of_trials((clauses, method), sketch, delta, allowance, locals);
        }
        if probability && (name == "splitting" || name == "fixed_effort") {
            return self.splitting(clauses, method, (delta, allowance), locals);
        }
        let known: &[&str] = match sketch.what {
            What::Probability => &[
                "okamoto",
                "massart",
                "spending",
                "clopper_pearson",
                "fixed",
                "gbas",
                "splitting",
                "fixed_effort",
            ],
            What::Quantile => &["fixed", "dkw"],
            What::Expectation => &["okamoto", "fixed"],
        };
        if !known.contains(&name) {
            return self.unknown_method(method, known, locals);
        }
        let arguments = self.arguments((clauses, method), ["epsilon", "delta"], sketch, locals);
        let delta = self.claimed(arguments.values[1], delta, allowance);
        let Some((epsilon, span)) = self.width_of(clauses, within, &arguments)? else {
            delta?;
            arguments.sound()?;
            let error = Diagnostic::error(Code::E0604, method.span, format!("`{name}` needs `epsilon`"));
            return self.report(error.formal());
        };
        if name == "gbas" {
            // A relative error has no scale.
            if !(1e-4..=0.999).contains(&epsilon) {
                let said = format!("the relative error must be between 0.0001 and 0.999 (got {epsilon})");
                return self.report(Diagnostic::error(Code::E0604, span, said));
            }
        } else {
            self.width((epsilon, span), sketch, WIDEST)?;
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

    /// A number of trials that is fixed beforehand.
    fn of_trials(
        &mut self,
        (clauses, method): (&Clauses, &Method),
        sketch: Sketch,
        delta: f64,
        allowance: Allowance,
        locals: &Locals,
    ) -> Lowered<Estimator> {
        let quantile = sketch.what == What::Quantile;
        let misplaced =
            match &clauses.within {
                Some(expr) if !quantile => {
                    let said = "a fixed number of trials cannot guarantee a width";
                    let error = Diagnostic::error(Code::E0607, expr.span, said);
                    self.report(error.hint(
                        "remove `by`, then the width determines the number of trials, or remove `within`",
                    ))
                }
                _ => Ok(()),
            };
        let arguments = self.arguments((clauses, method), ["trials", "delta"], sketch, locals);
        // The values of a quantile are kept.
        let most = if quantile { 1e9 } else { 1e12 };
        let trials = self.required(&arguments, 0, "trials").and_then(|(trials, span)| {
            if trials >= 1.0 && trials.fract() == 0.0 && trials <= most {
                return Ok(trials as u64);
            }
            let said = format!("`trials` must be a whole number from 1 to {most:e} (got {trials})");
            self.report(Diagnostic::error(Code::E0604, span, said))
        });
        let delta = self.claimed(arguments.values[1], delta, allowance);
        let (trials, delta) = both(trials, delta)?;
        arguments.sound()?;
        misplaced?;
        Ok(match method.name.name.as_str() {
            "dkw" => Estimator::Band { trials, delta },
            _ => Estimator::Fixed { trials, delta },
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
        let misplaced = match &clauses.within {
            Some(within) => {
                let error = Diagnostic::error(Code::E0607, within.span, "splitting cannot guarantee a width").hint(
                    "remove `within` and choose `replicas` and `runs`; their scatter determines the width",
                );
                self.report(error)
            }
            None => Ok(()),
        };
        let adaptive = method.name.name == "splitting";
        let names = ["replicas", "runs", "plain", "delta", "kill"];
        let arguments = self.arguments((clauses, method), names, Sketch::PROBABILITY, locals);
        let [replicas, runs, plain, _, kill] = arguments.values;
        // How many are killed is at most how many there are.
        let of = replicas.map(|(_, span)| span);
        let replicas = self.whole_in(replicas, "replicas", (10, 1_000_000), 1000, None);
        let runs = self.whole_in(runs, "runs", (2, 1000), 20, None);
        // Of what is wrong follows no default and no bound.
        let (most, times) = (replicas.unwrap_or(1_000_000), runs.unwrap_or(1000));
        let usual = (most * times / 2).max(LEAST_PLAIN);
        let plain = self.whole_in(plain, "plain", (LEAST_PLAIN, 1_000_000_000), usual, None);
        let delta = self.claimed(arguments.values[3], delta, allowance);
        let kill = self.whole_in(kill, "kill", (1, most - 1), (most / 10).max(1), of);
        let ((replicas, runs), (plain, kill)) = both(both(replicas, runs), both(plain, kill))?;
        let delta = delta?;
        let paths = replicas * runs;
        if paths > MOST_PATHS {
            let gigabytes = |paths: u64| (paths * BYTES_OF_A_PATH) as f64 / 1e9;
            let (taken, limit) = (gigabytes(paths), gigabytes(MOST_PATHS));
            let said = format!("{paths} paths need {taken:.1} GB of memory; the limit is {limit:.1} GB");
            let error = Diagnostic::error(Code::E0923, method.span, said);
            let fewer = MOST_PATHS / runs;
            let error = of.into_iter().fold(error, Diagnostic::hanging_on);
            return self.report(
                error.hint(format!("each run has one path for each replica: write `replicas = {fewer}`")),
            );
        }
        arguments.sound()?;
        misplaced?;
        Ok(Estimator::Splitting(Splitting { adaptive, replicas, runs, kill, plain, delta, level: 0 }))
    }

    /// A whole number in a range.
    fn whole_in(
        &mut self,
        value: Option<(f64, Span)>,
        name: &str,
        (low, high): (u64, u64),
        default: u64,
        hangs_on: Option<Span>,
    ) -> Lowered<u64> {
        match value {
            None => Ok(default),
            Some((value, _)) if value.fract() == 0.0 && value >= low as f64 && value <= high as f64 => {
                Ok(value as u64)
            }
            Some((value, span)) => {
                let said = format!("`{name}` must be a whole number from {low} to {high} (got {value})");
                let error = Diagnostic::error(Code::E0604, span, said);
                self.report(hangs_on.into_iter().fold(error, Diagnostic::hanging_on))
            }
        }
    }

    /// The error that a procedure states, as far as it is for one claim.
    pub(super) fn claimed(
        &mut self,
        value: Option<(f64, Span)>,
        default: f64,
        allowance: Allowance,
    ) -> Lowered<f64> {
        let stated = self.error_of(value, default, "delta")?;
        Ok(if value.is_some() { allowance.of(stated) } else { stated })
    }

    /// The width that a query names, by `within` or by `epsilon` and not by both, and where.
    pub(super) fn width_of<const N: usize>(
        &mut self,
        clauses: &Clauses,
        within: Lowered<Option<f64>>,
        arguments: &Arguments<'_, N>,
    ) -> Stated {
        match (arguments.values[0], &clauses.within) {
            (Some((_, span)), Some(_)) => {
                let said = "the width is given twice: by `within` and by `epsilon`";
                self.report(Diagnostic::error(Code::E0604, span, said).formal())
            }
            (Some(found), None) => Ok(Some(found)),
            (None, _) => stated(clauses, within),
        }
    }
}
