//! Elementary functions with the same bits on every machine.
//!
//! Built from `+ - * /`, `sqrt`, compare-and-select and bit patterns alone; Rust never contracts
//! `a * b + c`, so SSE2, AVX2, AVX-512 and NEON agree to the last bit. `exp`, `ln` and
//! `sin_cos_turn` are straight-line code, which the compiler turns into vector code when they are
//! applied lane by lane. Argument reductions and coefficients are the well-known ones of fdlibm
//! (Sun Microsystems, 1993) and of the Taylor series.

use std::f64::consts::{FRAC_PI_2, LOG2_E, PI};

/// Adding and subtracting 1.5 * 2^52 rounds to the nearest whole number.
const ROUND: f64 = 6_755_399_441_055_744.0;
const LN2_HIGH: f64 = 6.931_471_803_691_238_164_9e-1;
const LN2_LOW: f64 = 1.908_214_929_270_587_700_02e-10;

/// Largest number not above `bound`; compare and select, so that a NaN stays one.
#[inline(always)]
pub fn at_most(x: f64, bound: f64) -> f64 {
    if x > bound { bound } else { x }
}

/// Smallest number not below `bound`; compare and select, so that a NaN stays one.
#[inline(always)]
pub fn at_least(x: f64, bound: f64) -> f64 {
    if x < bound { bound } else { x }
}

/// The exponential function, within 1 ulp for -708 <= x <= 709; 0 below, infinite above.
#[inline(always)]
pub fn exp(x: f64) -> f64 {
    let clamped = at_most(at_least(x, -708.0), 709.0);
    let t = clamped * LOG2_E + ROUND;
    let n = t - ROUND;
    let r = clamped - n * LN2_HIGH - n * LN2_LOW;
    // Taylor to degree 13 in Estrin's order: on |r| <= ln(2)/2 the remainder is below 5e-18.
    let r2 = r * r;
    let r4 = r2 * r2;
    let r8 = r4 * r4;
    let p23 = 1.0 / 2.0 + r * (1.0 / 6.0);
    let p45 = 1.0 / 24.0 + r * (1.0 / 120.0);
    let p67 = 1.0 / 720.0 + r * (1.0 / 5_040.0);
    let p89 = 1.0 / 40_320.0 + r * (1.0 / 362_880.0);
    let pab = 1.0 / 3_628_800.0 + r * (1.0 / 39_916_800.0);
    let pcd = 1.0 / 479_001_600.0 + r * (1.0 / 6_227_020_800.0);
    let low = r + r2 * p23;
    let middle = p45 + r2 * p67;
    let high = (p89 + r2 * pab) + r4 * pcd;
    let p = 1.0 + (low + (r4 * middle + r8 * high));
    // The low bits of t hold n; shifted into the exponent field they scale by 2^n.
    let scaled = p * f64::from_bits((t.to_bits() << 52).wrapping_add(1023 << 52));
    let scaled = if x < -708.0 { 0.0 } else { scaled };
    let scaled = if x > 709.0 { f64::INFINITY } else { scaled };
    if x.is_nan() { x } else { scaled }
}

