//! Fitting the Gaussian process of a foot: hyper-parameters by the marginal likelihood, then the posterior, exact or with inducing
//! points (FITC: Snelson and Ghahramani 2006; Quiñonero-Candela and Rasmussen 2005, section 6).

use super::factor::{factor, log_determinant};
use super::likelihood;
use super::likelihood::{Hyper, kernel, log_likelihood, scaled, signals};
use super::transition::{LANES, Linear, Process};
use crate::base::math;
use nalgebra::{DMatrix, DVector};
use std::cmp::Ordering;

/// Most pairs of which the marginal likelihood is taken in the search.
const MOST_SEARCHED: usize = 1000;
/// Added to the variance of inducing points, so that their matrix has a factor in doubles.
const JITTER: f64 = 1e-8;
/// The noise of the model as published: what scikit-learn adds for the factor.
const PUBLISHED_NOISE: f64 = 1e-10;

/// A fitted transition and what each pair says about it.
pub(super) struct Fitted<T> {
    pub(super) transition: T,
    /// Outputs less the mean predicted from all other pairs.
    pub(super) residuals: DMatrix<f64>,
    /// Mean factor of the variances of these predictions.
    pub(super) variance: f64,
}

/// The best length scales and noise for at most a thousand pairs, spread over all.
pub(super) fn search(inputs: &DMatrix<f64>, outputs: &DMatrix<f64>, as_published: bool) -> Option<Hyper> {
    let (n, q) = inputs.shape();
    let kept: Vec<usize> = (0..n.min(MOST_SEARCHED)).map(|k| k * n / n.min(MOST_SEARCHED)).collect();
    let (inputs, outputs) = (inputs.select_rows(&kept), outputs.select_rows(&kept));
    if as_published {
        // One length scale for all inputs between 1e-5 and 1e5, the bounds of scikit-learn, eight in a decade.
        let hyper =
            |k: i32| Hyper { lengths: vec![math::pow(10.0, f64::from(k) / 8.0); q], noise: PUBLISHED_NOISE };
        let values =
            (-40..=40).filter_map(|k| Some((k, likelihood::value(&inputs, &outputs, &hyper(k), true)?)));
        return values.max_by(|a, b| a.1.total_cmp(&b.1)).map(|(k, _)| hyper(k));
    }
    let bound = |low: f64, high: f64| (math::ln(low), math::ln(high));
    let mut bounds = vec![bound(0.05, 100.0); q];
    bounds.push(bound(1e-3, 1e3));
    let mut start = vec![math::ln(2.0); q];
    start.push(math::ln(0.5));
    let (best, _) = ascend(&start, &bounds, |x| likelihood::with_gradient(&inputs, &outputs, x))?;
    Some(Hyper::of_logarithms(&best))
}

fn process(
    hyper: Hyper,
    points: &DMatrix<f64>,
    weights: &DMatrix<f64>,
    reduction: &DMatrix<f64>,
    signals: Vec<f64>,
    log_likelihood: f64,
) -> Process {
    let count = points.nrows().next_multiple_of(LANES);
    let at = |of: &DMatrix<f64>, i: usize, j: usize| of.get((i, j)).copied().unwrap_or(0.0);
    let list = |of: &DMatrix<f64>, c: usize| (0..count).map(|i| at(of, i, c)).collect();
    let lists = |of: &DMatrix<f64>| (0..of.ncols()).map(|c| list(of, c)).collect();
    let entry = |i: usize, j: usize| match i.cmp(&j) {
        Ordering::Less => 0.0,
        Ordering::Equal => at(reduction, i, i),
        Ordering::Greater => 2.0 * at(reduction, i, j),
    };
    let row = |i: usize| (0..(i / LANES + 1) * LANES).map(move |j| entry(i, j));
    Process {
        lengths: hyper.lengths,
        noise: hyper.noise,
        signals,
        points: lists(points),
        weights: lists(weights),
        reduction: (0..count).flat_map(row).collect(),
        log_likelihood,
    }
}

/// The exact posterior (Rasmussen and Williams 2006, sections 2.2 and, for the residuals, 5.4.2).
pub(super) fn exact(inputs: &DMatrix<f64>, outputs: &DMatrix<f64>, hyper: Hyper) -> Option<Fitted<Process>> {
    let (n, numbers) = (inputs.nrows(), outputs.len() as f64);
    let at = scaled(inputs, &hyper.lengths);
    let (lower, lower_inverse) = factor(&(kernel(&at, &at) + DMatrix::identity(n, n) * hyper.noise))?;
    let inverse = lower_inverse.transpose() * &lower_inverse;
    let solved = &inverse * outputs;
    let signals = signals(outputs, &solved);
    let likelihood = log_likelihood(&signals, log_determinant(&lower), n) / numbers;
    let residuals = DMatrix::from_fn(n, outputs.ncols(), |i, k| solved[(i, k)] / inverse[(i, i)]);
    let variance = inverse.diagonal().iter().map(|x| 1.0 / x).sum::<f64>() / n as f64;
    let transition = process(hyper, &at, &solved, &inverse, signals, likelihood);
    Some(Fitted { transition, residuals, variance })
}

