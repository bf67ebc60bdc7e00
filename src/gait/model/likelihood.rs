//! The marginal likelihood of a Gaussian process with several outputs (Rasmussen and Williams 2006, sections 2.3 and 5.4).
//!
//! All outputs share C = R + noise I, where R is the squared exponential kernel with a length scale for each input and variance
//! one. Output k has the covariance `s_k^2` C. The best `s_k^2` = `y_k`' C^-1 `y_k` / n is put in, which leaves
//! L = -n/2 sum ln `s_k^2` - d/2 ln|C| - n d/2 (1 + ln 2 pi) as a function of the length scales and the noise.

use super::factor::{factor, log_determinant};
use crate::base::math;
use nalgebra::DMatrix;

/// Length scales and noise of a kernel; the noise is a share of the variance of the signal.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Hyper {
    /// One for each input.
    pub(super) lengths: Vec<f64>,
    /// Variance of the noise over that of the signal.
    pub(super) noise: f64,
}

impl Hyper {
    /// From logarithms, those of the length scales first.
    pub(super) fn of_logarithms(logarithms: &[f64]) -> Self {
        let mut lengths: Vec<f64> = logarithms.iter().map(|x| math::exp(*x)).collect();
        let noise = lengths.pop().unwrap_or(1.0);
        Self { lengths, noise }
    }
}

/// Inputs (a row for each pair) divided by the length scales.
pub(super) fn scaled(inputs: &DMatrix<f64>, lengths: &[f64]) -> DMatrix<f64> {
    DMatrix::from_fn(inputs.nrows(), inputs.ncols(), |i, q| inputs[(i, q)] / lengths[q])
}

/// The kernel between the rows of two matrices of scaled inputs.
pub(super) fn kernel(a: &DMatrix<f64>, b: &DMatrix<f64>) -> DMatrix<f64> {
    DMatrix::from_fn(a.nrows(), b.nrows(), |i, j| {
        let squares = (0..a.ncols()).map(|q| (a[(i, q)] - b[(j, q)]) * (a[(i, q)] - b[(j, q)])).sum::<f64>();
        math::exp(-0.5 * squares)
    })
}

/// The variance of the signal of each output.
pub(super) fn signals(outputs: &DMatrix<f64>, solved: &DMatrix<f64>) -> Vec<f64> {
    let n = outputs.nrows() as f64;
    (0..outputs.ncols()).map(|k| (outputs.column(k).dot(&solved.column(k)) / n).max(1e-300)).collect()
}

/// The logarithm of the likelihood, for signals, the logarithm of |C| and a number of pairs.
pub(super) fn log_likelihood(signals: &[f64], log_determinant: f64, pairs: usize) -> f64 {
    let (n, d) = (pairs as f64, signals.len() as f64);
    let fits: f64 = signals.iter().map(|s| math::ln(*s)).sum();
    -0.5 * (n * fits + d * log_determinant + n * d * (1.0 + math::ln(2.0 * std::f64::consts::PI)))
}

/// The logarithm of the likelihood and its derivatives by the logarithms of the length scales and of the noise.
pub(super) fn with_gradient(
    inputs: &DMatrix<f64>,
    outputs: &DMatrix<f64>,
    logarithms: &[f64],
) -> Option<(f64, Vec<f64>)> {
    let hyper = Hyper::of_logarithms(logarithms);
    let at = scaled(inputs, &hyper.lengths);
    let (n, d) = (inputs.nrows(), outputs.ncols() as f64);
    let bare = kernel(&at, &at);
    let (lower, lower_inverse) = factor(&(&bare + DMatrix::identity(n, n) * hyper.noise))?;
    let inverse = lower_inverse.transpose() * &lower_inverse;
    let solved = &inverse * outputs;
    let signals = signals(outputs, &solved);
    let value = log_likelihood(&signals, log_determinant(&lower), n);
    // dL = 1/2 tr(W dC) with W = sum a_k a_k' / s_k^2 - d C^-1 and a_k = C^-1 y_k.
    let weighted = DMatrix::from_fn(n, outputs.ncols(), |i, k| solved[(i, k)] / signals[k]);
    let w = weighted * solved.transpose() - inverse * d;
    let noise = 0.5 * hyper.noise * w.trace();
    let g = w.component_mul(&bare);
    let sums = g.column_sum();
    // dC_ij / d ln l_q = R_ij (x_iq - x_jq)^2 for scaled inputs.
    let length = |q: usize| {
        let x = at.column(q);
        let outer: f64 = (0..n).map(|i| x[i] * x[i] * sums[i]).sum();
        outer - x.dot(&(&g * x))
    };
    Some((value, (0..inputs.ncols()).map(length).chain([noise]).collect()))
}

