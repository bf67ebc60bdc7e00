//! Values of parameters from outside: `--set name=value`, sweeps, `under`.

use crate::base::decimal::Decimal;
use crate::base::math;
use crate::compile::context::{
    Context, Locals, Lowered, Reported,
    number::Number,
    symbols::{Meaning, Param, unknown},
};
use crate::compile::dimension::{self, Dimension, Unit};
use crate::compile::lower::choices;
use crate::syntax::ast::{Expr, ExprKind, UnitExpr, Values};
use crate::syntax::codes::Code;
use crate::syntax::source::Span;

/// A value of `--set`.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    /// Name of the parameter.
    pub name: String,
    /// Where the value stands, for messages.
    pub span: Span,
    /// Its value or values.
    pub values: Values,
}

/// Most points of a sweep, and most combinations of several.
pub(crate) const MOST_POINTS: usize = 10_000;

/// The unit in which the default of a parameter is written.
fn unit_of_default(default: &Expr) -> Option<&UnitExpr> {
    match &default.kind {
        ExprKind::Quantity(quantity) => quantity.unit.as_ref(),
        ExprKind::Unary(_, inner) => unit_of_default(inner),
        _ => None,
    }
}

/// The parameter of a name.
pub(crate) fn param<'a>(context: &mut Context<'a>, name: &str, span: Span) -> Lowered<Param<'a>> {
    if context.names.is_doubtful(0, name) {
        return Err(Reported);
    }
    match context.names.scopes[0].get(name).map(|e| e.meaning.clone()) {
        Some(Meaning::Param(param)) => Ok(param),
        Some(meaning) => context
            .report(error!(E0210, span, "`{name}` is {} and cannot be set", meaning.noun();
                    hint: "declare it with `param`")),
        None => {
            let params: Vec<String> = context.names.scopes[0]
                .entries()
                .filter(|(_, e)| matches!(e.meaning, Meaning::Param(_)))
                .map(|(n, _)| n.to_owned())
                .collect();
            let mut error = unknown("parameter", name, span, Code::E0210, params.iter().map(String::as_str));
            if error.hint.is_none() {
                error = error.hint(match params.as_slice() {
                    [] => "the scenario declares no `param`".to_owned(),
                    known => format!("the scenario declares {}", known.join(", ")),
                });
            }
            context.report(error)
        }
    }
}

/// The value that a parameter is set to. A bare number takes the unit of the default; a share (`50 %`) is none.
pub(crate) fn setting(
    context: &mut Context<'_>,
    name: &str,
    value: &Expr,
    locals: &Locals,
) -> Lowered<Number> {
    let declared = param(context, name, value.span);
    if let Ok(Param { choices, .. }) = declared
        && !choices.is_empty()
    {
        return choices::place(context, name, value, choices);
    }
    let declared = declared
        .and_then(|Param { value, range, .. }| Ok((value, range, context.number(value, &Locals::of(0))?)));
    let number = context.number(value, locals);
    let ((default, range, declared), mut number) = (declared?, number?);
    let bare = !matches!(&value.kind, ExprKind::Quantity(quantity) if quantity.unit.is_some());
    if bare && number.dimension.is_none() && !declared.dimension.is_none() {
        let unit = unit_of_default(default).and_then(|unit| dimension::resolve(unit).ok());
        number = match unit {
            Some(unit) => number.times(Number::literal(Decimal::ONE, &unit)).unwrap_or(number),
            None => Number { dimension: declared.dimension, ..number },
        };
    }
    if number.dimension != declared.dimension {
        return context.wrong_dimension(value.span, declared.dimension, number.dimension);
    }
    if !number.value.is_finite() {
        return context.report(error!(E0405, value.span, "the value is not a finite number"));
    }
    // A range that depends on other parameters is that of the world in which the value is set.
    if let Some((low, high)) = range
        && !context.names.hangs_on_parameters(low.span.to(high.span))
    {
        in_range(context, (name, number), (value.span, value.span))?;
    }
    Ok(number)
}

/// Whether the value of a parameter is in its range in this world. `at` has the places for the errors of a value that
/// is too low and of one that is too high.
pub(crate) fn in_range(
    context: &mut Context<'_>,
    (name, number): (&str, Number),
    at: (Span, Span),
) -> Lowered<()> {
    let Ok(param @ Param { range: Some((low, high)), .. }) = param(context, name, at.0) else {
        return Ok(());
    };
    let place = low.span.to(high.span);
    let locals = Locals::of(0);
    let ends = (
        context.number_of(low, number.dimension, &locals),
        context.number_of(high, number.dimension, &locals),
    );
    let (low, high) = (ends.0?, ends.1?);
    if low.value > high.value {
        // Said where it is declared.
        return Err(Reported);
    }
    if number.value < low.value || number.value > high.value {
        let at = if number.value < low.value { at.0 } else { at.1 };
        let [low, high] = [low, high].map(|n| shown(context, param, n));
        let said = format!("`{name}` must be between {low} and {high}");
        let error = error!(E0405, at, "{said}"; hint: "the range is that of its declaration in the scenario");
        return context.report(error.hanging_on(place));
    }
    Ok(())
}

