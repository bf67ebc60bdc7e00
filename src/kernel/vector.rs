//! Eight doubles side by side at whatever width the machine has, and the elementary functions of the
//! inner loops on them.
//!
//! A vector has eight logical lanes at every level (`fearless_simd` splits them into registers), and only
//! `+ - * /`, `sqrt`, comparison, selection and bit patterns are used, never a fused multiply-add or an
//! estimate. So every lane has the same bits at every level. `ln` and `sin_cos_turn` follow
//! `base::math` operation by operation; a test holds them equal to the last bit.

use crate::base::lanes::{Lanes, Mask};
use fearless_simd::prelude::*;
use fearless_simd::{Simd, f64x8, mask64x8, u64x8};
use std::f64::consts::FRAC_PI_2;

/// 1.5 * 2^52: adding and subtracting it rounds to the nearest whole number.
const ROUND: f64 = 6_755_399_441_055_744.0;
const LN2_HIGH: f64 = 6.931_471_803_691_238_164_9e-1;
const LN2_LOW: f64 = 1.908_214_929_270_587_700_02e-10;

#[inline(always)]
pub(super) fn splat<S: Simd>(simd: S, value: f64) -> f64x8<S> {
    f64x8::splat(simd, value)
}

#[inline(always)]
pub(super) fn words<S: Simd>(simd: S, value: u64) -> u64x8<S> {
    u64x8::splat(simd, value)
}

#[inline(always)]
pub(super) fn load<S: Simd>(simd: S, lanes: &Lanes) -> f64x8<S> {
    f64x8::load_array_ref(simd, &lanes.0)
}

#[inline(always)]
pub(super) fn store<S: Simd>(value: f64x8<S>, lanes: &mut Lanes) {
    value.store_array(&mut lanes.0);
}

/// Stores the lanes of `mask`; the bytes of the others stay.
#[inline(always)]
pub(super) fn store_in<S: Simd>(simd: S, mask: mask64x8<S>, value: f64x8<S>, lanes: &mut Lanes) {
    store(mask.select(value, load(simd, lanes)), lanes);
}

#[inline(always)]
pub(super) fn mask<S: Simd>(simd: S, lanes: Mask) -> mask64x8<S> {
    mask64x8::from_bitmask(simd, u64::from(lanes.0))
}

#[inline(always)]
pub(super) fn bits<S: Simd>(mask: mask64x8<S>) -> Mask {
    Mask(mask.to_bitmask() as u8)
}

/// The smaller of two; the second where one is no number.
#[inline(always)]
pub(super) fn smaller<S: Simd>(a: f64x8<S>, b: f64x8<S>) -> f64x8<S> {
    a.simd_lt(b).select(a, b)
}

/// The larger of two; the second where one is no number.
#[inline(always)]
pub(super) fn larger<S: Simd>(a: f64x8<S>, b: f64x8<S>) -> f64x8<S> {
    a.simd_gt(b).select(a, b)
}

/// Two to the power `x` for -1022 <= x <= 1022, within 2 units in the last place, exactly 1 at 0.
/// Outside, and for NaN, some number or none: the caller selects.
///
/// x = n + f with |f| <= 1/2; (2^f - 1)/f is a polynomial of degree 10, the best one
/// (largest relative error 2.8e-17, by the Remez exchange), in even and odd halves; 2^n is made in the exponent field.
#[inline(always)]
pub(super) fn exp2<S: Simd>(simd: S, x: f64x8<S>) -> f64x8<S> {
    const C: [f64; 11] = [
        0.693_147_180_559_945_3,
        0.240_226_506_959_101_3,
        0.055_504_108_664_820_09,
        0.009_618_129_107_594_188,
        0.001_333_355_814_677_401_2,
        0.000_154_035_304_570_373_87,
        1.525_273_349_341_358_6e-5,
        1.321_543_531_575_366_6e-6,
        1.017_819_952_837_472_2e-7,
        7.073_778_002_087_502e-9,
        4.434_770_053_138_381e-10,
    ];
    // The bias of the exponent rides along, so that the low bits of `t` are the exponent field.
    const BIASED: f64 = ROUND + 1023.0;
    let c = |k: usize| splat(simd, C[k]);
    let t = x + splat(simd, BIASED);
    let f = x - (t - splat(simd, BIASED));
    let f2 = f * f;
    let even = c(0) + f2 * (c(2) + f2 * (c(4) + f2 * (c(6) + f2 * (c(8) + f2 * c(10)))));
    let odd = c(1) + f2 * (c(3) + f2 * (c(5) + f2 * (c(7) + f2 * c(9))));
    let power = splat(simd, 1.0) + (f * even + f2 * odd);
    power * f64x8::from_bits(t.to_bits() << 52)
}