/// The natural logarithm of a positive normal number, within 1 ulp.
/// -infinity at 0 and below the smallest normal number, NaN for negative numbers.
#[inline(always)]
pub fn ln(x: f64) -> f64 {
    const L: [f64; 7] = [
        6.666_666_666_666_735_130e-1,
        3.999_999_999_940_941_908e-1,
        2.857_142_874_366_239_149e-1,
        2.222_219_843_214_978_396e-1,
        1.818_357_216_161_805_012e-1,
        1.531_383_769_920_937_332e-1,
        1.479_819_860_511_658_591e-1,
    ];
    let bits = x.to_bits();
    // Split into m * 2^k with m in [sqrt(1/2), sqrt(2)).
    let shifted = bits.wrapping_add(0x3ff0_0000_0000_0000 - 0x3fe6_a09e_667f_3bcd);
    let k = f64::from_bits((shifted >> 52) | 0x4330_0000_0000_0000) - (4_503_599_627_370_496.0 + 1023.0);
    let m = f64::from_bits((shifted & 0x000f_ffff_ffff_ffff) + 0x3fe6_a09e_667f_3bcd);
    let f = m - 1.0;
    let s = f / (2.0 + f);
    let z = s * s;
    let w = z * z;
    let even = w * (L[1] + w * (L[3] + w * L[5]));
    let odd = z * (L[0] + w * (L[2] + w * (L[4] + w * L[6])));
    let half = 0.5 * f * f;
    let value = k * LN2_HIGH - ((half - (s * (half + (odd + even)) + k * LN2_LOW)) - f);
    let value = if x < f64::MIN_POSITIVE { f64::NEG_INFINITY } else { value };
    let value = if x < 0.0 { f64::NAN } else { value };
    if x < f64::INFINITY { value } else { x }
}

/// Sine and cosine on [-pi/4, pi/4].
#[inline(always)]
fn sin_cos_small(x: f64) -> (f64, f64) {
    let z = x * x;
    let w = z * z;
    let sin_tail = 8.333_333_333_322_489_46e-3
        + z * (-1.984_126_982_985_794_93e-4 + z * 2.755_731_370_707_006_77e-6)
        + z * w * (-2.505_076_025_340_686_34e-8 + z * 1.589_690_995_211_550_10e-10);
    let sin = x + x * z * (-1.666_666_666_666_663_24e-1 + z * sin_tail);
    let cos_tail = z
        * (4.166_666_666_666_660_19e-2
            + z * (-1.388_888_888_887_410_96e-3 + z * 2.480_158_728_947_672_94e-5))
        + w * w
            * (-2.755_731_435_139_066_33e-7
                + z * (2.087_572_321_298_174_83e-9 + z * -1.135_964_755_778_819_48e-11));
    let half = 0.5 * z;
    let one_less = 1.0 - half;
    let cos = one_less + (((1.0 - one_less) - half) + z * cos_tail);
    (sin, cos)
}

/// Turns the values on the reduced angle into those of quadrant `q` (a whole number as a double).
#[inline(always)]
fn in_quadrant(quarter_bits: u64, sin: f64, cos: f64) -> (f64, f64) {
    let swap = quarter_bits & 1 == 1;
    let (s, c) = if swap { (cos, sin) } else { (sin, cos) };
    // Sine is negative in quadrants 2 and 3, cosine in 1 and 2.
    let s = f64::from_bits(s.to_bits() ^ (quarter_bits & 2) << 62);
    let c = f64::from_bits(c.to_bits() ^ (quarter_bits.wrapping_add(1) & 2) << 62);
    (s, c)
}

/// Sine and cosine of `turn` whole turns, that is of the angle 2 pi `turn`; |turn| < 2^48.
#[inline(always)]
pub fn sin_cos_turn(turn: f64) -> (f64, f64) {
    let quarters = 4.0 * turn;
    let t = quarters + ROUND;
    let reduced = (quarters - (t - ROUND)) * FRAC_PI_2;
    let (sin, cos) = sin_cos_small(reduced);
    in_quadrant(t.to_bits(), sin, cos)
}

/// Sine and cosine of an angle in radians, for |x| up to about 1e5 within 2 ulp of 1; beyond that of an angle within an
/// ulp of x.
#[inline(always)]
pub fn sin_cos(x: f64) -> (f64, f64) {
    const PIO2_HIGH: f64 = 1.570_796_326_734_125_614_17;
    const PIO2_MIDDLE: f64 = 6.077_100_506_303_965_976_60e-11;
    const PIO2_LOW: f64 = 2.022_266_248_795_950_631_5e-21;
    // A remainder is exact, so the same everywhere.
    let x = if x.abs() > 1e5 { x % (2.0 * PI) } else { x };
    let t = x * (2.0 / PI) + ROUND;
    let n = t - ROUND;
    let reduced = ((x - n * PIO2_HIGH) - n * PIO2_MIDDLE) - n * PIO2_LOW;
    let (sin, cos) = sin_cos_small(reduced);
    in_quadrant(t.to_bits(), sin, cos)
}

