//! What the forces need to know of a scenario, the same in every trial.
//!
//! Social repulsion of a body i by a body j (Helbing, Farkas, Vicsek 2000; Given-Wilson et al. 2017,
//! equation (3)): `A_i exp((r_i + r_j - d)/B_i) Lambda n`, with n from j to i and, after Helbing and
//! Johansson, Lambda = lambda + (1 - lambda)(1 + cos phi)/2, cos phi = -n . e, e the *desired*
//! direction (so Lambda is defined in someone who stands). It is zero by definition beyond touching
//! distance + `REACH` B, where e^-16 of the force at touch is left: so both layouts sum the same pairs.
//! A second exponential term of the same form acts between bodies alone. Walls: equation (5) without its
//! compression, which is contact (and counted once). Between two bodies of several persons the social force
//! is bounded (`social::bounded`).

use super::noise;
use super::pace::fastest;
use super::surfaces::Surfaces;
use crate::base::math::at_least;
use crate::model::{Body, Law, Parameter, Scenario};

/// Range of the social force beyond touching distance, in units of B.
pub const REACH: f64 = 16.0;

/// The largest approach that contact candidates foresee at least, m/s.
const APPROACH: f64 = 5.0;

/// A body of several persons.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tie {
    /// Factor of the bounded social force towards another such body.
    pub(super) repulsion: f64,
    /// Friction constant towards another such body, kg/(m s).
    pub(super) friction: f64,
}

/// Members that attract each other.
#[derive(Clone, Debug)]
pub(super) struct Cohesion {
    pub(super) members: Vec<u32>,
    /// N.
    pub(super) attraction: f64,
}

/// What the forces need to know of a scenario.
#[derive(Clone, Debug)]
pub struct Forces {
    /// Walls and obstacles.
    pub(super) surfaces: Surfaces,
    /// Groups with an attraction.
    pub(super) groups: Vec<Cohesion>,
    /// Per agent: set in a body of several persons. Empty if there are not two of them.
    pub(super) ties: Vec<Option<Tie>>,
    /// B (and B of the second term), if it is the same constant in all bodies and no two are of several
    /// persons: then one exponential serves both bodies of a pair.
    pub(super) shared: Option<(f64, f64)>,
    /// Whether any body has the second term.
    pub(super) second: bool,
    /// Whether any velocity fluctuates.
    pub(super) noisy: bool,
    /// Per agent: its word in the counters of the noise.
    pub(super) noise_words: Vec<u32>,
    /// Bodies (and walls) nearer than this to touching may touch within a step, m.
    pub(super) margin: f64,
}

fn shared_constant(scenario: &Scenario, of: impl Fn(&Body) -> &Law) -> Option<f64> {
    let first = of(&scenario.agents.first()?.body).constant()?;
    scenario.agents.iter().all(|agent| of(&agent.body).constant() == Some(first)).then_some(first)
}

impl Forces {
    /// Prepares the forces of a scenario with steps of `dt` seconds.
    pub fn new(scenario: &Scenario, dt: f64) -> Self {
        let is_zero = |law: &Law| law.constant() == Some(0.0);
        let agents = &scenario.agents;
        // What behaviours change may differ from agent to agent.
        let changed = |parameter: Parameter| {
            let modes = scenario.behaviours.attached.iter().flat_map(|one| &one.conduct.states);
            modes.flat_map(|mode| &mode.changes).any(|(changed, _)| *changed == parameter)
        };
        let second =
            changed(Parameter::A2) || agents.iter().any(|agent| !is_zero(&agent.body[Parameter::A2]));
        let ties: Vec<_> = agents
            .iter()
            .map(|agent| {
                let particle = agent.particle.filter(|particle| particle.persons > 1)?;
                Some(Tie { repulsion: particle.repulsion, friction: particle.friction })
            })
            .collect();
        let ties = if ties.iter().flatten().count() < 2 { Vec::new() } else { ties };
        let same = !changed(Parameter::B) && !changed(Parameter::B2);
        let first_range = shared_constant(scenario, |body| &body[Parameter::B]).filter(|_| same);
        let second_range =
            if second { shared_constant(scenario, |body| &body[Parameter::B2]) } else { Some(1.0) };
        let shared = first_range.zip(second_range).filter(|_| ties.is_empty());
        Self {
            surfaces: Surfaces::new(&scenario.scene.barriers),
            groups: scenario
                .groups
                .iter()
                .filter(|group| group.attraction != 0.0 && group.members.len() > 1)
                .map(|group| Cohesion {
                    members: group.members.iter().map(|member| member.0).collect(),
                    attraction: group.attraction,
                })
                .collect(),
            ties,
            shared,
            second,
            noisy: changed(Parameter::Noise)
                || agents.iter().any(|agent| !is_zero(&agent.body[Parameter::Noise])),
            noise_words: agents.iter().map(|agent| noise::word_of(agent.entity)).collect(),
            margin: at_least(APPROACH, 2.0 * fastest(scenario)) * dt,
        }
    }

    /// Factor of the bounded social force between two bodies of several persons.
    #[inline(always)]
    pub(super) fn repulsion(&self, i: usize, j: usize) -> Option<f64> {
        match (self.ties.get(i), self.ties.get(j)) {
            (Some(Some(a)), Some(Some(b))) => Some(0.5 * (a.repulsion + b.repulsion)),
            _ => None,
        }
    }

    /// Friction constant between two bodies of several persons, who do not compress each other, kg/(m s).
    pub(super) fn friction(&self, i: usize, j: usize) -> Option<f64> {
        match (self.ties.get(i), self.ties.get(j)) {
            (Some(Some(a)), Some(Some(b))) => Some(0.5 * (a.friction + b.friction)),
            _ => None,
        }
    }
}
