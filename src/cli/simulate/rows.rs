//! Trials as rows of a table: one for each agent in each state, or for each state where there are no agents.

use crate::base::random::TrialKey;
use crate::base::tick::{Clock, Tick};
use crate::cli::end::early_end;
use crate::data::table::{Column, Kind, Table, Value};
use crate::engine::no_start;
use crate::kernel::{Address, End, Program, Run, Slot, State};
use crate::model::{AgentId, Domain, Parameter, Scenario};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// What the tables of a scenario are about, with every so many states.
pub(super) fn table(scenario: &Scenario, seed: u64, every: u64) -> Table {
    let has_agents = !scenario.agents.is_empty();
    let time = if scenario.clock == Clock::Steps { "steps" } else { "s" };
    let mut columns = vec![Column::new("time", Kind::Number(time)), Column::new("trial", Kind::Whole)];
    if has_agents {
        columns.push(Column::new("agent", Kind::Word));
        let numbers = [("x", "m"), ("y", "m"), ("vx", "m/s"), ("vy", "m/s"), ("speed", "m/s")];
        columns.extend(numbers.map(|(name, unit)| Column::new(name, Kind::Number(unit))));
        columns.push(Column::new("present", Kind::Truth));
        columns.push(Column::new("radius", Kind::Number("m")));
        if !scenario.scene.storeys.are_none() {
            columns.push(Column::new("level", Kind::Word));
        }
    }
    columns.extend(scenario.processes.variables.iter().map(|variable| {
        let kind = match variable.domain {
            Domain::Whole { .. } => Kind::Whole,
            Domain::Truth => Kind::Truth,
            Domain::Real => Kind::Number(""),
        };
        Column::new(&variable.name, kind)
    }));
    if has_agents {
        let behaviours = scenario.behaviours.declared.iter();
        let with_states = behaviours.filter(|behaviour| !behaviour.states.is_empty());
        columns.extend(with_states.map(|behaviour| Column::new(&behaviour.name, Kind::Word)));
    }
    Table {
        columns,
        scenario: scenario.title.clone(),
        seed,
        version: env!("CARGO_PKG_VERSION").to_owned(),
        interval: if scenario.clock.is_jumps() { 0.0 } else { scenario.clock.step_seconds() * every as f64 },
        walls: scenario.scene.walls().copied().collect(),
        solids: scenario.scene.solids().cloned().collect(),
    }
}

/// Runs trials one after the other and yields the rows of their states.
pub(super) struct Rows<'p> {
    program: &'p Program,
    seed: u64,
    every: u64,
    advice: Option<(usize, usize)>,
    /// The trials that come.
    trials: Box<dyn Iterator<Item = u64> + Send + 'p>,
    /// The trial that is under way, if one is; its state, and the one of its agents that comes next.
    run: Run<'p>,
    trial: Option<u64>,
    agent: usize,
    /// Trials in which bodies were made smaller at the start, and the first of them.
    pub(super) shrunk: (u64, Option<TrialKey>),
    /// Trials that ended before their time.
    pub(super) notes: Vec<String>,
    /// Whether the model was wrong in one of them.
    pub(super) is_wrong: bool,
    /// Whether a signal asks to stop.
    pub(super) interrupted: Arc<AtomicBool>,
}

impl<'p> Rows<'p> {
    /// No trials yet, of which every so many states are to be written, up to a tick.
    pub(super) fn new(
        program: &'p Program,
        (seed, every): (u64, u64),
        advice: Option<(usize, usize)>,
        last: Tick,
    ) -> Self {
        Self {
            program,
            seed,
            every,
            advice,
            trials: Box::new(std::iter::empty()),
            run: Run::new(program).until(last),
            trial: None,
            agent: 0,
            shrunk: (0, None),
            notes: Vec::new(),
            is_wrong: false,
            interrupted: Arc::default(),
        }
    }

    /// The rows of these trials come next.
    pub(super) fn of(&mut self, trials: impl Iterator<Item = u64> + Send + 'p) -> &mut Self {
        self.trials = Box::new(trials);
        self
    }

    /// So many threads of the pool of the calling one share a large crowd.
    pub(super) fn share(&mut self, threads: usize) {
        self.run.share(threads);
    }

    /// Whether a signal has asked to stop.
    pub(super) fn is_interrupted(&self) -> bool {
        self.interrupted.load(Ordering::Relaxed)
    }

