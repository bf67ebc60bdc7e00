//! The moving state of a batch of trials.
//!
//! Every field is a list of blocks of eight slots. A slot is one agent of one trial. Which eight share a
//! block depends on the layout: in `Layout::Trials` a block is one agent in eight trials (lane k is
//! trial k); in `Layout::Agents` it is eight agents of the only trial. All code that treats slots one by
//! one (noise, integration) is the same for both.

use super::drive::Routes;
use crate::base::lanes::{LANES, Lanes, Mask};
use crate::base::random::TrialKey;

/// What the eight slots of a block are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layout {
    /// One agent in eight trials: block `agent`, slot `lane`.
    Trials,
    /// Eight agents of one trial: block `agent / 8`, slot `agent % 8`; only lane 0 is in use.
    Agents,
}

/// Where an agent of a trial is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Slot {
    /// Block.
    pub block: usize,
    /// Place in the block.
    pub lane: usize,
}

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

    /// Position, m.
    pub x: Vec<Lanes>,
    /// Position, m.
    pub y: Vec<Lanes>,
    /// Velocity, m/s.
    pub vx: Vec<Lanes>,
    /// Velocity, m/s.
    pub vy: Vec<Lanes>,
    /// Driving direction, a unit vector. Never zero: it keeps its last value in someone who stands.
    pub ex: Vec<Lanes>,
    /// Driving direction.
    pub ey: Vec<Lanes>,
    /// Driving speed at present, m/s: `speed`, or 0 in someone who stands.
    pub drive: Vec<Lanes>,
    /// Length of the way gone, m.
    pub travelled: Vec<Lanes>,
    /// Slots whose agent is in the scene.
    pub present: Vec<Mask>,

    /// Driving speed, as drawn or as a behaviour has changed it, m/s.
    pub speed: Vec<Lanes>,
    /// Mass, kg (of a particle: the sum).
    pub mass: Vec<Lanes>,
    /// Radius, m.
    pub radius: Vec<Lanes>,
    /// Relaxation time, s.
    pub tau: Vec<Lanes>,
    /// Social force at touch that is felt, N: times the attention (of a particle also times its persons).
    pub a: Vec<Lanes>,
    /// Range of the social force, m.
    pub b: Vec<Lanes>,
    /// Weight of what is behind.
    pub lambda: Vec<Lanes>,
    /// Second exponential term.
    pub a2: Vec<Lanes>,
    /// Second exponential term.
    pub b2: Vec<Lanes>,
    /// Second exponential term.
    pub lambda2: Vec<Lanes>,
    /// Body compression, kg/s^2.
    pub k1: Vec<Lanes>,
    /// Sliding friction, kg/(m s).
    pub k2: Vec<Lanes>,
    /// Stationary standard deviation of each velocity component, m/s (of a particle: over the root of
    /// its persons).
    pub noise: Vec<Lanes>,

    /// What is left of a deviation from the driving velocity after a step, exp(-dt/tau); from `refresh`.
    pub decay: Vec<Lanes>,
    /// Standard deviation that the noise of a step adds, noise sqrt(1 - decay^2), m/s; from `refresh`.
    pub kick: Vec<Lanes>,
    /// Half a step over the mass, s/kg; from `refresh`.
    pub push: Vec<Lanes>,

    /// Force of everything but contact at the present positions, N; kept from step to step.
    pub fx: Vec<Lanes>,
    /// Force, second component, N.
    pub fy: Vec<Lanes>,

    /// Where everyone is on the way.
    pub route: Routes,

    /// How far the sources are.
    pub queues: super::start::Queues,
    /// Where everyone's behaviours stand.
    pub behaviours: super::behaviour::Standing,

    /// Values of the variables of processes, whose lanes are trials in both layouts.
    pub variables: Vec<Lanes>,
    /// Clocks of processes with rates and delays.
    pub clocks: super::process::Clocks,
    /// Lanes whose trial a process has ended by an error of the model; the variables are those before it.
    pub faulty: Mask,
    /// What the error is.
    pub faults: [Option<super::process::Fault>; LANES],
}

impl State {
    /// An empty batch: nobody is present, no lane occupied. Values in unused slots are harmless numbers.
    pub fn new(layout: Layout, agents: usize) -> Self {
        let blocks = match layout {
            Layout::Trials => agents,
            Layout::Agents => agents.div_ceil(LANES),
        };
        let zero = || vec![Lanes::ZERO; blocks];
        let one = || vec![Lanes::splat(1.0); blocks];
        Self {
            layout,
            agents,
            keys: [TrialKey::default(); LANES],
            ticks: [0; LANES],
            occupied: Mask::NONE,
            diverged: Mask::NONE,
            x: zero(),
            y: zero(),
            vx: zero(),
            vy: zero(),
            ex: one(),
            ey: zero(),
            drive: zero(),
            travelled: zero(),
            present: vec![Mask::NONE; blocks],
            speed: zero(),
            mass: one(),
            radius: zero(),
            tau: one(),
            a: zero(),
            b: one(),
            lambda: one(),
            a2: zero(),
            b2: one(),
            lambda2: one(),
            k1: zero(),
            k2: zero(),
            noise: zero(),
            decay: one(),
            kick: zero(),
            push: zero(),
            fx: zero(),
            fy: zero(),
            route: Routes::new(blocks),
            queues: super::start::Queues::default(),
            behaviours: super::behaviour::Standing::default(),
            variables: Vec::new(),
            clocks: super::process::Clocks::default(),
            faulty: Mask::NONE,
            faults: [None; LANES],
        }
    }

    /// Where agent `agent` of the trial in lane `lane` is kept.
    #[inline(always)]
    pub fn slot(&self, agent: usize, lane: usize) -> Slot {
        match self.layout {
            Layout::Trials => Slot { block: agent, lane },
            Layout::Agents => Slot { block: agent / LANES, lane: agent % LANES },
        }
    }

    /// Number of trials that it can hold.
    pub fn width(&self) -> usize {
        match self.layout {
            Layout::Trials => LANES,
            Layout::Agents => 1,
        }
    }

    /// A field of one agent as lanes are trials: in `Layout::Agents` its only value in every lane.
    #[inline(always)]
    pub fn lanes_of(&self, field: &[Lanes], agent: usize) -> Lanes {
        match self.layout {
            Layout::Trials => field[agent],
            Layout::Agents => Lanes::splat(field[agent / LANES].0[agent % LANES]),
        }
    }

    /// The lanes in which agent `agent` is present.
    #[inline(always)]
    pub fn present_in(&self, agent: usize) -> Mask {
        match self.layout {
            Layout::Trials => self.present[agent],
            Layout::Agents if self.present[agent / LANES].has(agent % LANES) => Mask::ALL,
            Layout::Agents => Mask::NONE,
        }
    }
}
