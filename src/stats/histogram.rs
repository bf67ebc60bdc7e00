//! Counts of a metric in fixed bins.

use super::invalid::{Invalid, range};

/// A histogram of equal bins over [low, high), with what falls outside counted apart.
#[derive(Clone, Debug, PartialEq)]
pub struct Histogram {
    /// Lower end of the first bin.
    pub low: f64,
    /// Upper end of the last bin, which includes it.
    pub high: f64,
    /// Number of values in each bin.
    pub bins: Vec<u64>,
    /// Values below `low`.
    pub below: u64,
    /// Values above `high`, infinite ones included.
    pub above: u64,
    /// Values that are not numbers.
    pub unresolved: u64,
}

impl Histogram {
    /// `bins` equal bins from `low` to `high`.
    pub fn new(low: f64, high: f64, bins: usize) -> Result<Self, Invalid> {
        range("bins", bins as f64, 1.0, 1e6)?;
        if !(low < high && (high - low).is_finite()) {
            return Err(Invalid::Order { low_name: "low", low, high_name: "high", high });
        }
        Ok(Self { low, high, bins: vec![0; bins], below: 0, above: 0, unresolved: 0 })
    }

    /// Counts one value.
    pub fn add(&mut self, value: f64) {
        if value.is_nan() {
            self.unresolved += 1;
        } else if value < self.low {
            self.below += 1;
        } else if value > self.high {
            self.above += 1;
        } else {
            let place = (value - self.low) / (self.high - self.low) * self.bins.len() as f64;
            let last = self.bins.len() - 1;
            let bin = place as usize;
            self.bins[if bin < last { bin } else { last }] += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_value_is_counted_once() {
        let mut histogram = Histogram::new(0.0, 1.0, 4).unwrap();
        for value in [-0.1, 0.0, 0.249, 0.25, 0.5, 1.0, 1.1, f64::INFINITY, f64::NAN] {
            histogram.add(value);
        }
        assert_eq!(histogram.bins, [2, 1, 1, 1]);
        assert_eq!((histogram.below, histogram.above, histogram.unresolved), (1, 2, 1));
        assert!(Histogram::new(1.0, 1.0, 4).is_err());
        assert!(Histogram::new(0.0, 1.0, 0).is_err());
    }
}
