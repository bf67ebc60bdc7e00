//! Dimensions and the table of units.
//!
//! A dimension is the exponents of kilogram, metre, second, angle and step. Units are exact multiples of the
//! SI unit, except the degree, which is exact in nothing but itself.

use crate::base::decimal::Decimal;
use crate::syntax::ast::UnitExpr;
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::Diagnostic;
use std::fmt;

/// Exponents of (kg, m, s, angle, step).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Dimension(pub [i8; 5]);

impl Dimension {
    /// A pure number.
    pub const NONE: Self = Self([0; 5]);
    /// kg
    pub const MASS: Self = Self([1, 0, 0, 0, 0]);
    /// m
    pub const LENGTH: Self = Self([0, 1, 0, 0, 0]);
    /// m^2
    pub const AREA: Self = Self([0, 2, 0, 0, 0]);
    /// s
    pub const TIME: Self = Self([0, 0, 1, 0, 0]);
    /// m/s
    pub const SPEED: Self = Self([0, 1, -1, 0, 0]);
    /// N
    pub const FORCE: Self = Self([1, 1, -2, 0, 0]);
    /// kg/s^2
    pub const STIFFNESS: Self = Self([1, 0, -2, 0, 0]);
    /// kg/(m s)
    pub const FRICTION: Self = Self([1, -1, -1, 0, 0]);
    /// rad
    pub const ANGLE: Self = Self([0, 0, 0, 1, 0]);
    /// steps
    pub const STEPS: Self = Self([0, 0, 0, 0, 1]);
    /// 1/m^2
    pub const DENSITY: Self = Self([0, -2, 0, 0, 0]);
    /// 1/s
    pub const RATE: Self = Self([0, 0, -1, 0, 0]);

    /// The dimension of a product.
    pub fn times(self, other: Self) -> Option<Self> {
        self.plus(other, 1)
    }

    /// The dimension of a quotient.
    pub fn over(self, other: Self) -> Option<Self> {
        self.plus(other, -1)
    }

    /// The dimension of a power.
    pub fn power(self, exponent: i32) -> Option<Self> {
        Self::NONE.plus(self, i8::try_from(exponent).ok()?)
    }

    fn plus(self, other: Self, factor: i8) -> Option<Self> {
        let mut out = self;
        for (a, b) in out.0.iter_mut().zip(other.0) {
            *a = a.checked_add(b.checked_mul(factor)?)?;
        }
        Some(out)
    }

    /// The dimension of a square root, if the exponents are even.
    pub fn root(self) -> Option<Self> {
        self.0.iter().all(|e| e % 2 == 0).then(|| Self(self.0.map(|e| e / 2)))
    }

    /// Whether it is a pure number.
    pub fn is_none(self) -> bool {
        self == Self::NONE
    }
}

impl fmt::Display for Dimension {
    /// In SI units: `kg/s^2`; `N` for newtons; a pure number is empty.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if *self == Self::FORCE {
            return f.write_str("N");
        }
        let names = ["kg", "m", "s", "rad", "steps"];
        let power = |e: i8| if e.abs() == 1 { String::new() } else { format!("^{}", e.abs()) };
        let factors = |sign: i8| -> Vec<String> {
            names
                .iter()
                .zip(self.0)
                .filter(|(_, e)| e.signum() == sign)
                .map(|(n, e)| format!("{n}{}", power(e)))
                .collect()
        };
        let (above, below) = (factors(1), factors(-1));
        f.write_str(&above.join(" "))?;
        match below.as_slice() {
            [] => Ok(()),
            [one] => write!(f, "/{one}"),
            many => write!(f, "/({})", many.join(" ")),
        }
    }
}

/// The number of a text that is one number with a unit.
pub(super) fn single_number(text: &str) -> Option<&str> {
    let (number, unit) = text.split_once(' ')?;
    let is_number = number.bytes().all(|byte| byte.is_ascii_digit() || byte == b'.');
    (is_number && !unit.contains([' ', '('])).then_some(number)
}

/// The name of a dimension in messages: `a length (m)`, `a number without a unit`.
pub fn describe(dimension: Dimension) -> String {
    let name = match dimension {
        Dimension::NONE => return "a number without a unit".to_owned(),
        Dimension::MASS => "a mass",
        Dimension::LENGTH => "a length",
        Dimension::AREA => "an area",
        Dimension::TIME => "a time",
        Dimension::SPEED => "a speed",
        Dimension::FORCE => "a force",
        Dimension::ANGLE => "an angle",
        Dimension::STEPS => "a number of steps",
        Dimension::DENSITY => "a density",
        Dimension::RATE => "a rate",
        _ => "a quantity",
    };
    format!("{name} ({dimension})")
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
            let mut error = Diagnostic::error(
                Code::E0113,
                factor.name.span,
                format!("unknown unit `{}`", factor.name.name),
            );
            if let Some(near) = super::nearest::nearest(&factor.name.name, UNITS.iter().copied()) {
                error = error.hint(format!("did you mean `{near}`?"));
            }
            return Err(error);
        };
        let too_large = || Diagnostic::error(Code::E0302, expression.span, "this unit is out of range");
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
    fn dimensions_print_as_units() {
        assert_eq!(Dimension::FRICTION.to_string(), "kg/(m s)");
        assert_eq!(Dimension::STIFFNESS.to_string(), "kg/s^2");
        assert_eq!(Dimension::DENSITY.to_string(), "/m^2");
        assert_eq!(Dimension::FORCE.to_string(), "N");
        assert_eq!(describe(Dimension::NONE), "a number without a unit");
    }

    #[test]
    fn every_listed_unit_is_known() {
        assert!(UNITS.iter().all(|name| unit(name).is_some()));
    }
}
