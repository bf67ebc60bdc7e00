//! The Clopper-Pearson interval (Biometrika 26, 1934): exact coverage at a number of trials fixed in
//! advance. At a number of trials that depends on the data it guarantees nothing.

use crate::base::special::{beta_quantile, beta_tails, beta_upper_quantile};
use crate::stats::invalid::{Invalid, probability, range};
use crate::stats::{Counts, Coverage, Estimator, Interval, Rule, Sequential, bisection};

/// Lower end at one-sided level `tail`: P(at least this many successes) is `tail` there. 0 without successes.
pub fn lower(counts: Counts, tail: f64) -> f64 {
    if counts.successes == 0 {
        return 0.0;
    }
    beta_quantile(counts.successes as f64, counts.failures as f64 + 1.0, tail).next_down()
}

/// Upper end at one-sided level `tail`. 1 without failures.
pub fn upper(counts: Counts, tail: f64) -> f64 {
    if counts.failures == 0 {
        return 1.0;
    }
    beta_upper_quantile(counts.successes as f64 + 1.0, counts.failures as f64, tail).next_up()
}

/// The two-sided interval at error `delta`, half of it on either side.
pub fn interval(counts: Counts, delta: f64) -> Interval {
    Interval {
        low: lower(counts, 0.5 * delta),
        high: upper(counts, 0.5 * delta),
        error: delta,
        coverage: Coverage::FixedSize,
    }
}

/// Whether the two-sided interval at error `delta` is at most `width` wide. Cheaper than both ends.
pub(in crate::stats) fn narrow(counts: Counts, delta: f64, width: f64) -> bool {
    let tail = 0.5 * delta;
    // From the end that is nearer to 0, so that its other tail is the plain one.
    let counts = if counts.successes > counts.failures {
        Counts { successes: counts.failures, failures: counts.successes }
    } else {
        counts
    };
    if counts.failures == 0 {
        return width >= 1.0;
    }
    let other = lower(counts, tail) + width;
    if other >= 1.0 {
        return true;
    }
    let (a, b) = (counts.successes as f64 + 1.0, counts.failures as f64);
    beta_tails(a, b, other, 1.0 - other).ln_upper <= crate::base::math::ln(tail)
}

/// The number of trials at which the interval's half-width is at most `epsilon` whatever the outcomes.
pub fn size(epsilon: f64, delta: f64) -> u64 {
    // The interval is widest at half successes; with an odd number, at either neighbour.
    let enough = |n: u64| narrow(Counts { successes: n / 2, failures: n - n / 2 }, delta, 2.0 * epsilon);
    let mut high = 2;
    while !enough(high) && high < 1 << 50 {
        high *= 2;
    }
    high = bisection::first(high / 2, high, enough);
    // Odd and even numbers differ a little: go back while all from there on suffice.
    while high > 2 && enough(high - 1) {
        high -= 1;
    }
    high
}

/// Estimation by a number of trials fixed in advance.
#[derive(Clone, Debug, PartialEq)]
pub struct FixedSize {
    size: u64,
    delta: f64,
}

impl FixedSize {
    /// `size` trials, an interval at error `delta`.
    pub fn new(size: u64, delta: f64) -> Result<Sequential<Self>, Invalid> {
        range("trials", size as f64, 1.0, 1e15)?;
        probability("delta", delta)?;
        Ok(Sequential::new(Self { size, delta }))
    }
}

impl Rule for FixedSize {
    type Answer = bool;

    #[inline]
    fn look(&mut self, counts: Counts, _: bool) -> bool {
        counts.trials() >= self.size
    }

    fn limit(&self) -> Option<u64> {
        Some(self.size)
    }

    fn is_planned(&self) -> bool {
        true
    }
}

impl Estimator for FixedSize {
    fn error(&self) -> f64 {
        self.delta
    }

    fn at_stop(&self, counts: Counts) -> Interval {
        interval(counts, self.delta)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(n: u64, s: u64) -> (f64, f64) {
        let interval = interval(Counts { successes: s, failures: n - s }, 0.05);
        (interval.low, interval.high)
    }

    /// T8.
    #[test]
    fn values_of_the_reference() {
        let cases = [
            (10, 0, 0.0, 0.308_497_107_8, 1e-10),
            (10, 3, 0.066_739_511_2, 0.652_452_850_1, 1e-10),
            (100, 5, 0.016_431_879_2, 0.112_834_911_1, 1e-10),
            (1000, 1, 0.000_025_317_5, 0.005_558_924_3, 1e-10),
            (100_000, 3, 6.186_8e-6, 8.767_02e-5, 1e-10),
            (1_000_000, 0, 0.0, 3.688_9e-6, 5e-11),
        ];
        for (n, s, low, high, tolerance) in cases {
            let (own_low, own_high) = at(n, s);
            assert!((own_low - low).abs() < tolerance, "{n} {s}: {own_low}");
            assert!((own_high - high).abs() < tolerance, "{n} {s}: {own_high}");
            let (mirror_low, mirror_high) = at(n, n - s);
            assert!((mirror_low - (1.0 - own_high)).abs() < 1e-14);
            assert!((mirror_high - (1.0 - own_low)).abs() < 1e-14);
        }
    }

    #[test]
    fn the_cheap_check_is_the_width_of_the_interval() {
        for n in [1u64, 2, 5, 17, 100, 462] {
            for s in 0..=n {
                let counts = Counts { successes: s, failures: n - s };
                let width = 2.0 * interval(counts, 0.035).half_width();
                assert!(narrow(counts, 0.035, width + 1e-9), "{n} {s}");
                assert!(!narrow(counts, 0.035, width - 1e-9), "{n} {s}");
            }
        }
    }

    /// T7: the size of the reference.
    #[test]
    fn the_size_for_a_width() {
        assert_eq!(size(0.01, 0.05), 9701);
    }
}
