//! The normal law: distribution function over the incomplete gamma functions of shape 1/2, quantile by the
//! rational approximations of Wichura, "Algorithm AS 241", Applied Statistics 37 (1988).

#![allow(clippy::excessive_precision, reason = "coefficients as published")]

use super::Tails;
use super::gamma::gamma_tails;
use crate::base::math;

const CENTRE: [[f64; 8]; 2] = [
    [
        3.387_132_872_796_366_608_0,
        1.331_416_678_917_843_774_5e2,
        1.971_590_950_306_551_442_7e3,
        1.373_169_376_550_946_112_5e4,
        4.592_195_393_154_987_145_7e4,
        6.726_577_092_700_870_085_3e4,
        3.343_057_558_358_812_810_5e4,
        2.509_080_928_730_122_672_7e3,
    ],
    [
        1.0,
        4.231_333_070_160_091_125_2e1,
        6.871_870_074_920_579_083_0e2,
        5.394_196_021_424_751_107_7e3,
        2.121_379_430_158_659_586_7e4,
        3.930_789_580_009_271_061_0e4,
        2.872_908_573_572_194_267_4e4,
        5.226_495_278_852_854_561_0e3,
    ],
];
const MIDDLE: [[f64; 8]; 2] = [
    [
        1.423_437_110_749_683_577_34,
        4.630_337_846_156_545_295_90,
        5.769_497_221_460_691_405_50,
        3.647_848_324_763_204_605_04,
        1.270_458_252_452_368_382_58,
        2.417_807_251_774_506_117_70e-1,
        2.272_384_498_926_918_458_33e-2,
        7.745_450_142_783_414_076_40e-4,
    ],
    [
        1.0,
        2.053_191_626_637_758_821_87,
        1.676_384_830_183_803_849_40,
        6.897_673_349_851_000_045_50e-1,
        1.481_039_764_274_800_745_90e-1,
        1.519_866_656_361_645_719_66e-2,
        5.475_938_084_995_344_946_00e-4,
        1.050_750_071_644_416_843_24e-9,
    ],
];
const FAR: [[f64; 8]; 2] = [
    [
        6.657_904_643_501_103_777_20,
        5.463_784_911_164_114_369_90,
        1.784_826_539_917_291_335_80,
        2.965_605_718_285_048_912_30e-1,
        2.653_218_952_657_612_309_30e-2,
        1.242_660_947_388_078_438_60e-3,
        2.711_555_568_743_487_578_15e-5,
        2.010_334_399_292_288_132_65e-7,
    ],
    [
        1.0,
        5.998_322_065_558_879_376_90e-1,
        1.369_298_809_227_358_053_10e-1,
        1.487_536_129_085_061_485_25e-2,
        7.868_691_311_456_132_591_00e-4,
        1.846_318_317_510_054_681_80e-5,
        1.421_511_758_316_445_888_70e-7,
        2.044_263_103_389_939_785_64e-15,
    ],
];

fn rational([top, bottom]: &[[f64; 8]; 2], x: f64) -> f64 {
    let at = |c: &[f64; 8]| c.iter().rev().fold(0.0, |sum, k| sum * x + k);
    at(top) / at(bottom)
}

/// The error function, absolute error below 3e-15.
pub fn erf(x: f64) -> f64 {
    let value = gamma_tails(0.5, x * x).lower();
    if x < 0.0 { -value } else { value }
}

/// The complementary error function, accurate in the far tail.
pub fn erfc(x: f64) -> f64 {
    let tails = gamma_tails(0.5, x * x);
    if x < 0.0 { 1.0 + tails.lower() } else { tails.upper() }
}

/// Both tails of the standard normal law at `z`.
pub fn normal_tails(z: f64) -> Tails {
    // P(|Z| > |z|) = Q(1/2, z^2 / 2), and half of it lies on each side.
    let ln_outer = gamma_tails(0.5, 0.5 * z * z).ln_upper - std::f64::consts::LN_2;
    let tails = Tails::from_ln_lower(ln_outer);
    if z > 0.0 { tails.swapped() } else { tails }
}

/// The distribution function of the standard normal law.
pub fn normal_cdf(z: f64) -> f64 {
    normal_tails(z).lower()
}

/// The quantile of the standard normal law, relative error about 1e-15; infinite at 0 and 1. For upper
/// tails below 1e-16 use symmetry.
pub fn normal_quantile(p: f64) -> f64 {
    if p.is_nan() || !(0.0..=1.0).contains(&p) {
        return f64::NAN;
    }
    if p == 0.0 {
        return f64::NEG_INFINITY;
    }
    if p == 1.0 {
        return f64::INFINITY;
    }
    let centred = p - 0.5;
    if centred.abs() <= 0.425 {
        return centred * rational(&CENTRE, 0.180_625 - centred * centred);
    }
    let tail = if centred < 0.0 { p } else { 1.0 - p };
    let r = (-math::ln(tail)).sqrt();
    let magnitude = if r <= 5.0 { rational(&MIDDLE, r - 1.6) } else { rational(&FAR, r - 5.0) };
    if centred < 0.0 { -magnitude } else { magnitude }
}

#[cfg(test)]
mod tests {
    use super::*;
    use statrs::function::erf as reference;

    #[test]
    fn error_functions_agree_with_the_reference() {
        for k in -500..500 {
            let x = f64::from(k) * 0.011;
            // The reference is a rational approximation with fewer digits.
            assert!((erf(x) - reference::erf(x)).abs() < 1e-9, "{x}");
            assert!((erfc(x) / reference::erfc(x) - 1.0).abs() < 1e-8, "{x}");
        }
        // Sixteen digits by Python's math.erf and math.erfc.
        for (x, low, high) in [
            (0.01, 0.011_283_415_555_849_616, 0.988_716_584_444_150_3),
            (0.4, 0.428_392_355_046_668_45, 0.571_607_644_953_331_5),
            (0.9, 0.796_908_212_422_832_2, 0.203_091_787_577_167_86),
            (1.3, 0.934_007_944_940_652_4, 0.065_992_055_059_347_55),
            (2.277, 0.998_718_828_452_629_4, 0.001_281_171_547_370_588_7),
            (2.86, 0.999_947_598_826_955_6, 5.240_117_304_439_781e-5),
            (4.5, 0.999_999_999_803_383_9, 1.966_160_441_542_887_3e-10),
            (6.0, 1.0, 2.151_973_671_249_891_6e-17),
        ] {
            assert!((erf(x) - low).abs() < 3e-15, "{x}");
            assert!((erfc(x) / high - 1.0).abs() < 2e-14, "{x}");
        }
        assert!((erfc(20.0) / 5.395_865_611_607_900_7e-176 - 1.0).abs() < 1e-12);
    }

    #[test]
    fn the_quantile_inverts_the_distribution_function() {
        for p in [1e-300, 1e-100, 1e-20, 1e-9, 1e-4, 0.025, 0.074, 0.076, 0.3, 0.5, 0.7, 0.975, 0.9999] {
            let z = normal_quantile(p);
            let tails = normal_tails(z);
            assert!((tails.lower() / p - 1.0).abs() < 1e-11, "{p} {z}");
        }
        assert!((normal_quantile(0.975) - 1.959_963_984_540_054).abs() < 1e-14);
        assert!((normal_tails(-40.0).ln_lower + 804.608_442_13).abs() < 1e-6);
    }
}
