//! The moving state of a batch of trials.
//!
//! Every field is a list of blocks of eight slots. A slot is one agent of one trial. Which eight share a
//! block depends on the layout: in `Layout::Trials` a block is one agent in eight trials (lane k is
//! trial k); in `Layout::Agents` it is eight agents of the only trial. All code that treats slots one by
//! one (noise, integration) is the same for both.

mod bodies;
mod clocks;
mod doors;
mod motion;
mod passages;
pub(super) mod plans;
pub(super) mod progress;
pub(super) mod route;
mod whereabouts;

use super::fault::Fault;
pub use super::layout::{Layout, Slot};
use super::plan::Plan;
use super::tape::Tape;
use crate::base::geometry::Vec2;
use crate::base::lanes::{LANES, Lanes, Mask};
use crate::base::random::TrialKey;
use crate::model::{AgentId, Periods, Scenario, Source};
pub use bodies::Bodies;
pub use clocks::Clocks;
pub use doors::ClosedDoors;
pub use motion::Motion;
pub(super) use motion::{Moves, Still};
pub use passages::Passages;
pub use plans::Plans;
pub use progress::Progress;
use route::Halt;
pub use route::{Routes, Way};
use std::sync::Arc;
pub use whereabouts::Whereabouts;

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
    /// On which level or stairs they are.
    pub whereabouts: Whereabouts,
    /// Columns of the recording that is shown; NaN in who has no number.
    pub columns: Vec<Vec<Lanes>>,
    /// States of their behaviours.
    pub behaviours: ActiveModes,
    /// Arrivals of the sources.
    pub queues: Queues,

    /// Doors that may change.
    pub doors: ClosedDoors,
    /// Values of the variables of processes, whose lanes are trials in both layouts.
    pub variables: Vec<Lanes>,
    /// Clocks of processes with rates and delays.
    pub clocks: Clocks,
    /// Lanes whose trial a process has ended by an error of the model; the variables are those before it.
    pub faulty: Mask,
    /// What the error is.
    pub faults: [Option<Fault>; LANES],
    /// What is played back, if it is a trial of a program elsewhere.
    pub tape: Option<Arc<Tape>>,
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
            whereabouts: Whereabouts::default(),
            columns: Vec::new(),
            behaviours: ActiveModes::default(),
            queues: Queues::default(),
            doors: ClosedDoors::default(),
            variables: Vec::new(),
            clocks: Clocks::default(),
            faulty: Mask::NONE,
            faults: [None; LANES],
            tape: None,
        }
    }

    /// Works out what follows from the parameters of a slot for steps of `dt` seconds. No driving, noise or force changes the
    /// velocity of an agent that moves by itself.
    pub(super) fn prepare(&mut self, slot: Slot, dt: f64) {
        self.bodies.prepare(slot, dt, self.plans.is_stepped(slot));
    }

    /// The noise of an agent of the collision-free speed model begins anew: all of its velocity is that of the model.
    pub(super) fn forget_noise(&mut self, Slot { block, lane }: Slot) {
        self.driving.go_x[block].0[lane] = self.motion.vx[block].0[lane];
        self.driving.go_y[block].0[lane] = self.motion.vy[block].0[lane];
    }

    /// Brings those who have left the scene of a closed plane back into it, with the places where they rest.
    pub(super) fn wrap(&mut self, periods: &Periods, moving: &[Mask]) {
        let (motion, driving) = (&mut self.motion, &mut self.driving);
        for (block, moving) in moving.iter().enumerate() {
            for lane in moving.iter() {
                let p = Vec2::new(motion.x[block].0[lane], motion.y[block].0[lane]);
                let image = periods.wrap(p);
                (motion.x[block].0[lane], motion.y[block].0[lane]) = (image.x, image.y);
                driving.rest_x[block].0[lane] += image.x - p.x;
                driving.rest_y[block].0[lane] += image.y - p.y;
            }
        }
    }

    /// The next tick of all trials.
    pub(super) fn go_on(&mut self) {
        for lane in self.occupied.iter() {
            self.ticks[lane] += 1;
        }
    }

    /// The doors that are closed in the trial of a slot in a lane: bit k is the k-th that may change.
    #[inline(always)]
    pub fn closed_doors(&self, lane: usize) -> u32 {
        self.doors.sets[self.layout.trial_of(lane)]
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

    /// An agent of the trial in a lane whose driver failed.
    pub fn undriven(&self, lane: usize) -> Option<usize> {
        (0..self.agents)
            .find(|&agent| matches!(self.plans.plan(self.slot(agent, lane)), Some(Plan::Failed(_))))
    }

    /// Number of trials that it can hold.
    pub fn width(&self) -> usize {
        match self.layout {
            Layout::Trials => LANES,
            Layout::Agents => 1,
        }
    }
}

// The present states of behaviours, as part of the state of a batch of trials.

/// In the place of the first stage of a detour: the agent is on its own route.
pub(in crate::kernel) const OWN_ROUTE: u32 = u32::MAX;

/// The present states of the behaviours of a batch, by declared behaviour and block.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ActiveModes {
    /// Number of the present state; -1 in someone who has no such behaviour.
    pub modes: Vec<Vec<Lanes>>,
    /// Tick at which the present state ends by itself; infinite if it does not.
    pub(in crate::kernel) due: Vec<Vec<Lanes>>,
    /// The transition that is taken then.
    pub(in crate::kernel) exit: Vec<Vec<[u32; LANES]>>,
    /// How many states have been entered.
    pub(in crate::kernel) entered: Vec<Vec<[u32; LANES]>>,
    /// What the present state set on entering it, SI units: so many values for each block as a state of the behaviour
    /// sets at most, in order of writing.
    pub(in crate::kernel) set: Vec<Vec<Lanes>>,
    /// Under which key the parameters of an agent were drawn, by block.
    pub(in crate::kernel) own_keys: Vec<[TrialKey; LANES]>,
    /// First stage of a route that a state demands, and where the own route was left.
    pub(in crate::kernel) detours: Vec<[(u32, Halt); LANES]>,
}

