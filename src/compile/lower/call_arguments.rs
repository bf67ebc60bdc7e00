//! Named arguments of values that are calls: `prm(samples = 500)`, `guided(candidates = 24)`.

use crate::compile::context::{Context, Locals, Lowered, Reported, symbols::unknown};
use crate::compile::dimension::Dimension;
use crate::syntax::ast::{Binding, Expr, ExprKind, Ident, Value};
use crate::syntax::codes::Code;

/// A number among the named arguments of a call.
pub(crate) struct Argument {
    pub(crate) name: &'static str,
    pub(crate) dimension: Dimension,
    /// Least and largest value; open below where it must be positive.
    pub(crate) range: (f64, f64),
    pub(crate) positive: bool,
    pub(crate) whole: bool,
}

impl Argument {
    pub(crate) const fn length(name: &'static str, positive: bool) -> Self {
        Self { name, dimension: Dimension::LENGTH, range: (0.0, 1e4), positive, whole: false }
    }

    pub(crate) const fn count(name: &'static str, least: f64, most: f64) -> Self {
        Self { name, dimension: Dimension::NONE, range: (least, most), positive: false, whole: true }
    }
}

/// An argument that is one of some words.
pub(crate) fn word_of(
    context: &mut Context<'_>,
    all: &[Binding],
    name: &str,
    words: &[&'static str],
) -> Lowered<Option<&'static str>> {
    let Some(argument) = all.iter().find(|argument| argument.name.name == name) else { return Ok(None) };
    let found = match &argument.value.kind {
        ExprKind::Name(word) => words.iter().copied().find(|known| known == word),
        _ => None,
    };
    if found.is_some() {
        return Ok(found);
    }
    let said = format!("`{name}` must be `{}`", words.join("` or `"));
    context.report(error!(E0305, argument.value.span, "{said}"))
}

/// The numbers among the arguments of a call; `others` are known names of other arguments.
pub(crate) fn numbers_among<const N: usize>(
    context: &mut Context<'_>,
    of: &Ident,
    all: &[Binding],
    known: &[Argument; N],
    others: &[&str],
    locals: &Locals,
) -> Lowered<[Option<f64>; N]> {
    let mut values = [None; N];
    let mut failed = false;
    for (k, argument) in all.iter().enumerate() {
        let name = &argument.name;
        if all[..k].iter().any(|before| before.name.name == name.name) {
            let said = format!("`{}` is given twice", name.name);
            context.note(error!(E0202, name.span, "{said}"));
            failed = true;
        } else if let Some(at) = known.iter().position(|known| known.name == name.name) {
            match number_among(context, &known[at], &argument.value, locals) {
                Ok(value) => values[at] = Some(value),
                Err(Reported) => failed = true,
            }
        } else if !others.contains(&name.name.as_str()) {
            let names = known.iter().map(|known| known.name).chain(others.iter().copied());
            let what = format!("argument of `{}`", of.name);
            context.note(unknown(&what, &name.name, name.span, Code::E0207, names));
            failed = true;
        }
    }
    if failed { Err(Reported) } else { Ok(values) }
}

fn number_among(
    context: &mut Context<'_>,
    argument: &Argument,
    value: &Expr,
    locals: &Locals,
) -> Lowered<f64> {
    let number = context.number_of(value, argument.dimension, locals)?;
    let (low, high) = argument.range;
    let fits = (low..=high).contains(&number.value)
        && !(argument.positive && number.value == 0.0)
        && !(argument.whole && number.as_whole().is_none());
    if fits {
        return Ok(number.value);
    }
    let unit = argument.dimension.to_string();
    let (unit, what) = (if unit.is_empty() { unit } else { format!(" {unit}") }, argument.name);
    let said = match (argument.whole, argument.positive) {
        (true, _) => format!("`{what}` must be a whole number from {low} to {high}"),
        (false, true) => format!("`{what}` must be positive and at most {high}{unit}"),
        (false, false) => format!("`{what}` must be from {low} to {high}{unit}"),
    };
    context.report(error!(E0405, value.span, "{said} (got {}{unit})", number.value))
}

/// A value that is one word.
pub(crate) fn word(value: &Value) -> Option<&str> {
    match value {
        Value::Plain(Expr { kind: ExprKind::Name(name), .. }) => Some(name),
        _ => None,
    }
}

/// A value that is a call with named arguments, perhaps none: its name and its arguments.
pub(crate) fn call(value: &Value) -> Option<(&Ident, &[Binding])> {
    match value {
        Value::Arguments { name, arguments } => Some((name, arguments)),
        Value::Plain(Expr { kind: ExprKind::Call { function, arguments }, .. }) if arguments.is_empty() => {
            Some((function, &[]))
        }
        _ => None,
    }
}
