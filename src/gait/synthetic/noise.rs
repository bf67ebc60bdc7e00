//! Noise of steps: a quarter of its variance drifts slowly, a quarter fast, half is new with each step. The sum has the
//! long-range correlation of stride times (detrended fluctuation analysis: Hausdorff et al. 1995).

use crate::gait::step::Draws;

/// Correlation of the two drifting parts from step to step.
const KEPT: [f64; 2] = [0.97, 0.7];
/// `sqrt(1 - KEPT²)`: what is new in them.
const NEW: [f64; 2] = [0.243_104_915_622_864_85, 0.714_142_842_854_285];
/// Weights of the standard normal parts: slow, fast and white.
const WEIGHTS: [f64; 3] = [0.5, 0.5, std::f64::consts::FRAC_1_SQRT_2];

/// Standard deviations of speed, length and time relative to their means (Collins and Kuo 2013; the speed changes length
/// and time too), and of the heading, rad.
const SPREAD: [f64; 4] = [0.023, 0.015, 0.02, 0.020_943_951_023_931_95];

/// The noise of one step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Noise {
    /// Factors of speed, length and time.
    pub(super) factors: [f64; 3],
    /// How far the direction of walking has drifted, rad, after and before the step.
    pub(super) heading: [f64; 2],
    /// How far the step points aside, rad.
    pub(super) aside: f64,
    /// The drifting parts after the step: slow and fast of speed, length, time, heading; in standard deviations.
    pub(super) drift: [f64; 8],
}

impl Noise {
    /// Of the step after the one with these drifting parts; `None` for a first step, which draws them from their law in
    /// the long run. It uses the normal pairs `first` to `first + 5`.
    pub(super) fn after(drift: Option<&[f64; 8]>, draws: Draws, first: u32) -> Self {
        let mut new = [0.0; 8];
        for quantity in 0..4 {
            let normal = draws.normal_pair(first + quantity as u32);
            for part in 0..2 {
                let at = 2 * quantity + part;
                new[at] = drift.map_or(normal[part], |old| KEPT[part] * old[at] + NEW[part] * normal[part]);
            }
        }
        let [a, b] = draws.normal_pair(first + 4);
        let [c, d] = draws.normal_pair(first + 5);
        let drifted =
            |of: &[f64; 8], k: usize| SPREAD[k] * (WEIGHTS[0] * of[2 * k] + WEIGHTS[1] * of[2 * k + 1]);
        let factor = |k: usize, white: f64| 1.0 + drifted(&new, k) + SPREAD[k] * WEIGHTS[2] * white;
        Self {
            factors: [factor(0, a), factor(1, b), factor(2, c)],
            heading: [drifted(&new, 3), drift.map_or(0.0, |old| drifted(old, 3))],
            aside: SPREAD[3] * WEIGHTS[2] * d,
            drift: new,
        }
    }
}
