//! One thing that is asked of each trace.

use super::{NodeId, Part, Relation, TermId};

/// A formula or a metric.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Root {
    /// A formula.
    Formula(NodeId),
    /// A metric.
    Metric(TermId),
    /// How far a formula is from changing its truth. All its conditions are comparisons of numbers.
    Robustness(NodeId, Sought),
}

/// What is wanted of a robustness: once its bounds force that, a trial can end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sought {
    /// Its value.
    Value,
    /// Its value where that lies in a range, else the side on which it lies outside.
    Clipped(f64, f64),
    /// Whether it is related so to a number.
    Compared(Relation, f64),
}

impl Root {
    /// The part of the tree that it is.
    pub const fn part(self) -> Part {
        match self {
            Self::Formula(node) | Self::Robustness(node, _) => Part::Node(node),
            Self::Metric(term) => Part::Term(term),
        }
    }
}
