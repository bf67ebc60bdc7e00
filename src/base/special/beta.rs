//! The regularised incomplete beta function by its continued fraction (DLMF 8.17.22) in log space, and its
//! inverse.
//!
//! The leading factor is written with the divergence from the mean and the remainders of Stirling's
//! formula, so that it keeps its digits for shapes of 1e9, where differences of `ln_gamma` lose six.

use super::gamma::{away_from_zero, ln_gamma, stirling_remainder};
use super::normal::normal_quantile;
use super::{Tails, ln_1p_less, solve};
use crate::base::math;
use std::f64::consts::PI;

/// The fraction needs about the square root of the larger shape; this is enough for 1e10.
const LIMIT: u32 = 200_000;

/// The logarithm of the beta function for positive shapes.
pub fn ln_beta(a: f64, b: f64) -> f64 {
    let (small, large) = if a < b { (a, b) } else { (b, a) };
    if small < 10.0 {
        return if large < 10.0 {
            ln_gamma(small) + ln_gamma(large) - ln_gamma(small + large)
        } else {
            // ln Gamma(large) - ln Gamma(large + small) without large terms that cancel.
            let sum = small + large;
            let ratio = (large - 0.5) * math::ln_1p(-small / sum) - small * math::ln(sum) + small;
            ln_gamma(small) + ratio + stirling_remainder(large) - stirling_remainder(sum)
        };
    }
    let sum = small + large;
    0.5 * math::ln(2.0 * PI * sum / (small * large)) - small * math::ln_1p(large / small)
        + large * math::ln_1p(-small / sum)
        + (stirling_remainder(small) + stirling_remainder(large) - stirling_remainder(sum))
}

/// ln(x^a y^b / B(a, b)) for y = 1 - x: the density of ln(X / (1 - X)) where X has the beta law.
fn ln_weight(a: f64, b: f64, x: f64, y: f64) -> f64 {
    let sum = a + b;
    let shift = x * b - y * a;
    let divergence = a * ln_1p_less(shift / a, x * (sum / a)) + b * ln_1p_less(-shift / b, y * (sum / b));
    0.5 * math::ln(a / (2.0 * PI) * (b / sum)) + divergence + stirling_remainder(sum)
        - stirling_remainder(a)
        - stirling_remainder(b)
}

/// The continued fraction of `I_x(a, b)`, for x below about the mean, by Lentz's method.
fn fraction(a: f64, b: f64, x: f64) -> f64 {
    let mut c = 1.0;
    let mut d = 1.0 / away_from_zero(1.0 - (a + b) * x / (a + 1.0));
    let mut value = d;
    for m in 1..LIMIT {
        let m = f64::from(m);
        let twice = a + 2.0 * m;
        let even = m * (b - m) * x / ((twice - 1.0) * twice);
        d = 1.0 / away_from_zero(1.0 + even * d);
        c = away_from_zero(1.0 + even / c);
        value *= c * d;
        let odd = -(a + m) * (a + b + m) * x / (twice * (twice + 1.0));
        d = 1.0 / away_from_zero(1.0 + odd * d);
        c = away_from_zero(1.0 + odd / c);
        let factor = c * d;
        value *= factor;
        if (factor - 1.0).abs() < 3e-16 {
            break;
        }
    }
    value
}

/// Tails and weight at x, y = 1 - x.
fn tails_and_weight(a: f64, b: f64, x: f64, y: f64) -> (Tails, f64) {
    if x <= 0.0 {
        return (Tails::NONE, f64::NEG_INFINITY);
    }
    if y <= 0.0 {
        return (Tails::ALL, f64::NEG_INFINITY);
    }
    let weight = ln_weight(a, b, x, y);
    let tails = if x < (a + 1.0) / (a + b + 2.0) {
        Tails::from_ln_lower(weight - math::ln(a) + math::ln(fraction(a, b, x)))
    } else {
        Tails::from_ln_lower(weight - math::ln(b) + math::ln(fraction(b, a, y))).swapped()
    };
    (tails, weight)
}

/// Both tails of the beta law of shapes `a`, `b` > 0 at x; `y` is 1 - x, given apart so that it keeps its
/// digits near x = 1.
pub fn beta_tails(a: f64, b: f64, x: f64, y: f64) -> Tails {
    if a.is_nan() || b.is_nan() || a <= 0.0 || b <= 0.0 || x.is_nan() || y.is_nan() {
        return Tails { ln_lower: f64::NAN, ln_upper: f64::NAN };
    }
    tails_and_weight(a, b, x, y).0
}

/// The logit of the x with `I_x(a, b)` = p.
fn quantile_logit(a: f64, b: f64, ln_p: f64, z: f64) -> f64 {
    // ln(X / (1 - X)) has about mean ln(a / b) and variance 1/a + 1/b; where a < 1 and p is small the
    // power law x^a / (a B) is the better start.
    let near_mean = math::ln(a / b) + z * (1.0 / a + 1.0 / b).sqrt();
    let power_law = (ln_p + math::ln(a) + ln_beta(a, b)) / a;
    let start = if a < 1.0 && power_law < 0.0 { power_law } else { near_mean };
    solve::invert(ln_p, start, (-745.0, 745.0), |u| {
        let (x, y) = logistic(u);
        let (tails, weight) = tails_and_weight(a, b, x, y);
        (tails.ln_lower, weight)
    })
}

