//! Arithmetic, with dimensions.

use crate::base::math;
use crate::compile::context::{Context, Locals, Lowered, Reported, number::Number, typed::Typed};
use crate::compile::dimension::{Dimension, describe};
use crate::compile::lower::{
    logic, misspelt,
    weight::{self, Weight},
};
use crate::logic::{Operation, Term};
use crate::model::{Arithmetic, Function, Num};
use crate::syntax::ast::{BinaryOp, Expr, ExprKind};
use crate::syntax::source::Span;

/// `-x`
pub(crate) fn minus(context: &mut Context<'_>, typed: Typed, span: Span) -> Lowered<Typed> {
    match typed {
        Typed::Number(number) => Ok(Typed::Number(number.negated())),
        Typed::Point(x, y) => Ok(Typed::Point(x.negated(), y.negated())),
        Typed::Num(num, dimension) => Ok(Typed::Num(Num::Apply(Function::Negate, Box::new(num)), dimension)),
        Typed::Vector(x, y, dimension) => {
            let negate = |n| Num::Apply(Function::Negate, Box::new(n));
            Ok(Typed::Vector(negate(x), negate(y), dimension))
        }
        Typed::Term(term, dimension) => {
            let zero = context.term(Term::Constant(0.0));
            Ok(Typed::Term(context.term(Term::Combine(Operation::Subtract, zero, term)), dimension))
        }
        found => context.mismatch(span, "a number", &found),
    }
}

/// A sum, difference, product or quotient.
pub(crate) fn combined(
    context: &mut Context<'_>,
    (span, op): (Span, BinaryOp),
    (left, a): (&Expr, Lowered<Typed>),
    (right, b): (&Expr, Lowered<Typed>),
    locals: &Locals,
) -> Lowered<Typed> {
    if b.is_err() {
        misspelt::suggest_unit(context, op, left, right);
    }
    let sum = matches!(op, BinaryOp::Plus | BinaryOp::Minus);
    let (a, b) = match (a, b) {
        (Ok(a), Ok(b)) => (a, b),
        (Err(_), Ok(found)) if sum => {
            return logic::misfit(context, (left, None), (right, Some(&found)), locals);
        }
        (Ok(found), Err(_)) if sum => {
            return logic::misfit(context, (left, Some(&found)), (right, None), locals);
        }
        _ => return Err(Reported),
    };
    if let (Typed::Number(a), Typed::Number(b)) = (&a, &b) {
        return fold(context, span, op, *a, (*b, right.span)).map(Typed::Number);
    }
    if is_vector(&a) || is_vector(&b) {
        return lower_vector(context, op, (a, left.span), (b, right.span));
    }
    if matches!(a, Typed::Term(..)) || matches!(b, Typed::Term(..)) {
        let sides = (context.as_term(a, left.span), context.as_term(b, right.span));
        let ((a, da), (b, db)) = (sides.0?, sides.1?);
        let dimension = joined(context, span, op, da, db, right.span)?;
        let operation = match op {
            BinaryOp::Plus => Operation::Add,
            BinaryOp::Minus => Operation::Subtract,
            BinaryOp::Times => Operation::Multiply,
            _ => Operation::Divide,
        };
        return Ok(Typed::Term(context.term(Term::Combine(operation, a, b)), dimension));
    }
    let sides = (context.as_num(a, left.span), context.as_num(b, right.span));
    let ((a, da), (b, db)) = (sides.0?, sides.1?);
    let dimension = joined(context, span, op, da, db, right.span)?;
    Ok(Typed::Num(Num::Combine(arithmetic(op), Box::new(a), Box::new(b)), dimension))
}

/// The dimension of a sum, difference, product or quotient.
fn joined(
    context: &mut Context<'_>,
    span: Span,
    op: BinaryOp,
    a: Dimension,
    b: Dimension,
    right: Span,
) -> Lowered<Dimension> {
    let joined = match op {
        BinaryOp::Plus | BinaryOp::Minus if a != b => return context.wrong_dimension(right, a, b),
        BinaryOp::Plus | BinaryOp::Minus => Some(a),
        BinaryOp::Times => a.times(b),
        _ => a.over(b),
    };
    match joined {
        Some(dimension) => Ok(dimension),
        None => context.report(error!(E0302, span, "the unit of the result is out of range")),
    }
}

