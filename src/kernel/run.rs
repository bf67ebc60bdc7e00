//! Trials in motion: the next state of each lane, or why its trial ended.
//!
//! All loops over a trial go through here. A run holds the lanes of a batch; a trial alone is the one of lane 0. With steps
//! every trial goes on until its horizon; in continuous time it goes from jump to jump until none comes before the horizon.
//! A trial may continue under other keys from given times on: paths of splitting do.

use super::code::{Code, Readings};
use super::dynamics::{self, Scratch};
use super::process;
use super::program::Program;
use super::start::{self, Loaded};
use super::state::{Slot, State};
use super::tape::Unplayed;
use super::{Close, Layout, driver};
use crate::base::geometry::Vec2;
use crate::base::lanes::{LANES, Lanes, Mask};
use crate::base::random::TrialKey;
use crate::base::tick::Tick;
use crate::model::AgentId;
use fearless_simd::Level;
use std::borrow::Cow;
use std::sync::Arc;

/// The address of a trial.
#[derive(Clone, Copy, Debug, Default)]
pub struct Address<'c> {
    /// The key of its start.
    pub key: TrialKey,
    /// The declaration of moves and its option that is followed, if any.
    pub advice: Option<(usize, usize)>,
    /// Times and the keys in force after them, ascending: ticks, or in continuous time the bits of a number of seconds.
    pub changes: &'c [(u64, TrialKey)],
}

impl From<TrialKey> for Address<'_> {
    fn from(key: TrialKey) -> Self {
        Self { key, ..Self::default() }
    }
}

/// Why a trial has no next state. Of several reasons the first in this order counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum End {
    /// The model is wrong in it.
    Faulty(process::Fault),
    /// A source has more arrivals than places.
    Full,
    /// A number is NaN, a speed exceeds the limit for a person, or a process jumps without end within a step.
    Diverged,
    /// It has reached its horizon.
    Horizon,
}

/// The trials of a batch.
#[derive(Clone, Debug)]
pub struct Run<'p> {
    program: Cow<'p, Program>,
    state: State,
    scratch: Scratch,
    /// Lane by lane the changes of the key that are still to come, the next one last; and where there are any.
    changes: [Vec<(u64, TrialKey)>; LANES],
    changing: Mask,
    horizon: Tick,
    /// The horizon, s.
    last: f64,
}

impl<'p> Run<'p> {
    /// An empty batch of trials of a program.
    pub fn new(program: &'p Program) -> Self {
        Self {
            state: State::new(program.layout, program.scenario.agents.len()),
            scratch: Scratch::default(),
            changes: Default::default(),
            changing: Mask::NONE,
            horizon: program.scenario.horizon,
            last: program.scenario.clock.seconds(program.scenario.horizon),
            program: Cow::Borrowed(program),
        }
    }

    /// A trial alone, in its first state, and what its start found.
    ///
    /// # Errors
    /// When the trial cannot start.
    pub fn of(program: &'p Program, address: Address<'_>) -> Result<(Self, Loaded), start::Fault> {
        let mut run = Self::new(program);
        let loaded = run.start(address)?;
        Ok((run, loaded))
    }

    /// A trial alone that owns its program, in its first state, and what its start found.
    ///
    /// # Errors
    /// When the trial cannot start.
    pub fn owned(program: Program, address: Address<'_>) -> Result<(Run<'static>, Loaded), start::Fault> {
        let Run { state, scratch, changes, changing, horizon, last, .. } = Run::new(&program);
        let program = Cow::Owned(program);
        let mut run = Run { program, state, scratch, changes, changing, horizon, last };
        let loaded = run.start(address)?;
        Ok((run, loaded))
    }

    /// Starts a trial in lane 0, in the place of the one before.
    ///
    /// # Errors
    /// When the trial cannot start.
    pub fn start(&mut self, address: Address<'_>) -> Result<Loaded, start::Fault> {
        let loaded = self.load(0, address)?;
        self.begin(Mask::lane(0));
        Ok(loaded)
    }

