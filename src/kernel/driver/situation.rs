//! What a driver is told.

use crate::base::geometry::Vec2;
use crate::base::random::TrialKey;
use crate::kernel::plan::{Occasion, Plan};
use crate::kernel::state::{Slot, State};
use crate::model::{AgentId, Goal, Leg, Parameter, Scenario};

/// What a driver is told when it is asked. Lengths are in m, times in s, velocities in m/s.
#[derive(Clone, Copy, Debug)]
pub struct Situation<'a> {
    /// Why it is asked.
    pub occasion: Occasion,
    /// The agent.
    pub agent: AgentId,
    /// Stable number of the person; addresses its random numbers.
    pub entity: u32,
    /// The trial.
    pub key: TrialKey,
    /// How often the driver of this person was asked before; numbers of draws may follow from it.
    pub asked: u32,
    /// Time of the state.
    pub time: f64,
    /// From one state to the next.
    pub dt: f64,
    /// How much later the plan begins: what is left of a trajectory that ends within the next step, else 0.
    pub after: f64,
    /// Where the agent is when the plan begins.
    pub position: Vec2,
    /// Its velocity then.
    pub velocity: Vec2,
    /// The legs of its route that are left, the present one first; none if it has no goals.
    pub legs: &'a [Leg],
    /// Whether it departs at the end of them.
    pub then_leave: bool,
    /// Under advice: the direction, zero for a stop.
    pub advice: Option<Vec2>,
    /// Its own preferred speed, m/s, whatever a behaviour has set.
    pub own_speed: f64,
    /// The class of paths that the agent is advised to take, as [`crate::model::Move::Path`] numbers them.
    pub path: Option<u32>,
    /// The plan that there is.
    pub plan: &'a Plan,
    /// The scenario.
    pub scenario: &'a Scenario,
    pub(super) state: &'a State,
    pub(super) slot: Slot,
}

/// Another agent in the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Other {
    /// Which.
    pub agent: AgentId,
    /// Its position, m.
    pub position: Vec2,
    /// Its velocity, m/s; of one that moves by itself, that of its present or next step.
    pub velocity: Vec2,
    /// Its radius, m.
    pub radius: f64,
}

impl<'a> Situation<'a> {
    /// The goal of the present leg; none in a pause, or without goals.
    pub fn goal(&self) -> Option<&'a Goal> {
        match self.legs.first() {
            Some(Leg::To(goal)) => Some(goal),
            _ => None,
        }
    }

    /// The doors that are closed, of those that may change: bit k is the k-th.
    pub fn closed_doors(&self) -> u32 {
        self.state.closed_doors(self.slot.lane)
    }

    /// A parameter of the agent at present, SI units.
    pub fn parameter(&self, parameter: Parameter) -> f64 {
        self.slot.of(&self.state.bodies[parameter])
    }

    /// Where the others are who go to their goals by ways of points, and where these ways end, m.
    pub fn ends(&self) -> impl Iterator<Item = (Vec2, Vec2)> + '_ {
        let trial = self.state.layout.trial_of(self.slot.lane);
        self.others().filter_map(move |other| {
            match self.state.plans.plan(self.state.slot(other.agent.0 as usize, trial)) {
                Some(Plan::Way(points)) => Some((other.position, *points.last()?)),
                _ => None,
            }
        })
    }

    /// All other agents that are in the scene of this trial, by number.
    pub fn others(&self) -> impl Iterator<Item = Other> + '_ {
        let (state, own) = (self.state, self.agent);
        let trial = state.layout.trial_of(self.slot.lane);
        (0..state.agents).map(move |agent| (agent, state.slot(agent, trial))).filter_map(
            move |(agent, slot)| {
                let here = state.is_present(slot) && agent != own.0 as usize;
                here.then(|| Other {
                    agent: AgentId(agent as u32),
                    position: state.position(slot),
                    velocity: state.velocity(slot),
                    radius: slot.of(&state.bodies[Parameter::Radius]),
                })
            },
        )
    }
}
