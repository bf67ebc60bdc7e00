//! Values of parameters: constants and distributions.

use crate::base::decimal::Decimal;
use crate::compile::context::{Context, Locals, Lowered, symbols::unknown, typed::Typed};
use crate::compile::dimension::Dimension;
use crate::compile::lower::{builtin::DISTRIBUTIONS, laws};
use crate::model::parameter::{self, Parameter};
use crate::model::stepper::stature;
use crate::model::{Family, Law};
use crate::syntax::ast::{BinaryOp, Expr, ExprKind, Value};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::source::Span;

/// How a time that must not be negative is mended.
pub(crate) fn advise_bounds(error: Diagnostic, law: &Law, text: &str) -> Diagnostic {
    match law.constant() {
        Some(_) => error,
        None => {
            let law_alone = text.split(" in ").next().unwrap_or_default();
            error.hint(format!("truncate it: `{law_alone} in 0 s .. {} s`", cut(law.mean())))
        }
    }
}

/// Where to cut a time so that its mean stays about what it is: as far above as 0 is below.
fn cut(mean: f64) -> f64 {
    if !(mean > 0.0 && mean.is_finite()) {
        return 60.0;
    }
    // Three digits will do.
    let (twice, mut scale, mut unit) = (2.0 * mean, 1.0, 1.0);
    while twice * scale < 100.0 {
        scale *= 10.0;
    }
    while twice > 1000.0 * unit {
        unit *= 10.0;
    }
    (twice * scale / unit).ceil() * unit / scale
}

/// The law of a parameter of a given dimension.
pub(crate) fn law(
    context: &mut Context<'_>,
    value: &Value,
    dimension: Dimension,
    locals: &Locals,
) -> Lowered<Law> {
    match value {
        Value::Plain(expr) => match distribution(expr) {
            Some(drawn) => {
                let family = family(context, &drawn, expr.span, dimension, locals)?;
                validated(context, family, (f64::NEG_INFINITY, f64::INFINITY), dimension, expr.span)
            }
            None => context.number_of(expr, dimension, locals).map(|n| Law::Constant(n.value)),
        },
        Value::Truncated { law, low, high } => {
            let ends =
                (context.number_of(low, dimension, locals), context.number_of(high, dimension, locals));
            let Some(drawn) = distribution(law) else {
                if let ExprKind::Call { function, arguments } = &law.kind {
                    let _ = context.lower_all(arguments, locals);
                    let error = unknown(
                        "distribution",
                        &function.name,
                        function.span,
                        Code::E0203,
                        DISTRIBUTIONS.into_iter(),
                    );
                    return context.report(error);
                }
                let error = error!(E0404, law.span, "only a distribution can be truncated";
                            hint: "write for example `normal(mean, sd) in lo .. hi`; the distributions are {}", DISTRIBUTIONS.join(", "));
                return context.report(error);
            };
            let family = family(context, &drawn, law.span, dimension, locals)?;
            validated(context, family.clone(), (f64::NEG_INFINITY, f64::INFINITY), dimension, law.span)?;
            let (low, high) = (ends.0?.value, ends.1?.value);
            validated(context, family, (low, high), dimension, value.span())
        }
        other => {
            let error = error!(E0305, other.span(), "expected a number or a distribution");
            context.report(error)
        }
    }
}

/// A time that somebody waits, or after which something happens, not negative; `what` is its name in the error.
pub(crate) fn waiting(context: &mut Context<'_>, value: &Value, locals: &Locals, what: &str) -> Lowered<Law> {
    let law = self::law(context, value, Dimension::TIME, locals)?;
    if law.bounds().0 < 0.0 {
        let (at, said) = (value.span(), format!("{what} cannot be negative"));
        let text = context.text(at);
        return context.report(advise_bounds(error!(E0405, at, "{said}"), &law, &text));
    }
    Ok(law)
}

/// The law of a parameter, all of whose values are possible.
pub(crate) fn parameter_law(
    context: &mut Context<'_>,
    parameter: Parameter,
    value: &Value,
    locals: &Locals,
) -> Lowered<Law> {
    let per_metre = parameter == Parameter::Pieces && is_per_metre(context, value, locals);
    let dimension = if per_metre { PER_METRE } else { parameter.description().dimension };
    let mut law = laws::law(context, value, dimension, locals)?;
    let is_few = parameter == Parameter::Pieces && law.bounds().0 < parameter::FEWEST_PIECES;
    if per_metre != is_few {
        let said =
            "`pieces` must be a whole number from 2 to 64, or more than 0 and less than 2 for each metre";
        return context.report(error!(E0405, value.span(), "{said}";
            hint: "write for example `pieces = 6`, or `pieces = 0.42 /m` for 4.2 pieces in 10 m"));
    }
    if parameter == Parameter::Height {
        law = stature(law);
    }
    match parameter.refuses(&law) {
        None => Ok(law),
        Some(reason) => context.report(error!(E0405, value.span(), "{reason}")),
    }
}