// The driving velocities of all agents: part of the state.

/// Driving direction and speed of all slots.
#[derive(Clone, Debug, PartialEq)]
pub struct Driving {
    /// Driving direction, a unit vector; it keeps its last value in an agent that stands. Zero in an agent that never had
    /// a direction.
    pub ex: Vec<Lanes>,
    /// Driving direction, second component.
    pub ey: Vec<Lanes>,
    /// Driving speed at present, m/s: that of the body, or 0 in an agent that stands.
    pub speed: Vec<Lanes>,
    /// Where an agent of the collision-free speed model goes, a unit vector.
    pub course_x: Vec<Lanes>,
    /// The same, second component.
    pub course_y: Vec<Lanes>,
    /// The velocity of such an agent without noise, m/s.
    pub go_x: Vec<Lanes>,
    /// The same, second component.
    pub go_y: Vec<Lanes>,
    /// Where an agent that stands came or comes to rest, m; infinite in one that does not stand.
    pub rest_x: Vec<Lanes>,
    /// The second coordinate.
    pub rest_y: Vec<Lanes>,
}

impl Driving {
    /// So many blocks that stand.
    fn new(blocks: usize) -> Self {
        let zero = || vec![Lanes::ZERO; blocks];
        let nowhere = || vec![Lanes::splat(f64::INFINITY); blocks];
        Self {
            ex: vec![Lanes::splat(1.0); blocks],
            ey: zero(),
            speed: zero(),
            course_x: vec![Lanes::splat(1.0); blocks],
            course_y: zero(),
            go_x: zero(),
            go_y: zero(),
            rest_x: nowhere(),
            rest_y: nowhere(),
        }
    }

    /// An agent that stands.
    pub(in crate::kernel) fn clear(&mut self, slot: Slot) {
        for (field, value) in [(&mut self.ex, 1.0), (&mut self.ey, 0.0), (&mut self.speed, 0.0)] {
            field[slot.block].0[slot.lane] = value;
        }
        self.move_on(slot);
    }

    /// An agent that is no longer where it stood.
    pub(in crate::kernel) fn move_on(&mut self, slot: Slot) {
        for field in [&mut self.rest_x, &mut self.rest_y] {
            field[slot.block].0[slot.lane] = f64::INFINITY;
        }
    }
}

// How far the sources of people are, as part of the state of a batch of trials.

/// How far the sources of a batch are; lanes are trials in both layouts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Queues {
    /// Time of the next arrival of each source, s.
    pub(in crate::kernel) next: Vec<Lanes>,
    /// How many have arrived.
    pub(in crate::kernel) arrived: Vec<[u32; LANES]>,
    /// How many have come in.
    pub entered: Vec<[u32; LANES]>,
    /// How often the next one has tried to come in.
    pub(in crate::kernel) tries: Vec<[u32; LANES]>,
    /// Per agent: how many numbers its person is behind the first one on its place. Empty without sources.
    pub(in crate::kernel) later: Vec<[u32; LANES]>,
    /// Lanes in which a place was given to a second person.
    pub reused: Mask,
    /// Lanes in which more have arrived than there is room for: the trial is unresolved.
    pub full: Mask,
    /// Which source that was.
    pub(in crate::kernel) which: [u32; LANES],
}

impl Queues {
    /// The lanes in which member `number` of a source, counted from 0, has come in.
    pub fn has_entered(&self, source: usize, number: u32) -> Mask {
        let Some(entered) = self.entered.get(source) else { return Mask::NONE };
        let here = entered.iter().enumerate().filter(|(_, entered)| **entered > number);
        here.fold(Mask::NONE, |mask, (lane, _)| mask | Mask::lane(lane))
    }

    /// Why the trial in a lane is unresolved, if a source is the reason.
    pub fn overrun(&self, sources: &[Source], lane: usize) -> Option<String> {
        let source = sources.get(self.which[lane] as usize).filter(|_| self.full.has(lane))?;
        let (count, name) = (source.members.len(), &source.name);
        let words =
            if self.reused.has(lane) { "are present at once from source" } else { "arrived by source" };
        Some(format!("more than {count} agents {words} `{name}`; write a larger `limit`"))
    }

    /// Why a question that follows single people has no answer in the trial of a lane, if that is the reason.
    pub fn lost_sight(&self, sources: &[Source], lane: usize) -> Option<String> {
        let source = sources.get(self.which[lane] as usize).filter(|_| self.reused.has(lane))?;
        let (count, name) = (source.members.len(), &source.name);
        Some(format!(
            "more than {} arrived by source `{name}`, and the formula follows single agents of it; write a larger `limit`",
            if count == 1 { "1 agent".to_owned() } else { format!("{count} agents") }
        ))
    }

    /// The name of the person on a place of a source, if it is not the first one there: `doors[57]`.
    pub fn arrival(&self, sources: &[Source], agent: AgentId, lane: usize) -> Option<String> {
        let later = self.later(agent.0 as usize, lane);
        let source = sources.iter().find(|source| later > 0 && source.members.contains(&agent))?;
        let place = source.members.iter().position(|member| *member == agent)?;
        Some(format!("{}[{}]", source.name, place as u32 + later + 1))
    }

    /// How many numbers the person on an agent's place is behind the first one there; 0 but for places of sources.
    #[inline]
    pub fn later(&self, agent: usize, lane: usize) -> u32 {
        self.later.get(agent).map_or(0, |later| later[lane])
    }
}
