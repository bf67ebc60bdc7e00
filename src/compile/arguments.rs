//! The named arguments of a procedure: `sprt(alpha = 0.01, indifference = 0.02)`. Names, ranges and defaults are those
//! that the procedure declares in `stats`.

use super::bounds::WIDEST;
use super::elaborator::{Elaborator, Locals, Lowered, Reported};
use super::families::Allowance;
use super::measures::Sketch;
use super::methods::{Stated, Theta, stated};
use super::nearest::nearest;
use crate::stats::spec::{Argument, Kind};
use crate::stats::{Chosen, Spec};
use crate::syntax::ast::{Clauses, Method};
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::source::Span;

/// Least value of a relative error, and the largest.
const RELATIVE: std::ops::RangeInclusive<f64> = 1e-4..=0.999;

/// What the arguments of a procedure depend on besides themselves.
pub(super) struct Setting<'l> {
    pub(super) sketch: Sketch,
    /// What a test decides about.
    pub(super) theta: Option<Theta>,
    /// The error of the query.
    pub(super) error: f64,
    pub(super) allowance: Allowance,
    /// The width of `within`.
    pub(super) within: Lowered<Option<f64>>,
    pub(super) locals: &'l Locals,
}

/// Named numbers of a method, in the order of its procedure.
pub(super) struct Arguments<'m> {
    pub(super) method: &'m Method,
    pub(super) values: Vec<Option<(f64, Span)>>,
    /// Whether some argument is wrong; that was said.
    failed: bool,
}

impl Arguments<'_> {
    /// An error where some argument is wrong.
    pub(super) fn sound(&self) -> Lowered<()> {
        if self.failed { Err(Reported) } else { Ok(()) }
    }
}

