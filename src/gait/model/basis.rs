//! Principal components of the steps of a foot (Agethen et al. 2018, section 4.1): rows centered and scaled, projected on the
//! directions that hold a share of the variance, scores scaled to variance one.

use super::columns::{COLUMNS, Columns};
use nalgebra::{DMatrix, SMatrix, SymmetricEigen};
use serde::{Deserialize, Serialize};

/// Scores of a step; those beyond the components are 0.
pub(super) type Scores = [f64; COLUMNS];

/// The components of the steps of a foot.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Basis {
    /// Mean row, m and s.
    pub(super) center: Columns,
    /// Unit of each column, m and s; 0 for a column that is left out.
    pub(super) scale: Columns,
    /// Directions of the components in scaled columns, orthonormal.
    pub(super) directions: Vec<Columns>,
    /// Standard deviation along each direction.
    pub(super) spread: Vec<f64>,
    /// Share of the variance of every component, those that were left out too.
    pub(super) explained: Vec<f64>,
}

impl Basis {
    /// That of some rows about a center, by singular values. `scaled` divides each column by its standard deviation; without
    /// it the landmarks stay in m and the duration is left out (as published). `None` where the rows do not differ.
    pub(super) fn fit(rows: &[Columns], center: Columns, variance: f64, scaled: bool) -> Option<Self> {
        let count = rows.len() as f64;
        let deviation = |k: usize| {
            let deviation =
                (rows.iter().map(|r| (r[k] - center[k]) * (r[k] - center[k])).sum::<f64>() / count).sqrt();
            if deviation > 1e-9 { deviation } else { 0.0 }
        };
        let scale: Columns =
            std::array::from_fn(|k| if scaled { deviation(k) } else { f64::from(k + 1 < COLUMNS) });
        let mut basis =
            Self { center, scale, directions: Vec::new(), spread: Vec::new(), explained: Vec::new() };
        let scaled_rows: Vec<Columns> = rows.iter().map(|r| basis.scaled(r)).collect();
        let svd = DMatrix::from_fn(rows.len(), COLUMNS, |i, k| scaled_rows[i][k]).svd(false, true);
        let transposed = svd.v_t?;
        let total: f64 = svd.singular_values.iter().map(|s| s * s).sum();
        if rows.len() < COLUMNS || total.is_nan() || total <= 1e-12 {
            return None;
        }
        basis.explained = svd.singular_values.iter().map(|s| s * s / total).collect();
        let mut held = 0.0;
        for (k, share) in basis.explained.iter().enumerate() {
            if held >= variance || *share < 1e-12 {
                break;
            }
            held += share;
            let direction: Columns = std::array::from_fn(|c| transposed[(k, c)]);
            // The sign of a direction is free: its largest entry is positive.
            let largest = direction.iter().copied().max_by(|a, b| a.abs().total_cmp(&b.abs()))?;
            basis.directions.push(direction.map(|x| if largest < 0.0 { -x } else { x }));
            basis.spread.push(svd.singular_values[k] / count.sqrt());
        }
        Some(basis)
    }

    /// Number of components.
    pub(super) fn components(&self) -> usize {
        self.directions.len()
    }

    /// A row in scaled columns about the center.
    pub(super) fn scaled(&self, row: &Columns) -> Columns {
        std::array::from_fn(
            |k| if self.scale[k] > 0.0 { (row[k] - self.center[k]) / self.scale[k] } else { 0.0 },
        )
    }

    /// The scores of a row in scaled columns.
    pub(super) fn scores(&self, scaled: &Columns) -> Scores {
        let mut scores = [0.0; COLUMNS];
        for ((score, direction), spread) in scores.iter_mut().zip(&self.directions).zip(&self.spread) {
            let mut sum = 0.0;
            for (x, v) in scaled.iter().zip(direction) {
                sum += x * v;
            }
            *score = sum / spread;
        }
        scores
    }

    /// Scores in scaled columns.
    pub(super) fn spanned(&self, scores: &Scores) -> Columns {
        let mut scaled = [0.0; COLUMNS];
        for ((score, direction), spread) in scores.iter().zip(&self.directions).zip(&self.spread) {
            for (x, v) in scaled.iter_mut().zip(direction) {
                *x += score * spread * v;
            }
        }
        scaled
    }

    /// The row of scaled columns.
    pub(super) fn row(&self, scaled: &Columns) -> Columns {
        std::array::from_fn(|k| self.center[k] + self.scale[k] * scaled[k])
    }
}

