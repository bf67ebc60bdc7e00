//! The largest value of a smooth function in a box, by the quasi-Newton rule of Broyden, Fletcher, Goldfarb and Shanno (Nocedal
//! and Wright 2006, chapter 6): coordinates at a bound that the gradient points to stand still.

use nalgebra::{DMatrix, DVector};

/// Where the search from a place ends, and the value there. `function` gives the value and the gradient, or `None` where it
/// has none; then the search does not go there. `None` if the start has no value.
pub(super) fn ascend(
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
    use super::*;

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
