//! Units and words that are misspelt, so that they read as names.

use crate::base::tick::Clock;
use crate::compile::context::{Context, Locals, Lowered, clock::Told};
use crate::compile::dimension;
use crate::compile::lower::{
    builtin::{BUILT_IN, DISTRIBUTIONS},
    modes, process_names,
};
use crate::model::BuiltIn;
use crate::syntax::ast::{BinaryOp, Expr, ExprKind, Moment};
use crate::syntax::codes::Code;
use crate::syntax::keywords;
use crate::syntax::parse::{foreign_word, time_meant, unit_meant};
use crate::syntax::source::Span;

/// `F<=1 sec (p)`, where the bound is a bare number and `sec (p)` a call: says so, and whether it is so.
pub(crate) fn misread_bound(context: &mut Context<'_>, end: &Expr, body: &Expr, locals: &Locals) -> bool {
    let is_bare = matches!(&end.kind, ExprKind::Quantity(quantity) if quantity.unit.is_none());
    let Some((name, span)) = leading_name(body).filter(|_| is_bare) else { return false };
    let between = Span { start: end.span.end, end: span.start, ..span };
    if end.span.end > span.start || !context.text(between).is_empty() || is_known(context, name, locals) {
        return false;
    }
    let Some((unit, is_sure)) = time_meant(name) else { return false };
    let number = context.text(end.span);
    let hint = match context.time.clock {
        // There a bare number is a bound, and nothing but the name is amiss.
        Clock::Steps if !is_sure || context.sink.told < Told::Stepped => return false,
        Clock::Steps => {
            format!("the steps of this scenario have no length: write `#{number}` or `{number} steps`")
        }
        _ => format!("did you mean `{number} {unit}`?"),
    };
    context.note(error!(E0113, span, "unknown unit `{name}`"; hint: "{hint}"));
    true
}

/// A likely meaning of an unknown name: a variable of a process, a word of another language, a unit.
pub(crate) fn misread_name(context: &Context<'_>, name: &str) -> Option<String> {
    let of_processes = process_names::paths_of(context, name);
    if !of_processes.is_empty() {
        return Some(format!("write {}", of_processes.join(" or ")));
    }
    foreign_word(name, "").or_else(|| {
        dimension::unit(name)?;
        Some(format!("write a unit after a number: `1 {name}`, or `1 /{name}` (no blank after the slash)"))
    })
}

/// `P(p) >= 0.9` and `(x at end) > 3` inside a formula: the error, if it is so.
pub(crate) fn misread_comparison<T>(
    context: &mut Context<'_>,
    left: &Expr,
    right: &Expr,
    locals: &Locals,
) -> Option<Lowered<T>> {
    if let ExprKind::Call { function, .. } = &left.kind
        && keywords::is_measure(&function.name)
        && !is_known(context, &function.name, locals)
    {
        let title = format!("`{}` is allowed only in queries, not in formulas", function.name);
        let query = context.text(left.span.to(right.span));
        let error = error!(E0504, function.span, "{title}");
        return Some(context.report(error.hint(format!("write a separate query: `check {query}`"))));
    }
    let (span, inner, moment) = [left, right].into_iter().find_map(|side| match &side.kind {
        ExprKind::At(inner, moment) => Some((side.span, inner.span, moment)),
        _ => None,
    })?;
    let whole = left.span.to(right.span);
    let before = context.text(Span { end: span.start, ..whole });
    let behind = context.text(Span { start: span.end, ..whole });
    let compared = format!("{before} {} {behind}", context.text(inner));
    Some(misplaced_moment(context, (span, inner), Some(compared.trim()), moment))
}

/// `… at end` elsewhere than around a whole metric.
pub(crate) fn misplaced_moment<T>(
    context: &mut Context<'_>,
    (span, inner): (Span, Span),
    read: Option<&str>,
    moment: &Moment,
) -> Lowered<T> {
    let (time, written) = match moment {
        Moment::End => (context.time.whole(), "at end".to_owned()),
        Moment::Time(time) => (context.text(time.span), format!("at {}", context.text(time.span))),
    };
    let title = format!("`{written}` must apply to the whole metric of `E(…)` or `Q(…)`");
    // `at` stands behind what is read, and a parenthesis behind it.
    let source = context.sources.iter().find(|source| source.id == span.source);
    let behind = source.map_or("", |source| source.slice(Span { start: inner.end, ..span }));
    let at = behind.find("at").unwrap_or(0);
    let start = inner.end + at as u32;
    let end = start + behind[at..].trim_end_matches([')', ' ']).len() as u32;
    let error = error!(E0504, Span { start, end, ..span }, "{title}");
    context.report(match read {
        Some(read) => error.hint(format!("for a condition write `F[{time}, {time}] ({read})`")),
        None => error.hint(format!("write it last: `E(… {written})`")),
    })
}

/// Whether a name stands for anything.
pub(crate) fn is_known(context: &Context<'_>, name: &str, locals: &Locals) -> bool {
    locals.names.iter().any(|(bound, _)| bound == name)
        || modes::is_inside(context, name, locals)
        || context.look_up(name, locals.scope).is_some()
        || BuiltIn::find(name).is_some()
        || DISTRIBUTIONS.contains(&name)
        || BUILT_IN.contains(&name)
}