impl Elaborator<'_> {
    /// The arguments of a method; all are pure numbers but `epsilon`, which is in the unit of the measure.
    pub(super) fn arguments<'m>(
        &mut self,
        (clauses, method): (&Clauses, &'m Method),
        known: &[Argument],
        sketch: Sketch,
        locals: &Locals,
    ) -> Arguments<'m> {
        let mut values = vec![None; known.len()];
        let mut failed = false;
        let names: Vec<&str> = known.iter().map(|one| one.name).collect();
        for argument in &method.arguments {
            let Some(at) = names.iter().position(|n| *n == argument.name.name) else {
                let known = format!("its arguments are {}", names.join(", "));
                let hint = nearest(&argument.name.name, names.iter().copied())
                    .map_or(known, |n| format!("did you mean `{n}`?"));
                let error = error!(
                    E0604,
                    argument.name.span, "`{}` has no argument `{}`", method.name.name, argument.name.name
                );
                self.note(error.formal().hint(hint));
                let _ = self.number(&argument.value, locals);
                failed = true;
                continue;
            };
            if let Some(first) = method.arguments.iter().find(|a| a.name.name == argument.name.name)
                && first.name.span != argument.name.span
            {
                let text = format!("`{}` is given twice", argument.name.name);
                let error = error!(E0604, argument.name.span, "{text}");
                self.note(error.formal().related(first.name.span, "first given here"));
                failed = true;
                continue;
            }
            if let Some(clause) = clauses.confidence.as_ref().filter(|_| known[at].is_error()) {
                let text = format!("the error is given twice: by `confidence` and by `{}`", names[at]);
                let error = error!(E0604, argument.name.span, "{text}");
                self.note(error.formal().related(clause.span, "given here"));
                failed = true;
                continue;
            }
            let sketch = if matches!(known[at].kind, Kind::Width) { sketch } else { Sketch::PROBABILITY };
            match self.number_in(&argument.value, sketch, locals) {
                Ok(number) => values[at] = Some((number.value, argument.value.span)),
                Err(_) => failed = true,
            }
        }
        Arguments { method, values, failed }
    }

    /// A procedure with the values of its arguments. All that is wrong with them is said at once.
    pub(super) fn chosen(
        &mut self,
        (clauses, method): (&Clauses, &Method),
        spec: &'static Spec,
        setting: &Setting<'_>,
    ) -> Lowered<Chosen> {
        let arguments = self.arguments((clauses, method), spec.arguments, setting.sketch, setting.locals);
        let (mut values, mut failed) = (Vec::new(), arguments.failed);
        for (at, argument) in spec.arguments.iter().enumerate() {
            let given = arguments.values[at];
            let value = match argument.kind {
                Kind::Side => self.error_of(given, setting.error, argument.name),
                Kind::Error => self.claimed(given, setting.error, setting.allowance),
                Kind::Indifference(least) => self.indifference(&arguments, at, least, setting.theta),
                kind @ (Kind::Width | Kind::Relative) => {
                    let width = self.width_of(clauses, setting.within, given);
                    width.and_then(|width| self.half_width(width, kind, &arguments, setting.sketch))
                }
                Kind::Trials(most) => self.fixed_trials(&arguments, at, most),
                Kind::Number { low, high, default, bounded_by, .. } => {
                    let high = high(&values);
                    let bound = bounded_by.and_then(|of| arguments.values[of]).map(|(_, span)| span);
                    self.number_between(given, *argument, (low, high), default(&values), bound)
                }
            };
            failed |= value.is_err();
            // Of what is wrong follows no bound for the others.
            values.push(value.unwrap_or_else(|_| match argument.kind {
                Kind::Number { high, .. } => high(&values),
                _ => f64::NAN,
            }));
        }
        if failed { Err(Reported) } else { Ok(spec.with(values)) }
    }

    /// The half width that a procedure needs.
    fn half_width(
        &mut self,
        width: Option<(f64, Span)>,
        kind: Kind,
        arguments: &Arguments<'_>,
        sketch: Sketch,
    ) -> Lowered<f64> {
        let (epsilon, span) = self.needed(width, arguments, "epsilon")?;
        if matches!(kind, Kind::Width) {
            return self.width((epsilon, span), sketch, WIDEST);
        }
        // A relative error has no scale.
        if RELATIVE.contains(&epsilon) {
            return Ok(epsilon);
        }
        let said = format!("the relative error must be between 0.0001 and 0.999 (got {epsilon})");
        self.report(error!(E0604, span, "{said}"))
    }

    /// A number of trials that is fixed beforehand.
    fn fixed_trials(&mut self, arguments: &Arguments<'_>, at: usize, most: u64) -> Lowered<f64> {
        let (trials, span) = self.needed(arguments.values[at], arguments, "trials")?;
        let most = most as f64;
        if trials >= 1.0 && trials.fract() == 0.0 && trials <= most {
            return Ok(trials);
        }
        let said = format!("`trials` must be a whole number from 1 to {most:e} (got {trials})");
        self.report(error!(E0604, span, "{said}"))
    }

    /// The indifference around a threshold; its region must lie inside (0, 1).
    fn indifference(
        &mut self,
        arguments: &Arguments<'_>,
        at: usize,
        least: f64,
        theta: Option<Theta>,
    ) -> Lowered<f64> {
        let (indifference, span) = self.needed(arguments.values[at], arguments, "indifference")?;
        if indifference <= 0.0 {
            return self.report(error!(E0602, span, "`indifference` must be positive (got {indifference})";
                hint: "remove the region: the default test needs none"));
        }
        // Around what is no threshold nothing is asked of it.
        if let Some(Theta { value: Some(theta), at, noun }) = theta {
            let (low, high) = (theta - indifference, theta + indifference);
            if !(low > 0.0 && high < 1.0 && low < theta && theta < high) {
                let round = |x: f64| (x * 1e12).round() / 1e12;
                let error = error!(
                    E0602,
                    span,
                    "the indifference region {} to {} must be inside (0, 1)",
                    round(low),
                    round(high)
                )
                .hanging_on(at)
                .related(at, format!("around this {noun}"))
                .hint("write a smaller indifference, or remove the region: the default test needs none");
                return self.report(error);
            }
        }
        if indifference < least {
            let name = &arguments.method.name.name;
            let said = format!("`indifference` must be at least {least} with `{name}` (got {indifference})");
            return self.report(error!(E0604, span, "{said}";
                hint: "`sprt` and the default test have no such limit"));
        }
        Ok(indifference)
    }

    /// A number in a range.
    fn number_between(
        &mut self,
        value: Option<(f64, Span)>,
        argument: Argument,
        (low, high): (f64, f64),
        default: f64,
        hangs_on: Option<Span>,
    ) -> Lowered<f64> {
        let Some((value, span)) = value else { return Ok(default) };
        let is_whole = value.fract() == 0.0 || matches!(argument.kind, Kind::Number { whole: false, .. });
        if is_whole && (low..=high).contains(&value) {
            return Ok(value);
        }
        let (name, noun) = (argument.name, argument.kind.noun());
        let said = format!("`{name}` must be {noun} from {low} to {high} (got {value})");
        let error = error!(E0604, span, "{said}");
        self.report(hangs_on.into_iter().fold(error, Diagnostic::hanging_on))
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
    pub(super) fn width_of(
        &mut self,
        clauses: &Clauses,
        within: Lowered<Option<f64>>,
        given: Option<(f64, Span)>,
    ) -> Stated {
        match (given, &clauses.within) {
            (Some((_, span)), Some(_)) => {
                let said = "the width is given twice: by `within` and by `epsilon`";
                self.report(error!(E0604, span, "{said}").formal())
            }
            (Some(found), None) => Ok(Some(found)),
            (None, _) => stated(clauses, within),
        }
    }

    fn needed(
        &mut self,
        value: Option<(f64, Span)>,
        arguments: &Arguments<'_>,
        name: &str,
    ) -> Lowered<(f64, Span)> {
        match value {
            Some(found) => Ok(found),
            // What is missing is perhaps what is misspelt.
            None if arguments.failed => Err(Reported),
            None => {
                let method = arguments.method;
                let error = error!(E0604, method.span, "`{}` needs `{name}`", method.name.name);
                self.report(error.formal())
            }
        }
    }
}
