//! Doubles side by side at the width of the machine, and the elementary functions of the inner loops.
//!
//! A block has eight logical lanes at every level; a machine whose vectors are narrower takes it in parts
//! (`Part` names one), lane by lane the same operations. Only `+ - * /`, `sqrt`, comparison, selection and
//! bit patterns are used, never a fused multiply-add or an estimate. So every lane has the same bits at
//! every level. `exp`, `ln` and `sin_cos_turn` follow `base::math` operation by operation; a test holds them equal
//! to the last bit.

use crate::base::lanes::{LANES, Lanes, Mask};
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use std::f64::consts::{FRAC_PI_2, LN_2, LOG2_E};

/// Doubles, as many as a vector of the machine holds.
pub(super) type Doubles<S> = <S as Simd>::f64s;
/// The same bits as whole numbers.
pub(super) type Words<S> = <Doubles<S> as SimdFloat<S>>::Bits;
/// Truth values, one a lane.
pub(super) type Truths<S> = <Doubles<S> as SimdBase<S>>::Mask;

/// 1.5 * 2^52: adding and subtracting it rounds to the nearest whole number.
const ROUND: f64 = 6_755_399_441_055_744.0;
const LN2_HIGH: f64 = 0.693_147_180_369_123_8;
const LN2_LOW: f64 = 1.908_214_929_270_587_7e-10;

/// A part of a block: so many lanes, from `at` on, as fit a vector of the machine.
#[derive(Clone, Copy)]
pub(super) struct Part<S: Simd> {
    simd: S,
    at: usize,
}

/// The parts of a block, in order.
#[inline(always)]
pub(super) fn parts<S: Simd>(simd: S) -> impl Iterator<Item = Part<S>> {
    (0..LANES / Doubles::<S>::LEN).map(move |k| Part { simd, at: k * Doubles::<S>::LEN })
}

/// The first part of a block. It serves for vectors that start anywhere.
#[inline(always)]
pub(super) fn first_part<S: Simd>(simd: S) -> Part<S> {
    Part { simd, at: 0 }
}

/// Lanes of a vector of the machine.
#[inline(always)]
pub(super) const fn width<S: Simd>() -> usize {
    Doubles::<S>::LEN
}

impl<S: Simd> Part<S> {
    /// The same number in every lane.
    #[inline(always)]
    pub(super) fn c(self, value: f64) -> Doubles<S> {
        Doubles::<S>::splat(self.simd, value)
    }

    /// The same word in every lane.
    #[inline(always)]
    pub(super) fn word(self, value: u64) -> Words<S> {
        Words::<S>::splat(self.simd, value)
    }

    /// Its lanes of a block.
    #[inline(always)]
    pub(super) fn load(self, lanes: &Lanes) -> Doubles<S> {
        self.slice(&lanes.0)
    }

    /// Its lanes of eight consecutive numbers.
    #[inline(always)]
    pub(super) fn slice(self, eight: &[f64]) -> Doubles<S> {
        Doubles::<S>::from_slice(self.simd, &eight[self.at..self.at + Doubles::<S>::LEN])
    }

    /// Its lanes, where `of` has the number of each lane of the block.
    #[inline(always)]
    pub(super) fn gather(self, of: impl Fn(usize) -> f64) -> Doubles<S> {
        let mut eight = [0.0; LANES];
        for lane in self.at..self.at + Doubles::<S>::LEN {
            eight[lane] = of(lane);
        }
        self.slice(&eight)
    }

    /// Its lanes of eight words.
    #[inline(always)]
    pub(super) fn words(self, eight: &[u64; LANES]) -> Words<S> {
        Words::<S>::from_slice(self.simd, &eight[self.at..self.at + Doubles::<S>::LEN])
    }

    #[inline(always)]
    pub(super) fn store(self, value: Doubles<S>, lanes: &mut Lanes) {
        value.store_slice(&mut lanes.0[self.at..self.at + Doubles::<S>::LEN]);
    }

    /// Stores into its lanes of eight words.
    #[inline(always)]
    pub(super) fn put_words(self, value: Words<S>, eight: &mut [u64; LANES]) {
        value.store_slice(&mut eight[self.at..self.at + Doubles::<S>::LEN]);
    }

