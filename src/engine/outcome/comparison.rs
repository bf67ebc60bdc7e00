//! The outcome of a `compare`.

use super::counts::Counts;
use super::interval::Interval;

/// The two sides of a `compare`.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// The side of `under`.
    pub first: Side,
    /// The side of `with`.
    pub second: Side,
    /// First less second, over pairs of trials with the same random numbers.
    pub difference: Side,
}

/// One side of a comparison, or the difference. Of the difference, `trials` counts pairs, successes those in
/// which only the first holds, and failures those in which only the second does.
#[derive(Clone, Debug, PartialEq)]
pub struct Side {
    /// Its settings, as written; for the difference `first - second`.
    pub label: String,
    /// What was measured.
    pub value: Interval,
    /// Its trials.
    pub counts: Counts,
}
