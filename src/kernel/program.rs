//! A scenario made ready to run: everything that is the same in every trial.

use super::behaviour::Behaviours;
use super::code::{Code, Readings};
use super::doors::Doors;
use super::driver::{Drive, Drivers};
use super::force::Forces;
use super::near::Close;
use super::noise::Noise;
use super::parameters::Parameters;
use super::passing::Passing;
use super::process::Processes;
use super::start::{Arrivals, Starts};
use super::state::{Layout, State};
use super::storeys::Stairwells;
use crate::model::Scenario;
use std::sync::Arc;

/// Up to so many agents, one lane is one trial and all pairs interact in lanes; above, the lanes are
/// agents of one trial and a cell list finds the pairs. The scene alone decides. Measured: lanes are
/// three times as fast with 200 agents who start at the same places in all trials.
pub const LARGEST_IN_LANES: usize = 256;

/// Threads may share one trial of more agents than these: in a smaller one they wait for each other longer than they work.
pub(super) const LARGE: usize = 2000;

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
    /// The routes and drivers.
    pub drive: Drive,
    /// The laws of the parameters of bodies.
    pub parameters: Parameters,
    /// The placements.
    pub starts: Starts,
    /// The processes.
    pub processes: Processes,
    /// The sources.
    pub arrivals: Arrivals,
    /// The doors that may change.
    pub doors: Doors,
    /// The behaviours.
    pub behaviours: Behaviours,
    /// The lines and regions that formulas ask about.
    pub passing: Passing,
    /// Levels and stairs.
    pub stairwells: Stairwells,
}

impl Program {
    /// Prepares a scenario whose agents head straight for the goals of their routes.
    pub fn new(scenario: Arc<Scenario>) -> Self {
        Self::driven(scenario, Drivers::default())
    }

    /// Prepares a scenario with the drivers of a run.
    pub fn driven(scenario: Arc<Scenario>, drivers: Drivers) -> Self {
        // What is played back is one trial at a time.
        let is_alone = scenario.agents.len() > LARGEST_IN_LANES || scenario.processes.outside.is_some();
        let layout = if is_alone { Layout::Agents } else { Layout::Trials };
        let dt = scenario.clock.step_seconds();
        let forces = Forces::new(&scenario, dt);
        let noise = Noise::new(&scenario);
        let mut drive = Drive::new(&scenario, drivers);
        let parameters = Parameters::new(&scenario);
        let starts = Starts::new(&scenario);
        let processes = Processes::new(&scenario);
        let arrivals = Arrivals::new(&scenario);
        let passing = Passing::new(&scenario.scene);
        let stairwells = Stairwells::new(&scenario.scene);
        let doors = Doors::new(&scenario);
        let behaviours = Behaviours::new(&scenario, &mut drive);
        Self {
            scenario,
            layout,
            dt,
            forces,
            noise,
            drive,
            parameters,
            starts,
            processes,
            arrivals,
            doors,
            behaviours,
            passing,
            stairwells,
        }
    }

    /// Whether threads may share one trial (`Run::share`).
    pub fn is_large(&self) -> bool {
        let moves = self.layout == Layout::Agents && self.scenario.processes.outside.is_none();
        moves && self.scenario.agents.len() > LARGE
    }
}

impl Code {
    /// Reads all lanes of a state. Values of lanes without a trial mean nothing; in `Layout::Agents` every
    /// lane has the value of the only trial.
    pub fn run(&self, program: &Program, state: &State, readings: &mut Readings) {
        self.read(program.layout, state, readings);
    }

    /// The same, with what the kernel found out about who is close to whom in this state: the same bits, sooner.
    pub fn run_close(
        &self,
        program: &Program,
        state: &State,
        close: Option<Close<'_>>,
        readings: &mut Readings,
    ) {
        self.read_close(program.layout, (state, close), readings);
    }
}
