//! Somebody who watches a run: progress and forecasts.

/// What a query is likely to take.
#[derive(Clone, Debug, PartialEq)]
pub struct Forecast {
    /// The query as written.
    pub query: String,
    /// Trials.
    pub trials: u64,
    /// Seconds.
    pub seconds: f64,
}

/// Somebody who watches a run. Nothing they do changes a result.
pub trait Watch {
    /// What a query is likely to take; told once, after the first trials.
    fn forecast(&self, _forecast: &Forecast) {}

    /// So many trials of a query are consumed, of so many that are expected.
    fn consumed(&self, _query: &str, _trials: u64, _of: Option<u64>) {}

    /// The run is over.
    fn finished(&self) {}
}

/// Nobody watches.
pub struct Nobody;

impl Watch for Nobody {}
