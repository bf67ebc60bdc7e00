//! Numbers known at compile time: exact where they can be, always with their dimension.

use crate::base::decimal::Decimal;
use crate::compile::dimension::{Dimension, Unit};

/// A number with a dimension, in SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Number {
    /// Nearest double.
    pub(crate) value: f64,
    /// The exact value, as long as only exact literals and `+ - * /` made it.
    pub(crate) exact: Option<Decimal>,
    /// Its dimension.
    pub(crate) dimension: Dimension,
}

impl Number {
    /// An exact number.
    pub(crate) fn exact(value: Decimal, dimension: Dimension) -> Self {
        Self { value: value.to_f64(), exact: Some(value), dimension }
    }

    /// A rounded number.
    pub(crate) const fn rounded(value: f64, dimension: Dimension) -> Self {
        Self { value, exact: None, dimension }
    }

    /// A pure whole number.
    pub(crate) fn whole(value: i64) -> Self {
        Self::exact(Decimal::whole(value), Dimension::NONE)
    }

    /// A literal in a unit.
    pub(crate) fn literal(value: Decimal, unit: &Unit) -> Self {
        let exact = unit.exact.and_then(|size| value.mul(size));
        match exact {
            Some(exact) => Self::exact(exact, unit.dimension),
            None => Self::rounded(value.to_f64() * unit.size, unit.dimension),
        }
    }

    fn join(
        self,
        other: Self,
        dimension: Dimension,
        exact: impl Fn(Decimal, Decimal) -> Option<Decimal>,
        rounded: impl Fn(f64, f64) -> f64,
    ) -> Self {
        match self.exact.zip(other.exact).and_then(|(a, b)| exact(a, b)) {
            Some(value) => Self::exact(value, dimension),
            None => Self::rounded(rounded(self.value, other.value), dimension),
        }
    }

    /// Sum of two numbers of one dimension.
    pub(crate) fn plus(self, other: Self) -> Self {
        self.join(other, self.dimension, Decimal::add, |a, b| a + b)
    }

    /// Difference of two numbers of one dimension.
    pub(crate) fn minus(self, other: Self) -> Self {
        self.join(other, self.dimension, Decimal::sub, |a, b| a - b)
    }

    /// Product; `None` if the dimension is out of range.
    pub(crate) fn times(self, other: Self) -> Option<Self> {
        Some(self.join(other, self.dimension.times(other.dimension)?, Decimal::mul, |a, b| a * b))
    }

    /// Quotient; `None` if the dimension is out of range.
    pub(crate) fn over(self, other: Self) -> Option<Self> {
        Some(self.join(other, self.dimension.over(other.dimension)?, Decimal::div, |a, b| a / b))
    }

    /// The other sign.
    pub(crate) fn negated(self) -> Self {
        Self { value: -self.value, exact: self.exact.map(Decimal::neg), dimension: self.dimension }
    }

    /// The whole number it is, if it is one (to within rounding where it is not exact).
    pub(crate) fn as_whole(self) -> Option<i64> {
        if let Some(exact) = self.exact {
            return exact.as_whole().and_then(|whole| i64::try_from(whole).ok());
        }
        let near = self.value.round();
        ((self.value - near).abs() <= 1e-9 * near.abs().max(1.0) && near.abs() < 9e15).then_some(near as i64)
    }
}
