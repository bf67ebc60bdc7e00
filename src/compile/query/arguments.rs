//! The named arguments of a procedure: `sprt(alpha = 0.01, indifference = 0.02)`. Names, ranges and defaults are those
//! that the procedure declares in `stats`.

use crate::compile::context::{Context, Locals, Lowered, Reported};
use crate::compile::nearest::nearest;
use crate::compile::query::{
    bounds::{self, WIDEST},
    families::Allowance,
    measures::{self, Sketch},
    methods::{Stated, Theta, stated},
};
use crate::stats::spec::{Argument, Kind};
use crate::stats::{Chosen, Spec};
use crate::syntax::ast::{Clauses, Method};
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::source::Span;

/// Least value of a relative error, and the largest.
const RELATIVE: std::ops::RangeInclusive<f64> = 1e-4..=0.999;

/// What the arguments of a procedure depend on besides themselves.
pub(crate) struct Setting<'l> {
    pub(crate) sketch: Sketch,
    /// What a test decides about.
    pub(crate) theta: Option<Theta>,
    /// The error of the query.
    pub(crate) error: f64,
    pub(crate) allowance: Allowance,
    /// The width of `within`.
    pub(crate) within: Lowered<Option<f64>>,
    pub(crate) locals: &'l Locals,
}

/// Named numbers of a method, in the order of its procedure.
pub(crate) struct Arguments<'m> {
    pub(crate) method: &'m Method,
    pub(crate) values: Vec<Option<(f64, Span)>>,
    /// Whether some argument is wrong; that was said.
    failed: bool,
}

impl Arguments<'_> {
    /// An error where some argument is wrong.
    pub(crate) fn sound(&self) -> Lowered<()> {
        if self.failed { Err(Reported) } else { Ok(()) }
    }
}

/// The arguments of a method; all are pure numbers but `epsilon`, which is in the unit of the measure.
pub(crate) fn arguments<'m>(
    context: &mut Context<'_>,
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
            context.note(error.formal().hint(hint).knowing(names.iter().copied()));
            let _ = context.number(&argument.value, locals);
            failed = true;
            continue;
        };
        if let Some(first) = method.arguments.iter().find(|a| a.name.name == argument.name.name)
            && first.name.span != argument.name.span
        {
            let text = format!("`{}` is given twice", argument.name.name);
            let error = error!(E0604, argument.name.span, "{text}");
            context.note(error.formal().related(first.name.span, "first given here"));
            failed = true;
            continue;
        }
        if let Some(clause) = clauses.confidence.as_ref().filter(|_| known[at].is_error()) {
            let text = format!("the error is given twice: by `confidence` and by `{}`", names[at]);
            let error = error!(E0604, argument.name.span, "{text}");
            context.note(error.formal().related(clause.span, "given here"));
            failed = true;
            continue;
        }
        let sketch = if matches!(known[at].kind, Kind::Width) { sketch } else { Sketch::PROBABILITY };
        match measures::number_in(context, &argument.value, sketch, locals) {
            Ok(number) => values[at] = Some((number.value, argument.value.span)),
            Err(_) => failed = true,
        }
    }
    Arguments { method, values, failed }
}

