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
        Self { kernel: square_root(SMatrix::from_fn(|i, j| covariance[(i, j)] * factor)), steps }
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
