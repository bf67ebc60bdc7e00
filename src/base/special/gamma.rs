//! The logarithm of the gamma function (Stirling's series, DLMF 5.11.1) and the regularised incomplete
//! gamma functions (series 8.11.4, continued fraction 8.9.2, and near the mean of large shapes Temme's uniform
//! expansion, 8.12.3 and 8.12.7), with inverses.

use super::normal::{normal_quantile, normal_tails};
use super::{Tails, ln_1p_less, solve};
use crate::base::math;

/// ln(2 pi) / 2.
const HALF_LN_TWO_PI: f64 = 0.918_938_533_204_672_8;
/// From here on Stirling's series with eight terms is exact to the last bit.
const STIRLING_FROM: f64 = 10.0;
const LIMIT: u32 = 200_000;
/// From this shape on the uniform expansion serves near the mean, where the series and the fraction take as many terms as
/// some standard deviations.
const UNIFORM_FROM: f64 = 1e4;
/// So near, as a part of the mean, its coefficients are taken from their series in eta.
const NEAR: f64 = 0.1;
/// c0, c1 and c2 of DLMF 8.12.9 to 8.12.10 as series in eta: Temme, SIAM Journal on Mathematical Analysis 10 (1979). The
/// terms left out are below 2e-13 of a tail.
const UNIFORM: [&[f64]; 3] = [
    &[
        -1.0 / 3.0,
        1.0 / 12.0,
        -2.0 / 135.0,
        1.0 / 864.0,
        1.0 / 2_835.0,
        -139.0 / 777_600.0,
        1.0 / 25_515.0,
        -571.0 / 261_273_600.0,
    ],
    &[-1.0 / 540.0, -1.0 / 288.0, 1.0 / 378.0, -77.0 / 77_760.0],
    &[25.0 / 6_048.0, -139.0 / 51_840.0],
];

/// The remainder of Stirling's formula: ln Gamma(x) - ((x - 1/2) ln x - x + ln(2 pi) / 2), for x > 0.
pub(super) fn stirling_remainder(x: f64) -> f64 {
    if x < STIRLING_FROM {
        return ln_gamma(x) - ((x - 0.5) * math::ln(x) - x + HALF_LN_TWO_PI);
    }
    let inverse = 1.0 / x;
    let square = inverse * inverse;
    let terms = [
        1.0 / 12.0,
        -1.0 / 360.0,
        1.0 / 1_260.0,
        -1.0 / 1_680.0,
        1.0 / 1_188.0,
        -691.0 / 360_360.0,
        1.0 / 156.0,
        -3_617.0 / 122_400.0,
    ];
    inverse * terms.iter().rev().fold(0.0, |sum, term| sum * square + term)
}

/// The logarithm of the gamma function for x > 0, absolute error about 1e-15 for x below 10, relative
/// error of a few ulp above; infinite at 0, NaN below.
pub fn ln_gamma(x: f64) -> f64 {
    if x.is_nan() || x < 0.0 {
        return f64::NAN;
    }
    if x < f64::MIN_POSITIVE || x == f64::INFINITY {
        return f64::INFINITY;
    }
    let mut product = 1.0;
    let mut shifted = x;
    while shifted < STIRLING_FROM {
        product *= shifted;
        shifted += 1.0;
    }
    let stirling =
        (shifted - 0.5) * math::ln(shifted) - shifted + HALF_LN_TWO_PI + stirling_remainder(shifted);
    stirling - math::ln(product)
}

/// ln(x^a e^-x / Gamma(a)): the density of ln X where X has the gamma law of shape a and scale 1.
fn ln_weight(a: f64, x: f64) -> f64 {
    let ratio = x / a;
    let t = (x - a) / a;
    a * ln_1p_less(t, ratio) + 0.5 * math::ln(a) - HALF_LN_TWO_PI - stirling_remainder(a)
}

