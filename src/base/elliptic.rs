//! Elliptic functions of parameter 1/2 in the form of Gauss: the lemniscate sine and its inverse.
//!
//! `arcsl(y)` is the integral of dt / sqrt(1 - t^4) from 0 to y, and `sl` its inverse (DLMF 22.18). With them the
//! incomplete integral is F(chi | 1/2) = sqrt(2) (QUARTER - arcsl(cos chi)), and the Jacobi function is
//! cn(t | 1/2) = sl(QUARTER - t / sqrt(2)). Both use their power series up to half of the quarter period, and beyond
//! it the identity sl(QUARTER - z)^2 = (1 - sl(z)^2) / (1 + sl(z)^2).

/// The quarter period of `sl`, K(1/2) / sqrt(2): half of the lemniscate constant.
pub const QUARTER: f64 = 1.311_028_777_146_059_9;

/// Up to this square of its argument `arcsl` uses its series: sqrt(2) - 1, the square of sl(QUARTER / 2).
const HALF_WAY: f64 = 0.414_213_562_373_095_03;

/// Coefficients of y^(4 n + 1) in `arcsl`. At the end of the range the next term is below 1e-18.
const INVERSE: [f64; 20] = {
    let mut terms = [1.0; 20];
    let (mut n, mut product) = (1, 1.0);
    while n < 20 {
        let k = n as f64;
        product *= (2.0 * k - 1.0) / (2.0 * k);
        terms[n] = product / (4.0 * k + 1.0);
        n += 1;
    }
    terms
};

/// Coefficients of z^(4 n + 1) in `sl`, from its equation y'' = -2 y^3. At the end of the range the next term is below 1e-18.
const SINE: [f64; 11] = {
    let mut terms = [1.0; 11];
    let mut n = 1;
    while n < 11 {
        let mut cube = 0.0;
        let mut i = 0;
        while i < n {
            let mut j = 0;
            while i + j < n {
                cube += terms[i] * terms[j] * terms[n - 1 - i - j];
                j += 1;
            }
            i += 1;
        }
        let k = n as f64;
        terms[n] = -2.0 * cube / ((4.0 * k + 1.0) * (4.0 * k));
        n += 1;
    }
    terms
};

/// The sum of a power series. Even and odd terms form two chains, which a processor adds side by side.
#[inline(always)]
fn series<const N: usize>(terms: &[f64; N], x: f64) -> f64 {
    let square = x * x;
    let (mut even, mut odd) = (0.0, 0.0);
    for (n, term) in terms.iter().enumerate().rev() {
        if n % 2 == 0 {
            even = even * square + term;
        } else {
            odd = odd * square + term;
        }
    }
    even + x * odd
}

/// `arcsl(y)` from `square`, y^2 in [0, 1], and `complement`, 1 - y^2. The caller often knows the complement better than the
/// difference does. Relative error about 5e-16.
pub fn arc_lemniscate_sine(square: f64, complement: f64) -> f64 {
    if square <= HALF_WAY {
        return square.sqrt() * series(&INVERSE, square * square);
    }
    let mirrored = complement / (1.0 + square);
    QUARTER - mirrored.sqrt() * series(&INVERSE, mirrored * mirrored)
}

/// `sl(z)` and its derivative sqrt(1 - sl(z)^4) for z in [0, QUARTER]. Relative errors about 5e-16; beyond the range, the
/// values at its nearest end.
pub fn lemniscate_sine(z: f64) -> (f64, f64) {
    let sine = |z: f64| {
        let z2 = z * z;
        z * series(&SINE, z2 * z2)
    };
    if z <= 0.5 * QUARTER {
        let y = sine(z.max(0.0));
        let square = y * y;
        return (y, (1.0 - square * square).sqrt());
    }
    let mirrored = sine((QUARTER - z).max(0.0));
    let square = mirrored * mirrored;
    (((1.0 - square) / (1.0 + square)).sqrt(), 2.0 * mirrored / (1.0 + square))
}

#[cfg(test)]
#[allow(clippy::excessive_precision, reason = "values of 22 digits")]
mod tests {
    use super::*;

    /// y, arcsl(y) of 30-digit arithmetic.
    const VALUES: [(f64, f64); 8] = [
        (1e-9, 1.000_000_000_000_000_062_282e-9),
        (0.1, 0.100_001_000_041_669_076_225_1),
        (0.4, 0.401_035_086_801_934_293_772),
        (0.6435, 0.655_410_837_543_198_227_846_9),
        (0.6437, 0.655_630_575_180_223_009_328_5),
        (0.9, 0.986_675_704_681_559_836_940_7),
        (0.999, 1.279_398_092_675_912_974_728),
        (0.999_999_999, 1.310_997_154_369_897_492_349),
    ];

    #[test]
    fn inverse_meets_the_values() {
        for (y, z) in VALUES {
            let found = arc_lemniscate_sine(y * y, (1.0 - y) * (1.0 + y));
            assert!((found / z - 1.0).abs() < 1e-15, "{y}: {found}");
        }
        assert_eq!(arc_lemniscate_sine(1.0, 0.0), QUARTER);
        assert_eq!(arc_lemniscate_sine(0.0, 1.0), 0.0);
        // The arc length of the whole lemniscate, against the complete integral.
        let complete = 1.854_074_677_301_371_918_433_850_347;
        assert!((QUARTER * 2f64.sqrt() - complete).abs() < 1e-15);
    }

    #[test]
    fn sine_is_the_inverse_and_keeps_its_identities() {
        for (y, z) in VALUES {
            let (found, derivative) = lemniscate_sine(z);
            assert!((found / y - 1.0).abs() < 1e-15, "{z}: {found}");
            let expected = ((1.0 - y) * (1.0 + y) * (1.0 + y * y)).sqrt();
            // Where the derivative is small, an ulp of z moves it by an ulp of 1.
            assert!((derivative - expected).abs() < 1e-15, "{z}: {derivative}");
        }
        assert_eq!(lemniscate_sine(QUARTER), (1.0, 0.0));
        assert_eq!(lemniscate_sine(-1.0), (0.0, 1.0));
    }

    #[test]
    fn duplication_holds_throughout() {
        // sl(2 z) = 2 sl(z) sl'(z) / (1 + sl(z)^4)
        for k in 0..=2000 {
            let z = 0.5 * QUARTER * f64::from(k) / 2000.0;
            let (y, slope) = lemniscate_sine(z);
            let twice = 2.0 * y * slope / (1.0 + y * y * y * y);
            assert!((lemniscate_sine(2.0 * z).0 - twice).abs() < 5e-16, "{z}");
        }
    }
}
