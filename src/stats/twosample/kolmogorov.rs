//! The two-sample test of Kolmogorov and Smirnov. The exact p counts the paths on which a shuffled pooled sample would come
//! as far from the diagonal (Hodges 1957), between equal values nowhere (Schroeer and Trenkler 1995); so it holds with
//! ties too. Large samples use the limit of Kolmogorov.

use crate::base::math;
use crate::base::special::normal::normal_cdf;

/// Up to so many pairs of values p is exact: the count takes as many steps.
const MOST_PAIRS: usize = 25_000_000;

/// Result of the test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KolmogorovSmirnov {
    /// Largest difference between the two empirical distribution functions.
    pub d: f64,
    /// Probability of a difference at least as large, if both samples have one law.
    pub p: f64,
}

/// Tests whether numbers come from one law. NaN where a sample is empty.
pub fn kolmogorov_smirnov(a: &[f64], b: &[f64]) -> KolmogorovSmirnov {
    let (n, m) = (a.len(), b.len());
    if n == 0 || m == 0 {
        return KolmogorovSmirnov { d: f64::NAN, p: f64::NAN };
    }
    let mut pooled: Vec<(f64, bool)> =
        a.iter().map(|x| (*x, true)).chain(b.iter().map(|x| (*x, false))).collect();
    pooled.sort_unstable_by(|x, y| x.0.total_cmp(&y.0));
    // Whether the distribution functions may be compared after so many values: not between equal ones.
    let ends: Vec<bool> =
        (0..=n + m).map(|k| k > 0 && pooled.get(k).is_none_or(|next| next.0 != pooled[k - 1].0)).collect();
    // In whole numbers, n m times the difference.
    let off = |i: usize, j: usize| (i * m).abs_diff(j * n);
    let (mut i, mut worst) = (0, 0);
    for (k, (_, is_first)) in pooled.iter().enumerate() {
        i += usize::from(*is_first);
        if ends[k + 1] {
            worst = worst.max(off(i, k + 1 - i));
        }
    }
    let d = worst as f64 / (n * m) as f64;
    if n * m > MOST_PAIRS {
        let size = n as f64 * m as f64 / (n + m) as f64;
        return KolmogorovSmirnov { d, p: limit(size.sqrt() * d) };
    }
    // The probability that a path to (i, j) has been that far off; its last step came from the left with i / (i + j).
    let far = |i: usize, j: usize| ends[i + j] && off(i, j) >= worst;
    let mut p = vec![0.0; m + 1];
    for i in 0..=n {
        for j in 0..=m {
            let share = if i + j == 0 { 0.0 } else { i as f64 / (i + j) as f64 };
            let from_below = if j == 0 { 0.0 } else { p[j - 1] };
            p[j] = if far(i, j) { 1.0 } else { share * p[j] + (1.0 - share) * from_below };
        }
    }
    KolmogorovSmirnov { d, p: p[m] }
}

/// Tests whether numbers have a normal law with their own mean and standard deviation: the largest difference of both distribution
/// functions, and p of Kolmogorov's limit, which is too large since mean and deviation are those of the numbers (Lilliefors
/// 1967): where it is small, the law is not normal. NaN for fewer than two different numbers.
pub fn normality(values: &[f64]) -> KolmogorovSmirnov {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let deviation = (values.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / (n - 1.0)).sqrt();
    if deviation.is_nan() || deviation <= 0.0 {
        return KolmogorovSmirnov { d: f64::NAN, p: f64::NAN };
    }
    let mut sorted = values.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    let off = |(k, x): (usize, &f64)| {
        let below = normal_cdf((x - mean) / deviation);
        (below - k as f64 / n).abs().max(((k + 1) as f64 / n - below).abs())
    };
    let d = sorted.iter().enumerate().map(off).fold(0.0, f64::max);
    KolmogorovSmirnov { d, p: limit(n.sqrt() * d) }
}

