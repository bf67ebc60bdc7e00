//! Exact decimals: rational numbers over `i128`.
//!
//! Literals of both languages are exact (`0.1`, `1 s / 60`), so that a bound in seconds is a whole
//! number of ticks or an error, never a rounding.

use std::cmp::Ordering;
use std::fmt;

/// A rational number in lowest terms with a positive denominator.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Decimal {
    numerator: i128,
    denominator: i128,
}

const fn gcd(mut a: u128, mut b: u128) -> u128 {
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a
}

#[allow(clippy::should_implement_trait, reason = "the operations are checked and yield an option")]
impl Decimal {
    /// Zero.
    pub const ZERO: Self = Self::whole(0);
    /// One.
    pub const ONE: Self = Self::whole(1);

    /// A whole number.
    pub const fn whole(value: i64) -> Self {
        Self { numerator: value as i128, denominator: 1 }
    }

    /// `numerator / denominator`; `None` if the denominator is zero or the quotient does not fit.
    pub fn ratio(numerator: i128, denominator: i128) -> Option<Self> {
        if denominator == 0 || numerator == i128::MIN || denominator == i128::MIN {
            return None;
        }
        let divisor = gcd(numerator.unsigned_abs(), denominator.unsigned_abs()).max(1) as i128;
        let sign = denominator.signum();
        Some(Self { numerator: sign * (numerator / divisor), denominator: sign * (denominator / divisor) })
    }

    /// Reads digits with an optional fraction and exponent: `12`, `0.5`, `1.2e5`, `.5`.
    /// `None` if the text is no such number or has more digits than an `i128` holds.
    pub fn parse(text: &str) -> Option<Self> {
        let (mantissa, exponent) = match text.find(['e', 'E']) {
            Some(at) => (&text[..at], text[at + 1..].parse::<i32>().ok()?),
            None => (text, 0),
        };
        let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
        let (negative, whole) = match whole.strip_prefix('-') {
            Some(rest) => (true, rest),
            None => (false, whole),
        };
        if whole.is_empty() && fraction.is_empty() {
            return None;
        }
        let fraction = fraction.trim_end_matches('0');
        let mut digits: i128 = 0;
        for byte in whole.bytes().chain(fraction.bytes()) {
            if !byte.is_ascii_digit() {
                return None;
            }
            digits = digits.checked_mul(10)?.checked_add(i128::from(byte - b'0'))?;
        }
        if negative {
            digits = -digits;
        }
        let power = exponent.checked_sub(i32::try_from(fraction.len()).ok()?)?;
        if digits == 0 {
            return Some(Self::ZERO);
        }
        let scale = 10i128.checked_pow(power.unsigned_abs())?;
        if power >= 0 { Self::ratio(digits.checked_mul(scale)?, 1) } else { Self::ratio(digits, scale) }
    }

    /// Numerator in lowest terms; carries the sign.
    pub const fn numerator(self) -> i128 {
        self.numerator
    }

    /// Denominator in lowest terms; positive.
    pub const fn denominator(self) -> i128 {
        self.denominator
    }

    /// The whole number it is, if it is one.
    pub const fn as_whole(self) -> Option<i128> {
        if self.denominator == 1 { Some(self.numerator) } else { None }
    }

    /// Nearest double (correctly rounded where both parts are below 2^53).
    pub fn to_f64(self) -> f64 {
        self.numerator as f64 / self.denominator as f64
    }

    /// Sum, if it fits.
    pub fn add(self, other: Self) -> Option<Self> {
        let left = self.numerator.checked_mul(other.denominator)?;
        let right = other.numerator.checked_mul(self.denominator)?;
        Self::ratio(left.checked_add(right)?, self.denominator.checked_mul(other.denominator)?)
    }

    /// Difference, if it fits.
    pub fn sub(self, other: Self) -> Option<Self> {
        self.add(other.neg())
    }

    /// Product, if it fits.
    pub fn mul(self, other: Self) -> Option<Self> {
        // Crosswise reduction keeps the intermediate products small.
        let a = Self::ratio(self.numerator, other.denominator)?;
        let b = Self::ratio(other.numerator, self.denominator)?;
        Self::ratio(a.numerator.checked_mul(b.numerator)?, a.denominator.checked_mul(b.denominator)?)
    }