/// A procedure with the values of its arguments. All that is wrong with them is said at once.
pub(crate) fn chosen(
    context: &mut Context<'_>,
    (clauses, method): (&Clauses, &Method),
    spec: &'static Spec,
    setting: &Setting<'_>,
) -> Lowered<Chosen> {
    let arguments = arguments(context, (clauses, method), spec.arguments, setting.sketch, setting.locals);
    let (mut values, mut failed) = (Vec::new(), arguments.failed);
    for (at, argument) in spec.arguments.iter().enumerate() {
        let given = arguments.values[at];
        let value = match argument.kind {
            Kind::Side => bounds::error_of(context, given, setting.error, argument.name),
            Kind::Error => claimed(context, given, setting.error, setting.allowance),
            Kind::Indifference(least) => indifference(context, &arguments, at, least, setting.theta),
            kind @ (Kind::Width | Kind::Relative) => {
                let width = width_of(context, clauses, setting.within, given);
                width.and_then(|width| half_width(context, width, kind, &arguments, setting.sketch))
            }
            Kind::Trials(most) => fixed_trials(context, &arguments, at, most),
            Kind::Number { low, high, default, bounded_by, .. } => {
                let high = high(&values);
                let bound = bounded_by.and_then(|of| arguments.values[of]).map(|(_, span)| span);
                number_between(context, given, *argument, (low, high), default(&values), bound)
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
    context: &mut Context<'_>,
    width: Option<(f64, Span)>,
    kind: Kind,
    arguments: &Arguments<'_>,
    sketch: Sketch,
) -> Lowered<f64> {
    let (epsilon, span) = needed(context, width, arguments, "epsilon")?;
    if matches!(kind, Kind::Width) {
        return bounds::width(context, (epsilon, span), sketch, WIDEST);
    }
    // A relative error has no scale.
    if RELATIVE.contains(&epsilon) {
        return Ok(epsilon);
    }
    let said = format!("the relative error must be between 0.0001 and 0.999 (got {epsilon})");
    context.report(error!(E0604, span, "{said}"))
}

/// A number of trials that is fixed beforehand.
fn fixed_trials(context: &mut Context<'_>, arguments: &Arguments<'_>, at: usize, most: u64) -> Lowered<f64> {
    let (trials, span) = needed(context, arguments.values[at], arguments, "trials")?;
    let most = most as f64;
    if trials >= 1.0 && trials.fract() == 0.0 && trials <= most {
        return Ok(trials);
    }
    let said = format!("`trials` must be a whole number from 1 to {most:e} (got {trials})");
    context.report(error!(E0604, span, "{said}"))
}

/// The indifference around a threshold; its region must lie inside (0, 1).
fn indifference(
    context: &mut Context<'_>,
    arguments: &Arguments<'_>,
    at: usize,
    least: f64,
    theta: Option<Theta>,
) -> Lowered<f64> {
    let (indifference, span) = needed(context, arguments.values[at], arguments, "indifference")?;
    if indifference <= 0.0 {
        return context.report(error!(E0602, span, "`indifference` must be positive (got {indifference})";
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
            return context.report(error);
        }
    }
    if indifference < least {
        let name = &arguments.method.name.name;
        let said = format!("`indifference` must be at least {least} with `{name}` (got {indifference})");
        return context.report(error!(E0604, span, "{said}";
                hint: "`sprt` and the default test have no such limit"));
    }
    Ok(indifference)
}

/// A number in a range.
fn number_between(
    context: &mut Context<'_>,
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
    context.report(hangs_on.into_iter().fold(error, Diagnostic::hanging_on))
}

/// The error that a procedure states, as far as it is for one claim.
pub(crate) fn claimed(
    context: &mut Context<'_>,
    value: Option<(f64, Span)>,
    default: f64,
    allowance: Allowance,
) -> Lowered<f64> {
    let stated = bounds::error_of(context, value, default, "delta")?;
    Ok(if value.is_some() { allowance.of(stated) } else { stated })
}

/// The width that a query names, by `within` or by `epsilon` and not by both, and where.
pub(crate) fn width_of(
    context: &mut Context<'_>,
    clauses: &Clauses,
    within: Lowered<Option<f64>>,
    given: Option<(f64, Span)>,
) -> Stated {
    match (given, &clauses.within) {
        (Some((_, span)), Some(_)) => {
            let said = "the width is given twice: by `within` and by `epsilon`";
            context.report(error!(E0604, span, "{said}").formal())
        }
        (Some(found), None) => Ok(Some(found)),
        (None, _) => stated(clauses, within),
    }
}

fn needed(
    context: &mut Context<'_>,
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
            context.report(error.formal())
        }
    }
}