    /// Goes to the next state that is written, and says of which trial it is; `None` when all trials are done.
    fn advance(&mut self) -> Option<u64> {
        let mut since = 0;
        while !self.is_interrupted() {
            let Some(trial) = self.trial else {
                let trial = self.trials.next()?;
                let key = TrialKey { seed: self.seed, index: trial, branch: 0 };
                match self.run.start(Address { advice: self.advice, ..key.into() }) {
                    Ok(loaded) => {
                        if !loaded.shrunk.is_empty() {
                            self.shrunk = (self.shrunk.0 + 1, self.shrunk.1.or(Some(key)));
                        }
                        self.trial = Some(trial);
                        return self.trial;
                    }
                    Err(fault) => {
                        let why = no_start(&self.program.scenario, fault);
                        self.notes.push(format!("trial {trial} cannot start: {why}"));
                    }
                }
                continue;
            };
            match self.run.next_state() {
                Ok(_) => since += 1,
                Err(end) => {
                    self.note(trial, end);
                    (self.trial, since) = (None, 0);
                }
            }
            if since == self.every {
                return self.trial;
            }
        }
        None
    }

    /// Notes why a trial ended, if that was before its time.
    fn note(&mut self, trial: u64, end: End) {
        self.is_wrong |= matches!(end, End::Faulty(_));
        if let Some(reason) = early_end(self.program, self.run.state(), end) {
            self.notes.push(format!("trial {trial} {reason}"));
        }
    }

    /// Seconds since the start of the trial (steps where steps have no length), and its number.
    fn head(&self, trial: u64) -> Vec<Value<'p>> {
        let time = match self.program.scenario.clock {
            Clock::Jumps(_) => self.run.state().clocks.now[0],
            clock => clock.seconds(Tick(self.run.state().ticks[0])),
        };
        vec![Value::Number(time), Value::Whole(trial as i64)]
    }

    fn variables(&self) -> impl Iterator<Item = Value<'p>> {
        let variables = self.program.scenario.processes.variables.iter().zip(&self.run.state().variables);
        variables.map(|(variable, lanes)| match variable.domain {
            Domain::Whole { .. } => Value::Whole(lanes.0[0] as i64),
            Domain::Truth => Value::Truth(lanes.0[0] != 0.0),
            Domain::Real => Value::Number(lanes.0[0]),
        })
    }

    /// The row of an agent in the present state.
    fn row(&self, trial: u64, agent: usize, slot: Option<Slot>) -> Vec<Value<'p>> {
        let (scenario, state) = (&self.program.scenario, self.run.state());
        let mut row = self.head(trial);
        row.push(Value::Word(match state.queues.arrival(&scenario.sources, AgentId(agent as u32), 0) {
            Some(name) => name.into(),
            None => scenario.agents[agent].name.as_str().into(),
        }));
        if let Some(slot) = slot {
            let (place, velocity) = (state.position(slot), state.velocity(slot));
            let (level, at) = scenario.scene.storeys.local(place).unzip();
            let at = at.unwrap_or(place);
            row.extend([at.x, at.y, velocity.x, velocity.y, velocity.norm()].map(Value::Number));
            row.extend([Value::Truth(true), Value::Number(slot.of(&state.bodies[Parameter::Radius]))]);
            row.extend(level.map(|level| Value::Word(level.name.as_str().into())));
        } else {
            row.extend([const { Value::Missing }; 5]);
            row.extend([Value::Truth(false), Value::Missing]);
            row.extend(scenario.scene.storeys.islands.first().map(|_| Value::Missing));
        }
        row.extend(self.variables());
        row.extend(modes(self.program, state, slot));
        row
    }
}

impl<'p> Iterator for Rows<'p> {
    type Item = Vec<Value<'p>>;

    fn next(&mut self) -> Option<Vec<Value<'p>>> {
        let agents = self.program.scenario.agents.len();
        if agents == 0 {
            let trial = self.advance()?;
            return Some(self.head(trial).into_iter().chain(self.variables()).collect());
        }
        loop {
            let trial = if self.agent == 0 { self.advance()? } else { self.trial? };
            let agent = self.agent;
            self.agent = (agent + 1) % agents;
            let state = self.run.state();
            let slot = state.slot(agent, 0);
            let slot = state.is_present(slot).then_some(slot);
            // An agent of a source, which keeps many more places than are taken, has rows while it is in the scene.
            if slot.is_some() || !self.program.arrivals.comes(agent) {
                return Some(self.row(trial, agent, slot));
            }
        }
    }
}

/// The states of all behaviours in a slot; missing without one.
fn modes<'p>(program: &'p Program, state: &State, slot: Option<Slot>) -> Vec<Value<'p>> {
    let declared = &program.scenario.behaviours.declared;
    let modes = &state.behaviours.modes;
    declared
        .iter()
        .enumerate()
        .filter(|(_, behaviour)| !behaviour.states.is_empty())
        .map(|(k, behaviour)| {
            let here = modes.get(k).zip(slot);
            let mode = here.map_or(-1.0, |(modes, slot)| slot.of(modes));
            // Nobody is in a state with a negative number.
            let name = if mode < 0.0 { None } else { behaviour.states.get(mode as usize) };
            name.map_or(Value::Missing, |name| Value::Word(name.as_str().into()))
        })
        .collect()
}
