//! A Gaussian kernel density of first steps (Scott 1992; as scipy's `gaussian_kde`): in the space of the d components its kernel has
//! the covariance of the steps times n^(-2/(d+4)). What the components leave out stays that of the step.

use super::basis::{Basis, combined, moments, square_root};
use super::columns::{COLUMNS, Columns, plus};
use crate::base::math;
use crate::gait::Draws;
use nalgebra::SMatrix;
use serde::{Deserialize, Serialize};

/// A density of steps.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Density {
    /// The steps in scaled columns.
    pub(super) steps: Vec<Columns>,
    /// Vectors whose sum with standard normal factors is distributed as the kernel.
    pub(super) kernel: Vec<Columns>,
}

impl Density {
    /// That of some steps in scaled columns.
    pub(super) fn fit(steps: Vec<Columns>, basis: &Basis) -> Self {
        let spanned: Vec<Columns> = steps.iter().map(|s| basis.spanned(&basis.scores(s))).collect();
        let (_, covariance) = moments(&spanned);
        let (n, d) = (steps.len() as f64, basis.components() as f64);
        let factor = math::pow(n, -2.0 / (d + 4.0)) * n / (n - 1.0).max(1.0);
        Self { kernel: square_root(&SMatrix::from_fn(|i, j| covariance[(i, j)] * factor)), steps }
    }

    /// A step in scaled columns.
    pub(super) fn draw(&self, draws: Draws) -> Columns {
        let [choice, _] = draws.uniform_pair(0);
        let chosen = ((choice * self.steps.len() as f64) as usize).min(self.steps.len() - 1);
        plus(&self.steps[chosen], 1.0, &combined(&self.kernel, &normals(draws, 1)))
    }
}

/// Standard normal numbers from a draw on.
pub(super) fn normals(draws: Draws, from: u32) -> [f64; COLUMNS] {
    let mut numbers = [0.0; COLUMNS];
    for (pair, k) in numbers.chunks_mut(2).zip(from..) {
        pair.copy_from_slice(&draws.normal_pair(k)[..pair.len()]);
    }
    numbers
}

#[cfg(test)]
mod tests {
    #![allow(
        clippy::disallowed_methods,
        clippy::print_stdout,
        reason = "tests may use the platform's functions"
    )]

    use super::super::{columns, made};
    use super::*;
    use crate::base::random::{Purpose, Stream, TrialKey};
    use crate::base::special::normal_cdf;
    use crate::gait::{Foot, Phase};

    #[test]
    fn draws_have_the_density_of_its_definition() {
        let steps = made::steps(60, 8);
        let rows = |first: bool| -> Vec<Columns> {
            let of = steps.iter().filter(|s| s.foot == Foot::Left && (!first || s.phase == Phase::First));
            of.map(|s| columns::of(&s.shape)).collect()
        };
        let all = rows(false);
        let basis = Basis::fit(&all, moments(&all).0, 0.95, true).unwrap();
        let first: Vec<Columns> = rows(true).iter().map(|r| basis.scaled(r)).collect();
        let density = Density::fit(first.clone(), &basis);
        // A projection of the density is a mixture of normal distributions about the steps, with the covariance of the steps'
        // scores times n^(-2/(d+4)), d components.
        let direction: Columns =
            basis.spanned(&std::array::from_fn(|k| if k < 2 { 1.0 + k as f64 } else { 0.0 }));
        let along = |r: &Columns| r.iter().zip(&direction).map(|(a, b)| a * b).sum::<f64>();
        let (n, d) = (first.len() as f64, basis.components() as f64);
        let scores: Vec<f64> = first.iter().map(|s| along(&basis.spanned(&basis.scores(s)))).collect();
        let mean = scores.iter().sum::<f64>() / n;
        let variance = scores.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / (n - 1.0);
        let bandwidth = (variance * n.powf(-2.0 / (d + 4.0))).sqrt();
        let mixture = |x: f64| first.iter().map(|s| normal_cdf((x - along(s)) / bandwidth)).sum::<f64>() / n;
        let stream = Stream::of(TrialKey::default(), 5, Purpose::Test);
        let mut drawn: Vec<f64> =
            (0..20_000).map(|k| along(&density.draw(Draws::of(stream, k, 0)))).collect();
        drawn.sort_by(f64::total_cmp);
        let gap = |k: usize| ((k as f64 + 0.5) / drawn.len() as f64 - mixture(drawn[k])).abs();
        let largest = (0..drawn.len()).map(gap).fold(0.0, f64::max);
        // 1.95 / sqrt(20000): the 0.1 % point of Kolmogorov's distribution.
        assert!(largest < 0.0138, "{largest}");
    }
}
