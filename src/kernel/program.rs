//! A scenario made ready to run: everything that is the same in every trial.

use super::behaviour::Behaviours;
use super::drive::Drive;
use super::force::Forces;
use super::noise::Noise;
use super::process::Processes;
use super::start::{Arrivals, Starts};
use super::state::Layout;
use crate::model::Scenario;
use std::sync::Arc;

/// Up to so many agents, one lane is one trial and all pairs interact in lanes; above, the lanes are
/// agents of one trial and a cell list finds the pairs. The scene alone decides. Measured: lanes are
/// three times as fast with 200 agents who start at the same places in all trials.
pub const LARGEST_IN_LANES: usize = 256;

/// A scenario made ready to run.
#[derive(Clone, Debug)]
pub struct Program {
    /// What it runs.
    pub scenario: Arc<Scenario>,
    /// What the eight slots of a block are.
    pub layout: Layout,
    /// Length of a step, s.
    pub dt: f64,
    /// What the forces need.
    pub forces: Forces,
    /// The noise of velocities.
    pub noise: Noise,
    /// The routes.
    pub drive: Drive,
    /// The placements.
    pub starts: Starts,
    /// The processes.
    pub processes: Processes,
    /// The sources.
    pub arrivals: Arrivals,
    /// The behaviours.
    pub behaviours: Behaviours,
}

impl Program {
    /// Prepares a scenario.
    pub fn new(scenario: Arc<Scenario>) -> Self {
        let layout = if scenario.agents.len() <= LARGEST_IN_LANES { Layout::Trials } else { Layout::Agents };
        let dt = scenario.clock.step_seconds();
        let forces = Forces::new(&scenario, dt);
        let noise = Noise::new(&scenario);
        let mut drive = Drive::new(&scenario);
        let starts = Starts::new(&scenario);
        let processes = Processes::new(&scenario);
        let arrivals = Arrivals::new(&scenario);
        let behaviours = Behaviours::new(&scenario, &mut drive);
        Self { scenario, layout, dt, forces, noise, drive, starts, processes, arrivals, behaviours }
    }
}
