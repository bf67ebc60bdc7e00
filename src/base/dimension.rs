//! Dimensions: the exponents of kilogram, metre, second, angle and step.

use serde::{Deserialize, Serialize};
use std::fmt;

/// Exponents of (kg, m, s, angle, step).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
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
    /// m/s^2
    pub const ACCELERATION: Self = Self([0, 1, -2, 0, 0]);
    /// 1/s
    pub const RATE: Self = Self([0, 0, -1, 0, 0]);
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

    /// Of the product.
    pub fn times(self, other: Self) -> Option<Self> {
        self.plus(other, 1)
    }

    /// Of the quotient.
    pub fn over(self, other: Self) -> Option<Self> {
        self.plus(other, -1)
    }

    /// Of the power.
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

    /// Of the square root, if the exponents are even.
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

/// What a dimension is called in messages: `a length (m)`, `a pure number`.
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
}