/// Vectors whose sum with independent standard normal factors has a covariance; as many as it has ranks.
pub(super) fn square_root(covariance: &SMatrix<f64, COLUMNS, COLUMNS>) -> Vec<Columns> {
    let eigen = SymmetricEigen::new(*covariance);
    let mut order: Vec<usize> = (0..COLUMNS).collect();
    order.sort_by(|a, b| eigen.eigenvalues[*b].total_cmp(&eigen.eigenvalues[*a]));
    let least = eigen.eigenvalues.max() * 1e-12;
    let root = |k: &usize| -> Columns {
        let length = eigen.eigenvalues[*k].sqrt();
        std::array::from_fn(|c| eigen.eigenvectors[(c, *k)] * length)
    };
    order.iter().filter(|k| eigen.eigenvalues[**k] > least).map(root).collect()
}

/// The mean of some rows and their covariance about it.
pub(super) fn moments(rows: &[Columns]) -> (Columns, SMatrix<f64, COLUMNS, COLUMNS>) {
    let count = rows.len().max(1) as f64;
    let mean: Columns = std::array::from_fn(|k| rows.iter().map(|r| r[k]).sum::<f64>() / count);
    let entry =
        |i: usize, j: usize| rows.iter().map(|r| (r[i] - mean[i]) * (r[j] - mean[j])).sum::<f64>() / count;
    (mean, SMatrix::from_fn(entry))
}

/// The sum of vectors with factors, in the order of the vectors.
pub(super) fn combined(vectors: &[Columns], factors: &[f64]) -> Columns {
    let mut sum = [0.0; COLUMNS];
    for (vector, factor) in vectors.iter().zip(factors) {
        for (x, v) in sum.iter_mut().zip(vector) {
            *x += factor * v;
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::super::{columns, made};
    use super::*;

    fn rows() -> Vec<Columns> {
        made::steps(20, 12).iter().map(|s| columns::of(&s.shape)).collect()
    }

    #[test]
    fn components_are_the_eigenvectors_of_the_covariance() {
        let rows = rows();
        let (center, covariance) = moments(&rows);
        let basis = Basis::fit(&rows, center, 0.95, true).unwrap();
        let correlation: SMatrix<f64, COLUMNS, COLUMNS> =
            SMatrix::from_fn(|i, j| covariance[(i, j)] / (covariance[(i, i)] * covariance[(j, j)]).sqrt());
        let mut values: Vec<f64> = SymmetricEigen::new(correlation).eigenvalues.iter().copied().collect();
        values.sort_by(|a, b| b.total_cmp(a));
        let held = |k: usize| values[..k].iter().sum::<f64>() / COLUMNS as f64;
        let kept = basis.components();
        assert!(held(kept) >= 0.95 && held(kept - 1) < 0.95);
        for (k, direction) in basis.directions.iter().enumerate() {
            assert!((basis.spread[k] - values[k].sqrt()).abs() < 1e-9);
            assert!((basis.explained[k] - values[k] / COLUMNS as f64).abs() < 1e-9);
            let v = nalgebra::SVector::from(*direction);
            assert!((correlation * v - v * values[k]).amax() < 1e-9 && (v.norm() - 1.0).abs() < 1e-12);
        }
        // Scores have variance one and no correlation, and with all components they keep the row.
        let scores: Vec<Columns> = rows.iter().map(|r| basis.scores(&basis.scaled(r))).collect();
        let (_, of_scores) = moments(&scores);
        for i in 0..kept {
            for j in 0..kept {
                assert!((of_scores[(i, j)] - f64::from(i == j)).abs() < 1e-9);
            }
        }
        let all = Basis::fit(&rows, center, 1.0, true).unwrap();
        let back = all.row(&all.spanned(&all.scores(&all.scaled(&rows[5]))));
        assert!((0..COLUMNS).all(|k| (back[k] - rows[5][k]).abs() < 1e-9));
        let published = Basis::fit(&rows, center, 0.95, false).unwrap();
        assert!(published.components() <= 2 && published.scale[columns::DURATION] == 0.0);
        assert!(Basis::fit(&[rows[0]; 30], rows[0], 0.95, true).is_none());
    }

    #[test]
    fn square_roots_have_their_covariance() {
        let (_, covariance) = moments(&rows());
        let root = square_root(&covariance);
        let product = |i: usize, j: usize| root.iter().map(|r| r[i] * r[j]).sum::<f64>();
        for i in 0..COLUMNS {
            for j in 0..COLUMNS {
                assert!((product(i, j) - covariance[(i, j)]).abs() < 1e-10);
            }
        }
        assert!(square_root(&SMatrix::zeros()).is_empty());
    }
}
