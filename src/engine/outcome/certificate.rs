//! The certificate of a result in numbers. `QueryResult::certifies` says the same in words.

use crate::stats::Claim;
use std::fmt;

/// A claim about the quantity of a query, and how surely it holds.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Certificate {
    /// What is claimed.
    pub claim: Certified,
    /// The probability, at most, with which the procedure makes such a claim although it is false.
    pub error: f64,
}

impl fmt::Display for Certificate {
    /// `P > 0.48, error at most 0.01`; numbers in the unit of the result.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.claim {
            Certified::Decided(Claim::Above(p)) => write!(f, "P > {p}"),
            Certified::Decided(Claim::AtLeast(p)) => write!(f, "P >= {p}"),
            Certified::Decided(Claim::Below(p)) => write!(f, "P < {p}"),
            Certified::Decided(Claim::AtMost(p)) => write!(f, "P <= {p}"),
            Certified::Decided(Claim::Between(low, high)) => write!(f, "{low} < P < {high}"),
            Certified::Between { low, high } => write!(f, "between {low} and {high}"),
            Certified::Best { choice, gap } => write!(f, "`{choice}` is within {gap} of the best"),
            Certified::Nothing => write!(f, "no option satisfies the constraints"),
            Certified::Front { options } => write!(f, "none dominates `{}`", options.join("`, `")),
        }?;
        write!(f, ", error at most {}", self.error)
    }
}

/// What is claimed, in the unit of the result.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
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
    /// No option satisfies the constraints.
    Nothing,
    /// No option is better than one of these by the width of an aim without being worse in another; each other option exceeds
    /// one of these in no aim by as much.
    Front {
        /// Their names.
        options: Vec<String>,
    },
}
