//! Knowledge about the clock of a scenario with errors: an error about a time is reported only if it is certain.

use crate::syntax::ast::{Item, ScenarioFile};
use crate::syntax::codes::Code;

/// How much of a clock is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Told {
    /// Nothing, not even whether there are steps.
    Nothing,
    /// That there are steps of a fixed length in seconds.
    Stepped,
    /// The length of a step.
    Step,
    /// All of it, the horizon too.
    Whole,
}

impl Told {
    /// The knowledge that an error with this code needs.
    pub(super) fn needed(code: Code) -> Self {
        match code {
            Code::E0502 => Self::Whole,
            Code::E0501 => Self::Step,
            Code::E0503 | Code::E0507 | Code::E0508 => Self::Stepped,
            _ => Self::Nothing,
        }
    }
}

/// Whether a scenario has bodies, which move by steps.
pub(super) fn has_bodies(file: &ScenarioFile) -> bool {
    file.items.iter().any(|item| {
        matches!(item, Item::Agents(_) | Item::Group(_) | Item::Source(_) | Item::Moves(_) | Item::Scene(_))
    })
}

/// Whether a scenario has steps of a fixed length in seconds, whatever its processes are.
pub(super) fn is_stepped(file: &ScenarioFile) -> bool {
    let sets = |item: &Item| matches!(item, Item::Setting { name, .. } if name.name == "step");
    has_bodies(file) || file.items.iter().any(sets)
}