    /// A trial alone whose states are given one by one ([`Run::show`]), with the parameters of a key.
    ///
    /// # Errors
    /// When a law draws no number with which somebody can move.
    pub fn given(program: &'p Program, key: TrialKey) -> Result<Self, start::Fault> {
        let mut run = Self::new(program);
        start::load_absent(program, &mut run.state, key)?;
        Ok(run)
    }

    /// Puts everybody of a trial alone where `seen` says, position in m and velocity in m/s; who is not seen is absent. Ways
    /// and legs go on from the state before, which belongs to the tick before.
    pub fn show(&mut self, tick: u64, mut seen: impl FnMut(AgentId) -> Option<(Vec2, Vec2)>) {
        self.state.ticks[0] = tick;
        let before = (self.state.motion.x.clone(), self.state.motion.y.clone(), self.state.present.clone());
        let all: Vec<_> = (0..self.state.agents).map(|agent| seen(AgentId(agent as u32))).collect();
        for (agent, shown) in all.iter().enumerate() {
            let slot = self.state.slot(agent, 0);
            let Slot { block, lane } = slot;
            let was_there = self.state.present[block].has(lane);
            let Some((position, _)) = *shown else {
                self.state.present[block] &= !Mask::lane(lane);
                continue;
            };
            let motion = &mut self.state.motion;
            let last = Vec2::new(motion.x[block].0[lane], motion.y[block].0[lane]);
            motion.travelled[block].0[lane] += if was_there { (position - last).norm() } else { 0.0 };
            (motion.x[block].0[lane], motion.y[block].0[lane]) = (position.x, position.y);
            self.state.present[block] |= Mask::lane(lane);
        }
        driver::steer(&self.program.drive, &mut self.state);
        // Steering turns velocities and lets those go who have arrived: here the recording decides.
        for (agent, shown) in all.into_iter().enumerate() {
            let Slot { block, lane } = self.state.slot(agent, 0);
            if let Some((_, velocity)) = shown {
                let motion = &mut self.state.motion;
                (motion.vx[block].0[lane], motion.vy[block].0[lane]) = (velocity.x, velocity.y);
                self.state.present[block] |= Mask::lane(lane);
            }
        }
        if !self.program.passing.is_empty() {
            let (x, y, was) = before;
            let moved: Vec<Mask> = was.iter().zip(&self.state.present).map(|(was, is)| *was & *is).collect();
            self.program.passing.step(Level::new(), &mut self.state, (&x, &y), &moved);
        }
    }

    /// The numbers of everybody in some columns of a recording, which are shown with the state; NaN where there is none.
    pub fn tell(&mut self, columns: usize, value: impl Fn(usize, AgentId) -> f64) {
        let nobody = vec![Lanes::splat(f64::NAN); self.state.present.len()];
        self.state.columns.resize(columns, nobody);
        for column in 0..columns {
            for agent in 0..self.state.agents {
                let Slot { block, lane } = self.state.slot(agent, 0);
                self.state.columns[column][block].0[lane] = value(column, AgentId(agent as u32));
            }
        }
    }

    /// Drives an agent of a trial alone with a velocity, m/s, in the next step.
    pub fn drive(&mut self, agent: AgentId, velocity: Vec2) {
        let slot = self.state.slot(agent.0 as usize, 0);
        let (speed, driving) = (velocity.norm(), &mut self.state.driving);
        let put = |field: &mut [Lanes], value| field[slot.block].0[slot.lane] = value;
        put(&mut driving.speed, speed);
        if speed > 0.0 {
            put(&mut driving.ex, velocity.x / speed);
            put(&mut driving.ey, velocity.y / speed);
            driving.move_on(slot);
        }
    }

    /// The variables of processes of a trial alone, in their order.
    pub fn put(&mut self, values: &[f64]) {
        for (variable, value) in self.state.variables.iter_mut().zip(values) {
            variable.0[0] = *value;
        }
    }

    /// A trial alone that continues from one of its states.
    pub fn from_state(program: &'p Program, state: State) -> Self {
        Self { state, ..Self::new(program) }
    }

    /// The same run with another horizon, not beyond that of the scenario.
    #[must_use]
    pub fn until(self, horizon: Tick) -> Self {
        Self { horizon, last: self.program.scenario.clock.seconds(horizon), ..self }
    }

