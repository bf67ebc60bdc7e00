//! What everybody in a crowd may ask, and the answers.

use crate::base::lanes::{Lanes, Mask};
use crate::kernel::code::node::{Cut, Measure};
use crate::model::Comparison;

/// What everybody may ask.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::kernel::code) enum Question {
    /// The smallest measure to the others; where it is cut perhaps something larger.
    Nearest {
        /// What is measured.
        measure: Measure,
        /// Where.
        cut: Cut,
    },
    /// Whether a comparison has the wanted value for all others.
    AllFar {
        /// What is measured.
        measure: Measure,
        /// Its comparison with the bound.
        test: Comparison,
        /// The value it must have.
        wanted: bool,
        /// The bits of the bound.
        bound: u64,
    },
}

/// Answers of all, by blocks of agents.
#[derive(Clone, Debug, Default)]
pub(super) struct All {
    /// The smallest measures; no numbers for those who are no members or not there.
    pub(super) nearest: Vec<Lanes>,
    /// Who has an answer to whether, and for whom it holds.
    pub(super) far: Vec<(Mask, Mask)>,
}

impl Question {
    pub(super) const fn measure(&self) -> Measure {
        match self {
            Self::Nearest { measure, .. } | Self::AllFar { measure, .. } => *measure,
        }
    }
}