    /// Stores into its lanes of eight consecutive numbers.
    #[inline(always)]
    pub(super) fn put(self, value: Doubles<S>, eight: &mut [f64]) {
        value.store_slice(&mut eight[self.at..self.at + Doubles::<S>::LEN]);
    }

    /// Takes a value off its lanes of eight consecutive numbers.
    #[inline(always)]
    pub(super) fn take(self, value: Doubles<S>, eight: &mut [f64]) {
        let eight = &mut eight[self.at..self.at + Doubles::<S>::LEN];
        (Doubles::<S>::from_slice(self.simd, eight) - value).store_slice(eight);
    }

    /// Stores the lanes of `mask`; the bytes of the others stay.
    #[inline(always)]
    pub(super) fn store_in(self, mask: Truths<S>, value: Doubles<S>, lanes: &mut Lanes) {
        self.store(mask.select(value, self.load(lanes)), lanes);
    }

    /// Its lanes of a mask.
    #[inline(always)]
    pub(super) fn mask(self, lanes: Mask) -> Truths<S> {
        Truths::<S>::from_bitmask(self.simd, u64::from(lanes.0) >> self.at)
    }

    /// Its lanes as a mask of the block; all others are out.
    #[inline(always)]
    pub(super) fn bits(self, mask: Truths<S>) -> Mask {
        Mask((mask.to_bitmask() << self.at) as u8)
    }
}

/// The nearest whole number, of numbers below 2^51.
#[inline(always)]
pub(super) fn nearest_whole<S: Simd>(part: Part<S>, x: Doubles<S>) -> Doubles<S> {
    (x + part.c(ROUND)) - part.c(ROUND)
}

/// The smaller of two; the second where one is no number.
#[inline(always)]
pub(super) fn smaller<S: Simd>(a: Doubles<S>, b: Doubles<S>) -> Doubles<S> {
    a.simd_lt(b).select(a, b)
}

/// The larger of two; the second where one is no number.
#[inline(always)]
pub(super) fn larger<S: Simd>(a: Doubles<S>, b: Doubles<S>) -> Doubles<S> {
    a.simd_gt(b).select(a, b)
}

/// Two to the power `x` for -1022 <= x <= 1022, within 4 units in the last place, exactly 1 at 0
/// (the argument of a force is itself rounded to more than that).
/// Outside, and for NaN, some number or none: the caller selects.
///
/// x = n + f with |f| <= 1/2; (2^f - 1)/f is a polynomial of degree 9, fitted at the
/// Chebyshev points (largest relative error 5.7e-16), in even and odd halves; 2^n is made in the exponent field.
#[inline(always)]
pub(super) fn exp2<S: Simd>(part: Part<S>, x: Doubles<S>) -> Doubles<S> {
    const C: [f64; 10] = [
        LN_2 + 9e-16,
        0.240_226_506_959_100_75,
        0.055_504_108_664_651_67,
        0.009_618_129_107_618_665,
        0.001_333_355_820_079_459_2,
        0.000_154_035_304_247_765_29,
        1.525_267_292_485_073_7e-5,
        1.321_545_163_322_143_4e-6,
        1.020_590_541_376_559e-7,
        7.070_977_866_508_138e-9,
    ];
    // The bias of the exponent rides along, so that the low bits of `t` are the exponent field.
    const BIASED: f64 = ROUND + 1023.0;
    let t = x + part.c(BIASED);
    let f = x - (t - part.c(BIASED));
    let f2 = f * f;
    let even =
        part.c(C[0]) + f2 * (part.c(C[2]) + f2 * (part.c(C[4]) + f2 * (part.c(C[6]) + f2 * part.c(C[8]))));
    let odd =
        part.c(C[1]) + f2 * (part.c(C[3]) + f2 * (part.c(C[5]) + f2 * (part.c(C[7]) + f2 * part.c(C[9]))));
    let power = part.c(1.0) + (f * even + f2 * odd);
    power * Doubles::<S>::from_bits(t.to_bits() << 52)
}

