//! Sources: people who come in while a trial runs.
//!
//! The n-th arrival of a source is one person, with the n-th of its stable numbers. It takes the n-th place of the source,
//! and once all places are taken the first one whose person has left; without such a one the trial is unresolved.
//! What follows a place as if it were a person (a formula over time about somebody) knows no more from then
//! on; where the scenario itself does so, places are used once. The times between arrivals are draws 0, 1, … of the
//! source's own stream. Someone has arrived at the first state at or after their time; they are placed where
//! they touch nobody who is present and no barrier. Without a free place they wait, those behind them too, and try
//! again at each state.

use crate::base::lanes::{LANES, Lanes, Mask};
use crate::base::random::{Purpose, Stream, TrialKey};
use crate::kernel::state::State;
use crate::model::law::Ready;
use crate::model::{AgentId, Bool, Num, Position, Scenario, Timing};

/// The share of a step within which a time after a state still counts as at it: rounding of sums.
pub(super) const SLACK: f64 = 1e-6;

/// One source.
#[derive(Clone, Debug)]
pub(super) struct Door {
    entity: u32,
    every: Ready,
    pub(super) members: Vec<AgentId>,
    /// Most arrivals.
    pub(super) most: u32,
}

/// The sources of a scenario.
#[derive(Clone, Debug, Default)]
pub struct Arrivals {
    pub(super) doors: Vec<Door>,
    /// Per agent, whether it comes from a source; empty without sources.
    comes: Vec<bool>,
    /// Whether places are used once, because the scenario speaks of single ones.
    pub(super) once: bool,
}

impl Arrivals {
    /// Prepares the sources of a scenario.
    pub fn new(scenario: &Scenario) -> Self {
        let mut out = Self::default();
        for source in &scenario.sources {
            out.comes.resize(scenario.agents.len(), false);
            for member in &source.members {
                if let Some(comes) = out.comes.get_mut(member.0 as usize) {
                    *comes = true;
                }
            }
            let (entity, every) = (source.entity, source.every.ready());
            out.doors.push(Door { entity, every, members: source.members.clone(), most: source.most });
        }
        out.once = out.speaks_of_single_ones(scenario);
        out
    }

    /// Whether behaviours, processes or starts of a scenario name single places of sources other than their own.
    fn speaks_of_single_ones(&self, scenario: &Scenario) -> bool {
        if self.doors.is_empty() {
            return false;
        }
        let mut found = false;
        for one in &scenario.behaviours.attached {
            let own = one.agent;
            let mut tell = |id: AgentId| found |= id != own && self.comes(id.0 as usize);
            one.guards.iter().for_each(|guard| guard.mentions(&mut tell));
        }
        let mut tell = |id: AgentId| found |= self.comes(id.0 as usize);
        for command in scenario.processes.list.iter().flat_map(|process| &process.commands) {
            command.guard.mentions(&mut tell);
            if let Timing::Rate(rate) = &command.timing {
                rate.mentions(&mut tell);
            }
            for branch in &command.branches {
                branch.weight.mentions(&mut tell);
                branch.updates.iter().for_each(|(_, value)| value.mentions(&mut tell));
            }
        }
        for agent in &scenario.agents {
            if let Position::Near { agent, .. } = &agent.start.position {
                tell(*agent);
            }
        }
        found
    }

    /// Whether a truth value or a number names somebody from a source.
    pub fn are_named(&self, atoms: &[Bool], signals: &[Num]) -> bool {
        let mut found = false;
        if !self.doors.is_empty() {
            let mut tell = |id: AgentId| found |= self.comes(id.0 as usize);
            for atom in atoms {
                atom.mentions(&mut tell);
            }
            for signal in signals {
                signal.mentions(&mut tell);
            }
        }
        found
    }

    /// Whether an agent comes from a source, and so is not there at the start.
    pub fn comes(&self, agent: usize) -> bool {
        self.comes.get(agent).copied().unwrap_or(false)
    }

    /// Begins a trial.
    pub(super) fn load(&self, state: &mut State, lane: usize, key: TrialKey) {
        state.queues.full &= !Mask::lane(lane);
        state.queues.reused &= !Mask::lane(lane);
        if self.doors.is_empty() {
            return;
        }
        let queues = &mut state.queues;
        queues.next.resize(self.doors.len(), Lanes::ZERO);
        for list in [&mut queues.arrived, &mut queues.entered, &mut queues.tries] {
            list.resize(self.doors.len(), [0; LANES]);
            for source in list {
                source[lane] = 0;
            }
        }
        queues.later.resize(self.comes.len(), [0; LANES]);
        queues.later.iter_mut().for_each(|later| later[lane] = 0);
        for (next, door) in queues.next.iter_mut().zip(&self.doors) {
            next.0[lane] = door.interval(key, 0);
        }
        for door in &self.doors {
            for member in &door.members {
                leave_empty(state, member.0 as usize, lane);
            }
        }
    }
}

impl Door {
    /// The place for arrival `number`, counted from 0: its own, or once all have been taken the first that is free.
    pub(super) fn place(&self, state: &State, lane: usize, number: u32) -> Option<usize> {
        let number = number as usize;
        if number < self.members.len() {
            return Some(number);
        }
        self.members.iter().position(|member| {
            let slot = state.slot(member.0 as usize, lane);
            !state.present[slot.block].has(slot.lane)
        })
    }

    /// Time between arrival `number` and the one before it, s.
    pub(super) fn interval(&self, key: TrialKey, number: u32) -> f64 {
        self.every.draw(Stream::of(key, self.entity, Purpose::Arrival).uniform(number))
    }
}

/// Harmless numbers in the place of someone who has not come yet.
fn leave_empty(state: &mut State, agent: usize, lane: usize) {
    let slot = state.slot(agent, lane);
    state.motion.clear(slot);
    state.driving.clear(slot);
    state.bodies.clear(slot);
    state.present[slot.block] &= !Mask::lane(slot.lane);
}
