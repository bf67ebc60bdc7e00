//! What a result certifies, in numbers. `QueryResult::certifies` says the same in words.

use crate::stats::Claim;

/// A claim about the quantity of a query, and how surely it holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Certificate {
    /// What is claimed.
    pub claim: Certified,
    /// The probability, at most, with which the procedure makes such a claim although it is false.
    pub error: f64,
}

/// What is claimed, in the unit of the result.
#[derive(Clone, Debug, PartialEq)]
pub enum Certified {
    /// A test has decided. For the check of a quantile it is about the probability that `QueryResult::of` names.
    Decided(Claim),
    /// The quantity lies between the two, inclusive; of a comparison it is the difference. An end may be infinite.
    Between {
        /// Lower end.
        low: f64,
        /// Upper end.
        high: f64,
    },
    /// An option of a ranking is at most so much worse than the best one.
    Best {
        /// Its name.
        choice: String,
        /// The largest loss.
        gap: f64,
    },
}
