//! Which margins the formula of a robustness has, noted while it is lowered.

use crate::compile::context::{Context, typed::Typed};
use crate::compile::dimension::{Dimension, describe};
use crate::model::{Arithmetic, Domain, Num};
use crate::syntax::ast::BinaryOp;
use crate::syntax::source::Span;

/// The range of a number of which nothing is known.
const UNKNOWN: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);

/// An equality: it has no margin. At an end of a range an inequality says the same.
pub(crate) fn note_equality(
    context: &mut Context<'_>,
    op: BinaryOp,
    (left, right): (Span, Span),
    sides: (&Typed, &Typed),
) {
    let (a, Typed::Number(b)) = sides else { return };
    if context.margins.as_ref().is_none_or(|m| m.equality.is_some()) {
        return;
    }
    let (low, high) = if let Typed::Num(num, _) = a { reach(context, num) } else { UNKNOWN };
    let [above, below] = if op == BinaryOp::Equal { [">=", "<="] } else { [">", "<"] };
    let (at_low, at_high) = (b.value <= low, b.value >= high);
    let sign = if at_low == (op == BinaryOp::Equal) && (at_low || at_high) { below } else { above };
    let other = if at_low || at_high { String::new() } else { format!(", or `{below}`") };
    let instead = format!("write `{} {sign} {}`{other}", context.text(left), context.text(right));
    if let Some(margins) = &mut context.margins {
        margins.equality = Some((left.to(right), instead));
    }
}

/// The smallest and the largest value that a number can have.
fn reach(context: &Context<'_>, num: &Num) -> (f64, f64) {
    match num {
        Num::Constant(value) => (*value, *value),
        Num::Variable(variable) => match context
            .processes
            .iter()
            .find_map(|process| process.domain(*variable))
            .and_then(Domain::values)
        {
            Some((low, count)) => (low, low + (count - 1) as f64),
            None => UNKNOWN,
        },
        // Truth values, as they are counted.
        Num::If(_, yes, no) if (&**yes, &**no) == (&Num::Constant(1.0), &Num::Constant(0.0)) => (0.0, 1.0),
        Num::Combine(Arithmetic::Add, a, b) => {
            let (a, b) = (reach(context, a), reach(context, b));
            (a.0 + b.0, a.1 + b.1)
        }
        Num::Count(set, _) => (0.0, set.members.len() as f64),
        _ => UNKNOWN,
    }
}

/// A condition with a margin of this dimension.
pub(crate) fn note_margin(context: &mut Context<'_>, dimension: Dimension, span: Span) {
    let Some(margins) = &mut context.margins else { return };
    if margins.inside > 0 {
        return;
    }
    match margins.first {
        None => margins.first = Some((dimension, span)),
        Some((first, place)) if first != dimension && !margins.mixed => {
            margins.mixed = true;
            let name = |d: Dimension| describe(d);
            let error = error!(
                E0611,
                span,
                "all margins of a robustness need the same unit (found {} and {})",
                name(dimension),
                name(first)
            )
            .related(place, "first margin")
            .hint("divide both sides by a reference value: `speed(user) / 1 m/s < 1.3`");
            context.note(error);
        }
        Some(_) => {}
    }
}

/// Lowers formulas that a number is made of: their conditions are those of the formula around it.
pub(crate) fn inside_a_formula<T>(context: &mut Context<'_>, lower: impl FnOnce(&mut Context<'_>) -> T) -> T {
    let inside = context.margins.as_mut().map(|margins| std::mem::take(&mut margins.inside));
    let lowered = lower(context);
    if let (Some(margins), Some(inside)) = (&mut context.margins, inside) {
        margins.inside = inside;
    }
    lowered
}