/// x = 1 / (1 + e^-u) and 1 - x.
fn logistic(u: f64) -> (f64, f64) {
    let e = math::exp(-u.abs());
    let (large, small) = (1.0 / (1.0 + e), e / (1.0 + e));
    if u < 0.0 { (small, large) } else { (large, small) }
}

/// The x with `I_x(a, b)` = p; NaN if p is no probability or a shape is not positive.
pub fn beta_quantile(a: f64, b: f64, p: f64) -> f64 {
    if p.is_nan() || !(0.0..=1.0).contains(&p) || a.is_nan() || b.is_nan() || a <= 0.0 || b <= 0.0 {
        return f64::NAN;
    }
    if p == 0.0 || p == 1.0 {
        return p;
    }
    logistic(quantile_logit(a, b, math::ln(p), normal_quantile(p))).0
}

/// The x with 1 - `I_x(a, b)` = q, accurate for small q.
pub fn beta_upper_quantile(a: f64, b: f64, q: f64) -> f64 {
    if q.is_nan() || !(0.0..=1.0).contains(&q) || a.is_nan() || b.is_nan() || a <= 0.0 || b <= 0.0 {
        return f64::NAN;
    }
    if q == 0.0 || q == 1.0 {
        return 1.0 - q;
    }
    logistic(quantile_logit(b, a, math::ln(q), normal_quantile(q))).1
}

#[cfg(test)]
mod tests {
    use super::*;
    use statrs::function::beta as reference;

    #[test]
    fn ln_beta_agrees_with_the_reference() {
        for a in [0.1, 0.5, 3.0, 12.0, 400.0, 1e5] {
            for b in [0.2, 1.0, 9.5, 30.0, 7e4] {
                let (own, other) = (ln_beta(a, b), reference::ln_beta(a, b));
                assert!((own - other).abs() < 2e-10 * other.abs().max(1.0), "{a} {b}: {own} {other}");
            }
        }
        // B(a, 1) = 1 / a keeps its digits at large shapes.
        assert!((ln_beta(1e9, 1.0) + math::ln(1e9)).abs() < 1e-12);
    }

    #[test]
    fn the_distribution_function_agrees_with_the_reference() {
        for (a, b) in [(0.5, 0.5), (1.0, 3.0), (4.0, 7.0), (30.0, 2.0), (900.0, 100.0), (5.0, 1e5)] {
            let mean: f64 = a / (a + b);
            let sd = (mean * (1.0 - mean) / (a + b + 1.0)).sqrt();
            for z in [-4.0, -2.0, -0.5, 0.0, 0.5, 1.0, 3.0, 6.0] {
                let x = mean + z * sd;
                if x > 0.0 && x < 1.0 {
                    let tails = beta_tails(a, b, x, 1.0 - x);
                    let lower = reference::beta_reg(a, b, x);
                    let upper = reference::beta_reg(b, a, 1.0 - x);
                    assert!((tails.lower() - lower).abs() < 1e-9 * lower.max(1e-3), "{a} {b} {x}");
                    assert!((tails.upper() - upper).abs() < 1e-9 * upper.max(1e-3), "{a} {b} {x}");
                }
            }
        }
    }

    #[test]
    fn closed_forms_hold_far_out_in_both_tails() {
        // I_x(1, b) = 1 - (1 - x)^b and I_x(a, 1) = x^a.
        let tails = beta_tails(1.0, 1e6, 0.5, 0.5);
        assert!((tails.ln_upper / (-1e6 * std::f64::consts::LN_2) - 1.0).abs() < 1e-12);
        assert_eq!(tails.ln_lower, 0.0);
        let tails = beta_tails(1e6, 1.0, 0.5, 0.5);
        assert!((tails.ln_lower / (-1e6 * std::f64::consts::LN_2) - 1.0).abs() < 1e-12);
        let tails = beta_tails(3.0, 1.0, 1e-90, 1.0);
        assert!((tails.ln_lower / (3.0 * math::ln(1e-90)) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn quantiles_invert_both_tails_at_shapes_where_others_hang() {
        let shapes = [
            (0.02, 0.5),
            (0.5, 0.5),
            (1.0, 10.0),
            (4.0, 99_997.0),
            (1.0, 1e7),
            (30.0, 1e7),
            (3.0, 1e8),
            (100.0, 1e8),
            (5e8, 5e8),
        ];
        for (a, b) in shapes {
            for p in [1e-9, 0.0005, 0.025, 0.3, 0.5, 0.9, 0.975] {
                let x = beta_quantile(a, b, p);
                if x > 1e-280 && x < 1.0 - 1e-12 {
                    assert!((beta_tails(a, b, x, 1.0 - x).lower() / p - 1.0).abs() < 1e-6, "{a} {b} {p} {x}");
                }
                let y = beta_upper_quantile(a, b, p);
                if y > 1e-280 && y < 1.0 - 1e-12 {
                    let upper = beta_tails(a, b, y, 1.0 - y).upper();
                    assert!((upper / p - 1.0).abs() < 1e-6, "{a} {b} {p} {y}");
                }
            }
        }
        // Zero successes: 1 - (alpha / 2)^(1 / n).
        let expected = -math::exp_m1(math::ln(0.025) / 1e6);
        // Near x = 1 the fraction itself loses the digits of 1 - x.
        let error = beta_upper_quantile(1.0, 1e6, 0.025) / expected - 1.0;
        assert!(error.abs() < 1e-11, "{error:e}");
    }
}
