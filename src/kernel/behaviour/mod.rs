//! Behaviours: automata of agents, of all trials of a batch.
//!
//! At a step each behaviour looks at the state before it (`watch`), as processes do. What it decided holds from the
//! state after the step on (`turn`). First all states are entered, then each agent concerned is changed once (`apply`),
//! so that nobody walks or leaves by a state of affairs that never was. What a state sets is computed on entering it and
//! kept as long as the state lasts; the parameters of the agent are then its own values, drawn again from their
//! addresses, with what the present states set put over them, so that nothing compounds. Times are drawn on entering a
//! state, the n-th of them from draw n of the behaviour's own stream; branches from the draw of the tick. Attention
//! multiplies A and A2 of the agent who feels the force.

mod conduct;

use super::code::{Code, Readings};
use super::driver::{self, Drive};
use super::fault::Fault;
use super::parameters::Parameters;
use super::state::route::Halt;
use super::state::{ActiveModes, Layout, OWN_ROUTE, Slot, State};
use crate::base::lanes::{LANES, Lanes, Mask};
use crate::base::random::{Purpose, Stream, TrialKey};
use crate::base::tick::steps_over;
use crate::model::{AgentId, Parameter, Scenario};
use conduct::{Amount, Conduct, Trigger, pick};

/// One behaviour of one agent.
#[derive(Clone, Debug)]
struct Machine {
    agent: u32,
    behaviour: u32,
    entity: u32,
    /// That of later people on the place of its agent is so much more than how much later they are.
    later: u32,
    conduct: u32,
    /// The atom of its first condition, and how many it has.
    guards: (u32, u32),
}

/// The behaviours of a scenario, made ready to run.
#[derive(Clone, Debug, Default)]
pub struct Behaviours {
    /// Most parameters that a state of each declared behaviour sets.
    most: Vec<usize>,
    machines: Vec<Machine>,
    /// First machine of each agent; one more at the end.
    first: Vec<u32>,
    conducts: Vec<Conduct>,
    /// The conditions.
    code: Option<Code>,
}

/// A state that is entered with the present step.
#[derive(Clone, Copy, Debug)]
struct Turn {
    machine: u32,
    lane: usize,
    mode: u32,
}

/// Room to work. It holds no part of the state.
#[derive(Clone, Debug, Default)]
pub(super) struct Scratch {
    readings: Readings,
    turns: Vec<Turn>,
    /// The lanes of each machine that turn.
    turning: Vec<Mask>,
    /// Those among them in which the state before or the one after changes something of the agent.
    changing: Vec<Mask>,
}

impl Machine {
    /// The stable number of the one whose behaviour it is.
    fn number(&self, state: &State, trial: usize) -> u32 {
        match state.queues.later(self.agent as usize, trial) {
            0 => self.entity,
            later => self.later + later,
        }
    }
}

impl Behaviours {
    /// Prepares the behaviours of a scenario; the routes of their states are added to those of `drive`.
    pub fn new(scenario: &Scenario, drive: &mut Drive) -> Self {
        let all = &scenario.behaviours;
        if all.attached.is_empty() {
            return Self::default();
        }
        let mut known: Vec<&std::sync::Arc<crate::model::Conduct>> = Vec::new();
        let mut out = Self { most: vec![0; all.declared.len()], ..Self::default() };
        let mut atoms = Vec::new();
        for one in &all.attached {
            let at = known.iter().rposition(|conduct| std::sync::Arc::ptr_eq(conduct, &one.conduct));
            let conduct = at.unwrap_or_else(|| {
                known.push(&one.conduct);
                let declared = &all.declared[one.behaviour.0 as usize];
                let conduct = Conduct::new(declared, &one.conduct, drive);
                let most = &mut out.most[one.behaviour.0 as usize];
                *most = conduct.modes.iter().map(|mode| mode.changes.len()).fold(*most, usize::max);
                out.conducts.push(conduct);
                known.len() - 1
            });
            out.machines.push(Machine {
                agent: one.agent.0,
                behaviour: one.behaviour.0,
                entity: one.entity,
                later: one.later,
                conduct: conduct as u32,
                guards: (atoms.len() as u32, one.guards.len() as u32),
            });
            atoms.extend(one.guards.iter().cloned());
        }
        for agent in 0..=scenario.agents.len() as u32 {
            out.first.push(out.machines.partition_point(|machine| machine.agent < agent) as u32);
        }
        out.code = (!atoms.is_empty()).then(|| Code::compile(scenario, &atoms, &[]));
        out
    }