/// `5 kg/(m*sec)`: a product of units one of which is misspelt, so that all read as names. Says so, and whether it
/// is so.
#[cold]
pub(crate) fn misread_factors(context: &mut Context<'_>, left: &Expr, right: &Expr, locals: &Locals) -> bool {
    let (before, mut factors) = (last_operand(left), Vec::new());
    let has_unit = matches!(&before.kind, ExprKind::Quantity(quantity) if quantity.unit.is_some());
    if !has_unit || !ends_in(context, left, before) || !named_factors(right, &mut factors) {
        return false;
    }
    let mut misspelt = Vec::new();
    for (name, span) in &factors {
        match unit_meant(name).filter(|_| !is_known(context, name, locals)) {
            None => return false,
            Some((unit, _)) if unit == *name => {}
            Some((unit, is_sure)) => misspelt.push((*name, *span, unit, is_sure)),
        }
    }
    // If all are units, or none is certainly one, they are unknown names.
    let is_sure = misspelt.len() < factors.len() || misspelt.iter().any(|(.., is_sure)| *is_sure);
    if misspelt.is_empty() || !is_sure {
        return false;
    }
    for (name, span, unit, _) in misspelt {
        context.note(error!(E0113, span, "unknown unit `{name}`"; hint: "did you mean `{unit}`?"));
    }
    true
}

/// `1 m/sec`, `0.1 /m2`, `1 m/sec^2`: of an unknown name that stands below or beside a unit, the unit it may mean.
#[cold]
pub(crate) fn suggest_unit(context: &mut Context<'_>, op: BinaryOp, left: &Expr, right: &Expr) {
    let (factor, power) = match &right.kind {
        ExprKind::Binary(BinaryOp::Power, base, _) => {
            (&**base, context.text(Span { start: base.span.end, ..right.span }))
        }
        _ => (right, String::new()),
    };
    let (ExprKind::Name(name), BinaryOp::Over | BinaryOp::Times) = (&factor.kind, op) else { return };
    let before = last_operand(left);
    let ExprKind::Quantity(quantity) = &before.kind else { return };
    if quantity.unit.is_none() && op == BinaryOp::Times {
        return;
    }
    let meant = unit_meant(name).filter(|(unit, _)| unit != name);
    let Some((unit, is_sure)) = meant.filter(|(unit, _)| is_power(unit, &power)) else { return };
    let mut written = context.text(Span { end: right.span.start, ..before.span }).trim_end().to_owned();
    if op == BinaryOp::Times {
        written.truncate(written.trim_end_matches(['*', ' ']).len());
        written.push('*');
    }
    // A unit behind parentheses belongs to no number.
    if !ends_in(context, left, before) {
        "1 ".clone_into(&mut written);
    }
    let unknown = context.sink.diagnostics.iter_mut().rev().find(|one| {
        one.code == Code::E0201 && one.place.as_ref().is_some_and(|place| place.span == factor.span)
    });
    if let Some(unknown) = unknown.filter(|one| is_sure || one.hint.is_none()) {
        unknown.hint = Some(format!("did you mean `{written}{unit}{power}`?"));
    }
}

/// Whether no parenthesis stands between the last operand of an expression and its end.
fn ends_in(context: &Context<'_>, expr: &Expr, last: &Expr) -> bool {
    expr.span.end == last.span.end && !context.text(last.span).starts_with('(')
}

/// Whether a unit takes a power as it is written: it has none of its own, and that one is whole.
fn is_power(unit: &str, power: &str) -> bool {
    let digits = power.strip_prefix('^').map(|power| power.strip_prefix('-').unwrap_or(power));
    digits.is_none_or(|digits| !unit.contains('^') && digits.bytes().all(|byte| byte.is_ascii_digit()))
}

/// Adds the names that an expression is a product of, with or without powers, and says whether it is one.
fn named_factors<'e>(expr: &'e Expr, found: &mut Vec<(&'e str, Span)>) -> bool {
    match &expr.kind {
        ExprKind::Name(name) => {
            found.push((name, expr.span));
            true
        }
        ExprKind::Binary(BinaryOp::Times, left, right) => {
            named_factors(left, found) && named_factors(right, found)
        }
        ExprKind::Binary(BinaryOp::Power, base, power) => {
            matches!(base.kind, ExprKind::Name(_))
                && matches!(power.kind, ExprKind::Quantity(_))
                && named_factors(base, found)
        }
        _ => false,
    }
}

/// The name that an expression starts with: of a call, or by itself.
fn leading_name(expr: &Expr) -> Option<(&str, Span)> {
    let mut expr = expr;
    loop {
        expr = match &expr.kind {
            ExprKind::Name(name) => return Some((name, expr.span)),
            ExprKind::Call { function, .. } => return Some((&function.name, function.span)),
            ExprKind::Binary(_, left, _)
            | ExprKind::TemporalPair(_, _, left, _)
            | ExprKind::Member(left, _)
            | ExprKind::Index(left, _) => left,
            _ => return None,
        };
    }
}

/// The operand that an expression ends with.
fn last_operand(expr: &Expr) -> &Expr {
    let mut expr = expr;
    while let ExprKind::Binary(_, _, last) | ExprKind::Unary(_, last) = &expr.kind {
        expr = last;
    }
    expr
}
