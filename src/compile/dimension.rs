//! The table of units. Units are exact multiples of the SI unit, except the degree, which is exact in nothing but itself.

use crate::base::decimal::Decimal;
pub use crate::base::dimension::{Dimension, describe};
use crate::compile::nearest;
use crate::syntax::ast::UnitExpr;
use crate::syntax::diagnostic::Diagnostic;

/// The number of a text that is one number with a unit.
pub(crate) fn single_number(text: &str) -> Option<&str> {
    let (number, unit) = text.split_once(' ')?;
    let is_number = number.bytes().all(|byte| byte.is_ascii_digit() || byte == b'.');
    (is_number && !unit.contains([' ', '('])).then_some(number)
}

/// A unit: its dimension, its size in SI units, and that size exactly where it is exact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    /// Its dimension.
    pub dimension: Dimension,
    /// Size in SI units, exact; `None` where an irrational factor is in it.
    pub exact: Option<Decimal>,
    /// Size in SI units.
    pub size: f64,
}

/// Every unit by name.
pub const UNITS: [&str; 17] =
    ["m", "cm", "mm", "km", "s", "ms", "min", "h", "kg", "g", "N", "kN", "deg", "rad", "Hz", "%", "steps"];

/// The unit of a name.
pub fn unit(name: &str) -> Option<Unit> {
    let exact = |dimension, numerator, denominator| {
        let value = Decimal::ratio(numerator, denominator)?;
        Some(Unit { dimension, exact: Some(value), size: value.to_f64() })
    };
    match name {
        "m" => exact(Dimension::LENGTH, 1, 1),
        "cm" => exact(Dimension::LENGTH, 1, 100),
        "mm" => exact(Dimension::LENGTH, 1, 1000),
        "km" => exact(Dimension::LENGTH, 1000, 1),
        "s" => exact(Dimension::TIME, 1, 1),
        "ms" => exact(Dimension::TIME, 1, 1000),
        "min" => exact(Dimension::TIME, 60, 1),
        "h" => exact(Dimension::TIME, 3600, 1),
        "kg" => exact(Dimension::MASS, 1, 1),
        "g" => exact(Dimension::MASS, 1, 1000),
        "N" => exact(Dimension::FORCE, 1, 1),
        "kN" => exact(Dimension::FORCE, 1000, 1),
        "rad" => exact(Dimension::ANGLE, 1, 1),
        "deg" => Some(Unit { dimension: Dimension::ANGLE, exact: None, size: std::f64::consts::PI / 180.0 }),
        "Hz" => exact(Dimension([0, 0, -1, 0, 0]), 1, 1),
        "%" => exact(Dimension::NONE, 1, 100),
        "step" | "steps" => exact(Dimension::STEPS, 1, 1),
        _ => None,
    }
}

/// The unit of an expression of units. Unknown names are errors with the nearest known one.
pub fn resolve(expression: &UnitExpr) -> Result<Unit, Diagnostic> {
    let mut out = Unit { dimension: Dimension::NONE, exact: Some(Decimal::ONE), size: 1.0 };
    for factor in &expression.factors {
        let Some(unit) = unit(&factor.name.name) else {
            let mut error = error!(E0113, factor.name.span, "unknown unit `{}`", factor.name.name);
            if let Some(near) = nearest::nearest(&factor.name.name, UNITS.iter().copied()) {
                error = error.hint(format!("did you mean `{near}`?"));
            }
            return Err(error);
        };
        let too_large = || error!(E0302, expression.span, "this unit is out of range");
        let power = factor.power;
        out.dimension =
            unit.dimension.power(power).and_then(|d| out.dimension.times(d)).ok_or_else(too_large)?;
        let mut exact = out.exact;
        for _ in 0..power.unsigned_abs() {
            exact = match (exact, unit.exact) {
                (Some(a), Some(b)) => {
                    if power > 0 {
                        a.mul(b)
                    } else {
                        a.div(b)
                    }
                }
                _ => None,
            };
            if power > 0 { out.size *= unit.size } else { out.size /= unit.size }
        }
        out.exact = exact;
        if let Some(exact) = exact {
            out.size = exact.to_f64();
        }
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_listed_unit_is_known() {
        assert!(UNITS.iter().all(|name| unit(name).is_some()));
    }
}