/// `base::math::exp`.
#[inline(always)]
pub(super) fn exp<S: Simd>(part: Part<S>, x: Doubles<S>) -> Doubles<S> {
    let c = |value: f64| part.c(value);
    let (least, most) = (x.simd_lt(c(-708.0)), x.simd_gt(c(709.0)));
    let clamped = most.select(c(709.0), least.select(c(-708.0), x));
    let t = clamped * c(LOG2_E) + c(ROUND);
    let n = t - c(ROUND);
    let r = clamped - n * c(LN2_HIGH) - n * c(LN2_LOW);
    let r2 = r * r;
    let r4 = r2 * r2;
    let r8 = r4 * r4;
    let p23 = c(1.0 / 2.0) + r * c(1.0 / 6.0);
    let p45 = c(1.0 / 24.0) + r * c(1.0 / 120.0);
    let p67 = c(1.0 / 720.0) + r * c(1.0 / 5_040.0);
    let p89 = c(1.0 / 40_320.0) + r * c(1.0 / 362_880.0);
    let pab = c(1.0 / 3_628_800.0) + r * c(1.0 / 39_916_800.0);
    let pcd = c(1.0 / 479_001_600.0) + r * c(1.0 / 6_227_020_800.0);
    let low = r + r2 * p23;
    let middle = p45 + r2 * p67;
    let high = (p89 + r2 * pab) + r4 * pcd;
    let p = c(1.0) + (low + (r4 * middle + r8 * high));
    let scale = Doubles::<S>::from_bits((t.to_bits() << 52) + part.word(1023 << 52));
    let scaled = least.select(c(0.0), p * scale);
    let scaled = most.select(c(f64::INFINITY), scaled);
    x.simd_eq(x).select(scaled, x)
}

/// `base::math::ln` for positive normal numbers.
#[inline(always)]
pub(super) fn ln<S: Simd>(part: Part<S>, x: Doubles<S>) -> Doubles<S> {
    const L: [f64; 7] = [
        0.666_666_666_666_673_5,
        0.399_999_999_994_094_2,
        0.285_714_287_436_623_9,
        0.222_221_984_321_497_84,
        0.181_835_721_616_180_5,
        0.153_138_376_992_093_73,
        0.147_981_986_051_165_86,
    ];
    let one = part.c(1.0);
    let shifted = x.to_bits() + part.word(0x3ff0_0000_0000_0000 - 0x3fe6_a09e_667f_3bcd);
    let k = Doubles::<S>::from_bits((shifted >> 52) | part.word(0x4330_0000_0000_0000))
        - part.c(4_503_599_627_370_496.0 + 1023.0);
    let m = Doubles::<S>::from_bits(
        (shifted & part.word(0x000f_ffff_ffff_ffff)) + part.word(0x3fe6_a09e_667f_3bcd),
    );
    let f = m - one;
    let s = f / (part.c(2.0) + f);
    let z = s * s;
    let w = z * z;
    let even = w * (part.c(L[1]) + w * (part.c(L[3]) + w * part.c(L[5])));
    let odd = z * (part.c(L[0]) + w * (part.c(L[2]) + w * (part.c(L[4]) + w * part.c(L[6]))));
    let half = part.c(0.5) * f * f;
    k * part.c(LN2_HIGH) - ((half - (s * (half + (odd + even)) + k * part.c(LN2_LOW))) - f)
}