    /// Whether nobody has any.
    pub fn is_empty(&self) -> bool {
        self.machines.is_empty()
    }

    fn machines_of(&self, agent: usize) -> std::ops::Range<usize> {
        match (self.first.get(agent), self.first.get(agent + 1)) {
            (Some(&from), Some(&to)) => from as usize..to as usize,
            _ => 0..0,
        }
    }

    /// Whether an agent follows a move that is suggested at the start of a trial: if all of its behaviours do.
    pub(super) fn heeds(&self, initial: &[f64], key: TrialKey, agent: usize) -> bool {
        self.machines_of(agent).all(|at| {
            let machine = &self.machines[at];
            let advice = &self.conducts[machine.conduct as usize].advice;
            let uniform = || Stream::of(key, machine.entity, Purpose::Decision).uniform(0);
            // Weights that are none are refused when they are compiled.
            advice.is_empty() || pick(advice, initial, uniform).unwrap_or(true)
        })
    }

    /// Puts an agent who has just been placed into the first states of its behaviours.
    pub(super) fn begin(&self, with: (&Drive, &Parameters), state: &mut State, agent: usize, lane: usize) {
        if self.is_empty() {
            return;
        }
        let blocks = state.motion.x.len();
        let standing = &mut state.behaviours;
        let declared = self.most.len();
        if standing.modes.len() != declared || standing.detours.len() != blocks {
            *standing = ActiveModes {
                modes: vec![vec![Lanes::splat(-1.0); blocks]; declared],
                due: vec![vec![Lanes::splat(f64::INFINITY); blocks]; declared],
                exit: vec![vec![[0; LANES]; blocks]; declared],
                entered: vec![vec![[0; LANES]; blocks]; declared],
                set: self.most.iter().map(|most| vec![Lanes::ZERO; blocks * most]).collect(),
                own_keys: vec![[TrialKey::default(); LANES]; blocks],
                detours: vec![[(OWN_ROUTE, Halt::default()); LANES]; blocks],
            };
        }
        let slot = state.slot(agent, lane);
        state.behaviours.detours[slot.block][slot.lane] = (OWN_ROUTE, Halt::default());
        state.behaviours.own_keys[slot.block][slot.lane] = state.keys[state.layout.trial_of(slot.lane)];
        for at in self.machines_of(agent) {
            let machine = &self.machines[at];
            state.behaviours.entered[machine.behaviour as usize][slot.block][slot.lane] = 0;
            if !self.conducts[machine.conduct as usize].modes.is_empty() {
                self.enter(with.0, state, at, slot, 0);
            }
        }
        let changed = self.machines_of(agent).any(|at| {
            let conduct = &self.conducts[self.machines[at].conduct as usize];
            conduct.modes.first().is_some_and(conduct::Mode::changes_something)
        });
        if changed {
            self.apply(with, state, (agent, lane), true, |_| true);
        }
    }

    /// Looks at the state before a step and notes which states end with it.
    pub(super) fn watch(&self, layout: Layout, state: &mut State, scratch: &mut Scratch) {
        for turn in scratch.turns.drain(..) {
            scratch.turning[turn.machine as usize] = Mask::NONE;
            scratch.changing[turn.machine as usize] = Mask::NONE;
        }
        if self.is_empty() || state.occupied.is_empty() {
            return;
        }
        scratch.turning.resize(self.machines.len(), Mask::NONE);
        scratch.changing.resize(self.machines.len(), Mask::NONE);
        if let Some(code) = &self.code {
            code.read(layout, state, &mut scratch.readings);
            for at in 0..self.machines.len() {
                self.watch_conditions(at, state, scratch);
            }
        }
        let mut now = Lanes::ZERO;
        for lane in 0..LANES {
            now.0[lane] = state.ticks[layout.trial_of(lane)] as f64 + 1.0;
        }
        let occupied = match layout {
            Layout::Trials => state.occupied & !state.faulty,
            Layout::Agents if state.occupied.has(0) && state.faulty.is_empty() => Mask::ALL,
            Layout::Agents => Mask::NONE,
        };
        for behaviour in 0..state.behaviours.due.len() {
            for block in 0..state.motion.x.len() {
                let ripe = state.behaviours.due[behaviour][block].compare(now, |due, now| due <= now);
                for lane in (ripe & occupied & state.present[block]).iter() {
                    let agent = match layout {
                        Layout::Trials => block,
                        Layout::Agents => block * LANES + lane,
                    };
                    let mut own = self.machines_of(agent);
                    let Some(at) = own.find(|&at| self.machines[at].behaviour as usize == behaviour) else {
                        continue;
                    };
                    // A condition that held before the time had come goes first.
                    if !scratch.turning[at].has(lane) {
                        let exit = state.behaviours.exit[behaviour][block][lane];
                        self.decide(at, state, lane, exit, scratch);
                    }
                }
            }
        }
    }

