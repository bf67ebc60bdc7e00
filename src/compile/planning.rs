//! What a planned kind has beside the parameters of a body: its fields and its defaults.

use super::presets;
use crate::model::planner::{RoadmapRule, SpeedRule, planned_default};
use crate::model::{self, Law, Parameter};

/// The fields.
pub(super) const FIELDS: [&str; 4] = ["limit acceleration", "roadmap", "profile", "avoid"];
/// The preset of the force that planned walkers feel unless their kind says otherwise.
pub(super) const FORCE: &str = "helbing2000";

/// How the walkers of a kind plan, as far as it is known.
#[derive(Clone, Debug)]
pub(super) struct Planning {
    pub(super) roadmap: RoadmapRule,
    pub(super) clearance: f64,
    pub(super) profile: SpeedRule,
}

impl Default for Planning {
    fn default() -> Self {
        Self { roadmap: RoadmapRule::default(), clearance: 0.2, profile: SpeedRule::Varied }
    }
}

/// Whether a planned kind takes the law of a parameter from the force that it avoids others by.
pub(super) fn is_of_force(parameter: Parameter) -> bool {
    let is_own = matches!(parameter, Parameter::Radius | Parameter::Speed);
    !is_own && parameter.description().kinds.contains(&model::Kind::Sfm)
}

/// The law that a planned kind has of a parameter unless it is set.
pub(super) fn default_law(parameter: Parameter, limit: Option<&Law>) -> Option<Law> {
    let of_force = || presets::law(FORCE, parameter).filter(|_| is_of_force(parameter));
    planned_default(parameter, limit).or_else(of_force)
}
