//! An estimate by splitting.

/// An estimate by splitting, with the plain trials beside it.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Rare {
    /// Independent runs.
    pub runs: u64,
    /// Runs in which no path reached the event.
    pub extinct: u64,
    /// Standard deviation of the estimate of one run.
    pub deviation: f64,
    /// Levels of a run, on average.
    pub levels: f64,
    /// Paths of all runs.
    pub paths: u64,
    /// Steps of the model in all paths.
    pub steps: u64,
    /// Mean of the runs; `None` if they did not come to an end.
    pub estimate: Option<f64>,
    /// Lower end of the asymptotic interval.
    pub low: f64,
    /// Upper end of it.
    pub high: f64,
    /// Lower end of the 99 % interval of the plain trials.
    pub plain_low: f64,
    /// Upper end of it.
    pub plain_high: f64,
    /// Upper bound of the probability, certified by the plain trials alone.
    pub plain_bound: f64,
    /// Lower bound of the probability, certified by the runs.
    pub floor: f64,
    /// Whether the mean of the runs lies in the interval of the plain trials; if not, it is refused.
    pub agrees: bool,
}