/// The logarithm of the likelihood alone; with `unscaled` for signals of variance one, as published.
pub(super) fn value(
    inputs: &DMatrix<f64>,
    outputs: &DMatrix<f64>,
    hyper: &Hyper,
    unscaled: bool,
) -> Option<f64> {
    let at = scaled(inputs, &hyper.lengths);
    let n = inputs.nrows();
    let (lower, inverse) = factor(&(kernel(&at, &at) + DMatrix::identity(n, n) * hyper.noise))?;
    let signals = signals(outputs, &(inverse.transpose() * (&inverse * outputs)));
    let best = log_likelihood(&signals, log_determinant(&lower), n);
    // Away from its best scale s^2 an output loses n/2 (s^2 - 1 - ln s^2).
    let lost: f64 = signals.iter().map(|s| s - 1.0 - math::ln(*s)).sum();
    Some(if unscaled { best - 0.5 * n as f64 * lost } else { best })
}

#[cfg(test)]
mod tests {
    #![allow(
        clippy::disallowed_methods,
        clippy::print_stdout,
        reason = "tests may use the platform's functions"
    )]

    use super::*;

    fn data(n: usize) -> (DMatrix<f64>, DMatrix<f64>) {
        let inputs = DMatrix::from_fn(n, 3, |i, q| (i as f64 * (0.37 + 0.21 * q as f64)).sin() * 2.0);
        let outputs = DMatrix::from_fn(n, 2, |i, k| {
            (inputs[(i, k)] * 1.3).cos() + 0.3 * (i as f64 * 12.9 + k as f64).sin()
        });
        (inputs, outputs)
    }

    #[test]
    fn it_is_the_density_of_a_normal_vector_at_its_best_scale() {
        let (inputs, outputs) = data(20);
        let hyper = Hyper { lengths: vec![0.8, 1.4, 3.0], noise: 0.3 };
        let covariance = DMatrix::from_fn(20, 20, |i, j| {
            let squares: f64 =
                (0..3).map(|q| ((inputs[(i, q)] - inputs[(j, q)]) / hyper.lengths[q]).powi(2)).sum();
            (-0.5 * squares).exp() + if i == j { 0.3 } else { 0.0 }
        });
        // The density with the determinant and the inverse written out, at any scale of the outputs.
        let density = |scales: [f64; 2]| -> f64 {
            (0..2)
                .map(|k| {
                    let c = &covariance * scales[k];
                    let y = outputs.column(k);
                    let fit = y.dot(&(c.clone().try_inverse().unwrap() * y));
                    -0.5 * (fit + (c * 2.0 * std::f64::consts::PI).determinant().ln())
                })
                .sum()
        };
        let best = |k: usize| {
            let y = outputs.column(k);
            y.dot(&(covariance.clone().try_inverse().unwrap() * y)) / 20.0
        };
        let best = [best(0), best(1)];
        let got = value(&inputs, &outputs, &hyper, false).unwrap();
        assert!((got - density(best)).abs() < 1e-9, "{got} {}", density(best));
        let unscaled = value(&inputs, &outputs, &hyper, true).unwrap();
        assert!((unscaled - density([1.0, 1.0])).abs() < 1e-9);
        assert!(got > density([best[0] * 1.05, best[1]]) && got > density([best[0], best[1] * 0.95]));
    }

    #[test]
    fn derivatives_are_the_limits_of_differences() {
        let (inputs, outputs) = data(70);
        let at = [-0.3, 0.4, 0.9, -1.2];
        let (value, gradient) = with_gradient(&inputs, &outputs, &at).unwrap();
        assert!(
            (value - super::value(&inputs, &outputs, &Hyper::of_logarithms(&at), false).unwrap()).abs()
                < 1e-9
        );
        for q in 0..at.len() {
            let shifted = |by: f64| {
                let mut to = at;
                to[q] += by;
                super::value(&inputs, &outputs, &Hyper::of_logarithms(&to), false).unwrap()
            };
            let difference = (shifted(1e-5) - shifted(-1e-5)) / 2e-5;
            assert!((difference - gradient[q]).abs() < 1e-5 * difference.abs().max(1.0), "{q}");
        }
    }
}