/// P(K > x) of Kolmogorov's law: 2 Σ (-1)^(k - 1) exp(-2 k^2 x^2).
fn limit(x: f64) -> f64 {
    // Below, it is 1 to 12 digits, and the sum converges slowly.
    if x < 0.2 {
        return 1.0;
    }
    let mut sum = 0.0;
    for k in (1..=40).rev() {
        let term = math::exp(-2.0 * f64::from(k * k) * x * x);
        sum += if k % 2 == 1 { term } else { -term };
    }
    (2.0 * sum).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normality_is_that_of_the_definition() {
        // By the error function and the series of Kolmogorov in other code; scipy.stats.kstest with the mean and the deviation.
        const NORMAL: (f64, f64) = (0.139_258_497_302_253_76, 0.194_965_300_470_516_7);
        let numbers: Vec<f64> = (0..60).map(|k| f64::from(k * k % 47) * 0.1).collect();
        let found = normality(&numbers);
        assert!((found.d - NORMAL.0).abs() < 1e-12 && (found.p - NORMAL.1).abs() < 1e-9, "{found:?}");
        assert!(normality(&[1.0, 1.0, 1.0]).d.is_nan() && normality(&[]).d.is_nan());
    }

    #[test]
    fn p_is_that_of_scipy() {
        // scipy.stats.ks_2samp(a, b, method="exact")
        let (a, b) = ([0.1, 0.4, 0.9, 1.3, 2.2], [0.7, 1.1, 1.9, 2.5, 3.3, 3.9, 4.1]);
        let steps = |count: u32, from: f64| (0..count).map(|k| f64::from(k) + from).collect::<Vec<_>>();
        for (a, b, d, p) in [
            (a.to_vec(), b.to_vec(), 4.0 / 7.0, 0.237_373_737_373_737_38),
            (a.map(|x| x + 2.05).to_vec(), b.to_vec(), 15.0 / 35.0, 0.545_454_545_454_545_4),
            (steps(20, 0.0), steps(30, 9.5), 2.0 / 3.0, 1.622_329_255_244_424e-5),
        ] {
            let found = kolmogorov_smirnov(&a, &b);
            assert!((found.d - d).abs() < 1e-14 && (found.p / p - 1.0).abs() < 1e-10, "{found:?} {d} {p}");
        }
        // scipy.special.kolmogorov
        for (x, p) in LIMIT {
            assert!((limit(x) - p).abs() < 1e-14, "{x} {}", limit(x));
        }
        assert!(kolmogorov_smirnov(&[], &[1.0]).p.is_nan());
        assert_eq!(kolmogorov_smirnov(&[1.0; 5], &[1.0; 7]), KolmogorovSmirnov { d: 0.0, p: 1.0 });
    }

    const LIMIT: [(f64, f64); 5] = [
        (0.3, 0.999_990_694_198_665_5),
        (0.5, 0.963_945_243_664_875_1),
        (1.0, 0.269_999_671_677_354_56),
        (2.0, 6.709_252_557_796_953e-4),
        (3.0, 3.045_995_948_942_526e-8),
    ];

    /// With ties p is the share of all divisions of the pooled sample whose difference is as large.
    #[test]
    fn p_with_ties_is_the_share_of_the_divisions() {
        let pooled = [1.0, 1.0, 2.0, 2.0, 2.0, 3.0, 4.0, 4.0, 5.0];
        let split = |chosen: u32| {
            let side =
                |one| (0..9).filter(|k| (chosen >> k & 1 == 1) == one).map(|k| pooled[k]).collect::<Vec<_>>();
            (side(true), side(false))
        };
        for observed in [0b0_0000_1111, 0b1_0100_0101, 0b0_1010_0110] {
            let (a, b) = split(observed);
            let found = kolmogorov_smirnov(&a, &b);
            let all: Vec<f64> = (0..512_u32)
                .filter(|c| c.count_ones() == 4)
                .map(split)
                .map(|(a, b)| kolmogorov_smirnov(&a, &b).d)
                .collect();
            let share = all.iter().filter(|d| **d >= found.d - 1e-12).count() as f64 / all.len() as f64;
            assert!((found.p - share).abs() < 1e-12, "{found:?} {share}");
        }
    }
}
