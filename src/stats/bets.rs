//! Mixtures of bets: their sizes, and the capital of a mixture from that of each bet.

use crate::base::math;

/// Bets from the least to the most, in geometric steps.
pub(super) fn geometric<const N: usize>(least: f64, most: f64) -> [f64; N] {
    std::array::from_fn(|k| {
        let part = k as f64 / (N - 1) as f64;
        math::exp(math::ln(least) + part * math::ln(most / least))
    })
}

/// The logarithm of the mean of exponentials.
pub(super) fn log_mean<const N: usize>(logs: &[f64; N]) -> f64 {
    let most = logs.iter().fold(f64::NEG_INFINITY, |a, b| math::at_least(a, *b));
    let sum: f64 = logs.iter().map(|log| math::exp(log - most)).sum();
    most + math::ln(sum / N as f64)
}
