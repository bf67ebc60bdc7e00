//! Sums, products and quotients of doubles with what rounding took off (Dekker, Numerische Mathematik 18, 1971): two doubles
//! that add up to the result.

/// A sum and its rounding error.
#[inline]
pub fn sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let of_b = sum - a;
    (sum, (a - (sum - of_b)) + (b - of_b))
}

/// The same, of which the first is larger.
#[inline]
pub fn sum_of_ordered(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    (sum, b - (sum - a))
}

/// A product and its rounding error.
#[inline]
pub fn product(a: f64, b: f64) -> (f64, f64) {
    /// Splits a double into two of half as many digits.
    fn halves(x: f64) -> (f64, f64) {
        let scaled = 134_217_729.0 * x;
        let high = scaled - (scaled - x);
        (high, x - high)
    }
    let product = a * b;
    let ((a, a_low), (b, b_low)) = (halves(a), halves(b));
    (product, ((a * b - product) + a * b_low + a_low * b) + a_low * b_low)
}

/// The quotient of two numbers of two doubles each, to about 32 digits.
#[inline]
pub fn quotient(numerator: (f64, f64), denominator: (f64, f64)) -> (f64, f64) {
    let quotient = numerator.0 / denominator.0;
    let (product, error) = product(quotient, denominator.0);
    let low = numerator.1 - quotient * denominator.1;
    (quotient, (((numerator.0 - product) - error) + low) / denominator.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_are_exact() {
        // Whole numbers, so that the product can be had exactly.
        for (a, b) in [
            (9_007_199_254_740_881_i64, 4_503_599_627_370_449_i64),
            (123_456_789_012_345, 98_765_432_109_876),
        ] {
            let (product, error) = product(a as f64, b as f64);
            assert_eq!(product as i128 + error as i128, i128::from(a) * i128::from(b));
        }
    }
}
