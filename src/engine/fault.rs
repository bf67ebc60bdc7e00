//! What can go wrong in the engine.

use thiserror::Error;

/// Why a query cannot be run.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum Fault {
    /// A procedure refuses its parameters.
    #[error(transparent)]
    Statistics(#[from] crate::stats::Invalid),
    /// A monitor cannot be built.
    #[error(transparent)]
    Logic(#[from] crate::logic::Invalid),
    /// A procedure does not fit what is measured.
    #[error("this procedure does not fit what is measured")]
    Unsuitable,
    /// People that cannot be placed.
    #[error("{0}")]
    Placement(String),
    /// A trial in which the model is wrong.
    #[error("{0}")]
    Model(String),
    /// No threads can be started.
    #[error("no threads can be started: {0}")]
    Threads(String),
}
