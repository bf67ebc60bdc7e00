//! What is observed of the states of a trial: formulas, numbers and conditions, and how each was written.

use crate::compile::context::{interned::Interned, wording::Texts};
use crate::compile::dimension::Dimension;
use crate::logic::Tree;
use crate::model::{Bool, Num};
use crate::syntax::source::Span;

/// What is observed of the states of a trial.
#[derive(Default)]
pub(crate) struct Observed {
    /// Formulas and numbers over states.
    pub(crate) tree: Tree,
    /// Truth values of a state.
    pub(crate) atoms: Vec<Bool>,
    /// How many of them stood before the present measure.
    pub(crate) atoms_before: usize,
    /// Whether the present measure has more of them than there may be: what it stands for is not known.
    pub(crate) overflown: bool,
    /// Numbers of a state.
    pub(crate) signals: Vec<Num>,
    /// Where nodes, terms, atoms and signals are.
    pub(crate) known: [Interned; 4],
    /// How atoms, signals and comparisons were written.
    pub(crate) texts: Texts,
}

/// Knowledge about the margins of the formula that is being lowered.
#[derive(Clone, Debug, Default)]
pub(crate) struct Margins {
    /// Dimension of the first condition with a margin, and where it stands.
    pub(crate) first: Option<(Dimension, Span)>,
    /// Whether another dimension was found.
    pub(crate) mixed: bool,
    /// How many numbers are around the present place: conditions inside a number are none of the formula.
    pub(crate) inside: u32,
    /// The first equality of numbers, which has none, and what to write instead.
    pub(crate) equality: Option<(Span, String)>,
}
