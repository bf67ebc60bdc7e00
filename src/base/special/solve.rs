//! Roots of the logarithm of a distribution function by Newton's method inside a bracket.

use crate::base::math;

/// Steps before the best point so far is returned. Newton's method needs about five; bisection of the
/// whole bracket to the last bit needs fewer than seventy.
const LIMIT: u32 = 200;

/// The point u at which `ln_cdf(u)` is `ln_p`, from `start`, within `bracket`.
///
/// `f(u)` gives the logarithms of the distribution function and of its density at u. Both laws solved here
/// have a log-concave density in u, so the logarithm of the distribution function is concave and Newton's
/// method converges from anywhere; the bracket catches overflow on flat parts.
pub(super) fn invert(ln_p: f64, start: f64, bracket: (f64, f64), f: impl Fn(f64) -> (f64, f64)) -> f64 {
    let (mut low, mut high) = bracket;
    let mut u = math::at_most(math::at_least(start, low), high);
    for _ in 0..LIMIT {
        let (ln_cdf, ln_density) = f(u);
        let excess = ln_cdf - ln_p;
        if excess == 0.0 {
            return u;
        }
        if excess > 0.0 {
            high = u;
        } else {
            low = u;
        }
        let mut next = u - excess * math::exp(ln_cdf - ln_density);
        let least = 4.0 * f64::EPSILON * math::at_least(u.abs(), 0.25);
        // So near the root rounding may place it on the other side of an end.
        if (next - u).abs() <= least {
            return next;
        }
        // A comparison with NaN is false, so that a step that is not a number bisects too.
        if !(next > low && next < high) {
            next = 0.5 * (low + high);
        }
        let step = (next - u).abs();
        u = next;
        if step <= least {
            return u;
        }
    }
    u
}
