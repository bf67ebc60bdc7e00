//! Instants of continuous time with what rounding took off: two doubles that add up to the time (Dekker, Numerische
//! Mathematik 18, 1971).
//!
//! Something that takes two seconds takes two seconds whenever it begins: a bound of two seconds must not miss it by a
//! rounding. One double has no room for the sum of a time that came by chance and a delay; two have, and for decimals and
//! thirds to some 32 digits.

use super::decimal::Decimal;
use super::rounding::{product, quotient, sum, sum_of_ordered};

/// Of a time, what millions of sums of two doubles may be off, amply: what is nearer to each other is at one time.
const NOISE: f64 = 1.0 / (1_u128 << 78) as f64;

/// A time, or the length of one, in seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instant {
    /// The double that is nearest to it; halfway between two the lower one, so that all that are at one time have the same.
    pub seconds: f64,
    /// What it is more than that; no number where nobody knows.
    pub rest: f64,
}

impl From<f64> for Instant {
    /// A double that may stand for what it was rounded from.
    fn from(seconds: f64) -> Self {
        Self { seconds, rest: f64::NAN }
    }
}

impl From<Decimal> for Instant {
    fn from(exact: Decimal) -> Self {
        // Whole numbers of more digits than a double has are two.
        let split = |whole: i128| {
            let high = whole as f64;
            (high, (whole - high as i128) as f64)
        };
        Self::quotient(split(exact.numerator()), split(exact.denominator()))
    }
}

impl Instant {
    /// Just a double.
    pub fn exactly(seconds: f64) -> Self {
        Self { seconds, rest: 0.0 }
    }

    /// A double that may be one of at most twelve digits behind the point: then that. Another is what it is.
    #[inline]
    pub fn decimal(seconds: f64) -> Self {
        let whole = (seconds * 1e12 + 0.5).floor();
        if whole < 9e15 && whole / 1e12 == seconds {
            Self::quotient((whole, 0.0), (1e12, 0.0))
        } else {
            Self::exactly(seconds)
        }
    }

    /// One number of two doubles by another.
    fn quotient(numerator: (f64, f64), denominator: (f64, f64)) -> Self {
        let (seconds, rest) = quotient(numerator, denominator);
        if rest.is_finite() { Self::of_parts(seconds, rest) } else { Self::exactly(seconds) }
    }

    /// The sum of two doubles, of which the first is much larger.
    #[inline]
    fn of_parts(seconds: f64, rest: f64) -> Self {
        let (seconds, rest) = sum_of_ordered(seconds, rest);
        let other = seconds + 2.0 * rest;
        if other != seconds {
            // About halfway to another double.
            let half = 0.5 * (other - seconds);
            if (rest - half).abs() <= seconds * NOISE {
                let lower = if other < seconds { other } else { seconds };
                return Self { seconds: lower, rest: half.abs() };
            }
        }
        Self { seconds, rest }
    }

    /// Whether this is earlier than another time, by more than noise. Of one of which nobody knows what rounding took off, the
    /// double counts.
    #[inline]
    pub fn is_before(self, other: Self) -> bool {
        self.seconds < other.seconds
            || (self.seconds == other.seconds && self.rest + self.seconds * NOISE < other.rest)
    }

    /// The instant that is `wait` later. An infinite wait has no end.
    #[inline]
    pub fn after(self, wait: Self) -> Self {
        let (sum, error) = sum(self.seconds, wait.seconds);
        if sum.is_infinite() {
            return Self::exactly(sum);
        }
        Self::of_parts(sum, error + (self.rest + wait.rest))
    }

    /// This time by a number of two doubles: the greatest whole number up to it, which a rounding does not miss.
    #[inline]
    pub fn floor_by(self, factor: Self) -> i64 {
        /// Of one: much more than 2^-46, which is what two doubles may be off of 2^60.
        const NEAR: f64 = 1.0 / (1 << 20) as f64;
        let (product, error) = product(self.seconds, factor.seconds);
        let whole = product.floor();
        let less = (product - whole) + (error + (self.seconds * factor.rest + self.rest * factor.seconds));
        whole as i64 + (less + NEAR).floor() as i64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> Instant {
        Instant::from(Decimal::parse(text).unwrap())
    }

    #[test]
    fn sums_of_decimals_and_thirds_are_what_they_are() {
        let third = Instant::from(Decimal::ratio(1, 3).unwrap());
        let mut now = Instant::exactly(0.0);
        for k in 1..=30_000 {
            now = now.after(third);
            if k % 3 == 0 {
                assert_eq!(now.seconds, f64::from(k / 3));
                assert!(now.rest.abs() < 1e-24, "{now:?}");
            }
        }
        let mut now = Instant::exactly(0.0);
        for k in 1..=5000 {
            now = now.after(of("0.1"));
            assert_eq!(now.seconds, f64::from(k) / 10.0);
        }
        assert_eq!(of("0.3").after(Instant::exactly(f64::INFINITY)).seconds, f64::INFINITY);
        assert_eq!(of("0.3"), Instant::decimal(0.3));
        assert_eq!(Instant::decimal(std::f64::consts::PI), Instant::exactly(std::f64::consts::PI));
        assert_eq!(Instant::decimal(1e300), Instant::exactly(1e300));
        assert_eq!(Instant::decimal(f64::INFINITY).seconds, f64::INFINITY);
    }

    #[test]
    fn a_delay_is_as_many_units_whenever_it_begins() {
        // Units of which a second has 10^9 times 2^24, and those of a third of a billionth.
        for units in [1_000_000_000_i64 << 24, 3_000_000_000 << 24] {
            let units = Instant::exactly(units as f64);
            for start in [0.123_456_789_012_345_6, 1.0 / 3.0, 3.069_993_738_794_106_5, 17.25, 0.0, 1e-9] {
                let now = Instant::exactly(start);
                for parts in [["1.5", "0.5"], ["1.7", "0.3"], ["0.1", "1.9"], ["2", "0"]] {
                    let due = parts.iter().fold(now, |now, part| now.after(of(part)));
                    let two = of("2").floor_by(units);
                    assert_eq!(due.floor_by(units) - now.floor_by(units), two, "{start} {parts:?}");
                }
            }
        }
    }
}
