//! Special functions with the same bits on every machine, built on `base::math` alone.
//!
//! Distribution functions come as logarithms of both tails, each formed without subtracting from one, so
//! that a tail of 1e-300 is as good as one of 1/2. Inverses are bracketed and have an iteration limit.

pub mod beta;
pub mod gamma;
pub mod normal;
mod solve;

pub use beta::{beta_quantile, beta_tails, beta_upper_quantile, ln_beta};
pub use gamma::{gamma_quantile, gamma_reg, gamma_tails, gamma_upper_quantile, ln_gamma};
pub use normal::{erf, erfc, normal_cdf, normal_quantile};

use super::math;

/// The logarithms of P(X <= x) and P(X > x).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tails {
    /// ln P(X <= x).
    pub ln_lower: f64,
    /// ln P(X > x).
    pub ln_upper: f64,
}

impl Tails {
    /// All of the mass lies above x.
    pub const NONE: Self = Self { ln_lower: f64::NEG_INFINITY, ln_upper: 0.0 };
    /// All of the mass lies at or below x.
    pub const ALL: Self = Self { ln_lower: 0.0, ln_upper: f64::NEG_INFINITY };

    /// P(X <= x).
    pub fn lower(self) -> f64 {
        math::exp(self.ln_lower)
    }

    /// P(X > x).
    pub fn upper(self) -> f64 {
        math::exp(self.ln_upper)
    }

    /// The same tails seen from the other side.
    pub const fn swapped(self) -> Self {
        Self { ln_lower: self.ln_upper, ln_upper: self.ln_lower }
    }

    /// From the logarithm of a lower tail that is not close to one.
    fn from_ln_lower(ln_lower: f64) -> Self {
        let ln_lower = math::at_most(ln_lower, 0.0);
        Self { ln_lower, ln_upper: math::ln_1p(-math::exp(ln_lower)) }
    }
}

/// `ln(1 + t) - t` without cancellation, where `ratio` is 1 + t (which may be more accurate than t near
/// t = -1).
pub fn ln_1p_less(t: f64, ratio: f64) -> f64 {
    if t.abs() > 0.4 {
        return math::ln(ratio) - t;
    }
    // With s = t / (2 + t), ln(1 + t) = 2 artanh(s), and 2 s - t = -t s.
    let s = t / (2.0 + t);
    let square = s * s;
    let mut sum = 0.0;
    let mut k = 33.0;
    while k >= 3.0 {
        sum = sum * square + 1.0 / k;
        k -= 2.0;
    }
    2.0 * s * square * sum - t * s
}

#[cfg(test)]
#[allow(clippy::disallowed_methods, reason = "the platform's functions are the reference")]
mod tests {
    use super::*;

    #[test]
    fn small_arguments_keep_their_digits() {
        for t in [1e-9, -1e-9, 1e-3, -1e-3f64] {
            let series = -t * t / 2.0 + t * t * t / 3.0 - t.powi(4) / 4.0 + t.powi(5) / 5.0;
            assert!((ln_1p_less(t, 1.0 + t) / series - 1.0).abs() < 1e-12, "{t}");
        }
        for t in [0.39, -0.39, 0.41, -0.41, 3.0, -0.99f64] {
            let direct = t.ln_1p() - t;
            assert!((ln_1p_less(t, 1.0 + t) / direct - 1.0).abs() < 1e-13, "{t}");
        }
    }
}