    /// So many threads of the pool of the calling one share a crowd that is large enough. States have the same bits at any
    /// number.
    pub fn share(&mut self, threads: usize) {
        self.scratch.share(threads);
    }

    /// The present states.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// How many trials it holds side by side.
    pub fn width(&self) -> usize {
        match self.program.layout {
            Layout::Trials => LANES,
            Layout::Agents => 1,
        }
    }

    /// Lanes that hold a trial.
    pub fn occupied(&self) -> Mask {
        self.state.occupied
    }

    /// Loads a trial into a lane. On an error no lane changes.
    ///
    /// # Errors
    /// When the trial cannot start.
    pub fn load(&mut self, lane: usize, address: Address<'_>) -> Result<Loaded, start::Fault> {
        if self.program.scenario.processes.outside.is_some() {
            return self.load_tape(address);
        }
        let loaded = start::load(&self.program, &mut self.state, lane, address.key, address.advice)?;
        self.changes[lane].clear();
        self.changes[lane].extend(address.changes.iter().rev());
        self.changing &= !Mask::lane(lane);
        self.changing |= if address.changes.is_empty() { Mask::NONE } else { Mask::lane(lane) };
        Ok(loaded)
    }

    /// Loads a trial that a program elsewhere runs, and shows its first state.
    fn load_tape(&mut self, address: Address<'_>) -> Result<Loaded, start::Fault> {
        let Address { key, advice, .. } = address;
        let program = self.program.as_ref();
        let Some(player) = program.drive.player() else {
            return Err(start::Fault::Program("the program was not allowed to run".into()));
        };
        let option = advice.and_then(|advice| program.scenario.move_name(advice));
        let played = player.play(&program.scenario, key, option.as_deref());
        let (tape, fault) = match played {
            Ok(tape) => (tape, None),
            Err(Unplayed::Failed(said)) => return Err(start::Fault::Program(said)),
            Err(Unplayed::Wrong(fault)) => (Arc::default(), Some(fault)),
        };
        start::load_played(program, &mut self.state, key);
        self.state.faulty |= if fault.is_some() { Mask::lane(0) } else { Mask::NONE };
        self.state.faults[0] = fault;
        self.state.tape = Some(tape);
        self.play()?;
        Ok(Loaded::default())
    }

    /// Shows the state of the present tick of a tape.
    fn play(&mut self) -> Result<(), start::Fault> {
        let Some(tape) = self.state.tape.clone() else { return Ok(()) };
        let tick = self.state.ticks[0];
        let seen = tape.seen(tick);
        if let Some(people) = self.program.scenario.processes.outside.as_ref().and_then(|o| o.people.as_ref())
        {
            for one in seen {
                let AgentId(agent) = people.members[one.place as usize];
                let entered = &mut self.state.queues.entered[0][0];
                if one.place >= *entered {
                    *entered = one.place + 1;
                    start::appear(&self.program, &mut self.state, agent as usize, one.position)?;
                }
            }
            let mut all = vec![None; self.state.agents];
            for one in seen {
                all[people.members[one.place as usize].0 as usize] = Some((one.position, one.velocity));
            }
            self.show(tick, |AgentId(agent)| all[agent as usize]);
        }
        self.put(tape.variables(tick));
        Ok(())
    }

    /// Makes lanes that were just loaded ready.
    pub fn begin(&mut self, lanes: Mask) {
        if !lanes.is_empty() && self.state.tape.is_none() {
            dynamics::refresh(&self.program, &mut self.state, &mut self.scratch, lanes);
        }
    }

    /// Empties some lanes.
    pub fn clear(&mut self, lanes: Mask) {
        self.state.occupied &= !lanes;
    }

    /// Lanes whose trial ended before its horizon.
    pub fn ended(&self) -> Mask {
        (self.state.faulty | self.state.queues.full | self.state.diverged) & self.state.occupied
    }

