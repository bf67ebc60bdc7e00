//! The driver of agents that find their way around barriers.

use super::atlas::Atlas;
use super::planner::{self, PathOption, Terrains, Walkers, path_options, walkers};
use super::rim;
use super::survey::{self, Doubt};
use crate::kernel::driver::{Driver, Drivers, Memory, Plan, Situation};
use crate::model::{Agent, AgentId, Parameter, Scenario, Scene};
use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

/// Answers with the shortest way to the goal of the leg.
#[derive(Debug)]
struct Wayfinder {
    atlas: Arc<Atlas>,
}

/// Most scenes whose atlases are kept: worlds of a sweep mostly share one.
const KEPT: usize = 8;

/// The atlases of the scenes of a call and the terrains of its planned kinds, each made once.
#[derive(Debug, Default)]
pub struct Ways {
    known: Mutex<VecDeque<Arc<Atlas>>>,
    terrains: Arc<Terrains>,
}

impl Ways {
    /// The atlas of a scene.
    fn atlas(&self, scene: &Scene) -> Arc<Atlas> {
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(atlas) = known.iter().find(|atlas| atlas.scene() == scene) {
            return Arc::clone(atlas);
        }
        let atlas = Arc::new(Atlas::new(scene.clone()));
        known.truncate(KEPT - 1);
        known.push_front(Arc::clone(&atlas));
        atlas
    }

    /// The drivers of a run: everybody finds their way, unless their kind plans or goes straight, or no barrier can stand in the way.
    pub fn drivers(&self, scenario: &Scenario, seed: u64) -> Drivers {
        let drivers = walkers(Drivers::new(seed), &self.terrains, scenario);
        let agents = finders(scenario);
        if agents.is_empty() {
            return drivers;
        }
        drivers.with(agents, Arc::new(Wayfinder { atlas: self.atlas(&scenario.scene) }))
    }

    /// The walkers of a scenario that plan.
    pub fn walkers(&self, scenario: &Scenario, seed: u64) -> Walkers {
        Walkers::new(&self.terrains, scenario, seed)
    }

    /// At most so many paths of different classes for an agent, the shortest first.
    pub fn paths(&self, scenario: &Scenario, seed: u64, agent: AgentId, most: usize) -> Vec<PathOption> {
        path_options(&self.terrains, scenario, seed, agent, most)
    }

    /// What is wrong or doubtful with the ways of a scenario, before the first trial: with shortest ways, and with the roadmaps of
    /// a run with a seed.
    pub fn doubts(&self, scenario: &Scenario, seed: u64) -> Vec<Doubt> {
        let others = |id: &AgentId| {
            let body = &scenario.agents[id.0 as usize].body;
            body.planner.is_some() || body.stepper.is_some()
        };
        let others = (0..scenario.agents.len() as u32).map(AgentId).filter(others);
        let mut agents: Vec<AgentId> = finders(scenario).into_iter().chain(others).collect();
        agents.sort_unstable();
        if agents.is_empty() {
            Vec::new()
        } else {
            let planned = |id, who: &str| planner::doubt(&self.terrains, scenario, seed, id, who);
            survey::doubts(&self.atlas(&scenario.scene), scenario, &agents, planned)
        }
    }
}

/// The agents that find their way.
fn finders(scenario: &Scenario) -> Vec<AgentId> {
    if scenario.scene.barriers.is_empty() || rim::is_open(scenario) {
        return Vec::new();
    }
    let finds = |id: &AgentId| scenario.agents[id.0 as usize].body.finds_ways;
    (0..scenario.agents.len() as u32).map(AgentId).filter(finds).collect()
}

/// The drivers of a run: everybody finds their way, unless their kind goes straight, or no barrier can stand in the way.
pub fn drivers(scenario: &Scenario, seed: u64) -> Drivers {
    Ways::default().drivers(scenario, seed)
}

/// Whether an agent may have another radius in another trial.
pub(super) fn is_drawn(agent: &Agent) -> bool {
    agent.particle.is_some() || agent.body[Parameter::Radius].constant().is_none()
}

impl Driver for Wayfinder {
    fn plan(&self, situation: &Situation<'_>, _: &mut Memory) -> Plan {
        let Some(goal) = situation.goal() else { return Plan::Straight };
        let agent = &situation.scenario.agents[situation.agent.0 as usize];
        let radius = Atlas::class(situation.parameter(Parameter::Radius), is_drawn(agent));
        match self.atlas.way(situation.position, goal, radius) {
            Some(way) if way.is_straight => Plan::Straight,
            Some(way) => Plan::Way(way.points().into()),
            None => Plan::NoWay,
        }
    }
}
