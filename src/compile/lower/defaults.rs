//! Defaults of parameters that contradict their ranges.

use crate::compile::context::{Context, Locals, entry::doubt};
use crate::compile::lower::form;
use crate::syntax::ast::{Expr, ExprKind, Ident, Item, ScenarioFile, UnaryOp};
use crate::syntax::diagnostic::Diagnostic;

/// Parameters whose default, a number as it is written, is of another dimension than both ends of its range, or beyond one:
/// that is the slip, and not all that fits the range.
pub(crate) fn doubt_defaults(context: &mut Context<'_>, file: &ScenarioFile) {
    for item in &file.items {
        let Item::Param { name, value, range: Some(range), .. } = item else { continue };
        let is_own = context.names.scopes[0].get(&name.name).is_some_and(|entry| entry.span == name.span);
        if is_own && let Some(error) = fault_of_default(context, name, value, range) {
            context.note(error);
            doubt(context, 0, &name.name);
        }
    }
}

/// The error of such a default.
pub(crate) fn fault_of_default(
    context: &mut Context<'_>,
    name: &Ident,
    value: &Expr,
    (low, high): &(Expr, Expr),
) -> Option<Diagnostic> {
    let locals = Locals::of(0);
    if !is_number(value) {
        return None;
    }
    let gist = |expr| form::gist(context, expr, &locals);
    let (found, expected) = (gist(value)?, gist(low)?);
    if gist(high)? != expected {
        return None;
    }
    if found != expected {
        return Some(context.other_dimension(value.span, expected, found));
    }
    if context.names.settings.contains_key(&name.name) || !is_number(low) || !is_number(high) {
        return None;
    }
    let mut number = |expr| context.number(expr, &locals).ok().map(|number| number.value);
    let (default, low, high) = (number(value)?, number(low)?, number(high)?);
    let is_beyond = low <= high && (default < low || default > high);
    is_beyond.then(|| {
        let text = format!("the default of `{}` is outside its range", name.name);
        error!(E0405, value.span, "{text}")
    })
}

/// Whether it is a number as it is written.
fn is_number(expr: &Expr) -> bool {
    match &expr.kind {
        ExprKind::Quantity(_) => true,
        ExprKind::Unary(UnaryOp::Minus, inner) => is_number(inner),
        _ => false,
    }
}