/// Both tails for a large shape near the mean: Q = erfc(eta sqrt(a / 2)) / 2 + e^(-a eta^2 / 2) S / sqrt(2 pi a), where
/// eta^2 / 2 = t - ln(1 + t), t = x / a - 1, and S = c0 + c1 / a + c2 / a^2. P is 1 - Q with the sign of S turned.
fn uniform_tails(a: f64, x: f64) -> Tails {
    let t = (x - a) / a;
    let eta = (-2.0 * ln_1p_less(t, x / a)).sqrt() * t.signum();
    let coefficient = |row: &[f64]| row.iter().rev().fold(0.0, |sum, c| sum * eta + c);
    let sum = UNIFORM.iter().rev().fold(0.0, |sum, row| sum / a + coefficient(row));
    let z = eta * a.sqrt();
    // The smaller tail is that of the normal law, times one and a small part.
    let outer = normal_tails(-z.abs()).ln_lower;
    let density = -0.5 * z * z - HALF_LN_TWO_PI;
    let part = math::exp(density - outer) * sum / a.sqrt();
    if t > 0.0 {
        Tails::from_ln_lower(outer + math::ln_1p(part)).swapped()
    } else {
        Tails::from_ln_lower(outer + math::ln_1p(-part))
    }
}

/// Both tails of the gamma law of shape `a` > 0 and scale 1 at `x`.
pub fn gamma_tails(a: f64, x: f64) -> Tails {
    if x.is_nan() || a.is_nan() || a <= 0.0 {
        return Tails { ln_lower: f64::NAN, ln_upper: f64::NAN };
    }
    if x < f64::MIN_POSITIVE {
        return Tails::NONE;
    }
    if x == f64::INFINITY {
        return Tails::ALL;
    }
    if a >= UNIFORM_FROM && (x - a).abs() <= NEAR * a {
        return uniform_tails(a, x);
    }
    let weight = ln_weight(a, x);
    if x < a + 1.0 {
        // P = weight * sum of x^n / (a (a + 1) ... (a + n)).
        let mut term = 1.0 / a;
        let mut sum = term;
        for n in 1..LIMIT {
            term *= x / (a + f64::from(n));
            sum += term;
            if term < sum * 1e-17 {
                break;
            }
        }
        return Tails::from_ln_lower(weight + math::ln(sum));
    }
    // Q = weight / (x + 1 - a - 1 (1 - a) / (x + 3 - a - ...)), by Lentz's method.
    let mut b = x + 1.0 - a;
    let mut c = 1e300;
    let mut d = 1.0 / b;
    let mut fraction = d;
    for n in 1..LIMIT {
        let n = f64::from(n);
        let numerator = -n * (n - a);
        b += 2.0;
        d = 1.0 / away_from_zero(b + numerator * d);
        c = away_from_zero(b + numerator / c);
        let factor = c * d;
        fraction *= factor;
        if (factor - 1.0).abs() < 2e-16 {
            break;
        }
    }
    Tails::from_ln_lower(weight + math::ln(fraction)).swapped()
}

/// Lentz's method never divides by zero.
pub(super) fn away_from_zero(x: f64) -> f64 {
    if x.abs() < 1e-300 { 1e-300 } else { x }
}

/// P(a, x): the regularised lower incomplete gamma function.
pub fn gamma_reg(a: f64, x: f64) -> f64 {
    gamma_tails(a, x).lower()
}

/// A first guess of ln of the quantile, for a standard normal quantile z: Wilson and Hilferty (1931), or
/// the leading term of the series where the law reaches to 0.
fn ln_start(a: f64, z: f64, ln_p: f64) -> f64 {
    let cube = 1.0 - 1.0 / (9.0 * a) + z / (3.0 * a.sqrt());
    if a > 0.5 && cube > 0.1 {
        return math::ln(a) + 3.0 * math::ln(cube);
    }
    (ln_p + ln_gamma(a + 1.0)) / a
}