/// The result of two numbers that are known now.
fn fold(
    context: &mut Context<'_>,
    span: Span,
    op: BinaryOp,
    a: Number,
    (b, right): (Number, Span),
) -> Lowered<Number> {
    joined(context, span, op, a.dimension, b.dimension, right)?;
    if op == BinaryOp::Over && b.value == 0.0 {
        return context.report(error!(E0405, right, "division by zero"));
    }
    let value = match op {
        BinaryOp::Plus => Some(a.plus(b)),
        BinaryOp::Minus => Some(a.minus(b)),
        BinaryOp::Times => a.times(b),
        _ => a.over(b),
    };
    value.map_or_else(|| context.report(error!(E0302, span, "the unit of the result is out of range")), Ok)
}

/// Both coordinates of a point that is known now.
fn fold_point(
    context: &mut Context<'_>,
    op: BinaryOp,
    (ax, ay, left): (Number, Number, Span),
    (bx, by, right): (Number, Number, Span),
) -> Lowered<Typed> {
    let span = left.to(right);
    let x = fold(context, span, op, ax, (bx, right))?;
    let y = fold(context, span, op, ay, (by, right))?;
    if !(x.value.is_finite() && y.value.is_finite()) {
        return context.report(error!(E0405, span, "the point is not finite"));
    }
    Ok(Typed::Point(x, y))
}

/// Sums of vectors, and products with numbers.
fn lower_vector(
    context: &mut Context<'_>,
    op: BinaryOp,
    a: (Typed, Span),
    b: (Typed, Span),
) -> Lowered<Typed> {
    match (op, &a.0, &b.0) {
        (BinaryOp::Plus | BinaryOp::Minus, Typed::Point(ax, ay), Typed::Point(bx, by)) => {
            return fold_point(context, op, (*ax, *ay, a.1), (*bx, *by, b.1));
        }
        (BinaryOp::Times | BinaryOp::Over, Typed::Point(x, y), Typed::Number(factor)) => {
            return fold_point(context, op, (*x, *y, a.1), (*factor, *factor, b.1));
        }
        _ => {}
    }
    let combine = |op, x: &Num, y: &Num| Num::Combine(op, Box::new(x.clone()), Box::new(y.clone()));
    match op {
        BinaryOp::Plus | BinaryOp::Minus => {
            let (ax, ay, da) = context.as_vector(a.0, a.1)?;
            let (bx, by, db) = context.as_vector(b.0, b.1)?;
            if da != db {
                return context.wrong_dimension(b.1, da, db);
            }
            let op = arithmetic(op);
            Ok(Typed::Vector(combine(op, &ax, &bx), combine(op, &ay, &by), da))
        }
        BinaryOp::Times | BinaryOp::Over if is_vector(&a.0) && !is_vector(&b.0) => {
            let (x, y, dv) = context.as_vector(a.0, a.1)?;
            let (factor, df) = context.as_num(b.0, b.1)?;
            weight::count_copy(context, Weight::of_num(&factor), b.1)?;
            let dimension = joined(context, b.1, op, dv, df, b.1)?;
            let op = arithmetic(op);
            Ok(Typed::Vector(combine(op, &x, &factor), combine(op, &y, &factor), dimension))
        }
        BinaryOp::Times if !is_vector(&a.0) => lower_vector(context, op, b, a),
        _ => context.report(
            error!(E0305, a.1.to(b.1), "vectors can only be added, subtracted, and multiplied by numbers";
                    hint: "for the length of a vector write `distance(a, b)` or `speed(a)`"),
        ),
    }
}

