//! Cholesky factors of large matrices and their inverses, by halves, so that nearly all work is products of matrices (Golub and
//! Van Loan 2013, section 4.2). Only fitting uses them.

use nalgebra::DMatrix;

/// The lower factor of a symmetric positive definite matrix and the inverse of the factor; `None` if it is none.
pub(super) fn factor(matrix: &DMatrix<f64>) -> Option<(DMatrix<f64>, DMatrix<f64>)> {
    const SMALL: usize = 48;
    let n = matrix.nrows();
    if n <= SMALL {
        let lower = matrix.clone().cholesky()?.l();
        let inverse = lower.solve_lower_triangular(&DMatrix::identity(n, n))?;
        return inverse.iter().all(|x| x.is_finite()).then_some((lower, inverse));
    }
    let half = n / 2;
    let (first, first_inverse) = factor(&matrix.view((0, 0), (half, half)).into_owned())?;
    let below = matrix.view((half, 0), (n - half, half)) * first_inverse.transpose();
    let rest = matrix.view((half, half), (n - half, n - half)) - &below * below.transpose();
    let (second, second_inverse) = factor(&rest)?;
    let corner = -(&second_inverse * (&below * &first_inverse));
    let join = |a: &DMatrix<f64>, b: &DMatrix<f64>, c: &DMatrix<f64>| {
        let mut whole = DMatrix::zeros(n, n);
        whole.view_mut((0, 0), (half, half)).copy_from(a);
        whole.view_mut((half, 0), (n - half, half)).copy_from(b);
        whole.view_mut((half, half), (n - half, n - half)).copy_from(c);
        whole
    };
    Some((join(&first, &below, &second), join(&first_inverse, &corner, &second_inverse)))
}

/// Twice the sum of the logarithms of a factor's diagonal: the logarithm of the determinant of its matrix.
pub(super) fn log_determinant(lower: &DMatrix<f64>) -> f64 {
    2.0 * lower.diagonal().iter().map(|x| crate::base::math::ln(*x)).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_multiply_to_the_matrix_and_inverses_to_one() {
        for n in [1, 7, 48, 49, 130] {
            let points = DMatrix::from_fn(n, n, |i, j| ((i * 31 + j * 17) % 23) as f64 / 23.0);
            let matrix = &points * points.transpose() + DMatrix::identity(n, n);
            let (lower, inverse) = factor(&matrix).unwrap();
            assert!((&lower * lower.transpose() - &matrix).amax() < 1e-10 * matrix.amax(), "{n}");
            assert!((&inverse * &lower - DMatrix::identity(n, n)).amax() < 1e-11, "{n}");
            if n < 60 {
                let determinant = crate::base::math::ln(matrix.determinant());
                assert!((log_determinant(&lower) - determinant).abs() < 1e-9 * determinant.abs().max(1.0));
            }
        }
        assert!(factor(&-DMatrix::<f64>::identity(60, 60)).is_none());
    }
}
