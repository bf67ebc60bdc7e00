//! Consumed trials, by outcome and by what else is counted of them.

/// The trials that a result was computed from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ConsumedTrials {
    /// Their number, in all and by outcome.
    pub counts: Counts,
    /// Those clipped by a declared range.
    pub clipped: u64,
    /// Those in which radii were shrunk to part people who overlap at the start.
    pub shrunk: u64,
    /// Those in which somebody had no way to a goal.
    pub no_way: u64,
    /// Steps of the model in all of them.
    pub steps: u64,
}

/// Consumed trials by outcome. Trials with a number instead of a truth value are neither successes nor
/// failures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// All.
    pub trials: u64,
    /// Those in which the formula holds.
    pub successes: u64,
    /// Those in which it does not.
    pub failures: u64,
    /// Those that diverged or hit a cap.
    pub unresolved: u64,
}
