//! How many times as wide one sample is as another: the ratio of interquartile ranges, with the percentile interval of the
//! bootstrap (Efron 1979).

use super::summary::quantile;
use super::{Draws, below};
use crate::stats::bootstrap::percentiles;

/// A ratio of interquartile ranges.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpreadRatio {
    /// Interquartile range of the second sample over that of the first.
    pub ratio: f64,
    /// Lower end of the interval.
    pub low: f64,
    /// Upper end of the interval.
    pub high: f64,
}

/// The ratio of `b` to `a` and an interval at this confidence; `None` where the range of `a` is 0 or a sample is empty.
pub fn spread_ratio(
    a: &[f64],
    b: &[f64],
    confidence: f64,
    resamples: u32,
    draws: Draws,
) -> Option<SpreadRatio> {
    let range = |values: &mut Vec<f64>| {
        values.sort_unstable_by(f64::total_cmp);
        quantile(values, 0.75) - quantile(values, 0.25)
    };
    let ratio = range(&mut b.to_vec()) / range(&mut a.to_vec());
    if !ratio.is_finite() {
        return None;
    }
    let mut room = Vec::new();
    let mut ratios = Vec::with_capacity(resamples as usize);
    for repetition in 0..resamples {
        let stream = draws.stream(repetition);
        let mut again = |values: &[f64], first: usize| {
            room.clear();
            room.extend((0..values.len()).map(|k| values[below(stream, (first + k) as u32, values.len())]));
            range(&mut room)
        };
        // A resample of `a` without a range bounds nothing from above.
        let one = again(b, a.len()) / again(a, 0);
        ratios.push(if one.is_nan() { f64::INFINITY } else { one });
    }
    ratios.sort_unstable_by(f64::total_cmp);
    let [low, high] = if resamples == 0 { [ratio; 2] } else { percentiles(&ratios, confidence) };
    Some(SpreadRatio { ratio, low, high })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::random::{Purpose, Stream, TrialKey};

    fn normal(index: u64, count: u32, scale: f64) -> Vec<f64> {
        let stream = Stream::of(TrialKey { seed: 9, index, branch: 0 }, 0, Purpose::Test);
        (0..count).map(|k| scale * stream.normal_pair(k)[0]).collect()
    }

    /// The interval has its confidence: 200 pairs of samples, 95 % with a standard deviation of 1.5 %.
    #[test]
    fn intervals_contain_the_true_ratio() {
        for scale in [1.0, 0.5] {
            let of = |k: u64| {
                let draws = Draws { seed: k, procedure: 0 };
                spread_ratio(&normal(2 * k, 60, 1.0), &normal(2 * k + 1, 60, scale), 0.95, 199, draws)
                    .unwrap()
            };
            let all: Vec<SpreadRatio> = (0..200).map(of).collect();
            let contain = all.iter().filter(|one| one.low <= scale && scale <= one.high).count();
            assert!((180..=199).contains(&contain), "{contain}");
            assert!(all.iter().all(|one| one.low <= one.ratio && one.ratio <= one.high));
        }
    }

    #[test]
    fn a_range_of_zero_is_no_denominator() {
        let draws = Draws::default();
        assert_eq!(spread_ratio(&[1.0; 9], &[1.0, 2.0], 0.95, 99, draws), None);
        assert_eq!(spread_ratio(&[], &[1.0, 2.0], 0.95, 99, draws), None);
        let found = spread_ratio(&[1.0, 2.0], &[1.0; 9], 0.95, 99, draws).unwrap();
        assert_eq!((found.ratio, found.low), (0.0, 0.0));
        assert_eq!(found.high, f64::INFINITY, "half of the resamples of two values have no range");
    }
}