/// The x with P(a, x) = p; 0 at p = 0, infinite at p = 1.
pub fn gamma_quantile(a: f64, p: f64) -> f64 {
    if p.is_nan() || !(0.0..=1.0).contains(&p) || a.is_nan() || a <= 0.0 {
        return f64::NAN;
    }
    if p == 0.0 {
        return 0.0;
    }
    if p == 1.0 {
        return f64::INFINITY;
    }
    if a == 1.0 {
        // The exponential law.
        return -math::ln_1p(-p);
    }
    if p > 0.5 {
        return gamma_upper_quantile(a, 1.0 - p);
    }
    let ln_p = math::ln(p);
    let u = solve::invert(ln_p, ln_start(a, normal_quantile(p), ln_p), (-745.0, 709.0), |u| {
        let x = math::exp(u);
        (gamma_tails(a, x).ln_lower, ln_weight(a, x))
    });
    math::exp(u)
}

/// The x with Q(a, x) = 1 - P(a, x) = q, accurate for small q; infinite at q = 0, 0 at q = 1.
pub fn gamma_upper_quantile(a: f64, q: f64) -> f64 {
    if q.is_nan() || !(0.0..=1.0).contains(&q) || a.is_nan() || a <= 0.0 {
        return f64::NAN;
    }
    if q == 0.0 {
        return f64::INFINITY;
    }
    if a == 1.0 {
        return -math::ln(q);
    }
    if q > 0.5 {
        return gamma_quantile(a, 1.0 - q);
    }
    let start = ln_start(a, -normal_quantile(q), math::ln_1p(-q));
    // In -ln x the upper tail is a lower one.
    let u = solve::invert(math::ln(q), -start, (-709.0, 745.0), |u| {
        let x = math::exp(-u);
        (gamma_tails(a, x).ln_upper, ln_weight(a, x))
    });
    math::exp(-u)
}

#[cfg(test)]
#[allow(clippy::disallowed_methods, reason = "the platform's functions are the reference")]
mod tests {
    use super::*;
    use statrs::function::gamma as reference;

    #[test]
    fn ln_gamma_agrees_with_the_reference() {
        for k in 1..4000 {
            let x = f64::from(k) * 0.013;
            let (own, other) = (ln_gamma(x), reference::ln_gamma(x));
            assert!((own - other).abs() < 3e-14 * other.abs().max(1.0), "{x}: {own} {other}");
        }
        for x in [1e-5, 1e3, 1e6, 1e9] {
            assert!((ln_gamma(x) / reference::ln_gamma(x) - 1.0).abs() < 1e-14, "{x}");
        }
        // 170! from its definition.
        let factorial: f64 = (1..=170).map(|k| f64::from(k).ln()).sum();
        assert!((ln_gamma(171.0) - factorial).abs() < 1e-11);
    }

    #[test]
    fn both_tails_agree_with_the_reference() {
        for a in [0.02, 0.5, 1.0, 3.7, 20.0, 400.0, 1e4] {
            for z in [-3.0, -1.0, -0.1, 0.0, 0.5, 2.0, 4.0] {
                let x: f64 = (a + z * f64::sqrt(a)).max(a * 0.05);
                let tails = gamma_tails(a, x);
                let (lower, upper) = (reference::gamma_lr(a, x), reference::gamma_ur(a, x));
                assert!((tails.lower() - lower).abs() < 1e-11, "{a} {x}");
                assert!((tails.upper() - upper).abs() < 1e-11, "{a} {x}");
            }
        }
        // A closed form far out: Q(1, x) = e^-x.
        assert!((gamma_tails(1.0, 600.0).ln_upper + 600.0).abs() < 1e-10);
        assert!((gamma_tails(1.0, 1e-12).ln_lower - 1e-12f64.ln()).abs() < 1e-11);
    }

