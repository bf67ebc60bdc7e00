//! How the values of a metric are distributed.

use super::Interval;

/// How the values of a metric are distributed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Distribution {
    /// Counts in bins of equal width.
    pub histogram: Option<Histogram>,
    /// Quantiles, by level ascending.
    pub quantiles: Vec<Quantile>,
    /// The empirical distribution function, at a hundred shares at most.
    pub empirical: Vec<Step>,
    /// The true function is nowhere farther than this from the empirical one, with the error of the result (Dvoretzky,
    /// Kiefer, Wolfowitz; Massart), however unresolved trials are read. `None` where the number of trials depends on
    /// the values.
    pub band: Option<f64>,
    /// The probability as a function of a time, where that was asked; the rest is empty then.
    pub curve: Option<Curve>,
}

/// A step of the empirical distribution function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// A value; infinite beyond the horizon.
    pub value: f64,
    /// Share of the resolved trials with at most this value.
    pub share: f64,
}

/// A probability as a function of a time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Curve {
    /// Its points, by time ascending; their intervals hold jointly.
    pub points: Vec<CurvePoint>,
    /// Half of the width of the band, before it is cut at 0 and 1.
    pub reach: f64,
    /// The name of the bound.
    pub name: String,
    /// The unit of times: `s`, or `steps`.
    pub unit: String,
}

/// A point of a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurvePoint {
    /// The time.
    pub at: f64,
    /// The probability.
    pub value: Interval,
}

/// Counts in bins of equal width.
#[derive(Clone, Debug, PartialEq)]
pub struct Histogram {
    /// Lower end of the first bin.
    pub low: f64,
    /// Upper end of the last bin.
    pub high: f64,
    /// Trials per bin.
    pub counts: Vec<u64>,
    /// Trials with the value -∞: a difference of times of which the second does not come.
    pub below: u64,
    /// Trials with the value ∞.
    pub beyond: u64,
}

/// One quantile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quantile {
    /// Its level, in (0, 1).
    pub level: f64,
    /// Its value; infinite beyond the horizon.
    pub value: Interval,
}
