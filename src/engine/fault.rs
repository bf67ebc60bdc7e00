//! What can go wrong in the engine.

use crate::engine::flaw::Flaw;
use crate::syntax::source::Span;
use thiserror::Error;

/// Most values of metrics that are kept at once: their distribution is reported.
pub(super) const MOST_VALUES: u64 = 1 << 28;

/// What so many values take, GB.
fn gigabytes(values: u64) -> f64 {
    values as f64 * 8.0 / 1e9
}

/// Why a query cannot be run.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum Fault {
    /// A procedure refuses its parameters.
    #[error(transparent)]
    Statistics(#[from] crate::stats::Invalid),
    /// A procedure refuses the parameters of a query.
    #[error("{reason}")]
    Procedure {
        /// The query.
        place: Span,
        /// Why.
        reason: crate::stats::Invalid,
    },
    /// A monitor cannot be built.
    #[error(transparent)]
    Logic(#[from] crate::logic::Invalid),
    /// A procedure does not fit what is measured.
    #[error("the procedure is not available for this measure")]
    Unsuitable,
    /// People that cannot be placed.
    #[error("{reason}")]
    Placement {
        /// In words.
        reason: String,
        /// Where the start of the first of them is written.
        place: Option<Span>,
    },
    /// Places where more people are to start than fit, each as a fault of its own.
    #[error("{}", .0.first().map(ToString::to_string).unwrap_or_default())]
    Crowded(Vec<Fault>),
    /// More values than fit into memory.
    #[error("the values of metrics need {:.1} GB; the limit is {:.1} GB", gigabytes(*.values), gigabytes(MOST_VALUES))]
    Memory {
        /// The first query of those that share trials.
        place: Span,
        /// How many values are kept at most.
        values: u64,
    },
    /// A trial in which the model is wrong.
    #[error("{0}")]
    Model(Box<Flaw>),
    /// No threads can be started.
    #[error("no threads can be started: {0}")]
    Threads(String),
}
