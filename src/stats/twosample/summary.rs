//! A sample in seven numbers. Quantiles interpolate between order statistics (Hyndman and Fan 1996, type 7), as R, numpy and
//! spreadsheets do.

/// A sample in numbers; all of them NaN where it is empty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Summary {
    /// Number of values.
    pub count: usize,
    /// Mean.
    pub mean: f64,
    /// Median.
    pub median: f64,
    /// Lower quartile.
    pub low_quartile: f64,
    /// Upper quartile.
    pub high_quartile: f64,
    /// 95th percentile.
    pub p95: f64,
    /// Largest value.
    pub max: f64,
}

impl Summary {
    /// Of values in any order.
    pub fn of(values: &[f64]) -> Self {
        let mut sorted = values.to_vec();
        sorted.sort_unstable_by(f64::total_cmp);
        let at = |q| quantile(&sorted, q);
        Self {
            count: values.len(),
            mean: values.iter().sum::<f64>() / values.len() as f64,
            median: at(0.5),
            low_quartile: at(0.25),
            high_quartile: at(0.75),
            p95: at(0.95),
            max: at(1.0),
        }
    }

    /// Interquartile range.
    pub fn iqr(&self) -> f64 {
        self.high_quartile - self.low_quartile
    }
}

/// The `q`-quantile of ascending values; NaN of none.
pub fn quantile(sorted: &[f64], q: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else { return f64::NAN };
    let place = last as f64 * q;
    let below = (place as usize).min(last);
    let (low, high) = (sorted[below], sorted[(below + 1).min(last)]);
    low + (place - below as f64) * (high - low)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_summary_has_the_numbers_of_numpy() {
        // numpy.percentile([3, 1, 4, 1, 5, 9, 2, 6], [25, 50, 75, 95])
        let summary = Summary::of(&[3.0, 1.0, 4.0, 1.0, 5.0, 9.0, 2.0, 6.0]);
        assert_eq!((summary.low_quartile, summary.median, summary.high_quartile), (1.75, 3.5, 5.25));
        assert!((summary.p95 - 7.95).abs() < 1e-12);
        assert_eq!((summary.count, summary.mean, summary.max, summary.iqr()), (8, 3.875, 9.0, 3.5));
        assert_eq!(Summary::of(&[2.0]).iqr(), 0.0);
        assert!(Summary::of(&[]).median.is_nan());
    }
}
