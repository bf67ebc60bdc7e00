//! Somebody who watches a run: progress and forecasts.

/// What a query is likely to take.
#[derive(Clone, Debug, PartialEq)]
pub struct Forecast {
    /// The query as written.
    pub query: String,
    /// Values of swept parameters, as written.
    pub settings: Vec<(String, String)>,
    /// Trials; of a ranking those of all options, of a comparison those of both sides.
    pub trials: u64,
    /// Seconds on its own. Checks and estimates of one scenario share their trials.
    pub seconds: f64,
}

/// What a call is likely to take.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outlook {
    /// Query by query, in the order in which they are answered.
    pub queries: Vec<Forecast>,
    /// Seconds of all of them, shared trials counted once.
    pub seconds: f64,
}

/// Somebody who watches a run. Nothing they do changes a result.
pub trait Watch {
    /// What the call is likely to take; told once, before sampling, and never where there is a deadline.
    fn forecast(&self, _outlook: &Outlook) {}

    /// So many trials of a query are consumed, of so many that are expected.
    fn consumed(&self, _query: &str, _trials: u64, _of: Option<u64>) {}

    /// The run is over.
    fn finished(&self) {}
}

/// Nobody watches.
pub struct Nobody;

impl Watch for Nobody {}
