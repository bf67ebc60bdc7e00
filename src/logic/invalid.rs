//! Why a formula or metric cannot be monitored.

use thiserror::Error;

/// Why a formula or metric cannot be monitored. Numbers are ticks unless they say otherwise.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum Invalid {
    /// A bound reaches beyond the last state of a trial.
    #[error("the formula needs {needed} steps, the horizon is {horizon} steps")]
    BeyondHorizon {
        /// Last state that is looked at.
        needed: u64,
        /// Last state that a trial has.
        horizon: u64,
    },
    /// A window that holds no state.
    #[error("a window from step {from} to step {to} contains no state")]
    EmptyWindow {
        /// First state.
        from: u64,
        /// Last state, before the first.
        to: u64,
    },
    /// A part names a part that does not exist or that contains it.
    #[error("a part of the formula refers to a part that does not exist or that contains it")]
    Malformed,
    /// Too many levels of parts.
    #[error("the formula is nested {depth} levels deep; the limit is {limit}")]
    TooDeep {
        /// Levels.
        depth: u64,
        /// Most levels.
        limit: u64,
    },
    /// Nested windows that would need too many stored states.
    #[error("the nested windows of the formula need {needed} stored states; the limit is {limit}")]
    TooLarge {
        /// Stored states.
        needed: u64,
        /// Most stored states.
        limit: u64,
    },
    /// Sums or means up to the horizon, at so many states that all of them, which come at once there, take too long.
    #[error(
        "sums of all states up to the horizon, in each state, add {needed} numbers; the limit is {limit}"
    )]
    TooMany {
        /// Numbers that are added.
        needed: u64,
        /// Most of them.
        limit: u64,
    },
    /// A horizon that no trial ever reaches.
    #[error("the horizon of {horizon} steps is longer than {limit} steps")]
    TooLong {
        /// Last state of a trial.
        horizon: u64,
        /// Longest horizon.
        limit: u64,
    },
    /// A comparison of numbers that look at other states than the present one has no margin, except
    /// of the extremes of windows and of times with a constant.
    #[error("a comparison of an aggregate of several states has no margin")]
    NoMargin,
    /// A sum over continuous time.
    #[error("`sum` over time is not available in continuous time: write `mean`, the time average")]
    SumOverTime,
    /// A time or a time average, asked about at many moments, that is not compared with a constant.
    #[error("a time or a time average inside another window can only be compared with a constant")]
    MovingNumber,
    /// The clock has no steps.
    #[error("a clock without steps has no states to count")]
    NoSteps,
}