/// The values of a parameter, without one that is listed twice. `most` of them are allowed.
pub(crate) fn values(
    context: &mut Context<'_>,
    (name, at): (&str, Span),
    values: &Values,
    most: usize,
    locals: &Locals,
) -> Lowered<Vec<Number>> {
    let Ok(Param { value: default, choices, .. }) = param(context, name, at) else {
        // Their values are unknown; their errors are reported.
        return context.lower_all(values.parts(), locals).and(Err(Reported));
    };
    let (from, to, by, log) = match values {
        Values::List(list) => return listed(context, (name, at), list, most, locals),
        Values::Range { from, .. } if !choices.is_empty() => {
            return context.report(error!(E0213, from.span, "a choice has no range"; hint: "list its names"));
        }
        Values::Range { from, to, by, log } => (from, to, by, *log),
    };
    let step = context.number(by, locals);
    let ends = (setting(context, name, from, locals), setting(context, name, to, locals));
    let (first, last, step) = (ends.0?, ends.1?, step?);
    let unit = unit_of_default(default).and_then(|unit| dimension::resolve(unit).ok());
    if log {
        let places = [from.span, to.span, by.span];
        return decades(context, [first, last, step], places, unit.as_ref(), (at, most));
    }
    if !step.dimension.is_none() && step.dimension != first.dimension {
        return context.wrong_dimension(by.span, first.dimension, step.dimension);
    }
    let step = match unit {
        // A share without its sign is what it is, as a value is.
        Some(unit) if step.dimension.is_none() && !unit.dimension.is_none() => {
            step.times(Number::literal(Decimal::ONE, &unit)).unwrap_or(step)
        }
        _ => Number { dimension: first.dimension, ..step },
    };
    if step.value <= 0.0 || last.value < first.value {
        return context.report(error!(
            E0405,
            if step.value <= 0.0 { by.span } else { to.span },
            "the values must go up from the first to the last by a positive step"
        ));
    }
    let count = ((last.value - first.value) / step.value + 1e-9).floor();
    if count >= most as f64 {
        return too_many(context, at, most);
    }
    // Each from the first: steps that are no decimals would add up their rounding, and leave the range.
    let point = |k: i64| {
        let way = step.times(Number::whole(k)).map_or(first, |way| first.plus(way));
        // Where the last one is meant it is that one, whatever rounding made of the step.
        let is_last = (last.value - way.value).abs() <= 1e-9 * step.value;
        if is_last { last } else { way }
    };
    Ok((0..=count as i64).map(point).collect())
}

/// Values one by one.
fn listed(
    context: &mut Context<'_>,
    (name, at): (&str, Span),
    list: &[Expr],
    most: usize,
    locals: &Locals,
) -> Lowered<Vec<Number>> {
    let all: Vec<Lowered<Number>> = list.iter().map(|value| setting(context, name, value, locals)).collect();
    let numbers: Vec<Number> = all.into_iter().collect::<Lowered<_>>()?;
    for (k, (number, value)) in numbers.iter().zip(list).enumerate() {
        if let Some(first) = numbers[..k].iter().position(|known| known.value == number.value) {
            let said = format!("the value `{}` is listed twice", context.text(value.span));
            let error = error!(E0405, value.span, "{said}");
            return context
                .report(error.related(list[first].span, "first listed here").hint("remove one of them"));
        }
    }
    if list.len() > most { too_many(context, at, most) } else { Ok(numbers) }
}

/// Values of which each is the same factor larger than the one before, `count` in a decade; with six digits in the
/// unit of the default, so that they can be written.
fn decades(
    context: &mut Context<'_>,
    [first, last, count]: [Number; 3],
    [from, to, by]: [Span; 3],
    unit: Option<&Unit>,
    (at, most): (Span, usize),
) -> Lowered<Vec<Number>> {
    let error = if first.value <= 0.0 {
        Some((from, "the first of values by decades must be positive"))
    } else if last.value < first.value {
        Some((to, "the values must go up from the first to the last"))
    } else if !count.dimension.is_none() || count.as_whole().is_none_or(|count| count < 1) {
        Some((by, "the number of values a decade must be whole and positive"))
    } else {
        None
    };
    if let Some((at, said)) = error {
        return context.report(error!(E0405, at, "{said}"));
    }
    let factor = math::ln(10.0) / count.value;
    let steps = (math::ln(last.value / first.value) / factor + 1e-9).floor();
    if steps >= most as f64 {
        return too_many(context, at, most);
    }
    let point = |k: usize| {
        let value = first.value * math::exp(factor * k as f64);
        let written = format!("{:.5e}", value / unit.map_or(1.0, |unit| unit.size));
        let number = match (Decimal::parse(&written), unit) {
            (Some(written), Some(unit)) => Number::literal(written, unit),
            (Some(written), None) => Number::exact(written, first.dimension),
            (None, _) => Number::rounded(value, first.dimension),
        };
        let is = |end: Number| (end.value - value).abs() <= 1e-9 * end.value;
        [first, last].into_iter().find(|end| is(*end)).unwrap_or(number)
    };
    Ok((0..=steps as usize).map(point).collect())
}

fn too_many<T>(context: &mut Context<'_>, at: Span, most: usize) -> Lowered<T> {
    context.report(error!(E0405, at, "at most {most} values are allowed"))
}

/// The value of a parameter: of a choice its name, else in the unit in which the default is written.
pub(crate) fn shown(context: &Context<'_>, param: Param<'_>, number: Number) -> String {
    let Param { value: default, choices, .. } = param;
    let place = number.as_whole().and_then(|at| usize::try_from(at).ok());
    if let Some(choice) = place.and_then(|at| choices.get(at)) {
        return choice.name.clone();
    }
    let unit = unit_of_default(default);
    let resolved = unit.and_then(|unit| dimension::resolve(unit).ok());
    match (unit, resolved) {
        (Some(unit), Some(resolved)) => {
            let scaled = match (number.exact, resolved.exact) {
                (Some(a), Some(b)) => a.div(b).map_or(number.value / resolved.size, Decimal::to_f64),
                _ => number.value / resolved.size,
            };
            format!("{scaled} {}", context.text(unit.span))
        }
        _ if number.dimension == Dimension::NONE => format!("{}", number.value),
        _ => format!("{} {}", number.value, number.dimension),
    }
}
