//! The moving state of a batch of trials.
//!
//! Every field is a list of blocks of eight slots. A slot is one agent of one trial. Which eight share a
//! block depends on the layout: in `Layout::Trials` a block is one agent in eight trials (lane k is
//! trial k); in `Layout::Agents` it is eight agents of the only trial. All code that treats slots one by
//! one (noise, integration) is the same for both.

mod behaviours;
mod bodies;
mod clocks;
mod driving;
mod motion;
mod passages;
pub(super) mod plans;
pub(super) mod progress;
mod queues;
pub(super) mod route;

pub use super::layout::{Layout, Slot};
pub(super) use behaviours::{ActiveModes, OWN_ROUTE};
pub use bodies::Bodies;
pub use clocks::Clocks;
pub use driving::Driving;
pub use motion::Motion;
pub use passages::Passages;
pub use plans::Plans;
pub use progress::Progress;
pub use queues::Queues;
pub use route::{Routes, Way};

use super::fault::Fault;
use crate::base::geometry::Vec2;
use crate::base::lanes::{LANES, Lanes, Mask};
use crate::base::random::TrialKey;
use crate::model::{AgentId, Scenario};

/// The moving state of a batch.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// What the slots of a block are.
    pub layout: Layout,
    /// Number of agents of a trial.
    pub agents: usize,
    /// The trials in the lanes (lane 0 alone in `Layout::Agents`).
    pub keys: [TrialKey; LANES],
    /// Ticks since the start of each lane's trial.
    pub ticks: [u64; LANES],
    /// Lanes that hold a trial that goes on.
    pub occupied: Mask,
    /// Lanes whose trial diverged: a number that is none, or a speed no human reaches.
    pub diverged: Mask,
    /// Lanes in whose trial somebody has had no way to a goal.
    pub no_way: Mask,

    /// Slots whose agent is in the scene.
    pub present: Vec<Mask>,
    /// Where all agents are and how they move.
    pub motion: Motion,
    /// Their parameters.
    pub bodies: Bodies,
    /// Their driving velocities.
    pub driving: Driving,
    /// Where they are on their routes.
    pub route: Routes,
    /// The plans that those with a driver follow.
    pub plans: Plans,
    /// How far they have come.
    pub progress: Progress,
    /// Which lines they have crossed, and how long they have been in which region.
    pub passages: Passages,
    /// States of their behaviours.
    pub behaviours: ActiveModes,
    /// Arrivals of the sources.
    pub queues: Queues,

    /// Values of the variables of processes, whose lanes are trials in both layouts.
    pub variables: Vec<Lanes>,
    /// Clocks of processes with rates and delays.
    pub clocks: Clocks,
    /// Lanes whose trial a process has ended by an error of the model; the variables are those before it.
    pub faulty: Mask,
    /// What the error is.
    pub faults: [Option<Fault>; LANES],
}

impl State {
    /// An empty batch: nobody is present, no lane occupied. Values in unused slots are harmless numbers.
    pub fn new(layout: Layout, agents: usize) -> Self {
        let blocks = layout.blocks(agents);
        Self {
            layout,
            agents,
            keys: [TrialKey::default(); LANES],
            ticks: [0; LANES],
            occupied: Mask::NONE,
            diverged: Mask::NONE,
            no_way: Mask::NONE,
            present: vec![Mask::NONE; blocks],
            motion: Motion::new(blocks),
            bodies: Bodies::new(blocks),
            driving: Driving::new(blocks),
            route: Routes::new(blocks),
            plans: Plans::default(),
            progress: Progress::new(blocks),
            passages: Passages::default(),
            behaviours: ActiveModes::default(),
            queues: Queues::default(),
            variables: Vec::new(),
            clocks: Clocks::default(),
            faulty: Mask::NONE,
            faults: [None; LANES],
        }
    }

    /// Works out what follows from the parameters of a slot for steps of `dt` seconds. No driving, noise or force changes the
    /// velocity of an agent that moves by itself.
    pub(super) fn prepare(&mut self, slot: Slot, dt: f64) {
        self.bodies.prepare(slot, dt, self.plans.is_stepped(slot));
    }

    /// Where agent `agent` of the trial in lane `lane` is kept.
    #[inline(always)]
    pub fn slot(&self, agent: usize, lane: usize) -> Slot {
        match self.layout {
            Layout::Trials => Slot { block: agent, lane },
            Layout::Agents => Slot { block: agent / LANES, lane: agent % LANES },
        }
    }

    /// Whether somebody is in a slot.
    pub fn is_present(&self, slot: Slot) -> bool {
        self.present[slot.block].has(slot.lane)
    }

    /// Where the agent in a slot is, m.
    pub fn position(&self, slot: Slot) -> Vec2 {
        slot.vector(&self.motion.x, &self.motion.y)
    }

    /// How fast the agent in a slot is, m/s.
    pub fn velocity(&self, slot: Slot) -> Vec2 {
        slot.vector(&self.motion.vx, &self.motion.vy)
    }

    /// The name of an agent of the trial in a lane; that of a person of a source has the number of the arrival.
    pub fn name_of(&self, scenario: &Scenario, agent: AgentId, lane: usize) -> String {
        let arrival = self.queues.arrival(&scenario.sources, agent, lane);
        arrival.unwrap_or_else(|| scenario.agents[agent.0 as usize].name.clone())
    }

    /// Number of trials that it can hold.
    pub fn width(&self) -> usize {
        match self.layout {
            Layout::Trials => LANES,
            Layout::Agents => 1,
        }
    }
}
