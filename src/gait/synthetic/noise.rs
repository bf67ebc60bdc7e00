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

#[cfg(test)]
#[allow(clippy::disallowed_methods, reason = "the platform's functions are the reference")]
mod tests {
    use super::*;
    use crate::base::math;
    use crate::base::random::{Purpose, Stream, TrialKey};
    use crate::gait::step::{Foot, SPANS, Shape, Stance};
    use crate::gait::synthetic::{Person, SyntheticGait};

    fn stream(index: u64) -> Stream {
        Stream::of(TrialKey { seed: 6, index, branch: 0 }, 0, Purpose::Test)
    }

    fn straight(count: u32, index: u64) -> Vec<Shape> {
        let gait = SyntheticGait::of(Person { height: 1.72, speed: 1.34, width: 0.155 });
        let (mut stance, mut foot) = (Stance::default(), Foot::Left);
        let mut next = |number| {
            stance = gait.toward(&stance, foot, 1.0, 0.0, Draws::of(stream(index), number, 0));
            foot = foot.other();
            stance.last.unwrap().1
        };
        (0..count).map(&mut next).collect()
    }

    fn mean_and_cv(values: &[f64]) -> (f64, f64) {
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let square = values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / (n - 1.0);
        (mean, square.sqrt() / mean)
    }

    /// Exponent of detrended fluctuation analysis (Peng et al. 1994): profiles detrended by lines in windows of 4 to n/4.
    fn fluctuation_exponent(values: &[f64]) -> f64 {
        let n = values.len();
        let mean = values.iter().sum::<f64>() / n as f64;
        let profile: Vec<f64> = values
            .iter()
            .scan(0.0, |sum, v| {
                *sum += v - mean;
                Some(*sum)
            })
            .collect();
        let (mut points, mut window) = (Vec::new(), 4.0f64);
        while window <= n as f64 / 4.0 {
            let size = window as usize;
            let mut squares = 0.0;
            for part in profile.chunks_exact(size) {
                let middle = (size as f64 - 1.0) / 2.0;
                let level = part.iter().sum::<f64>() / size as f64;
                let at = |k: usize| k as f64 - middle;
                let slope = part.iter().enumerate().map(|(k, y)| at(k) * y).sum::<f64>()
                    / (0..size).map(|k| at(k) * at(k)).sum::<f64>();
                squares +=
                    part.iter().enumerate().map(|(k, y)| (y - level - slope * at(k)).powi(2)).sum::<f64>();
            }
            points.push((math::ln(size as f64), 0.5 * math::ln(squares / ((n / size) * size) as f64)));
            window *= 1.3;
        }
        let m = points.len() as f64;
        let (x, y) =
            (points.iter().map(|p| p.0).sum::<f64>() / m, points.iter().map(|p| p.1).sum::<f64>() / m);
        points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum::<f64>()
            / points.iter().map(|p| (p.0 - x).powi(2)).sum::<f64>()
    }

    #[test]
    fn white_noise_has_an_exponent_of_one_half() {
        let white: Vec<f64> = (0..4000).map(|k| stream(0).normal_pair(k)[0]).collect();
        assert!((fluctuation_exponent(&white) - 0.5).abs() < 0.07, "{}", fluctuation_exponent(&white));
    }

    #[test]
    fn stride_times_have_long_range_correlation() {
        let mut exponents = Vec::new();
        for index in 0..20 {
            let steps = straight(1201, 100 + index);
            let strides: Vec<f64> =
                steps[1..].chunks_exact(2).map(|pair| pair[0].duration + pair[1].duration).collect();
            exponents.push(fluctuation_exponent(&strides));
        }
        let (mean, _) = mean_and_cv(&exponents);
        assert!((0.6..1.0).contains(&mean), "{mean}");
    }

    #[test]
    fn noise_has_its_spread_from_the_first_step_on() {
        let cv = |number: usize, of: fn(&Shape) -> f64| {
            let values: Vec<f64> =
                (0..4000).map(|index| of(&straight(number as u32 + 1, index)[number])).collect();
            mean_and_cv(&values).1
        };
        let length = |s: &Shape| s.landmarks[SPANS - 1].norm();
        // The speed changes the length with its power 0.5 and the time with -0.5.
        let (of_length, of_time) = ((0.5f64 * 2.3).hypot(1.5) / 100.0, (0.5f64 * 2.3).hypot(2.0) / 100.0);
        for number in [0, 1, 20] {
            let (l, t) = (cv(number, length), cv(number, |s| s.duration));
            assert!((l / of_length - 1.0).abs() < 0.06 && (t / of_time - 1.0).abs() < 0.06);
        }
    }
}
