//! The integral and the mean of a number that is constant between jumps.
//!
//! Equal neighbouring pieces are one piece, so the result depends on the number alone and not on the moments at which somebody
//! looked at it. The sum has two doubles: pieces that cancel give zero, and pieces of one sign never do.

use super::moment::Moment;
use crate::base::rounding::{product, quotient, sum, sum_of_ordered};
use crate::logic::formula::{Operation, bracket};

/// The pieces so far. Lengths are in units.
#[derive(Clone, Copy, Debug)]
pub(super) struct Integral {
    /// Of all pieces but the last.
    sum: (f64, f64),
    /// The last piece, which may go on.
    value: f64,
    length: i64,
    total: i64,
    least: f64,
    most: f64,
}

impl Integral {
    /// No piece.
    pub(super) const EMPTY: Self = Self {
        sum: (0.0, 0.0),
        value: 0.0,
        length: 0,
        total: 0,
        least: f64::INFINITY,
        most: f64::NEG_INFINITY,
    };

    /// Adds a piece. An instant has no length.
    #[inline]
    pub(super) fn add(&mut self, value: f64, from: Moment, to: Moment) {
        let length = to / 2 - from / 2;
        if length <= 0 {
            return;
        }
        self.total += length;
        self.least = Operation::Min.apply(self.least, value);
        self.most = Operation::Max.apply(self.most, value);
        if value.to_bits() == self.value.to_bits() {
            self.length += length;
        } else {
            self.sum = self.sum();
            (self.value, self.length) = (value, length);
        }
    }

    /// The integral, in two doubles.
    pub(super) fn sum(&self) -> (f64, f64) {
        let (high, low) = self.sum;
        if self.value == 0.0 || self.length == 0 {
            return (high, low);
        }
        let (long, short) = split(self.length);
        let (part, error) = product(self.value, long);
        let (sum, rounded) = sum(high, part);
        let rest = low + (rounded + (error + self.value * short));
        if rest.is_finite() { sum_of_ordered(sum, rest) } else { (sum, 0.0) }
    }

    /// The mean, between the least and the greatest value.
    pub(super) fn mean(&self) -> f64 {
        let (high, low) = quotient(self.sum(), split(self.total));
        bracket(if low.is_finite() { high + low } else { high }, self.least, self.most)
    }
}

/// A whole number as two doubles.
fn split(whole: i64) -> (f64, f64) {
    let high = whole as f64;
    (high, (whole - high as i64) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(pieces: &[(f64, i64)]) -> Integral {
        let (mut integral, mut at) = (Integral::EMPTY, 0);
        for (value, units) in pieces {
            integral.add(*value, at, at + 2 * units);
            at += 2 * units;
        }
        integral
    }

    #[test]
    fn looks_in_between_change_no_bit() {
        let long = (1 << 58) - 12_345_677;
        for value in [0.1, 3.0, 1.0 / 3.0, -0.7, 1e-300] {
            let whole = of(&[(value, long), (0.3, 7), (0.1, long)]);
            for first in [1, 3, 1 << 20, (1 << 57) + 1] {
                let parts = of(&[(value, first), (value, long - first), (0.3, 7), (0.1, long)]);
                assert_eq!(parts.sum(), whole.sum());
                assert_eq!(parts.mean().to_bits(), whole.mean().to_bits());
            }
            assert_eq!(of(&[(value, long)]).mean().to_bits(), value.to_bits());
        }
    }

    #[test]
    fn sums_cancel_and_signs_are_exact() {
        let long = (1 << 58) - 3;
        assert_eq!(of(&[(0.1, long), (-0.2, long), (0.1, long)]).sum().0, 0.0);
        assert!(of(&[(0.0, long), (-1e-300, 1)]).sum().0 < 0.0);
        assert!(of(&[(1.0, long), (-1.0, long + 1)]).sum().0 < 0.0);
        assert_eq!(of(&[(1e308, 2), (1e308 / 2.0, 1)]).mean(), 1e308);
        assert_eq!(of(&[(f64::INFINITY, 2), (1.0, 1)]).mean(), f64::INFINITY);
        assert!(of(&[(f64::INFINITY, 2), (f64::NEG_INFINITY, 1)]).mean().is_nan());
        assert!(of(&[(1.0, 2), (f64::NAN, 1), (2.0, 5)]).mean().is_nan());
    }
}
