//! Families of whole numbers and listed values.

use super::Family;
use crate::base::math;
use crate::base::special::{gamma, normal_quantile};

/// P(X <= x).
pub(super) fn cdf(family: &Family, x: f64) -> f64 {
    match family {
        Family::UniformInt { low, high } => {
            let (low, high) = (*low as f64, *high as f64);
            math::at_most(math::at_least((x.floor() - low + 1.0) / (high - low + 1.0), 0.0), 1.0)
        }
        Family::Poisson { mean } => poisson_cdf(*mean, x.floor()),
        Family::Bernoulli { p } => {
            if x < 0.0 {
                0.0
            } else if x < 1.0 {
                1.0 - p
            } else {
                1.0
            }
        }
        Family::Choice(options) | Family::Multiple { options, .. } => {
            options.iter().filter(|(value, _)| *value <= x).map(|(_, weight)| weight).sum()
        }
        _ => f64::NAN,
    }
}

/// The smallest x with P(X <= x) >= p.
pub(super) fn quantile(family: &Family, p: f64) -> f64 {
    match family {
        Family::UniformInt { low, high } => whole_number(*low, *high, p),
        Family::Poisson { mean } => poisson_quantile(*mean, p),
        Family::Bernoulli { p: success } => f64::from(p > 1.0 - success),
        Family::Choice(options) | Family::Multiple { options, .. } => {
            let mut sorted: Vec<(f64, f64)> = options.clone();
            sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
            pick(&sorted, p)
        }
        _ => f64::NAN,
    }
}

/// The whole number that `u` in (0, 1) falls on, all of `low ..= high` alike.
pub(super) fn whole_number(low: i64, high: i64, u: f64) -> f64 {
    let (low, high) = (low as f64, high as f64);
    math::at_most(low + (u * (high - low + 1.0)).floor(), high)
}

/// The first value at which the running sum of the weights reaches `u` times their sum.
pub(super) fn pick(options: &[(f64, f64)], u: f64) -> f64 {
    let total: f64 = options.iter().map(|(_, weight)| weight).sum();
    let mut sum = 0.0;
    let mut last = f64::NAN;
    for (value, weight) in options {
        if *weight > 0.0 {
            sum += weight;
            last = *value;
            if sum >= u * total {
                break;
            }
        }
    }
    last
}

/// P(X <= k) of the Poisson law: Q(k + 1, mean).
pub(super) fn poisson_cdf(mean: f64, k: f64) -> f64 {
    if k < 0.0 {
        0.0
    } else if mean == 0.0 || k == f64::INFINITY {
        1.0
    } else {
        gamma::gamma_tails(k + 1.0, mean).upper()
    }
}

/// P(X > k), without subtraction.
pub(super) fn poisson_upper(mean: f64, k: f64) -> f64 {
    if k < 0.0 {
        1.0
    } else if mean == 0.0 || k == f64::INFINITY {
        0.0
    } else {
        gamma::gamma_tails(k + 1.0, mean).lower()
    }
}

fn poisson_quantile(mean: f64, p: f64) -> f64 {
    if p >= 1.0 {
        return f64::INFINITY;
    }
    smallest(mean, p, |k| poisson_cdf(mean, k) >= p)
}

/// The smallest k with P(X > k) <= q.
pub(super) fn poisson_upper_quantile(mean: f64, q: f64) -> f64 {
    if q <= 0.0 {
        return f64::INFINITY;
    }
    smallest(mean, 1.0 - q, |k| poisson_upper(mean, k) <= q)
}

/// The smallest whole number that satisfies a monotone `reached`, searched outward from the normal
/// approximation of the Poisson quantile at `p`.
fn smallest(mean: f64, p: f64, reached: impl Fn(f64) -> bool) -> f64 {
    let z = math::at_least(math::at_most(normal_quantile(p), 9.0), -9.0);
    let guess = math::at_least((mean + z * mean.sqrt()).floor(), 0.0);
    let mut step = 1.0;
    let (mut low, mut high) = (guess - 1.0, guess);
    while high < 1e300 && !reached(high) {
        low = high;
        high += step;
        step *= 2.0;
    }
    while low >= 0.0 && reached(low) {
        high = low;
        low = math::at_least(low - step, -1.0);
        step *= 2.0;
    }
    while high - low > 1.0 {
        let middle = ((low + high) * 0.5).floor();
        if middle <= low || middle >= high {
            break;
        }
        if reached(middle) {
            high = middle;
        } else {
            low = middle;
        }
    }
    high
}
