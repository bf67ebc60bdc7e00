//! Somebody who watches a run: progress and forecasts.

use crate::compile::study::Query;

/// What a query is likely to take.
#[derive(Clone, Debug, PartialEq)]
pub struct Forecast {
    /// The query as written.
    pub query: String,
    /// Values of swept parameters, as written.
    pub settings: Vec<(String, String)>,
    /// Trials; of a ranking those of all options, of a comparison those of both sides.
    pub trials: Likely,
    /// Seconds that the likely trials take on their own. Checks and estimates of one scenario share their trials.
    pub seconds: f64,
}

/// A number that a few trials foretell: in nine of ten cases it lies between two others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Likely {
    /// The lower end.
    pub least: u64,
    /// The likely number.
    pub likely: u64,
    /// The upper end.
    pub most: u64,
}

impl Likely {
    /// A number that is known.
    pub const fn exactly(number: u64) -> Self {
        Self { least: number, likely: number, most: number }
    }

    /// Each of the three changed alike.
    #[must_use]
    pub fn map(self, change: impl Fn(u64) -> u64) -> Self {
        Self { least: change(self.least), likely: change(self.likely), most: change(self.most) }
    }
}

impl Forecast {
    /// Of a query, of which each trial takes some seconds.
    pub(in crate::engine) fn of(query: &Query, trials: Likely, seconds: f64) -> Self {
        let (text, settings) = (query.text.clone(), query.settings.clone());
        Self { query: text, settings, trials, seconds: trials.likely as f64 * seconds }
    }

    /// Seconds of the fewest and of the most trials.
    pub fn seconds_between(&self) -> (f64, f64) {
        let each = self.seconds / self.trials.likely.max(1) as f64;
        (each * self.trials.least as f64, each * self.trials.most as f64)
    }
}

/// What a call is likely to take.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CallForecast {
    /// Query by query, in the order in which they are answered.
    pub queries: Vec<Forecast>,
    /// Seconds of all of them, shared trials counted once.
    pub seconds: f64,
    /// The same, of the fewest and of the most trials of each.
    pub between: (f64, f64),
}

/// Somebody who watches a run. Nothing they do changes a result.
pub trait Watch {
    /// What the call is likely to take; told once, before sampling, and never where there is a deadline.
    fn forecast(&self, _total: &CallForecast) {}

    /// The first trial is about to run: scenes and stopping rules are prepared.
    fn samples(&self) {}

    /// So many trials of a query are consumed, of so many that are expected.
    fn consumed(&self, _query: &str, _trials: u64, _of: Option<u64>) {}

    /// The run is over.
    fn finished(&self) {}
}

/// Nobody watches.
pub struct Nobody;

impl Watch for Nobody {}
