//! Percentile intervals of a statistic of persons by the bootstrap (Efron 1979): the ends are quantiles of the
//! statistic over resamples of the persons.
//!
//! The instants of one person depend on each other, so whole persons are drawn with replacement, each with all its
//! instants (Davison and Hinkley 1997, section 3.8). A statistic reads how often each person counts.

use crate::base::math;
use crate::base::random::{Purpose, Stream, TrialKey};
use serde::Serialize;

/// Usual number of resamples.
pub const DRAWS: u32 = 1000;

/// How persons are resampled. Statistics with one seed read the same resamples, so they can be compared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bootstrap {
    /// Number of persons.
    pub persons: usize,
    /// Number of resamples.
    pub draws: u32,
    /// Seed of the draws.
    pub seed: u64,
    /// Probability with which an interval shall contain the true value, such as 0.95.
    pub confidence: f64,
}

/// A statistic of all persons and its interval.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Estimate {
    /// The statistic of all persons, each counted once.
    #[serde(rename = "estimate")]
    pub value: f64,
    /// Its ends, ascending. `None` with fewer than two persons, or if less than half of the resamples have a value.
    pub interval: Option<[f64; 2]>,
}

impl Estimate {
    /// With the basic interval (Davison and Hinkley 1997, section 5.2.1): the ends are reflected at the value. It is
    /// for a statistic that is never negative and too large in small samples, such as a mean distance: resamples
    /// double its bias. The interval is extended to the value where it lies below it.
    #[must_use]
    pub fn reflected(self) -> Self {
        let reflect = |[low, high]: [f64; 2]| {
            let below = if low < self.value { low } else { self.value };
            [math::at_least(2.0 * self.value - high, 0.0), 2.0 * self.value - below]
        };
        Self { interval: self.interval.map(reflect), ..self }
    }
}

impl Bootstrap {
    /// A statistic and its interval. The statistic reads how often each person counts. It may have no value; resamples
    /// without a value are left out.
    pub fn estimate(&self, statistic: impl Fn(&[u32]) -> Option<f64>) -> Option<Estimate> {
        let [found] = self.estimates(|counts| [statistic(counts)]);
        found
    }

    /// Several statistics of the same resamples.
    pub fn estimates<const N: usize>(
        &self,
        statistics: impl Fn(&[u32]) -> [Option<f64>; N],
    ) -> [Option<Estimate>; N] {
        let values = statistics(&vec![1; self.persons]);
        let mut resampled = [const { Vec::new() }; N];
        // The resamples of one person are all alike, and do not show how much persons differ.
        if self.persons > 1 {
            for draw in 0..self.draws {
                let found = statistics(&self.resample(draw));
                resampled.iter_mut().zip(found).for_each(|(all, value)| all.extend(value));
            }
        }
        let mut resampled = resampled.into_iter();
        values.map(|value| {
            let interval = resampled.next().and_then(|all| self.interval(all));
            value.map(|value| Estimate { value, interval })
        })
    }

    /// How often each person is drawn.
    fn resample(&self, draw: u32) -> Vec<u32> {
        let key = TrialKey { seed: self.seed, index: u64::from(draw), branch: 0 };
        let stream = Stream::of(key, 0, Purpose::Resample);
        let n = self.persons;
        let mut counts = vec![0; n];
        for uniform in (0..n.div_ceil(2)).flat_map(|pair| stream.uniform_pair(pair as u32)).take(n) {
            // The product may round up to the number of persons.
            counts[((uniform * n as f64) as usize).min(n - 1)] += 1;
        }
        counts
    }

    /// The percentile interval of resampled values.
    fn interval(&self, mut values: Vec<f64>) -> Option<[f64; 2]> {
        if values.is_empty() || 2 * values.len() < self.draws as usize {
            return None;
        }
        values.sort_unstable_by(f64::total_cmp);
        Some(percentiles(&values, self.confidence))
    }
}

/// The ends of the percentile interval of a statistic, by its values in some resamples, ascending.
pub(super) fn percentiles(values: &[f64], confidence: f64) -> [f64; 2] {
    // The ends have these ranks among the resamples and the sample itself.
    let rank = |share: f64| (share * (values.len() + 1) as f64).round() as usize;
    let tail = 0.5 * (1.0 - confidence);
    [tail, 1.0 - tail].map(|share| values[rank(share).clamp(1, values.len()) - 1])
}