/// `x ^ y`
pub(crate) fn raised(
    context: &mut Context<'_>,
    span: Span,
    (base, left): (Typed, &Expr),
    (exponent, right): (Typed, &Expr),
) -> Lowered<Typed> {
    let (exponent, base) = match (exponent, base) {
        (Typed::Num(exponent, Dimension::NONE), base) if !matches!(base, Typed::Term(..)) => {
            let (base, dimension) = context.as_num(base, left.span)?;
            if !dimension.is_none() {
                let said = format!("{} can only be raised to a fixed whole power", describe(dimension));
                return context.report(error!(E0303, right.span, "{said}"));
            }
            let power = Num::Combine(Arithmetic::Power, Box::new(base), Box::new(exponent));
            return Ok(Typed::Num(power, dimension));
        }
        // An error of the exponent is reported by what asks for a fixed number.
        (exponent, base) => (context.as_known_of(exponent, right.span, Dimension::NONE)?, base),
    };
    let whole = exponent.as_whole().and_then(|n| i32::try_from(n).ok()).filter(|n| n.abs() <= 64);
    let power = |this: &mut Context<'_>, dimension: Dimension| -> Lowered<Dimension> {
        if dimension.is_none() {
            return Ok(dimension);
        }
        fixed_exponent(this, right, dimension)?;
        match whole {
            Some(n) => match dimension.power(n) {
                Some(d) => Ok(d),
                None => this.report(error!(E0302, span, "the unit of the result is out of range")),
            },
            None => this.report(error!(
                E0303,
                right.span,
                "{} can only be raised to a whole power",
                describe(dimension)
            )),
        }
    };
    match base {
        Typed::Number(base) => {
            let dimension = power(context, base.dimension)?;
            if base.value == 0.0 && exponent.value < 0.0 {
                return context.report(error!(E0405, left.span, "division by zero";
                            hint: "a negative power of zero is undefined"));
            }
            if let Some(n) = whole {
                let one = Some(Number::whole(1));
                let product = (0..n.abs())
                    .fold(one, |p, _| p.and_then(|p| if n > 0 { p.times(base) } else { p.over(base) }));
                if let Some(product) = product {
                    return Ok(Typed::Number(product));
                }
            }
            let value = math::pow(base.value, exponent.value);
            if !value.is_finite() {
                return context.report(error!(E0405, span, "the value is not a finite number"));
            }
            Ok(Typed::Number(Number::rounded(value, dimension)))
        }
        other => {
            let (num, dimension) = context.as_num(other, left.span)?;
            let dimension = power(context, dimension)?;
            let exponent = Box::new(Num::Constant(exponent.value));
            Ok(Typed::Num(Num::Combine(Arithmetic::Power, Box::new(num), exponent), dimension))
        }
    }
}

/// Refuses an exponent of a quantity with a unit that depends on parameters, directly or by the arguments of a
/// function: so would the unit of the power.
fn fixed_exponent(context: &mut Context<'_>, exponent: &Expr, dimension: Dimension) -> Lowered<()> {
    let place = exponent.span;
    if matches!(exponent.kind, ExprKind::Quantity(_)) {
        return Ok(());
    }
    let inside = |used: &Span| place.start <= used.start && used.end <= place.end;
    let from = context.words.aliases.range(Span { end: 0, ..place }..);
    let used = from.take_while(|(used, _)| used.source == place.source && used.start < place.end);
    let meant = used.filter(|(used, _)| inside(used)).map(|(_, meant)| *meant);
    if std::iter::once(place).chain(meant).any(|place| context.names.hangs_on_parameters(place)) {
        return context.report(
            error!(E0303, place, "the exponent of {} cannot depend on a parameter", describe(dimension);
                hint: "the unit of the power would depend on it: write a number"),
        );
    }
    Ok(())
}

fn is_vector(typed: &Typed) -> bool {
    matches!(typed, Typed::Point(..) | Typed::Vector(..))
}

fn arithmetic(op: BinaryOp) -> Arithmetic {
    match op {
        BinaryOp::Plus => Arithmetic::Add,
        BinaryOp::Minus => Arithmetic::Subtract,
        BinaryOp::Times => Arithmetic::Multiply,
        _ => Arithmetic::Divide,
    }
}
