//! The signed rank test of Wilcoxon (1945) for paired values: is the law of the differences symmetric about 0? Differences
//! of 0 are left out, ties share their mean rank. For small samples p is exact given the ranks, for large ones it
//! comes from the normal law with the variance that ties leave and a correction for continuity.

use super::summary::quantile;
use crate::base::special::normal::normal_tails;

/// Up to so many differences p is exact.
const MOST_EXACT: usize = 100;

/// Result of the test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SignedRank {
    /// Number of pairs.
    pub pairs: usize,
    /// Pairs without a difference, which the test leaves out.
    pub equal: usize,
    /// Median difference, of all pairs.
    pub median: f64,
    /// Sum of the ranks of positive differences.
    pub w: f64,
    /// Probability, on both sides, of a sum at least as far from its mean, if the law is symmetric about 0.
    pub p: f64,
}

/// Tests differences of pairs.
pub fn signed_rank(differences: &[f64]) -> SignedRank {
    let mut sorted = differences.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    let median = quantile(&sorted, 0.5);
    sorted.retain(|difference| *difference != 0.0);
    sorted.sort_unstable_by(|x, y| x.abs().total_cmp(&y.abs()));
    // Twice the ranks, which are whole numbers: of ties at the places k + 1 .. k + size their sum of first and last.
    let (mut ranks, mut w, mut ties) = (Vec::with_capacity(sorted.len()), 0, 0.0);
    for group in sorted.chunk_by(|x, y| x.abs() == y.abs()) {
        let (before, size) = (ranks.len(), group.len());
        let rank = 2 * before + size + 1;
        w += rank * group.iter().filter(|difference| **difference > 0.0).count();
        ranks.resize(before + size, rank);
        ties += (size * size * size - size) as f64;
    }
    let p = if ranks.len() <= MOST_EXACT { exact(&ranks, w) } else { normal(ranks.len() as f64, w, ties) };
    let equal = differences.len() - ranks.len();
    SignedRank { pairs: differences.len(), equal, median, w: 0.5 * w as f64, p }
}

/// Both tails of the law of the sum, in which each rank counts with probability 1/2.
fn exact(ranks: &[usize], w: usize) -> f64 {
    let mut law = vec![0.0; ranks.iter().sum::<usize>() + 1];
    law[0] = 1.0;
    for &rank in ranks {
        for sum in (0..law.len()).rev() {
            let with = if sum >= rank { law[sum - rank] } else { 0.0 };
            law[sum] = 0.5 * (law[sum] + with);
        }
    }
    let lower: f64 = law[..=w].iter().sum();
    let upper: f64 = law[w..].iter().sum();
    (2.0 * lower.min(upper)).min(1.0)
}

fn normal(n: f64, w: usize, ties: f64) -> f64 {
    let mean = 0.25 * n * (n + 1.0);
    let variance = n * (n + 1.0) * (2.0 * n + 1.0) / 24.0 - ties / 48.0;
    let off = ((0.5 * w as f64 - mean).abs() - 0.5).max(0.0);
    (2.0 * normal_tails(off / variance.sqrt()).upper()).min(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn p_is_that_of_scipy() {
        // scipy.stats.wilcoxon(d, method="exact") and, of 150 differences, wilcoxon(d, correction=True, method="approx")
        let small = [1.1, -0.4, 2.3, 0.7, -1.9, 3.1, 0.2, 1.6, -0.1, 2.8, 0.9, 1.3];
        let found = signed_rank(&small);
        assert_eq!((found.pairs, found.equal, found.w), (12, 0, SMALL.0));
        assert!((found.p - SMALL.1).abs() < 1e-14, "{}", found.p);
        let large: Vec<f64> = (0..150).map(|k| f64::from(k * 37 % 101) - 42.0).collect();
        let found = signed_rank(&large);
        assert_eq!(found.w, LARGE.0);
        assert!((found.p / LARGE.1 - 1.0).abs() < 1e-12, "{}", found.p);
    }

    const SMALL: (f64, f64) = (65.0, 0.042_480_468_75);
    const LARGE: (f64, f64) = (7165.5, 0.002_793_084_775_695_733);

    #[test]
    fn p_with_ties_is_the_share_of_the_signs() {
        let sizes = [1.0, 1.0, 2.0, 2.0, 2.0, 3.5, 4.0, 4.0];
        let signed = |signs: u32| -> Vec<f64> {
            (0..8).map(|k| if signs >> k & 1 == 1 { sizes[k] } else { -sizes[k] }).collect()
        };
        let all: Vec<f64> = (0..256).map(|signs| signed_rank(&signed(signs)).w).collect();
        for signs in [0b1111_1111, 0b0011_0111, 0b1010_1010] {
            let found = signed_rank(&signed(signs));
            let share = |is: &dyn Fn(f64) -> bool| all.iter().filter(|w| is(**w)).count() as f64 / 256.0;
            let (below, above) = (share(&|w| w <= found.w), share(&|w| w >= found.w));
            assert!((found.p - (2.0 * below.min(above)).min(1.0)).abs() < 1e-12, "{found:?}");
        }
    }

    #[test]
    fn equal_pairs_are_left_out() {
        let found = signed_rank(&[0.0, 1.0, -0.0, 2.0]);
        assert_eq!((found.pairs, found.equal, found.median, found.w), (4, 2, 0.5, 3.0));
        assert_eq!(found.p, 0.5);
        assert_eq!(signed_rank(&[0.0; 3]).p, 1.0);
        assert_eq!(signed_rank(&[]).p, 1.0);
    }
}