/// Rows of scaled inputs, each the one that the rows before it explain least: the pivots of a Cholesky factor (Fine and
/// Scheinberg 2001).
fn inducing(at: &DMatrix<f64>, count: usize) -> Vec<usize> {
    let n = at.nrows();
    let mut left: Vec<f64> = vec![1.0; n];
    let mut factors: Vec<DVector<f64>> = Vec::new();
    let mut chosen = Vec::new();
    while chosen.len() < count.min(n) {
        let Some(pivot) = (0..n).max_by(|a, b| left[*a].total_cmp(&left[*b])) else { break };
        if left[pivot] < JITTER {
            break;
        }
        let mut column = kernel(at, &at.rows(pivot, 1).into_owned()).column(0).into_owned();
        for factor in &factors {
            column.axpy(-factor[pivot], factor, 1.0);
        }
        column /= left[pivot].sqrt();
        for i in 0..n {
            left[i] -= column[i] * column[i];
        }
        left[pivot] = 0.0;
        factors.push(column);
        chosen.push(pivot);
    }
    chosen
}

/// The posterior with `count` inducing points.
pub(super) fn sparse(
    inputs: &DMatrix<f64>,
    outputs: &DMatrix<f64>,
    hyper: Hyper,
    count: usize,
) -> Option<Fitted<Process>> {
    let (n, numbers) = (inputs.nrows(), outputs.len() as f64);
    let at = scaled(inputs, &hyper.lengths);
    let points = at.select_rows(&inducing(&at, count));
    let m = points.nrows();
    // Q = V' V, C = Q + D with the diagonal D, B = I + V D^-1 V' and T = LB^-1 V; by Woodbury C^-1 = D^-1 - D^-1 T' T D^-1.
    let (_, points_inverse) = factor(&(kernel(&points, &points) + DMatrix::identity(m, m) * JITTER))?;
    let v = &points_inverse * kernel(&points, &at);
    let diagonal = DVector::from_fn(n, |i, _| (1.0 - v.column(i).norm_squared()).max(0.0) + hyper.noise);
    let over = |of: &DMatrix<f64>| DMatrix::from_fn(of.nrows(), n, |r, i| of[(r, i)] / diagonal[i]);
    let (lower, lower_inverse) = factor(&(DMatrix::identity(m, m) + over(&v) * v.transpose()))?;
    let t = &lower_inverse * &v;
    let t_over = over(&t);
    let projected = &t_over * outputs;
    let solved = DMatrix::from_fn(n, outputs.ncols(), |i, k| outputs[(i, k)] / diagonal[i])
        - t_over.transpose() * &projected;
    let signals = signals(outputs, &solved);
    let determinant = diagonal.iter().map(|x| math::ln(*x)).sum::<f64>() + log_determinant(&lower);
    let likelihood = log_likelihood(&signals, determinant, n) / numbers;
    let precision = |i: usize| 1.0 / diagonal[i] - t_over.column(i).norm_squared();
    let residuals = DMatrix::from_fn(n, outputs.ncols(), |i, k| solved[(i, k)] / precision(i));
    let variance = (0..n).map(|i| 1.0 / precision(i)).sum::<f64>() / n as f64;
    let both = &lower_inverse * &points_inverse;
    let weights = both.transpose() * projected;
    let reduction = points_inverse.transpose() * &points_inverse - both.transpose() * &both;
    Some(Fitted {
        transition: process(hyper, &points, &weights, &reduction, signals, likelihood),
        residuals,
        variance,
    })
}

/// The least squares of the outputs on the inputs and a constant: an autoregression of order one.
pub(super) fn linear(inputs: &DMatrix<f64>, outputs: &DMatrix<f64>) -> Option<Fitted<Linear>> {
    let (n, q) = inputs.shape();
    let x = DMatrix::from_fn(n, q + 1, |i, k| if k < q { inputs[(i, k)] } else { 1.0 });
    // A little is added for inputs that do not vary.
    let squares = x.transpose() * &x + DMatrix::identity(q + 1, q + 1) * (1e-9 * n as f64);
    let (_, inverse) = factor(&squares)?;
    let half = &inverse * x.transpose();
    let coefficients = inverse.transpose() * (&half * outputs);
    let fitted = &x * &coefficients;
    let left_out = |i: usize| 1.0 - half.column(i).norm_squared();
    let residuals =
        DMatrix::from_fn(n, outputs.ncols(), |i, k| (outputs[(i, k)] - fitted[(i, k)]) / left_out(i));
    let rows = coefficients.column_iter().map(|c| c.iter().copied().collect()).collect();
    let variances = residuals.column_iter().map(|c| c.norm_squared() / n as f64).collect();
    Some(Fitted { transition: Linear { rows, variances }, residuals, variance: 1.0 })
}

