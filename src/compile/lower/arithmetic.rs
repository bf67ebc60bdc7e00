//! Arithmetic, with dimensions.

use super::super::dimension::{Dimension, describe};
use super::super::elaborator::{Elaborator, Locals, Lowered, Reported};
use super::super::number::Number;
use super::super::typed::Typed;
use super::super::weight::Weight;
use crate::base::math;
use crate::logic::{Operation, Term};
use crate::model::{Arithmetic, Function, Num};
use crate::syntax::ast::{BinaryOp, Expr, ExprKind};
use crate::syntax::source::Span;

impl Elaborator<'_> {
    pub(super) fn lower_minus(&mut self, operand: &Expr, locals: &Locals) -> Lowered<Typed> {
        match self.lower(operand, locals)? {
            Typed::Number(number) => Ok(Typed::Number(number.negated())),
            Typed::Point(x, y) => Ok(Typed::Point(x.negated(), y.negated())),
            Typed::Num(num, dimension) => {
                Ok(Typed::Num(Num::Apply(Function::Negate, Box::new(num)), dimension))
            }
            Typed::Vector(x, y, dimension) => {
                let negate = |n| Num::Apply(Function::Negate, Box::new(n));
                Ok(Typed::Vector(negate(x), negate(y), dimension))
            }
            Typed::Term(term, dimension) => {
                let zero = self.term(Term::Constant(0.0));
                Ok(Typed::Term(self.term(Term::Combine(Operation::Subtract, zero, term)), dimension))
            }
            found => self.mismatch(operand.span, "a number", &found),
        }
    }

    pub(super) fn lower_arithmetic(
        &mut self,
        span: Span,
        op: BinaryOp,
        left: &Expr,
        right: &Expr,
        locals: &Locals,
    ) -> Lowered<Typed> {
        if op == BinaryOp::Power {
            return self.lower_power(span, left, right, locals);
        }
        let is_over_product =
            op == BinaryOp::Over && matches!(right.kind, ExprKind::Binary(BinaryOp::Times, ..));
        if is_over_product && self.misread_factors(left, right, locals) {
            return Err(Reported);
        }
        let sides = (self.lower(left, locals), self.lower(right, locals));
        if sides.1.is_err() {
            self.suggest_unit(op, left, right);
        }
        let sum = matches!(op, BinaryOp::Plus | BinaryOp::Minus);
        let (a, b) = match sides {
            (Ok(a), Ok(b)) => (a, b),
            (Err(_), Ok(found)) if sum => return self.misfit((left, None), (right, Some(&found)), locals),
            (Ok(found), Err(_)) if sum => return self.misfit((left, Some(&found)), (right, None), locals),
            _ => return Err(Reported),
        };
        if let (Typed::Number(a), Typed::Number(b)) = (&a, &b) {
            return self.fold(span, op, *a, (*b, right.span)).map(Typed::Number);
        }
        if is_vector(&a) || is_vector(&b) {
            return self.lower_vector(op, (a, left.span), (b, right.span));
        }
        if matches!(a, Typed::Term(..)) || matches!(b, Typed::Term(..)) {
            let sides = (self.as_term(a, left.span), self.as_term(b, right.span));
            let ((a, da), (b, db)) = (sides.0?, sides.1?);
            let dimension = self.joined(span, op, da, db, right.span)?;
            let operation = match op {
                BinaryOp::Plus => Operation::Add,
                BinaryOp::Minus => Operation::Subtract,
                BinaryOp::Times => Operation::Multiply,
                _ => Operation::Divide,
            };
            return Ok(Typed::Term(self.term(Term::Combine(operation, a, b)), dimension));
        }
        let sides = (self.as_num(a, left.span), self.as_num(b, right.span));
        let ((a, da), (b, db)) = (sides.0?, sides.1?);
        let dimension = self.joined(span, op, da, db, right.span)?;
        Ok(Typed::Num(Num::Combine(arithmetic(op), Box::new(a), Box::new(b)), dimension))
    }

    /// The dimension of a sum, difference, product or quotient.
    fn joined(
        &mut self,
        span: Span,
        op: BinaryOp,
        a: Dimension,
        b: Dimension,
        right: Span,
    ) -> Lowered<Dimension> {
        let joined = match op {
            BinaryOp::Plus | BinaryOp::Minus if a != b => return self.wrong_dimension(right, a, b),
            BinaryOp::Plus | BinaryOp::Minus => Some(a),
            BinaryOp::Times => a.times(b),
            _ => a.over(b),
        };
        match joined {
            Some(dimension) => Ok(dimension),
            None => self.report(error!(E0302, span, "the unit of the result is out of range")),
        }
    }

    /// The result of two numbers that are known now.
    fn fold(&mut self, span: Span, op: BinaryOp, a: Number, (b, right): (Number, Span)) -> Lowered<Number> {
        self.joined(span, op, a.dimension, b.dimension, right)?;
        if op == BinaryOp::Over && b.value == 0.0 {
            return self.report(error!(E0405, right, "division by zero"));
        }
        let value = match op {
            BinaryOp::Plus => Some(a.plus(b)),
            BinaryOp::Minus => Some(a.minus(b)),
            BinaryOp::Times => a.times(b),
            _ => a.over(b),
        };
        value.map_or_else(|| self.report(error!(E0302, span, "the unit of the result is out of range")), Ok)
    }

    /// Both coordinates of a point that is known now.
    fn fold_point(
        &mut self,
        op: BinaryOp,
        (ax, ay, left): (Number, Number, Span),
        (bx, by, right): (Number, Number, Span),
    ) -> Lowered<Typed> {
        let span = left.to(right);
        let x = self.fold(span, op, ax, (bx, right))?;
        let y = self.fold(span, op, ay, (by, right))?;
        if !(x.value.is_finite() && y.value.is_finite()) {
            return self.report(error!(E0405, span, "the point is not finite"));
        }
        Ok(Typed::Point(x, y))
    }

    /// Sums of vectors, and products with numbers.
    fn lower_vector(&mut self, op: BinaryOp, a: (Typed, Span), b: (Typed, Span)) -> Lowered<Typed> {
        match (op, &a.0, &b.0) {
            (BinaryOp::Plus | BinaryOp::Minus, Typed::Point(ax, ay), Typed::Point(bx, by)) => {
                return self.fold_point(op, (*ax, *ay, a.1), (*bx, *by, b.1));
            }
            (BinaryOp::Times | BinaryOp::Over, Typed::Point(x, y), Typed::Number(factor)) => {
                return self.fold_point(op, (*x, *y, a.1), (*factor, *factor, b.1));
            }
            _ => {}
        }
        let combine = |op, x: &Num, y: &Num| Num::Combine(op, Box::new(x.clone()), Box::new(y.clone()));
        match op {
            BinaryOp::Plus | BinaryOp::Minus => {
                let (ax, ay, da) = self.as_vector(a.0, a.1)?;
                let (bx, by, db) = self.as_vector(b.0, b.1)?;
                if da != db {
                    return self.wrong_dimension(b.1, da, db);
                }
                let op = arithmetic(op);
                Ok(Typed::Vector(combine(op, &ax, &bx), combine(op, &ay, &by), da))
            }
            BinaryOp::Times | BinaryOp::Over if is_vector(&a.0) && !is_vector(&b.0) => {
                let (x, y, dv) = self.as_vector(a.0, a.1)?;
                let (factor, df) = self.as_num(b.0, b.1)?;
                self.count_copy(Weight::of_num(&factor), b.1)?;
                let dimension = self.joined(b.1, op, dv, df, b.1)?;
                let op = arithmetic(op);
                Ok(Typed::Vector(combine(op, &x, &factor), combine(op, &y, &factor), dimension))
            }
            BinaryOp::Times if !is_vector(&a.0) => self.lower_vector(op, b, a),
            _ => self.report(
                error!(E0305, a.1.to(b.1), "vectors can only be added, subtracted, and multiplied by numbers";
                    hint: "for the length of a vector write `distance(a, b)` or `speed(a)`"),
            ),
        }
    }

    fn lower_power(&mut self, span: Span, left: &Expr, right: &Expr, locals: &Locals) -> Lowered<Typed> {
        let sides = (self.lower(right, locals), self.lower(left, locals));
        let (exponent, base) = match (sides.0?, sides.1?) {
            (Typed::Num(exponent, Dimension::NONE), base) if !matches!(base, Typed::Term(..)) => {
                let (base, dimension) = self.as_num(base, left.span)?;
                if !dimension.is_none() {
                    let said = format!("{} can only be raised to a fixed whole power", describe(dimension));
                    return self.report(error!(E0303, right.span, "{said}"));
                }
                let power = Num::Combine(Arithmetic::Power, Box::new(base), Box::new(exponent));
                return Ok(Typed::Num(power, dimension));
            }
            // An error of the exponent is reported by what asks for a fixed number.
            (_, base) => (self.number_of(right, Dimension::NONE, locals)?, base),
        };
        let whole = exponent.as_whole().and_then(|n| i32::try_from(n).ok()).filter(|n| n.abs() <= 64);
        let power = |this: &mut Self, dimension: Dimension| -> Lowered<Dimension> {
            if dimension.is_none() {
                return Ok(dimension);
            }
            this.fixed_exponent(right, dimension)?;
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
                let dimension = power(self, base.dimension)?;
                if base.value == 0.0 && exponent.value < 0.0 {
                    return self.report(error!(E0405, left.span, "division by zero";
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
                    return self.report(error!(E0405, span, "the value is not a finite number"));
                }
                Ok(Typed::Number(Number::rounded(value, dimension)))
            }
            other => {
                let (num, dimension) = self.as_num(other, left.span)?;
                let dimension = power(self, dimension)?;
                let exponent = Box::new(Num::Constant(exponent.value));
                Ok(Typed::Num(Num::Combine(Arithmetic::Power, Box::new(num), exponent), dimension))
            }
        }
    }
}

impl Elaborator<'_> {
    /// Refuses an exponent of a quantity with a unit that depends on parameters, directly or by the arguments of a
    /// function: so would the unit of the power.
    fn fixed_exponent(&mut self, exponent: &Expr, dimension: Dimension) -> Lowered<()> {
        let place = exponent.span;
        if matches!(exponent.kind, ExprKind::Quantity(_)) {
            return Ok(());
        }
        let inside = |used: &Span| place.start <= used.start && used.end <= place.end;
        let from = self.aliases.range(Span { end: 0, ..place }..);
        let used = from.take_while(|(used, _)| used.source == place.source && used.start < place.end);
        let meant = used.filter(|(used, _)| inside(used)).map(|(_, meant)| *meant);
        if std::iter::once(place).chain(meant).any(|place| self.hangs_on_parameters(place)) {
            return self.report(
                error!(E0303, place, "the exponent of {} cannot depend on a parameter", describe(dimension);
                hint: "the unit of the power would depend on it: write a number"),
            );
        }
        Ok(())
    }
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