/// Arc tangent of `x`.
fn atan(x: f64) -> f64 {
    const A: [f64; 11] = [
        3.333_333_333_333_293_18e-1,
        -1.999_999_999_987_648_32e-1,
        1.428_571_427_250_346_64e-1,
        -1.111_111_040_546_235_58e-1,
        9.090_887_133_436_506_56e-2,
        -7.691_876_205_044_829_99e-2,
        6.661_073_137_387_531_21e-2,
        -5.833_570_133_790_573_49e-2,
        4.976_877_994_615_932_36e-2,
        -3.653_157_274_421_691_55e-2,
        1.628_582_011_536_578_24e-2,
    ];
    let magnitude = if x < 0.0 { -x } else { x };
    if magnitude.is_nan() {
        return x;
    }
    // Reduce to |reduced| < 7/16 around 0, 1/2, 1, 3/2 or infinity.
    let (base, low, reduced) = if magnitude < 0.4375 {
        (0.0, 0.0, magnitude)
    } else if magnitude < 0.6875 {
        (
            4.636_476_090_008_060_935_2e-1,
            2.269_877_745_296_168_709_24e-17,
            (2.0 * magnitude - 1.0) / (2.0 + magnitude),
        )
    } else if magnitude < 1.1875 {
        (std::f64::consts::FRAC_PI_4, 3.061_616_997_868_383_017_93e-17, (magnitude - 1.0) / (magnitude + 1.0))
    } else if magnitude < 2.4375 {
        (
            9.827_937_232_473_290_541e-1,
            1.390_331_103_123_099_845_16e-17,
            (magnitude - 1.5) / (1.0 + 1.5 * magnitude),
        )
    } else {
        (FRAC_PI_2, 6.123_233_995_736_766_035_87e-17, -1.0 / magnitude)
    };
    let z = reduced * reduced;
    let w = z * z;
    let even = z * (A[0] + w * (A[2] + w * (A[4] + w * (A[6] + w * (A[8] + w * A[10])))));
    let odd = w * (A[1] + w * (A[3] + w * (A[5] + w * (A[7] + w * A[9]))));
    let value = base - ((reduced * (even + odd) - low) - reduced);
    if x < 0.0 { -value } else { value }
}

/// Angle of the point (x, y) in (-pi, pi]; 0 for the origin.
pub fn atan2(y: f64, x: f64) -> f64 {
    if x.is_nan() || y.is_nan() {
        return f64::NAN;
    }
    if x == 0.0 && y == 0.0 {
        return 0.0;
    }
    if x == 0.0 {
        return if y > 0.0 { FRAC_PI_2 } else { -FRAC_PI_2 };
    }
    let angle = atan(y / x);
    if x > 0.0 {
        angle
    } else if y >= 0.0 {
        angle + PI
    } else {
        angle - PI
    }
}

/// `base` to the power `exponent`. Whole exponents up to 1024 multiply; others go over `exp` and `ln`,
/// so that a negative base with a fractional exponent is NaN.
pub fn pow(base: f64, exponent: f64) -> f64 {
    if exponent == exponent.trunc() && exponent.abs() <= 1024.0 {
        let mut left = exponent.abs() as u32;
        let (mut square, mut product) = (base, 1.0);
        while left > 0 {
            if left & 1 == 1 {
                product *= square;
            }
            square *= square;
            left >>= 1;
        }
        return if exponent < 0.0 { 1.0 / product } else { product };
    }
    if base == 0.0 {
        return if exponent > 0.0 { 0.0 } else { f64::INFINITY };
    }
    exp(exponent * ln(base))
}