// The largest value of a smooth function in a box, by the quasi-Newton rule of Broyden, Fletcher, Goldfarb and Shanno (Nocedal
// and Wright 2006, chapter 6): coordinates at a bound that the gradient points to stand still.

/// Where the search from a place ends, and the value there. `function` gives the value and the gradient, or `None` where it
/// has none; then the search does not go there. `None` if the start has no value.
fn ascend(
    start: &[f64],
    bounds: &[(f64, f64)],
    function: impl Fn(&[f64]) -> Option<(f64, Vec<f64>)>,
) -> Option<(Vec<f64>, f64)> {
    const ROUNDS: usize = 60;
    let n = start.len();
    let inside = |x: &DVector<f64>| DVector::from_fn(n, |q, _| x[q].clamp(bounds[q].0, bounds[q].1));
    let ask = |x: &DVector<f64>| function(x.as_slice()).map(|(value, g)| (value, DVector::from_vec(g)));
    let mut x = inside(&DVector::from_column_slice(start));
    let (mut value, mut gradient) = ask(&x)?;
    let mut metric = DMatrix::<f64>::identity(n, n);
    for _ in 0..ROUNDS {
        let stands = |q: usize| {
            (x[q] <= bounds[q].0 && gradient[q] < 0.0) || (x[q] >= bounds[q].1 && gradient[q] > 0.0)
        };
        let free = DVector::from_fn(n, |q, _| if stands(q) { 0.0 } else { gradient[q] });
        if free.amax() < 1e-3 {
            break;
        }
        let mut direction = &metric * &free;
        (0..n).filter(|q| stands(*q)).for_each(|q| direction[q] = 0.0);
        if direction.dot(&free) <= 0.0 {
            metric.fill_with_identity();
            direction = free.clone();
        }
        // A factor of e^2 at most in a round.
        let mut length = (2.0 / direction.amax()).min(1.0);
        let mut found = None;
        for _ in 0..25 {
            let to = inside(&(&x + &direction * length));
            let enough = 1e-4 * free.dot(&(&to - &x));
            found = ask(&to).filter(|(there, _)| *there >= value + enough).map(|(there, g)| (to, there, g));
            if found.is_some() {
                break;
            }
            length *= 0.4;
        }
        let Some((to, there, g)) = found else { break };
        let (step, bend) = (&to - &x, &gradient - &g);
        let product = step.dot(&bend);
        let gained = there - value;
        (x, value, gradient) = (to, there, g);
        if product > 1e-12 {
            let left = DMatrix::identity(n, n) - &step * bend.transpose() / product;
            metric = &left * metric * left.transpose() + &step * step.transpose() / product;
        }
        if gained < 1e-7 * value.abs().max(1.0) {
            break;
        }
    }
    Some((x.as_slice().to_vec(), value))
}