    /// Why the trial of a lane has ended, if it has. In continuous time the horizon shows only when no jump comes.
    pub fn end(&self, lane: usize) -> Option<End> {
        let state = &self.state;
        let is_jumps = self.program.scenario.clock.is_jumps();
        if let Some(fault) = state.faults[lane].filter(|_| state.faulty.has(lane)) {
            Some(End::Faulty(fault))
        } else if state.queues.full.has(lane) {
            Some(End::Full)
        } else if state.diverged.has(lane) {
            Some(End::Diverged)
        } else {
            (!is_jumps && state.ticks[lane] >= self.horizon.0).then_some(End::Horizon)
        }
    }

    /// All occupied lanes go to their next state; those that did. In continuous time nothing more happens in the others.
    #[inline]
    pub fn advance(&mut self) -> Mask {
        if self.program.scenario.clock.is_jumps() {
            return self.jump();
        }
        if self.state.tape.is_some() {
            return self.advance_tape();
        }
        for lane in (self.changing & self.state.occupied).iter() {
            let now = self.state.ticks[lane];
            while let Some((_, key)) = self.change(lane, |from| from <= now) {
                self.state.keys[lane] = key;
            }
        }
        dynamics::step(&self.program, &mut self.state, &mut self.scratch);
        self.state.occupied
    }

    /// The next state of a tape.
    #[cold]
    fn advance_tape(&mut self) -> Mask {
        self.state.ticks[0] += 1;
        // Whoever appears has a body that its place allows.
        if self.play().is_err() {
            self.state.diverged |= Mask::lane(0);
        }
        self.state.occupied
    }

    /// The next jump of all occupied lanes, before which the keys of some may change.
    #[inline]
    fn jump(&mut self) -> Mask {
        let last = self.last;
        let mut until = [last; LANES];
        let mut jumped = Mask::NONE;
        loop {
            for lane in self.changing.iter() {
                // In a lane that has jumped nothing more happens.
                until[lane] = match self.changes[lane].last() {
                    _ if jumped.has(lane) => f64::NEG_INFINITY,
                    Some(&(from, _)) if f64::from_bits(from) < last => f64::from_bits(from),
                    _ => last,
                };
            }
            jumped |= dynamics::jump_until(&self.program, &mut self.state, &mut self.scratch, &until);
            let waiting = self.changing & self.state.occupied & !jumped & !self.state.faulty;
            if waiting.is_empty() {
                return jumped;
            }
            for lane in (self.state.occupied & !waiting).iter() {
                until[lane] = f64::NEG_INFINITY;
            }
            for lane in waiting.iter() {
                if let Some((from, key)) = self.change(lane, |from| f64::from_bits(from) < last) {
                    let change = (f64::from_bits(from), key);
                    dynamics::renew(&self.program, &mut self.state, &mut self.scratch, lane, change);
                }
                until[lane] = last;
            }
        }
    }

    /// Takes the next change of the key of a lane, if it is due. One that is not due in continuous time never comes.
    fn change(&mut self, lane: usize, is_due: impl Fn(u64) -> bool) -> Option<(u64, TrialKey)> {
        let next = self.changes[lane].pop_if(|(from, _)| is_due(*from));
        let is_over =
            self.changes[lane].is_empty() || (next.is_none() && self.program.scenario.clock.is_jumps());
        self.changing &= if is_over { !Mask::lane(lane) } else { Mask::ALL };
        next
    }

    /// The next state of the trial in lane 0, or why there is none. A step in which the model is wrong leads to no state.
    ///
    /// # Errors
    /// When the trial has ended.
    pub fn next_state(&mut self) -> Result<&State, End> {
        if let Some(end) = self.end(0) {
            return Err(end);
        }
        let moved = self.advance();
        match self.end(0) {
            Some(end @ End::Faulty(_)) => Err(end),
            _ if moved.is_empty() => Err(End::Horizon),
            _ => Ok(&self.state),
        }
    }

    /// Who may touch whom in the present state of a large crowd, where the kernel knows it.
    pub fn close(&self) -> Option<Close<'_>> {
        self.scratch.close(&self.state).filter(|_| self.state.tape.is_none())
    }

    /// Reads the present states.
    pub fn read(&self, code: &Code, close: Option<Close<'_>>, readings: &mut Readings) {
        code.run_close(&self.program, &self.state, close, readings);
    }
}