/// `base::math::ln` for positive normal numbers.
#[inline(always)]
pub(super) fn ln<S: Simd>(simd: S, x: f64x8<S>) -> f64x8<S> {
    const L: [f64; 7] = [
        6.666_666_666_666_735_130e-1,
        3.999_999_999_940_941_908e-1,
        2.857_142_874_366_239_149e-1,
        2.222_219_843_214_978_396e-1,
        1.818_357_216_161_805_012e-1,
        1.531_383_769_920_937_332e-1,
        1.479_819_860_511_658_591e-1,
    ];
    let l = |k: usize| splat(simd, L[k]);
    let one = splat(simd, 1.0);
    let shifted = x.to_bits() + words(simd, 0x3ff0_0000_0000_0000 - 0x3fe6_a09e_667f_3bcd);
    let k = f64x8::from_bits((shifted >> 52) | words(simd, 0x4330_0000_0000_0000))
        - splat(simd, 4_503_599_627_370_496.0 + 1023.0);
    let m =
        f64x8::from_bits((shifted & words(simd, 0x000f_ffff_ffff_ffff)) + words(simd, 0x3fe6_a09e_667f_3bcd));
    let f = m - one;
    let s = f / (splat(simd, 2.0) + f);
    let z = s * s;
    let w = z * z;
    let even = w * (l(1) + w * (l(3) + w * l(5)));
    let odd = z * (l(0) + w * (l(2) + w * (l(4) + w * l(6))));
    let half = splat(simd, 0.5) * f * f;
    k * splat(simd, LN2_HIGH) - ((half - (s * (half + (odd + even)) + k * splat(simd, LN2_LOW))) - f)
}

/// `base::math::sin_cos_turn`.
#[inline(always)]
pub(super) fn sin_cos_turn<S: Simd>(simd: S, turn: f64x8<S>) -> (f64x8<S>, f64x8<S>) {
    let c = |value: f64| splat(simd, value);
    let quarters = c(4.0) * turn;
    let t = quarters + c(ROUND);
    let x = (quarters - (t - c(ROUND))) * c(FRAC_PI_2);
    let z = x * x;
    let w = z * z;
    let sin_tail = c(8.333_333_333_322_489_46e-3)
        + z * (c(-1.984_126_982_985_794_93e-4) + z * c(2.755_731_370_707_006_77e-6))
        + z * w * (c(-2.505_076_025_340_686_34e-8) + z * c(1.589_690_995_211_550_10e-10));
    let sin = x + x * z * (c(-1.666_666_666_666_663_24e-1) + z * sin_tail);
    let cos_tail = z
        * (c(4.166_666_666_666_660_19e-2)
            + z * (c(-1.388_888_888_887_410_96e-3) + z * c(2.480_158_728_947_672_94e-5)))
        + w * w
            * (c(-2.755_731_435_139_066_33e-7)
                + z * (c(2.087_572_321_298_174_83e-9) + z * c(-1.135_964_755_778_819_48e-11)));
    let half = c(0.5) * z;
    let one_less = c(1.0) - half;
    let cos = one_less + (((c(1.0) - one_less) - half) + z * cos_tail);
    let quarter = t.to_bits();
    let one = words(simd, 1);
    let two = words(simd, 2);
    let swap = (quarter & one).simd_eq(one);
    let (s, k) = (swap.select(cos, sin), swap.select(sin, cos));
    let s = f64x8::from_bits(s.to_bits() ^ ((quarter & two) << 62));
    let k = f64x8::from_bits(k.to_bits() ^ (((quarter + one) & two) << 62));
    (s, k)
}

#[cfg(test)]
#[allow(clippy::disallowed_methods, reason = "the platform's functions are the reference")]
mod tests {
    use super::*;
    use crate::base::math;
    use fearless_simd::{Level, dispatch};

    #[inline(always)]
    fn three<S: Simd>(simd: S, x: [f64; 8]) -> [[f64; 8]; 4] {
        let v = f64x8::load_array(simd, x);
        let (sin, cos) = sin_cos_turn(simd, v);
        [exp2(simd, v).to_array(), ln(simd, v).to_array(), sin.to_array(), cos.to_array()]
    }

    #[test]
    fn logarithm_and_angles_equal_the_scalar_ones_to_the_last_bit() {
        for k in 0..5_000 {
            let x: [f64; 8] = std::array::from_fn(|lane| (f64::from(8 * k) + lane as f64 + 0.37) / 40_000.0);
            let [_, logs, sins, coss] = dispatch!(Level::new(), simd => three(simd, x));
            for lane in 0..8 {
                assert_eq!(logs[lane].to_bits(), math::ln(x[lane]).to_bits());
                let (sin, cos) = math::sin_cos_turn(x[lane]);
                assert_eq!((sins[lane].to_bits(), coss[lane].to_bits()), (sin.to_bits(), cos.to_bits()));
            }
        }
    }

    #[test]
    fn powers_of_two_are_right_to_a_few_units_in_the_last_place() {
        for k in -3_000..3_000 {
            let x: [f64; 8] = std::array::from_fn(|lane| (f64::from(k) + lane as f64 / 8.0) * 0.0321);
            let powers = dispatch!(Level::new(), simd => three(simd, x))[0];
            for lane in 0..8 {
                let exact = x[lane].exp2();
                assert!(
                    (powers[lane] - exact).abs() <= 4.4e-16 * exact,
                    "{} {}",
                    x[lane],
                    powers[lane] / exact
                );
            }
        }
        let ones = dispatch!(Level::new(), simd => three(simd, [0.0; 8]))[0];
        assert_eq!(ones, [1.0; 8]);
    }
}