/// `exp(x) - 1` without cancellation near 0 (Kahan's correction of `exp` and `ln`).
pub fn exp_m1(x: f64) -> f64 {
    if x.abs() > 0.5 {
        return exp(x) - 1.0;
    }
    let u = exp(x);
    if u == 1.0 {
        return x;
    }
    let less = u - 1.0;
    less * x / ln(u)
}

/// `ln(1 + x)` without cancellation near 0.
pub fn ln_1p(x: f64) -> f64 {
    let u = 1.0 + x;
    if u == 1.0 { x } else { ln(u) * x / (u - 1.0) }
}

/// The median; of an even number of values the greater one of the two in the middle. `None` of no values.
pub fn median(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let mut sorted: Vec<f64> = values.into_iter().collect();
    sorted.sort_unstable_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied()
}

#[cfg(test)]
#[allow(clippy::disallowed_methods, reason = "the platform's functions are the reference")]
mod tests {
    use super::*;

    fn ulps(a: f64, b: f64) -> u64 {
        (a.to_bits() as i64).abs_diff(b.to_bits() as i64)
    }

    #[test]
    fn exp_is_within_an_ulp() {
        let worst = (-70_000..70_000).map(|k| f64::from(k) * 0.01).map(|x| ulps(exp(x), x.exp())).max();
        assert!(worst.unwrap() <= 1, "{worst:?}");
        assert_eq!(exp(0.0), 1.0);
        assert_eq!(exp(-1000.0), 0.0);
        assert_eq!(exp(1000.0), f64::INFINITY);
        assert!(exp(f64::NAN).is_nan());
    }

    #[test]
    fn ln_is_within_an_ulp() {
        let worst = (1..200_000)
            .map(|k| f64::from(k) * 0.000_37)
            .chain((1..300).map(|k| 2f64.powi(k - 150) * 1.3))
            .map(|x| ulps(ln(x), x.ln()))
            .max();
        assert!(worst.unwrap() <= 1, "{worst:?}");
        assert_eq!(ln(1.0), 0.0);
        assert_eq!(ln(0.0), f64::NEG_INFINITY);
        assert!(ln(-1.0).is_nan());
        assert_eq!(ln(f64::INFINITY), f64::INFINITY);
    }

    #[test]
    fn angles_agree_with_the_platform() {
        for k in -2000..2000 {
            let x = f64::from(k) * 0.0173;
            let (s, c) = sin_cos(x);
            assert!((s - x.sin()).abs() < 4e-16 && (c - x.cos()).abs() < 4e-16, "{x}");
            let (s, c) = sin_cos_turn(x);
            let angle = (x - x.floor()) * 2.0 * PI;
            assert!((s - angle.sin()).abs() < 2e-15 && (c - angle.cos()).abs() < 2e-15, "{x}");
            let y = f64::from(k % 37) * 0.31;
            assert!((atan2(y, x) - y.atan2(x)).abs() < 1e-15, "{y} {x}");
        }
        // Beyond, of an angle within an ulp of it; always a sine.
        for x in [1.5e5, 3e8, 1e12, 1e17, 1e20, 1e30, 1e300, -1e20] {
            let (s, c) = sin_cos(x);
            assert!((s * s + c * c - 1.0).abs() < 1e-12, "{x}");
            assert!((s - x.sin()).abs() <= 2e-16 * x.abs(), "{x}");
        }
        assert!(sin_cos(f64::INFINITY).0.is_nan());
    }

    #[test]
    fn powers() {
        assert_eq!(pow(3.0, 4.0), 81.0);
        assert_eq!(pow(2.0, -2.0), 0.25);
        assert!((pow(2.0, 0.5) - 2f64.sqrt()).abs() < 1e-15);
        assert!(pow(-1.0, 0.5).is_nan());
        assert!((exp_m1(1e-10) - 1e-10f64.exp_m1()).abs() < 1e-25);
        assert!((ln_1p(1e-10) - 1e-10f64.ln_1p()).abs() < 1e-25);
    }
}