    fn watch_conditions(&self, at: usize, state: &mut State, scratch: &mut Scratch) {
        let machine = &self.machines[at];
        let (first, count) = (machine.guards.0 as usize, machine.guards.1 as usize);
        if scratch.readings.atoms[first..first + count].iter().all(|atom| atom.is_empty()) {
            return;
        }
        for trial in (state.occupied & !state.faulty).iter() {
            let slot = state.slot(machine.agent as usize, trial);
            if !state.present[slot.block].has(slot.lane) {
                continue;
            }
            let mode = state.behaviours.modes[machine.behaviour as usize][slot.block].0[slot.lane];
            let Some(mode) = self.conducts[machine.conduct as usize].modes.get(mode as usize) else {
                continue;
            };
            let holds = |trigger: &Trigger| match trigger {
                Trigger::When(guard) => scratch.readings.atoms[first + *guard as usize].has(trial),
                Trigger::After { .. } => false,
            };
            if let Some(exit) = mode.exits.iter().position(|exit| holds(&exit.trigger)) {
                self.decide(at, state, slot.lane, exit as u32, scratch);
            }
        }
    }

    /// Draws the state that follows by a transition.
    fn decide(&self, at: usize, state: &mut State, lane: usize, exit: u32, scratch: &mut Scratch) {
        let machine = &self.machines[at];
        let trial = state.layout.trial_of(lane);
        let slot = state.slot(machine.agent as usize, trial);
        let old = state.behaviours.modes[machine.behaviour as usize][slot.block].0[slot.lane] as usize;
        let modes = &self.conducts[machine.conduct as usize].modes;
        let Some(old) = modes.get(old) else { return };
        let Some(exit) = old.exits.get(exit as usize) else { return };
        let variables: Vec<f64> = state.variables.iter().map(|lanes| lanes.0[trial]).collect();
        let stream = Stream::of(state.keys[trial], machine.number(state, trial), Purpose::Process);
        match pick(&exit.targets, &variables, || stream.uniform(state.ticks[trial] as u32)) {
            Some(mode) => {
                scratch.turns.push(Turn { machine: at as u32, lane, mode });
                scratch.turning[at] |= Mask::lane(lane);
                if old.changes_something() || modes[mode as usize].changes_something() {
                    scratch.changing[at] |= Mask::lane(lane);
                }
            }
            None => fail(state, trial, Fault::Branches { attached: at as u32 }),
        }
    }

    /// Enters the states that were decided on; to be called with the ticks and positions after the step. Whether
    /// the range of some force changed.
    pub(super) fn turn(&self, with: (&Drive, &Parameters), state: &mut State, scratch: &Scratch) -> bool {
        for &Turn { machine: at, lane, mode } in &scratch.turns {
            let machine = &self.machines[at as usize];
            let trial = state.layout.trial_of(lane);
            if !state.faulty.has(trial) {
                let slot = state.slot(machine.agent as usize, trial);
                self.enter(with.0, state, at as usize, slot, mode);
            }
        }
        let mut ranges = false;
        for &Turn { machine: at, lane, .. } in &scratch.turns {
            let agent = self.machines[at as usize].agent as usize;
            let trial = state.layout.trial_of(lane);
            // Where several behaviours of an agent turn, the first of them stands for all.
            let changing = |at: usize| scratch.changing[at].has(lane);
            let first = self.machines_of(agent).find(|&at| changing(at));
            if first == Some(at as usize) && !state.faulty.has(trial) {
                ranges |= self.apply(with, state, (agent, trial), false, changing);
            }
        }
        ranges
    }

