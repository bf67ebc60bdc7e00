//! A quadratic surface through losses near their minimum: where another weighting of the persons would have its minimum.
//!
//! A search for each resample of the bootstrap would take a thousand times as long. The losses of candidates near the minimum are
//! known person by person, so those of a resample are weighted sums of them. A quadratic is fitted to these by least squares,
//! and its minimum stands for the one that a search would find (response surfaces, Box and Wilson 1951).

/// The design of a surface: scaled places of the candidates, and the triangular factor of their normal equations.
pub(super) struct Surface {
    centre: Vec<f64>,
    scale: Vec<f64>,
    /// The terms `1`, `x_i` and `x_i x_j` of each candidate.
    rows: Vec<Vec<f64>>,
    /// Cholesky factor of the sum of products of terms.
    factor: Vec<Vec<f64>>,
}

/// A minimum farther than so many standard deviations of the candidates is none.
const FARTHEST: f64 = 4.0;

impl Surface {
    /// How many terms a surface has.
    pub(super) const fn terms(dimensions: usize) -> usize {
        1 + dimensions + dimensions * (dimensions + 1) / 2
    }

    /// Over some places; `None` where they do not determine it.
    pub(super) fn over(places: &[Vec<f64>]) -> Option<Self> {
        let (count, n) = (places.len() as f64, places.first()?.len());
        let centre: Vec<f64> =
            (0..n).map(|i| places.iter().map(|place| place[i]).sum::<f64>() / count).collect();
        let square = |i: usize, place: &Vec<f64>| (place[i] - centre[i]) * (place[i] - centre[i]);
        let scale: Vec<f64> = (0..n)
            .map(|i| (places.iter().map(|place| square(i, place)).sum::<f64>() / count).sqrt())
            .collect();
        let rows: Vec<Vec<f64>> = places
            .iter()
            .map(|place| {
                let x: Vec<f64> = (0..n).map(|i| (place[i] - centre[i]) / scale[i]).collect();
                let mut terms = vec![1.0];
                terms.extend(&x);
                for i in 0..n {
                    terms.extend((0..=i).map(|j| x[i] * x[j]));
                }
                terms
            })
            .collect();
        let size = Self::terms(n);
        let product = |i: usize, j: usize| rows.iter().map(|row| row[i] * row[j]).sum::<f64>();
        let normal: Vec<Vec<f64>> = (0..size).map(|i| (0..size).map(|j| product(i, j)).collect()).collect();
        Some(Self { factor: cholesky(&normal)?, centre, scale, rows })
    }

    /// The place of the minimum for some losses of the candidates; `None` where the surface has none nearby.
    pub(super) fn minimum(&self, losses: &[f64]) -> Option<Vec<f64>> {
        let n = self.centre.len();
        let size = Self::terms(n);
        let right: Vec<f64> =
            (0..size).map(|i| self.rows.iter().zip(losses).map(|(row, loss)| row[i] * loss).sum()).collect();
        let terms = solve(&self.factor, &right);
        let of = |i: usize, j: usize| terms[1 + n + i * (i + 1) / 2 + j];
        let hessian: Vec<Vec<f64>> = (0..n)
            .map(|i| {
                let entry = |j: usize| match i.cmp(&j) {
                    std::cmp::Ordering::Equal => 2.0 * of(i, i),
                    std::cmp::Ordering::Greater => of(i, j),
                    std::cmp::Ordering::Less => of(j, i),
                };
                (0..n).map(entry).collect()
            })
            .collect();
        let slope: Vec<f64> = (0..n).map(|i| -terms[1 + i]).collect();
        let x = solve(&cholesky(&hessian)?, &slope);
        let near = x.iter().all(|x| x.abs() <= FARTHEST);
        near.then(|| (0..n).map(|i| self.centre[i] + self.scale[i] * x[i]).collect())
    }
}

/// The lower factor of a positive definite matrix.
fn cholesky(matrix: &[Vec<f64>]) -> Option<Vec<Vec<f64>>> {
    let n = matrix.len();
    let mut factor = vec![vec![0.0; n]; n];
    for i in 0..n {
        for j in 0..=i {
            let sum: f64 = (0..j).map(|k| factor[i][k] * factor[j][k]).sum();
            let rest = matrix[i][j] - sum;
            if i != j {
                factor[i][j] = rest / factor[j][j];
            } else if rest > 1e-12 * matrix[i][i] {
                factor[i][i] = rest.sqrt();
            } else {
                return None;
            }
        }
    }
    Some(factor)
}

/// The solution of the equations whose matrix has a lower factor.
fn solve(factor: &[Vec<f64>], right: &[f64]) -> Vec<f64> {
    let n = right.len();
    let mut x = right.to_vec();
    for i in 0..n {
        let sum: f64 = (0..i).map(|k| factor[i][k] * x[k]).sum();
        x[i] = (x[i] - sum) / factor[i][i];
    }
    for i in (0..n).rev() {
        let sum: f64 = (i + 1..n).map(|k| factor[k][i] * x[k]).sum();
        x[i] = (x[i] - sum) / factor[i][i];
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_minimum_of_a_quadratic_is_found() {
        let places: Vec<Vec<f64>> = (0..30)
            .map(|k| vec![f64::from(k % 5) + 0.01 * f64::from(k), f64::from(k % 7) - 0.02 * f64::from(k)])
            .collect();
        let loss = |x: &Vec<f64>| {
            let (a, b) = (x[0] - 1.5, x[1] - 2.25);
            2.0 * a * a + a * b + 0.5 * b * b + 7.0
        };
        let surface = Surface::over(&places).unwrap();
        let found = surface.minimum(&places.iter().map(loss).collect::<Vec<_>>()).unwrap();
        assert!((found[0] - 1.5).abs() < 1e-10 && (found[1] - 2.25).abs() < 1e-10, "{found:?}");
        let hill: Vec<f64> = places.iter().map(|x| -loss(x)).collect();
        assert_eq!(surface.minimum(&hill), None);
        assert!(Surface::over(&places[..4]).is_none(), "four places do not determine six terms");
    }
}