    /// Quotient; `None` if the divisor is zero or the quotient does not fit.
    pub fn div(self, other: Self) -> Option<Self> {
        self.mul(Self::ratio(other.denominator, other.numerator)?)
    }

    /// The number with the other sign.
    pub const fn neg(self) -> Self {
        Self { numerator: -self.numerator, denominator: self.denominator }
    }

    /// Largest whole number not above.
    pub const fn floor(self) -> i128 {
        self.numerator.div_euclid(self.denominator)
    }

    /// Whether it is below zero.
    pub const fn is_negative(self) -> bool {
        self.numerator < 0
    }

    /// Whether it is zero.
    pub const fn is_zero(self) -> bool {
        self.numerator == 0
    }
}

impl PartialOrd for Decimal {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Decimal {
    fn cmp(&self, other: &Self) -> Ordering {
        // Whole parts first, then what is left, upside down: as Euclid's algorithm goes, so that nothing overflows.
        let (mut a, mut b) = ((self.numerator, self.denominator), (other.numerator, other.denominator));
        loop {
            let whole = a.0.div_euclid(a.1).cmp(&b.0.div_euclid(b.1));
            let (left, right) = (a.0.rem_euclid(a.1), b.0.rem_euclid(b.1));
            if whole != Ordering::Equal {
                return whole;
            }
            if left == 0 || right == 0 {
                return (left != 0).cmp(&(right != 0));
            }
            (a, b) = ((b.1, right), (a.1, left));
        }
    }
}

impl fmt::Display for Decimal {
    /// The shortest decimal that is exact where there is one (`0.02`), else the nearest double.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.to_f64())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn literals_are_exact() {
        let tenth = Decimal::parse("0.1").unwrap();
        assert_eq!((tenth.numerator(), tenth.denominator()), (1, 10));
        let sum = (0..10).try_fold(Decimal::ZERO, |s, _| s.add(tenth)).unwrap();
        assert_eq!(sum, Decimal::ONE);
        assert_eq!(Decimal::parse("1.2e5").unwrap(), Decimal::whole(120_000));
        assert_eq!(Decimal::parse("25e-3").unwrap(), Decimal::ratio(1, 40).unwrap());
        assert_eq!(Decimal::parse("-.5").unwrap(), Decimal::ratio(-1, 2).unwrap());
    }

    #[test]
    fn what_is_no_number_is_none() {
        for text in ["", ".", "1.2.3", "e5", "0x1", "1e999", "9".repeat(60).as_str()] {
            assert_eq!(Decimal::parse(text), None, "{text}");
        }
    }

    #[test]
    fn a_sixtieth_times_sixty_is_one() {
        let step = Decimal::ONE.div(Decimal::whole(60)).unwrap();
        assert_eq!(step.mul(Decimal::whole(60)).unwrap(), Decimal::ONE);
        assert!(Decimal::ONE.div(Decimal::ZERO).is_none());
    }

    #[test]
    fn order_is_exact_where_differences_do_not_fit() {
        let big = i128::MAX / 3;
        let a = Decimal::ratio(big, big - 1).unwrap();
        let b = Decimal::ratio(big - 1, big - 2).unwrap();
        assert_eq!(a.sub(b), None);
        assert_eq!((a.cmp(&b), b.cmp(&a), a.cmp(&a)), (Ordering::Less, Ordering::Greater, Ordering::Equal));
        let minus = |x: Decimal| Decimal::ZERO.sub(x).unwrap();
        assert_eq!(minus(a).cmp(&minus(b)), Ordering::Greater);
    }

    #[test]
    fn order_and_floor() {
        let third = Decimal::ratio(1, 3).unwrap();
        assert!(third < Decimal::ratio(1, 2).unwrap());
        assert_eq!(Decimal::ratio(-7, 2).unwrap().floor(), -4);
        assert_eq!(Decimal::ratio(7, 2).unwrap().to_string(), "3.5");
    }
}
