//! How well predicted positions fit the one that was recorded: in their 90 % region, and the density there.
//!
//! The predicted positions of n trials are taken as a sample of a normal law of the plane. Another position of that law lies in the
//! region around the mean m with probability 0.9, where (x - m) S^-1 (x - m) <= (1 + 1/n) 2 (n - 1)/(n - 2) F and S is the
//! covariance of the sample (Hotelling 1931; the quantile F of F(2, n - 2) is (n - 2)/2 (0.1^(-2/(n - 2)) - 1)). With many trials
//! the bound is that of the chi-squared law, 4.605.
//!
//! Parameters are fitted by the predictive density: that of another position given the sample, if nothing was known of the law
//! before. It is Student's t law of the plane with n - 2 degrees of freedom, the centre m and the scale
//! (1 + 1/n) (n - 1)/(n - 2) S (Geisser 1993, section 9.1). It allows for the number of trials, and its logarithm is a proper score.

use crate::base::geometry::Vec2;
use crate::base::math;
use std::f64::consts::PI;

/// Seconds after which positions are compared.
pub const HORIZONS: [f64; 3] = [1.0, 2.0, 4.8];
/// Probability of the region.
pub const REGION: f64 = 0.9;
/// Fewer positions have no region.
const FEWEST: usize = 5;
/// Added to the variances, m^2: recorded positions are no more exact than 1 cm.
const EXACTNESS: f64 = 1e-4;

/// A recorded position among predicted ones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    /// Whether it is in the region.
    pub inside: bool,
    /// Square of its distance from the middle of the region, in units of the region: 1 at the rim.
    pub score: f64,
    /// Logarithm of the density of the normal law there, 1/m^2.
    pub log_density: f64,
    /// Logarithm of the predictive density there, 1/m^2.
    pub predictive: f64,
}

impl Fit {
    /// Of a recorded position among predicted ones; `None` where they are too few.
    pub fn of(predicted: &[Vec2], recorded: Vec2) -> Option<Self> {
        let n = predicted.len() as f64;
        if predicted.len() < FEWEST {
            return None;
        }
        let mean = predicted.iter().sum::<Vec2>() / n;
        let moment = |of: fn(Vec2) -> f64| predicted.iter().map(|p| of(p - mean)).sum::<f64>() / (n - 1.0);
        let (xx, yy) = (moment(|d| d.x * d.x) + EXACTNESS, moment(|d| d.y * d.y) + EXACTNESS);
        let xy = moment(|d| d.x * d.y);
        let (determinant, off) = (xx * yy - xy * xy, recorded - mean);
        let square = (yy * off.x * off.x - 2.0 * xy * off.x * off.y + xx * off.y * off.y) / determinant;
        let outside = math::exp(-2.0 / (n - 2.0) * math::ln(1.0 - REGION)) - 1.0;
        let scale = (1.0 + 1.0 / n) * (n - 1.0) / (n - 2.0);
        let rim = (1.0 + 1.0 / n) * (n - 1.0) * outside;
        Some(Self {
            inside: square <= rim,
            score: square / rim,
            log_density: -0.5 * square - 0.5 * math::ln(determinant) - math::ln(2.0 * PI),
            predictive: -0.5 * n * math::ln_1p(square / scale / (n - 2.0))
                - math::ln(scale)
                - 0.5 * math::ln(determinant)
                - math::ln(2.0 * PI),
        })
    }
}

#[cfg(test)]
#[allow(clippy::disallowed_methods, reason = "the platform's functions are the reference")]
mod tests {
    use super::*;
    use crate::base::random::{Purpose, Stream, TrialKey};

    /// Normal positions, sheared.
    fn positions(index: u64, count: u32) -> Vec<Vec2> {
        let stream = Stream::of(TrialKey { seed: 3, index, branch: 0 }, 1, Purpose::Test);
        let one = |k: u32| {
            let [u, v] = stream.uniform_pair(k);
            let (r, a) = ((-2.0 * u.ln()).sqrt(), 2.0 * PI * v);
            Vec2::new(1.0 + 2.0 * r * a.cos() + r * a.sin(), 0.5 * r * a.sin())
        };
        (0..count).map(one).collect()
    }

    #[test]
    fn the_region_holds_nine_of_ten_further_positions_whatever_the_number_of_trials() {
        for count in [6, 20, 200] {
            let inside = (0..4000).filter(|k| {
                let all = positions(*k, count + 1);
                Fit::of(&all[1..], all[0]).unwrap().inside
            });
            let share = inside.count() as f64 / 4000.0;
            // The standard error is 0.0047.
            assert!((share - 0.9).abs() < 0.019, "{share} of {count}");
        }
    }

    #[test]
    fn the_predictive_density_integrates_to_one_and_tends_to_the_normal_one() {
        for count in [6, 20] {
            let all = positions(1, count);
            let cell = |k: i32| 0.1 * (f64::from(k) + 0.5);
            let mut sum = 0.0;
            for i in -600..600 {
                for j in -300..300 {
                    sum += 0.01 * Fit::of(&all, Vec2::new(cell(i), cell(j))).unwrap().predictive.exp();
                }
            }
            assert!((sum - 1.0).abs() < 4e-3, "{sum} of {count}");
        }
        let many = Fit::of(&positions(2, 20_000), Vec2::new(2.0, 0.5)).unwrap();
        assert!((many.predictive - many.log_density).abs() < 1e-3, "{many:?}");
    }

    #[test]
    fn the_density_is_that_of_the_normal_law() {
        let square =
            [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0), (0.0, 0.0)].map(|(x, y)| Vec2::new(x, y));
        let variance: f64 = 1.0 + 1e-4;
        let wanted = -(2.0 * PI * variance).ln() - 0.5 * (0.25 + 4.0) / variance;
        let found = Fit::of(&square, Vec2::new(0.5, 2.0)).unwrap();
        assert!((found.log_density - wanted).abs() < 1e-12, "{found:?}, wanted {wanted}");
        assert_eq!(Fit::of(&square[..4], Vec2::zeros()), None);
    }
}
