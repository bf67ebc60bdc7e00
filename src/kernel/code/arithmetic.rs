//! Arithmetic of one lane: what each function and operator of an expression means.

use crate::base::math;
use crate::model::{Arithmetic, Function};

/// A function of one number.
#[inline(always)]
pub(super) fn apply(function: Function, x: f64) -> f64 {
    match function {
        Function::Negate => -x,
        Function::Abs => x.abs(),
        Function::Sqrt => x.sqrt(),
        Function::Exp => math::exp(x),
        Function::Ln => math::ln(x),
        Function::Sin => math::sin_cos(x).0,
        Function::Cos => math::sin_cos(x).1,
        Function::Floor => x.floor(),
        Function::Ceil => x.ceil(),
        Function::Round => x.round(),
    }
}

/// Arithmetic of two numbers.
#[inline(always)]
pub(super) fn combine(operator: Arithmetic, a: f64, b: f64) -> f64 {
    match operator {
        Arithmetic::Add => a + b,
        Arithmetic::Subtract => a - b,
        Arithmetic::Multiply => a * b,
        Arithmetic::Divide => a / b,
        Arithmetic::Power => math::pow(a, b),
        // NaN if one is, so that a diverged position never looks far away.
        Arithmetic::Min => {
            if b < a || b.is_nan() {
                b
            } else {
                a
            }
        }
        Arithmetic::Max => {
            if b > a || b.is_nan() {
                b
            } else {
                a
            }
        }
        Arithmetic::Atan2 => math::atan2(a, b),
        Arithmetic::Modulo => modulo(a, b),
    }
}

/// The remainder with the sign of the divisor. The remainder of truncating division is exact.
fn modulo(a: f64, b: f64) -> f64 {
    let remainder = a % b;
    if remainder != 0.0 && (remainder < 0.0) != (b < 0.0) { remainder + b } else { remainder }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_remainder_has_the_sign_of_the_divisor() {
        assert_eq!(combine(Arithmetic::Modulo, -1.0, 3.0), 2.0);
        assert_eq!(combine(Arithmetic::Modulo, 1.0, -3.0), -2.0);
        assert_eq!(combine(Arithmetic::Modulo, 6.0, 3.0), 0.0);
        assert!(combine(Arithmetic::Modulo, 1.0, 0.0).is_nan());
    }

    #[test]
    fn a_nan_survives_min_and_max() {
        for (a, b) in [(f64::NAN, 1.0), (1.0, f64::NAN)] {
            assert!(combine(Arithmetic::Min, a, b).is_nan() && combine(Arithmetic::Max, a, b).is_nan());
        }
        assert_eq!([combine(Arithmetic::Min, 1.0, 2.0), combine(Arithmetic::Max, 1.0, 2.0)], [1.0, 2.0]);
    }

    #[test]
    fn halves_round_away_from_zero() {
        assert_eq!([apply(Function::Round, 0.5), apply(Function::Round, -0.5)], [1.0, -1.0]);
    }
}