/// `base::math::sin_cos_turn`.
#[inline(always)]
pub(super) fn sin_cos_turn<S: Simd>(part: Part<S>, turn: Doubles<S>) -> (Doubles<S>, Doubles<S>) {
    let quarters = part.c(4.0) * turn;
    let t = quarters + part.c(ROUND);
    let x = (quarters - (t - part.c(ROUND))) * part.c(FRAC_PI_2);
    let z = x * x;
    let w = z * z;
    let sin_tail = part.c(0.008_333_333_333_322_49)
        + z * (part.c(-0.000_198_412_698_298_579_5) + z * part.c(2.755_731_370_707_006_8e-6))
        + z * w * (part.c(-2.505_076_025_340_686_3e-8) + z * part.c(1.589_690_995_211_55e-10));
    let sin = x + x * z * (part.c(-0.166_666_666_666_666_32) + z * sin_tail);
    let cos_tail = z
        * (part.c(0.041_666_666_666_666_6)
            + z * (part.c(-0.001_388_888_888_887_411) + z * part.c(2.480_158_728_947_673e-5)))
        + w * w
            * (part.c(-2.755_731_435_139_066_3e-7)
                + z * (part.c(2.087_572_321_298_175e-9) + z * part.c(-1.135_964_755_778_819_5e-11)));
    let half = part.c(0.5) * z;
    let one_less = part.c(1.0) - half;
    let cos = one_less + (((part.c(1.0) - one_less) - half) + z * cos_tail);
    let quarter = t.to_bits();
    let one = part.word(1);
    let two = part.word(2);
    let swap = (quarter & one).simd_eq(one);
    let (sin, cos) = (sin.to_bits(), cos.to_bits());
    let s = swap.select(cos, sin) ^ ((quarter & two) << 62);
    let k = swap.select(sin, cos) ^ (((quarter + one) & two) << 62);
    (Doubles::<S>::from_bits(s), Doubles::<S>::from_bits(k))
}

#[cfg(test)]
#[allow(clippy::disallowed_methods, reason = "the platform's functions are the reference")]
mod tests {
    use super::*;
    use crate::base::math;
    use fearless_simd::{Level, dispatch};

    #[inline(always)]
    fn five<S: Simd>(simd: S, x: [f64; 8]) -> [[f64; 8]; 5] {
        let mut out = [Lanes::ZERO; 5];
        for part in parts(simd) {
            let x = part.slice(&x);
            let (sin, cos) = sin_cos_turn(part, x);
            part.store(exp2(part, x), &mut out[0]);
            part.store(ln(part, x), &mut out[1]);
            part.store(sin, &mut out[2]);
            part.store(cos, &mut out[3]);
            part.store(exp(part, x), &mut out[4]);
        }
        out.map(|lanes| lanes.0)
    }

    #[test]
    fn logarithm_and_angles_equal_the_scalar_ones_to_the_last_bit() {
        for k in 0..5_000 {
            let x: [f64; 8] = std::array::from_fn(|lane| (f64::from(8 * k) + lane as f64 + 0.37) / 40_000.0);
            let [_, logs, sins, coss, _] = dispatch!(Level::new(), simd => five(simd, x));
            for lane in 0..8 {
                assert_eq!(logs[lane].to_bits(), math::ln(x[lane]).to_bits());
                let (sin, cos) = math::sin_cos_turn(x[lane]);
                assert_eq!((sins[lane].to_bits(), coss[lane].to_bits()), (sin.to_bits(), cos.to_bits()));
            }
        }
    }

    #[test]
    fn exponentials_equal_the_scalar_ones_to_the_last_bit() {
        let odd = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -0.0, -708.0, -708.5, 709.0, 709.5];
        let many =
            (0..5_000).map(|k| std::array::from_fn(|l| (f64::from(8 * k) + l as f64 - 20_000.0) / 27.3));
        for x in many.chain([odd]) {
            let found = dispatch!(Level::new(), simd => five(simd, x))[4];
            assert_eq!(found.map(f64::to_bits), x.map(|x| math::exp(x).to_bits()));
        }
    }

    #[test]
    fn powers_of_two_are_right_to_four_units_in_the_last_place() {
        for k in -3_000..3_000 {
            let x: [f64; 8] = std::array::from_fn(|lane| (f64::from(k) + lane as f64 / 8.0) * 0.0321);
            let powers = dispatch!(Level::new(), simd => five(simd, x))[0];
            for lane in 0..8 {
                let exact = x[lane].exp2();
                assert!(
                    (powers[lane] - exact).abs() <= 9e-16 * exact,
                    "{} {}",
                    x[lane],
                    powers[lane] / exact
                );
            }
        }
        let ones = dispatch!(Level::new(), simd => five(simd, [0.0; 8]))[0];
        assert_eq!(ones, [1.0; 8]);
    }
}
