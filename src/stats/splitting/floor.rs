//! A lower bound of the mean of independent estimates that are never negative: what splitting can certify.
//!
//! For a mean of at most m, the capital of who bets the share c on each estimate z, multiplied by 1 + c (z / m - 1)
//! each time, does not grow on average; that it ever is 1 / delta times what it was has at most probability delta (Ville; one
//! side of Waudby-Smith and Ramdas 2024, which needs no upper end of the range). The bound is the largest m for which
//! it is. Nothing is assumed but that the estimates are independent and unbiased.

use crate::stats::bisection;

/// The shares among which the capital is spread at the beginning.
const SHARES: [f64; 4] = [0.1, 0.3, 0.6, 0.9];

/// The capital after all bets, for a mean of `m`.
fn capital(estimates: &[f64], m: f64) -> f64 {
    let one = |share: f64| estimates.iter().map(|z| 1.0 + share * (z / m - 1.0)).product::<f64>();
    SHARES.iter().map(|share| one(*share)).sum::<f64>() / SHARES.len() as f64
}

/// A number that the mean is not below, with an error of at most `delta`; 0 if there is no evidence.
pub fn floor(estimates: &[f64], delta: f64) -> f64 {
    let most = estimates.iter().copied().fold(0.0, |x: f64, y| if y > x { y } else { x });
    if most <= 0.0 || estimates.iter().any(|z| !(*z >= 0.0 && z.is_finite())) {
        return 0.0;
    }
    // Above the largest estimate all capital is lost; it falls as m rises.
    let (low, _) = bisection::halved(0.0, most, 200, |m| capital(estimates, m) >= 1.0 / delta);
    // On the safe side of rounding.
    low * (1.0 - 1e-9)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_estimates_give_a_bound_below_them() {
        // With all on the largest share it is 0.9 (r - 1) + 1 = 20^(1/20) at best, r = 1.179.
        let low = floor(&[2e-6; 20], 0.05);
        assert!(low < 2e-6 / 1.179 && low > 2e-6 / 1.26, "{low}");
        assert!(floor(&[2e-6; 200], 0.05) > 0.97 * 2e-6);
    }

    #[test]
    fn without_evidence_it_is_nothing() {
        assert_eq!(floor(&[0.0; 20], 0.05), 0.0);
        assert_eq!(floor(&[], 0.05), 0.0);
        assert_eq!(floor(&[1.0, f64::NAN], 0.05), 0.0);
        // One run in twenty: hardly any.
        let mut one = [0.0; 20];
        one[7] = 1.0;
        let low = floor(&one, 0.05);
        assert!(low > 0.0 && low < 0.05, "{low}");
    }
}
