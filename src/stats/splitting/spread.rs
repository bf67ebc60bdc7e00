//! The mean of independent runs and its interval by Student's t: asymptotic, too low where runs are skewed.

use crate::base::special::beta_quantile;
use crate::stats::invalid::{Invalid, probability, range};

/// The t beyond which, on both sides together, `delta` of Student's law lies.
pub fn student(freedom: f64, delta: f64) -> f64 {
    let x = beta_quantile(0.5 * freedom, 0.5, delta);
    (freedom * (1.0 - x) / x).sqrt()
}

/// Estimates of independent runs, summed up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// Number of runs.
    pub runs: u64,
    /// Mean.
    pub mean: f64,
    /// Standard deviation of one run.
    pub deviation: f64,
    /// Lower end of the interval; not below 0.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// Runs whose estimate is 0.
    pub extinct: u64,
    /// What the mean is certified not to be below, with an error of at most delta.
    pub floor: f64,
}

impl Spread {
    /// Of two runs or more; the interval misses with about `delta`.
    pub fn of(estimates: &[f64], delta: f64) -> Result<Self, Invalid> {
        probability("delta", delta)?;
        range("runs", estimates.len() as f64, 2.0, 1e6)?;
        let n = estimates.len() as f64;
        let mean = estimates.iter().sum::<f64>() / n;
        let squares: f64 = estimates.iter().map(|x| (x - mean) * (x - mean)).sum();
        let deviation = (squares / (n - 1.0)).sqrt();
        let half = student(n - 1.0, delta) * deviation / n.sqrt();
        let low = mean - half;
        Ok(Self {
            runs: estimates.len() as u64,
            mean,
            deviation,
            low: if low > 0.0 { low } else { 0.0 },
            high: mean + half,
            extinct: estimates.iter().filter(|x| **x == 0.0).count() as u64,
            floor: super::floor(estimates, delta),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_of_student() {
        // Tables: t(19) 2.0930, t(1) 12.706, t(1000) 1.9623.
        assert!((student(19.0, 0.05) - 2.093_024).abs() < 1e-5);
        assert!((student(1.0, 0.05) - 12.706_2).abs() < 1e-3);
        assert!((student(1000.0, 0.05) - 1.962_339).abs() < 1e-5);
    }

    #[test]
    fn a_spread_of_two() {
        let spread = Spread::of(&[0.0, 2.0], 0.05).unwrap();
        assert_eq!((spread.mean, spread.deviation, spread.extinct, spread.low), (1.0, 2f64.sqrt(), 1, 0.0));
        assert!((spread.high - 13.7062).abs() < 1e-3);
        assert!(Spread::of(&[1.0], 0.05).is_err());
    }
}
