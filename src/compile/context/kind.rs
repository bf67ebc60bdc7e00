//! A kind of agents as far as it is known, with all that planned kinds have beside the parameters of a body.

use crate::compile::presets;
use crate::model::planner::{RoadmapRule, RoundingRule, SpeedRule, planned_default};
use crate::model::stepper::stepped_default;
use crate::model::{self, GaitRule, Law, Parameter, SearchRule};

/// The fields.
pub(crate) const FIELDS: [&str; 5] = ["limit acceleration", "roadmap", "profile", "rounding", "avoid"];
/// The preset of the force that planned walkers feel unless their kind says otherwise.
pub(crate) const FORCE: &str = "helbing2000";

/// How the walkers of a kind plan, as far as it is known.
#[derive(Clone, Debug)]
pub(crate) struct Planning {
    pub(crate) roadmap: RoadmapRule,
    pub(crate) clearance: f64,
    pub(crate) profile: SpeedRule,
    pub(crate) rounding: RoundingRule,
    pub(crate) reciprocal: bool,
}

impl Default for Planning {
    fn default() -> Self {
        let (roadmap, rounding) = (RoadmapRule::default(), RoundingRule::default());
        Self { roadmap, clearance: 0.2, profile: SpeedRule::Varied, rounding, reciprocal: false }
    }
}

/// Whether a planned kind takes the law of a parameter from the force that it avoids others by.
pub(crate) fn is_of_force(parameter: Parameter) -> bool {
    let is_own = matches!(parameter, Parameter::Radius | Parameter::Speed);
    !is_own && parameter.description().kinds.contains(&model::Kind::Sfm)
}

/// The law that a planned kind has of a parameter unless it is set.
pub(crate) fn default_law(parameter: Parameter, limit: Option<&Law>) -> Option<Law> {
    let of_force = || presets::law(FORCE, parameter).filter(|_| is_of_force(parameter));
    planned_default(parameter, limit).or_else(of_force)
}

/// The parameters of a kind as far as they are known.
#[derive(Clone, Debug)]
pub(crate) struct Kind {
    /// The kind of the language from which it starts.
    pub(crate) base: model::Kind,
    /// Whether it goes straight for its goals whatever is in the way.
    pub(crate) straight: bool,
    /// How its walkers plan, if they do.
    pub(crate) planning: Planning,
    /// Where the steps of its walkers come from, and how they are chosen, if they step.
    pub(crate) gait: GaitRule,
    pub(crate) search: SearchRule,
    /// How long they stand before they set out.
    pub(crate) premovement: Option<Law>,
    /// Their speed on stairs, as a share of that of the table of the stairs.
    pub(crate) stairs: f64,
    /// A law for each parameter.
    pub(crate) laws: [Option<Law>; Parameter::COUNT],
}

impl Default for Kind {
    fn default() -> Self {
        Self {
            base: model::Kind::default(),
            straight: false,
            planning: Planning::default(),
            gait: GaitRule::default(),
            search: SearchRule::default(),
            premovement: None,
            stairs: 1.0,
            laws: [const { None }; Parameter::COUNT],
        }
    }
}

impl Kind {
    /// The parameter of this name, if the kind has it.
    pub(crate) fn parameter(&self, name: &str) -> Option<Parameter> {
        Parameter::of_kind(self.base).find(|parameter| parameter.name() == name)
    }

    /// The law of a parameter: as set, or its default.
    pub(crate) fn law(&self, parameter: Parameter) -> Option<Law> {
        let default = || parameter.description().default.map(Law::Constant);
        let of_kind = || match self.base {
            model::Kind::Sfm | model::Kind::Cfs => None,
            model::Kind::Planned => {
                default_law(parameter, self.laws[Parameter::LimitSpeed as usize].as_ref())
            }
            model::Kind::Stepped => stepped_default(parameter),
        };
        self.laws[parameter as usize].clone().or_else(of_kind).or_else(default)
    }

    /// Sets the law of a parameter.
    pub(crate) fn set(&mut self, parameter: Parameter, law: Law) {
        self.laws[parameter as usize] = Some(law);
    }
}