/// Of a number for each metre.
const PER_METRE: Dimension = Dimension([0, -1, 0, 0, 0]);

/// Whether a number, or the first argument of a distribution or its factor, is one for each metre.
fn is_per_metre(context: &mut Context<'_>, value: &Value, locals: &Locals) -> bool {
    let (Value::Plain(expr) | Value::Truncated { law: expr, .. }) = value else { return false };
    let drawn = distribution(expr);
    let factor = drawn.as_ref().and_then(Drawn::factor);
    let first = drawn.and_then(|drawn| drawn.arguments.first());
    let measured = factor.as_ref().or(first).unwrap_or(expr);
    matches!(context.lower(measured, locals), Ok(Typed::Number(number)) if number.dimension == PER_METRE)
}

fn validated(
    context: &mut Context<'_>,
    family: Family,
    (low, high): (f64, f64),
    dimension: Dimension,
    span: Span,
) -> Lowered<Law> {
    let law = Law::Random { family, low, high };
    match law.validate() {
        Ok(()) => Ok(law),
        Err(reason) => {
            let error = error!(E0404, span, "{reason}");
            context.report(if dimension.is_none() {
                error
            } else {
                error.hint(format!("the value is in {dimension}"))
            })
        }
    }
}

/// The family of a distribution, or of a multiple of one.
fn family(
    context: &mut Context<'_>,
    drawn: &Drawn<'_>,
    span: Span,
    dimension: Dimension,
    locals: &Locals,
) -> Lowered<Family> {
    let Some(factor) = drawn.factor() else {
        return own_family(context, drawn, span, dimension, locals);
    };
    let family = own_family(context, drawn, span, Dimension::NONE, locals);
    let by = context.number_of(&factor, dimension, locals);
    let (family, by) = (family?, by?);
    validated(context, family.clone(), (f64::NEG_INFINITY, f64::INFINITY), Dimension::NONE, span)?;
    if !(by.value > 0.0 && by.value.is_finite()) {
        let error = error!(E0404, factor.span, "the factor of a distribution must be positive");
        return context.report(error);
    }
    let Some(mut scaled) = family.scaled(by.value) else {
        return context.report(error!(E0404, span, "this `{}` cannot be multiplied", drawn.name;
                hint: "a multiple of `beta` would leave (0, 1), and a multiple of a count can have at most 4096 values"));
    };
    // Three times 0.1 s is 0.3 s, which a product of doubles misses.
    let exact = exactly(context, drawn, &scaled, locals);
    if let Family::Choice(options) | Family::Multiple { options, .. } = &mut scaled {
        for ((value, _), (_, exact)) in options.iter_mut().zip(exact) {
            *value = exact.map_or(*value, Decimal::to_f64);
        }
    }
    Ok(scaled)
}

/// The values that a law can take, and what they are exactly: of laws of few values, those that are not rounded.
pub(crate) fn exact_values(
    context: &mut Context<'_>,
    value: &Value,
    law: &Law,
    locals: &Locals,
) -> Vec<(f64, Decimal)> {
    let (Value::Plain(expr) | Value::Truncated { law: expr, .. }) = value else { return Vec::new() };
    match (law, distribution(expr)) {
        (Law::Constant(value), _) => {
            let exact = context.number(expr, locals).ok().and_then(|number| number.exact);
            exact.map(|exact| (*value, exact)).into_iter().collect()
        }
        (Law::Random { family, .. }, Some(drawn)) => {
            let values = exactly(context, &drawn, family, locals);
            values.into_iter().filter_map(|(value, exact)| Some((value, exact?))).collect()
        }
        (Law::Random { .. }, None) => Vec::new(),
    }
}

/// The values that a family can take, in its order, as far as each is known exactly.
fn exactly(
    context: &mut Context<'_>,
    drawn: &Drawn<'_>,
    family: &Family,
    locals: &Locals,
) -> Vec<(f64, Option<Decimal>)> {
    let by = match drawn.factor() {
        Some(factor) => context.number(&factor, locals).ok().and_then(|number| number.exact),
        None => Some(Decimal::ONE),
    };
    let Some(by) = by else { return Vec::new() };
    let mut written = |place: usize| {
        let number = context.number(drawn.arguments.get(place)?, locals).ok()?;
        number.exact?.mul(by)
    };
    match *family {
        Family::Choice(ref options) => {
            options.iter().enumerate().map(|(place, (value, _))| (*value, written(place))).collect()
        }
        Family::Multiple { by: unit, ref options, .. } => {
            let count = |value: f64| Decimal::whole((value / unit + 0.5).floor() as i64);
            options.iter().map(|(value, _)| (*value, count(*value).mul(by))).collect()
        }
        // Without spread it is its mean.
        Family::Normal { mean, sd }
        | Family::LogNormal { mean, sd }
        | Family::Gamma { mean, sd }
        | Family::Weibull { mean, sd }
            if sd == 0.0 =>
        {
            vec![(mean, written(0))]
        }
        _ => Vec::new(),
    }
}

