//! Signals of motion, one value per frame: speed, Gaussian smoothing, percentiles.

use crate::base::math::exp;

/// Half the time over which a speed is taken, s; at least a frame.
const HALF: f64 = 0.02;

/// The speed of a point, m/s, from the frames `HALF` before and after each frame.
pub(super) fn speed(points: &[[f64; 3]], fps: f64) -> Vec<f64> {
    let half = ((HALF * fps).round() as usize).max(1);
    let last = points.len().saturating_sub(1);
    let at = |k: usize| {
        let (a, b) = (k.saturating_sub(half), (k + half).min(last));
        let square: f64 = (0..3)
            .map(|axis| (points[b][axis] - points[a][axis]) * (points[b][axis] - points[a][axis]))
            .sum();
        if a < b { square.sqrt() * fps / (b - a) as f64 } else { 0.0 }
    };
    (0..points.len()).map(at).collect()
}

/// Gaussian smoothing with a standard deviation in frames, cut at four of them; beyond its ends the signal is mirrored (as
/// `gaussian_filter1d` of scipy does).
pub(super) fn smoothed(signal: &[f64], sigma: f64) -> Vec<f64> {
    let (n, radius) = (signal.len(), (4.0 * sigma + 0.5) as usize);
    let weights: Vec<f64> = (0..=radius)
        .map(|k| {
            let t = k as f64 / sigma;
            exp(-0.5 * t * t)
        })
        .collect();
    let total: f64 = weights.iter().sum::<f64>() * 2.0 - 1.0;
    let mirrored = |at: usize| {
        let at = at % (2 * n);
        signal[if at < n { at } else { 2 * n - 1 - at }]
    };
    // A multiple of the period keeps the index above 0.
    let shift = 2 * n * (radius / (2 * n).max(1) + 1);
    let at = |k: usize| {
        let sides = (1..=radius).map(|d| weights[d] * (mirrored(k + shift - d) + mirrored(k + d)));
        (signal[k] + sides.sum::<f64>()) / total
    };
    (0..n).map(at).collect()
}

/// The value below which a share of the signal lies, interpolated between neighbours; 0 of an empty signal.
pub(super) fn percentile(signal: &[f64], share: f64) -> f64 {
    let mut sorted = signal.to_vec();
    sorted.sort_by(f64::total_cmp);
    let at = share * sorted.len().saturating_sub(1) as f64;
    let (below, above) = (sorted.get(at as usize), sorted.get(at as usize + 1));
    let below = below.copied().unwrap_or_default();
    below + (above.copied().unwrap_or(below) - below) * at.fract()
}