/// The ratio of two sums over persons, each with parts of both: a mean over all instants, or a share of them. It has
/// no value where the second sum is 0.
pub fn ratio(parts: &[[f64; 2]]) -> impl Fn(&[u32]) -> Option<f64> {
    move |counts| {
        let sum = |k: usize| counts.iter().zip(parts).map(|(n, part)| f64::from(*n) * part[k]).sum::<f64>();
        let whole = sum(1);
        (whole != 0.0).then(|| sum(0) / whole)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bootstrap(persons: usize, seed: u64) -> Bootstrap {
        Bootstrap { persons, draws: 499, seed, confidence: 0.95 }
    }

    /// Persons of 1 to 8 instants, each with a probability of its own: outcomes that happened, and all.
    fn persons(index: u64) -> Vec<[f64; 2]> {
        let stream = Stream::of(TrialKey { seed: 4, index, branch: 0 }, 0, Purpose::Test);
        let one = |person: u32| {
            let draw = |k: u32| stream.uniform(10 * person + k);
            let (count, probability) = (1 + (8.0 * draw(0)) as u32, draw(1));
            let happened = (0..count).filter(|k| draw(2 + k) < probability).count();
            [happened as f64, f64::from(count)]
        };
        (0..50).map(one).collect()
    }

    /// The share is one half. 95 % with a standard deviation of 1.1 %; instants as if independent would cover far
    /// less.
    #[test]
    fn intervals_over_persons_contain_the_true_share() {
        let (mut covered, mut as_independent) = (0, 0);
        for index in 0..400 {
            let found = bootstrap(50, index).estimate(ratio(&persons(index))).unwrap();
            let [low, high] = found.interval.unwrap();
            covered += u32::from(low <= 0.5 && 0.5 <= high);
            let count: f64 = persons(index).iter().map(|[_, count]| count).sum();
            let reach = 1.96 * (found.value * (1.0 - found.value) / count).sqrt();
            as_independent += u32::from((found.value - 0.5).abs() <= reach);
        }
        assert!((360..=392).contains(&covered), "{covered}");
        assert!(as_independent < 340, "{as_independent}");
    }

    #[test]
    fn each_resample_has_all_persons_and_depends_on_its_seed_alone() {
        let mut all = [0; 5];
        for draw in 0..2000 {
            let counts = bootstrap(5, 1).resample(draw);
            assert_eq!(counts.iter().sum::<u32>(), 5);
            all.iter_mut().zip(counts).for_each(|(sum, count)| *sum += count);
        }
        // 2000 expected for each, standard deviation 40.
        assert!(all.iter().all(|count| count.abs_diff(2000) < 160), "{all:?}");
        let found = |seed| bootstrap(50, seed).estimate(ratio(&persons(0)));
        assert_eq!(found(1), found(1));
        assert_ne!(found(1), found(2));
    }

    #[test]
    fn statistics_without_a_value() {
        assert_eq!(bootstrap(0, 0).estimate(ratio(&[])), None);
        assert_eq!(bootstrap(2, 0).estimate(ratio(&[[0.0, 0.0]; 2])), None);
        let alone = bootstrap(1, 0).estimate(ratio(&[[1.0, 4.0]]));
        assert_eq!(alone, Some(Estimate { value: 0.25, interval: None }), "one person shows no difference");
        // A resample lacks one of three persons with probability 8 / 27, and two of them are often lacked.
        let of_the_first = |counts: &[u32]| (counts[0] > 0).then_some(1.0);
        let found = bootstrap(3, 0).estimate(of_the_first).unwrap();
        assert_eq!(found.interval, Some([1.0, 1.0]));
        let of_all = |counts: &[u32]| counts.iter().all(|count| *count > 0).then_some(1.0);
        assert_eq!(bootstrap(3, 0).estimate(of_all).unwrap().interval, None, "2 of 9 have a value");
        let many = Bootstrap { draws: 0, ..bootstrap(3, 0) };
        assert_eq!(many.estimate(of_all), Some(Estimate { value: 1.0, interval: None }));
    }

    #[test]
    fn a_reflected_interval_contains_the_value_and_is_not_negative() {
        let of = |low, high| Estimate { value: 0.5, interval: Some([low, high]) }.reflected().interval;
        assert_eq!(of(0.25, 0.75), Some([0.25, 0.75]));
        assert_eq!(of(0.375, 1.5), Some([0.0, 0.625]));
        assert_eq!(of(0.75, 0.875), Some([0.125, 0.5]));
    }
}