#[cfg(test)]
mod tests {
    #![allow(
        clippy::disallowed_methods,
        clippy::print_stdout,
        reason = "tests may use the platform's functions"
    )]
    use super::super::transition::Transition;
    use super::*;

    fn data(n: usize) -> (DMatrix<f64>, DMatrix<f64>) {
        let inputs = DMatrix::from_fn(n, 3, |i, q| (i as f64 * (0.737 + 0.231 * q as f64)).sin() * 2.0);
        let outputs = DMatrix::from_fn(n, 2, |i, k| {
            (inputs[(i, k)] * 1.3).cos() + 0.3 * (i as f64 * 12.9 + k as f64).sin()
        });
        (inputs, outputs)
    }

    fn hyper() -> Hyper {
        Hyper { lengths: vec![0.8, 1.4, 3.0], noise: 0.2 }
    }

    fn predicted(transition: Process, x: [f64; 3]) -> ([f64; 2], f64) {
        let (mut inputs, mut mean) = ([0.0; 12], [0.0; 11]);
        inputs[..3].copy_from_slice(&x);
        let variance = Transition::Process(transition).predict(&inputs, &mut mean, true);
        ([mean[0], mean[1]], variance)
    }

    /// The posterior by the formulas of the textbook, with the inverse written out.
    fn direct(inputs: &DMatrix<f64>, outputs: &DMatrix<f64>, x: [f64; 3]) -> ([f64; 2], f64) {
        let h = hyper();
        let k = |a: &dyn Fn(usize) -> f64, b: &dyn Fn(usize) -> f64| -> f64 {
            (-0.5 * (0..3).map(|q| ((a(q) - b(q)) / h.lengths[q]).powi(2)).sum::<f64>()).exp()
        };
        let n = inputs.nrows();
        let c = DMatrix::from_fn(n, n, |i, j| {
            k(&|q| inputs[(i, q)], &|q| inputs[(j, q)]) + if i == j { h.noise } else { 0.0 }
        });
        let star = DVector::from_fn(n, |i, _| k(&|q| inputs[(i, q)], &|q| x[q]));
        let inverse = c.try_inverse().unwrap();
        let mean = star.transpose() * &inverse * outputs;
        ([mean[0], mean[1]], 1.0 + h.noise - star.dot(&(&inverse * &star)))
    }

    #[test]
    fn exact_and_all_points_inducing_are_the_textbook() {
        let (inputs, outputs) = data(60);
        let (exact, all) =
            (exact(&inputs, &outputs, hyper()).unwrap(), sparse(&inputs, &outputs, hyper(), 60).unwrap());
        for x in [[0.1, -0.4, 1.2], [1.9, 1.9, -1.9], [4.0, 0.0, 0.0]] {
            let want = direct(&inputs, &outputs, x);
            for (got, tolerance) in [(&exact, 1e-10), (&all, 1e-5)] {
                let (mean, variance) = predicted(got.transition.clone(), x);
                assert!((mean[0] - want.0[0]).abs() < tolerance && (mean[1] - want.0[1]).abs() < tolerance);
                assert!((variance - want.1).abs() < tolerance, "{variance} {want:?}");
            }
        }
        assert!((exact.transition.log_likelihood - all.transition.log_likelihood).abs() < 1e-6);
        assert!((exact.variance - all.variance).abs() < 1e-5);
        let value = likelihood::value(&inputs, &outputs, &hyper(), false).unwrap() / 120.0;
        assert!((exact.transition.log_likelihood - value).abs() < 1e-12);
    }

    #[test]
    fn residuals_are_those_of_a_fit_without_the_pair() {
        let (inputs, outputs) = data(40);
        let line = linear(&inputs, &outputs).unwrap();
        let (full, few) =
            (exact(&inputs, &outputs, hyper()).unwrap(), sparse(&inputs, &outputs, hyper(), 40).unwrap());
        for left_out in [0, 17, 39] {
            let (x, y) = (inputs.clone().remove_row(left_out), outputs.clone().remove_row(left_out));
            let (mean, _) = direct(&x, &y, std::array::from_fn(|q| inputs[(left_out, q)]));
            let want = outputs[(left_out, 0)] - mean[0];
            assert!((full.residuals[(left_out, 0)] - want).abs() < 1e-10);
            assert!((few.residuals[(left_out, 0)] - want).abs() < 1e-4);
            let other = linear(&x, &y).unwrap().transition;
            let fit =
                (0..3).map(|q| other.rows[0][q] * inputs[(left_out, q)]).sum::<f64>() + other.rows[0][3];
            assert!((line.residuals[(left_out, 0)] - (outputs[(left_out, 0)] - fit)).abs() < 1e-6);
        }
    }

    /// A bent ridge (Rosenbrock 1960) with its top at (1, 1).
    #[allow(clippy::unnecessary_wraps, reason = "as the function that is climbed")]
    fn ridge(x: &[f64]) -> Option<(f64, Vec<f64>)> {
        let (a, b) = (1.0 - x[0], x[1] - x[0] * x[0]);
        Some((-(a * a + 100.0 * b * b), vec![2.0 * a + 400.0 * b * x[0], -200.0 * b]))
    }

    #[test]
    fn it_finds_the_top_of_a_bent_ridge_and_that_of_a_box() {
        let (top, value) = ascend(&[-1.2, 1.0], &[(-5.0, 5.0); 2], ridge).unwrap();
        assert!((top[0] - 1.0).abs() < 1e-2 && (top[1] - 1.0).abs() < 1e-2 && value > -1e-4, "{top:?}");
        // With x at most 0.5 the best y is its square.
        let (top, _) = ascend(&[-1.2, 1.0], &[(-5.0, 0.5), (-5.0, 5.0)], ridge).unwrap();
        assert!((top[0] - 0.5).abs() < 1e-9 && (top[1] - 0.25).abs() < 1e-3, "{top:?}");
        assert!(ascend(&[0.0], &[(-1.0, 1.0)], |_| None).is_none());
    }
}