fn own_family(
    context: &mut Context<'_>,
    drawn: &Drawn<'_>,
    span: Span,
    dimension: Dimension,
    locals: &Locals,
) -> Lowered<Family> {
    let (name, arguments) = (drawn.name, drawn.arguments);
    let wanted = match name {
        "choice" => arguments.len().max(1),
        "exponential" | "poisson" | "bernoulli" => 1,
        _ => 2,
    };
    if arguments.len() != wanted {
        let usage = match name {
            "uniform" | "uniform_int" => "both ends: `uniform(low, high)`".to_owned(),
            "exponential" | "poisson" => format!("the mean: `{name}(mean)`"),
            "bernoulli" => "the probability of 1: `bernoulli(p)`".to_owned(),
            "choice" => "the values to choose from".to_owned(),
            _ => format!("the mean and the standard deviation: `{name}(mean, sd)`"),
        };
        return context.report(error!(E0204, span, "`{name}` needs {usage}"));
    }
    if matches!(name, "uniform_int" | "poisson" | "bernoulli") && !dimension.is_none() {
        return context
            .report(error!(E0404, span, "`{name}` draws numbers without a unit, but {dimension} is needed";
                hint: "multiply it by a unit: `{} * 1 {dimension}`", context.text(span)));
    }
    let numbers: Vec<_> = arguments.iter().map(|a| context.number_of(a, dimension, locals)).collect();
    let numbers: Vec<f64> =
        numbers.into_iter().collect::<Lowered<Vec<_>>>()?.iter().map(|n| n.value).collect();
    let (first, second) = (numbers[0], numbers.get(1).copied().unwrap_or(0.0));
    Ok(match name {
        "normal" => Family::Normal { mean: first, sd: second },
        "lognormal" => Family::LogNormal { mean: first, sd: second },
        "uniform" => Family::Uniform { low: first, high: second },
        "uniform_int" => {
            if first.fract() != 0.0 || second.fract() != 0.0 {
                return context
                    .report(error!(E0404, span, "the ends of `uniform_int` must be whole numbers"));
            }
            Family::UniformInt { low: first as i64, high: second as i64 }
        }
        "exponential" => Family::Exponential { mean: first },
        "poisson" => Family::Poisson { mean: first },
        "bernoulli" => Family::Bernoulli { p: first },
        "beta" => Family::Beta { mean: first, sd: second },
        "gamma" => Family::Gamma { mean: first, sd: second },
        "weibull" => Family::Weibull { mean: first, sd: second },
        _ => {
            let weight = 1.0 / numbers.len() as f64;
            Family::Choice(numbers.into_iter().map(|value| (value, weight)).collect())
        }
    })
}

/// A distribution as written: `poisson(4)`, `poisson(4) * 1 s`, `2 * poisson(4) * 1 s`.
pub(crate) struct Drawn<'e> {
    name: &'e str,
    pub(crate) arguments: &'e [Expr],
    /// What it is multiplied by, in the order of writing.
    pub(crate) factors: Vec<&'e Expr>,
}

impl Drawn<'_> {
    /// All factors as one, if there are any: `2 * lognormal(1, 0.1) * 1 m/s`.
    fn factor(&self) -> Option<Expr> {
        self.factors.iter().copied().cloned().reduce(|first, second| Expr {
            span: first.span.to(second.span),
            kind: ExprKind::Binary(BinaryOp::Times, Box::new(first), Box::new(second)),
        })
    }
}

/// A distribution, or a multiple of one.
pub(crate) fn distribution(expr: &Expr) -> Option<Drawn<'_>> {
    match &expr.kind {
        ExprKind::Call { function, arguments } if DISTRIBUTIONS.contains(&function.name.as_str()) => {
            Some(Drawn { name: &function.name, arguments, factors: Vec::new() })
        }
        ExprKind::Binary(BinaryOp::Times, left, right) => match (distribution(left), distribution(right)) {
            (Some(mut drawn), None) => {
                drawn.factors.push(right);
                Some(drawn)
            }
            (None, Some(mut drawn)) => {
                drawn.factors.insert(0, left);
                Some(drawn)
            }
            _ => None,
        },
        _ => None,
    }
}