    #[test]
    #[allow(clippy::unreadable_literal, reason = "as they were printed")]
    fn large_shapes_near_the_mean_are_exact() {
        // ln P and ln Q by mpmath with 40 digits.
        for (a, x, ln_lower, ln_upper) in [
            (10000.0, 9100.0, -46.23389005875034, -8.334444723475769e-21),
            (10000.0, 9700.0, -6.697352074748682, -0.0012349378063634525),
            (10000.0, 9990.0, -0.7733113065674339, -0.6189351472810177),
            (10000.0, 10000.0, -0.6904910944019723, -0.69581034030382),
            (10000.0, 10050.0, -0.36767458925897195, -1.1787679350023146),
            (10000.0, 10200.0, -0.023562756305381648, -3.759846180932281),
            (10000.0, 10600.0, -1.9621924840581465e-09, -20.049203375552512),
            (10000.0, 10950.0, -1.5117971250005492e-20, -45.638402767712996),
            (100000.0, 97153.95, -44.41303607234971, -5.148296007170415e-20),
            (100000.0, 99051.317, -6.635612840488562, -0.0013136364201777706),
            (100000.0, 99968.377, -0.7752553515725247, -0.6172722004240683),
            (100000.0, 100000.0, -0.6923064898187249, -0.6939885786567972),
            (100000.0, 100158.114, -0.3685438081263481, -1.1768146323003128),
            (100000.0, 100632.456, -0.023187274786248255, -3.775722886806259),
            (100000.0, 101897.367, -1.234299277522079e-09, -20.51276241513012),
            (100000.0, 103004.164, -2.539097290825013e-21, -47.422478332326094),
        ] {
            let tails = gamma_tails(a, x);
            assert!((tails.ln_lower - ln_lower).abs() < 2e-12 + 1e-10 * ln_lower.abs().min(1e-3), "{a} {x}");
            assert!((tails.ln_upper - ln_upper).abs() < 2e-12 + 1e-10 * ln_upper.abs().min(1e-3), "{a} {x}");
        }
        // Where the expansion takes over from the series and the fraction nothing jumps.
        for a in [1e4, 3e4, 1e5] {
            for x in [a * (1.0 - NEAR), a * (1.0 + NEAR)] {
                let (near, far) = (uniform_tails(a, x), gamma_tails(a, x + (x - a).signum() * 1e-9 * a));
                let step = 1e-9 * a * math::exp(ln_weight(a, x)) / x;
                let (inner, outer) =
                    if x < a { (near.lower(), far.lower()) } else { (near.upper(), far.upper()) };
                assert!(((inner - step) / outer - 1.0).abs() < 1e-6, "{a} {x} {inner:e} {outer:e}");
            }
        }
        // Shapes of which neither the series nor the fraction would come to an end.
        for a in [1e8, 1e11, 1e14] {
            for z in [-8.0, -2.0, -0.3, 0.0, 1.0, 6.0] {
                let tails = gamma_tails(a, a + z * f64::sqrt(a));
                let normal = normal_tails(z);
                // The first correction of Edgeworth's series.
                let skew = (z * z - 1.0) / (3.0 * f64::sqrt(a)) * math::exp(-0.5 * z * z - HALF_LN_TWO_PI);
                assert!((tails.lower() - normal.lower() + skew).abs() < 20.0 / a + 1e-9, "{a} {z}");
            }
        }
    }

    #[test]
    fn quantiles_invert_both_tails() {
        for a in [0.02, 0.3, 1.0, 7.5, 100.0, 1e6, 1e9, 1e13] {
            // The logarithm in which it is sought has so many digits.
            let off = f64::max(1e-9, 1e-12 * f64::sqrt(a));
            for p in [1e-12, 1e-3, 0.1, 0.5, 0.9, 0.999] {
                let x = gamma_quantile(a, p);
                assert!(x == 0.0 || (gamma_reg(a, x) / p - 1.0).abs() < off, "{a} {p} {x}");
                let y = gamma_upper_quantile(a, p);
                if y > 1e-280 {
                    assert!((gamma_tails(a, y).upper() / p - 1.0).abs() < off, "{a} {p} {y}");
                }
            }
        }
        assert!(gamma_quantile(2.0, 1.5).is_nan());
        assert_eq!(gamma_quantile(2.0, 0.0), 0.0);
    }
}
