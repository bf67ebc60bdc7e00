//! How walkers of a planned kind make their plans (Li, Li, Ge 2019): all that is no parameter of a body.

use super::agent::Goal;
use super::law::Law;
use super::parameter::Parameter;

/// Share of the largest speed that somebody prefers unless their kind says otherwise.
pub const PREFERRED: f64 = 0.85;

/// Pieces of constant acceleration for each metre of recorded walks (`docs/planning.md`).
pub const PIECES_PER_METRE: f64 = 0.42;

/// How the walkers of a kind plan.
#[derive(Clone, Debug, PartialEq)]
pub struct Planner {
    /// Name of the kind: it addresses the draws of the roadmap.
    pub kind: String,
    /// How the roadmap is drawn.
    pub roadmap: RoadmapRule,
    /// What the roadmap keeps from barriers beyond the radius of a body, m.
    pub clearance: f64,
    /// How speeds along a path come about.
    pub profile: SpeedRule,
    /// How much of an edge an arc at its end may take.
    pub rounding: RoundingRule,
    /// Whether walkers avoid others by velocity (ORCA) instead of force.
    pub reciprocal: bool,
    /// Whether the preferred speed is a share of the largest one, drawn with it.
    pub speed_follows: bool,
}

/// How a roadmap is drawn.
#[derive(Clone, Debug, PartialEq)]
pub enum RoadmapRule {
    /// A probabilistic roadmap (Kavraki, Svestka, Latombe, Overmars 1996).
    Prm {
        /// Most places that are drawn.
        samples: u32,
        /// Whether half of the places are drawn between barriers (bridge test, Hsu, Jiang, Reif, Sun 2003).
        bridge: bool,
        /// Least distance of two vertices, m.
        separation: f64,
        /// To how many of the nearest vertices each is joined.
        neighbours: u32,
    },
    /// A rapidly exploring random tree (`LaValle` 1998).
    Rrt {
        /// Where it is rooted.
        root: Goal,
        /// How many places are drawn.
        samples: u32,
        /// Longest edge, m.
        step: f64,
        /// Probability that it grows towards the goal.
        bias: f64,
    },
}

/// How much of an edge of a path the arc at its end may take.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RoundingRule {
    /// Half of an edge between two corners, all of the first and the last one.
    #[default]
    Shared,
    /// Half of every edge (Li, Li, Ge 2019, Figure 1).
    HalfEdges,
}

impl RoundingRule {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::Shared, Self::HalfEdges];

    /// Its name in a scenario.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Shared => "shared",
            Self::HalfEdges => "half_edges",
        }
    }
}

/// How speeds along a path come about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SpeedRule {
    /// Drawn at knots around the preferred speed.
    Varied,
    /// The fastest profile.
    Optimal,
    /// Drawn from all profiles with so many pieces.
    Uniform,
}

impl SpeedRule {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Varied, Self::Optimal, Self::Uniform];

    /// Its name in a scenario.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Varied => "varied",
            Self::Optimal => "optimal",
            Self::Uniform => "uniform",
        }
    }
}

impl Default for RoadmapRule {
    fn default() -> Self {
        Self::Prm { samples: 500, bridge: true, separation: 0.5, neighbours: 6 }
    }
}

/// The law of a parameter that a planned kind leaves open and that the table of parameters has no default for.
pub fn planned_default(parameter: Parameter, limit: Option<&Law>) -> Option<Law> {
    match parameter {
        Parameter::Radius => Some(Law::Constant(0.25)),
        Parameter::Pieces => Some(Law::Constant(PIECES_PER_METRE)),
        Parameter::Speed => limit?.scaled(PREFERRED),
        _ => None,
    }
}