    /// Enters a state: the times at which it may end are drawn.
    fn enter(&self, drive: &Drive, state: &mut State, at: usize, slot: Slot, mode: u32) {
        let machine = &self.machines[at];
        let conduct = &self.conducts[machine.conduct as usize];
        let trial = state.layout.trial_of(slot.lane);
        let stream = Stream::of(state.keys[trial], machine.number(state, trial), Purpose::Delay);
        let now = state.ticks[trial] as f64;
        let (behaviour, block, lane) = (machine.behaviour as usize, slot.block, slot.lane);
        let standing = &mut state.behaviours;
        let entered = &mut standing.entered[behaviour][block][lane];
        let first = entered.wrapping_mul(conduct.delays);
        *entered = entered.wrapping_add(1);
        standing.modes[behaviour][block].0[lane] = f64::from(mode);
        // The shortest time wins, also among those that end with the same step.
        let (mut shortest, mut chosen) = (f64::INFINITY, 0);
        for (number, exit) in conduct.modes[mode as usize].exits.iter().enumerate() {
            if let Trigger::After { law, number: draw } = &exit.trigger {
                let after = law.draw(stream.uniform(first.wrapping_add(*draw)));
                if after < shortest {
                    (shortest, chosen) = (after, number as u32);
                }
            }
        }
        standing.due[behaviour][block].0[lane] = now + steps_over(shortest, drive.dt);
        standing.exit[behaviour][block][lane] = chosen;
    }

    /// Gives an agent the parameters and the route that its behaviours want now. What those set that have just
    /// `turned` is computed; what others set stays as it was. `comes`: who has just been placed. Whether a range changed.
    fn apply(
        &self,
        (drive, parameters): (&Drive, &Parameters),
        state: &mut State,
        (agent, trial): (usize, usize),
        comes: bool,
        turned: impl Fn(usize) -> bool,
    ) -> bool {
        let slot = state.slot(agent, trial);
        // Replicas of a trial go on under other keys: what was drawn stays.
        let key = state.behaviours.own_keys[slot.block][slot.lane];
        let who = (AgentId(agent as u32), state.queues.later(agent, trial));
        let Some(own) = parameters.own(who, key) else { return false };
        let mut values = own;
        let mut known: Vec<f64> = state.variables.iter().map(|lanes| lanes.0[trial]).collect();
        known.extend(own);
        let mut route = OWN_ROUTE;
        let mut round = 0;
        for at in self.machines_of(agent) {
            let machine = &self.machines[at];
            let behaviour = machine.behaviour as usize;
            let mode = state.behaviours.modes[behaviour][slot.block].0[slot.lane] as usize;
            let Some(mode) = self.conducts[machine.conduct as usize].modes.get(mode) else { continue };
            let entered = state.behaviours.entered[behaviour][slot.block][slot.lane];
            let (first, turned) = (slot.block * self.most[behaviour], turned(at));
            for (number, (parameter, amount)) in mode.changes.iter().enumerate() {
                if turned {
                    let value = match amount {
                        Amount::Computed(num) => num.evaluate(&known).unwrap_or(f64::NAN),
                        Amount::Drawn(law) => {
                            let draw = parameter.draw().wrapping_add(entered);
                            let entity = machine.number(state, trial);
                            law.draw(Stream::of(state.keys[trial], entity, Purpose::Parameter).uniform(draw))
                        }
                    };
                    if !parameter.allows(value) {
                        let (attached, parameter) = (at as u32, *parameter);
                        fail(state, trial, Fault::Change { attached, parameter, value });
                        return false;
                    }
                    state.behaviours.set[behaviour][first + number].0[slot.lane] = value;
                }
                values[*parameter as usize] = state.behaviours.set[behaviour][first + number].0[slot.lane];
            }
            if let Some(stage) = mode.route {
                (route, round) = (stage, entered);
            }
        }
        let ranges = state.bodies.put(slot, &values, Parameter::changeable());
        state.whereabouts.slow(&mut state.bodies, slot);
        state.prepare(slot, drive.dt);
        let (present, home) = state.behaviours.detours[slot.block][slot.lane];
        if route == present {
            driver::renew(drive, state, slot);
            return ranges;
        }
        let home = if present == OWN_ROUTE { driver::halt(drive, state, slot) } else { home };
        state.behaviours.detours[slot.block][slot.lane] = (route, home);
        let (from, round) = if route == OWN_ROUTE { (home, 0) } else { (Halt::before(route), round) };
        driver::divert(drive, state, slot, (from, round), comes);
        ranges
    }
}

fn fail(state: &mut State, trial: usize, fault: Fault) {
    if !state.faulty.has(trial) {
        state.faulty |= Mask::lane(trial);
        state.faults[trial] = Some(fault);
    }
}
