//! The Beta-mixture confidence sequence with the prior of Krichevsky and Trofimov (1981): an interval that
//! holds P at all numbers of trials at once, and so at any deadline (Robbins 1970; Ville 1939).

use super::{Counts, Coverage, Interval, bisection};
use crate::base::math;
use crate::base::special::ln_beta;

/// The logarithm of the mixture likelihood ratio over `m` in (0, 1), less that of S and F alone.
fn ln_mixture(counts: Counts) -> f64 {
    ln_beta(0.5 + counts.successes as f64, 0.5 + counts.failures as f64) - ln_beta(0.5, 0.5)
}

/// k ln x with 0 ln 0 = 0.
fn times_ln(k: u64, ln_x: f64) -> f64 {
    if k == 0 { 0.0 } else { k as f64 * ln_x }
}

/// Whether the evidence against `m`, in (0, 1), is below one over `delta`, or may be but for rounding: logarithms of
/// the size of the numbers of trials are off by some parts in 1e16 of themselves.
fn inside(counts: Counts, ln_mixture: f64, ln_delta: f64, m: f64) -> bool {
    let (successes, failures) =
        (times_ln(counts.successes, math::ln(m)), times_ln(counts.failures, math::ln_1p(-m)));
    let slack = math::at_least(1e-12, -2e-15 * (ln_mixture + successes + failures));
    -successes - failures < -ln_delta - ln_mixture + slack
}

/// Whether `m`, in (0, 1), lies in the interval: the same as the interval's ends say, without finding them.
pub fn holds(counts: Counts, delta: f64, m: f64) -> bool {
    inside(counts, ln_mixture(counts), math::ln(delta), m)
}

/// The interval at all times that misses with probability at most `delta`.
pub fn interval(counts: Counts, delta: f64) -> Interval {
    let (ln_mixture, ln_delta) = (ln_mixture(counts), math::ln(delta));
    let inside = |m: f64| inside(counts, ln_mixture, ln_delta, m);
    let share = counts.share();
    // Bisection outward of the share of successes, towards either end.
    let bound = |end: f64| bisection::halved(share, end, 100, inside).1;
    let none = counts.trials() == 0;
    Interval {
        low: if none || counts.successes == 0 { 0.0 } else { bound(0.0) },
        high: if none || counts.failures == 0 { 1.0 } else { bound(1.0) },
        error: delta,
        coverage: Coverage::TimeUniform,
    }
}

/// The same with unresolved trials, which may be successes or failures.
pub fn interval_with(counts: Counts, unresolved: u64, delta: f64) -> Interval {
    let Counts { successes, failures } = counts;
    let fewest = interval(Counts { successes, failures: failures + unresolved }, delta);
    fewest.hull(interval(Counts { successes: successes + unresolved, failures }, delta))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_lie_on_the_threshold() {
        for (successes, failures) in [(1, 0), (3, 7), (500, 500), (1, 99_999), (100_000, 3)] {
            let counts = Counts { successes, failures };
            let found = interval(counts, 0.05);
            for m in [found.low, found.high] {
                if m > 0.0 && m < 1.0 {
                    let value = ln_mixture(counts)
                        - times_ln(successes, math::ln(m))
                        - times_ln(failures, math::ln_1p(-m));
                    assert!((value - math::ln(20.0)).abs() < 1e-6, "{counts:?} {m}: {value}");
                }
            }
            assert!(found.holds(counts.share()));
        }
        assert_eq!(
            (interval(Counts::default(), 0.05).low, interval(Counts::default(), 0.05).high),
            (0.0, 1.0)
        );
    }

    /// The logarithms of the mixture, computed with 60 digits: rounding stays below the slack at the ends, where it is
    /// that of the numbers of trials.
    #[test]
    fn the_slack_covers_rounding_at_any_size() {
        for (successes, failures, exact) in [
            (1_000_000, 1_000_000, -1_386_301.841_240_237_5),
            (300_000_000, 700_000_000, -610_864_312.642_317_8),
            (999_999_999, 1, -32.350_410_878_529_26),
            (100_000, 10_000_000_000_000, -1_942_083.267_490_115_3),
            (1_000_000_000_000, 1_000_000_000_000, -1_386_294_361_134.278_5),
        ] {
            let counts = Counts { successes, failures };
            let error = (ln_mixture(counts) - exact).abs();
            assert!(error <= -1e-15 * exact, "{counts:?}: {error}");
            // At the end itself the evidence is one over delta but for that slack, and never less.
            let found = interval(counts, 0.05);
            assert!(found.low < counts.share() && counts.share() < found.high, "{counts:?}: {found:?}");
            assert!(
                !holds(counts, 0.05, found.low) && !holds(counts, 0.05, found.high),
                "{counts:?}: {found:?}"
            );
        }
    }

    #[test]
    fn without_successes_the_upper_end_has_a_closed_form() {
        let counts = Counts { successes: 0, failures: 1000 };
        let expected = 1.0 - math::exp((ln_mixture(counts) - math::ln(20.0)) / 1000.0);
        assert!((interval(counts, 0.05).high - expected).abs() < 1e-12);
    }
}
