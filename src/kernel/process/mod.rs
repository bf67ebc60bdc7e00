//! Processes: guarded commands of all trials of a batch at once.
//!
//! At a step each process looks at the old state, picks its enabled command and a branch of it by one
//! uniform number (`Purpose::Process`, its entity, the tick), and all new values are written together.
//! Guards, probabilities and updates are linear code over lanes; a process that depends on few values only
//! is a table made by that same code.

mod chain;
mod commands;
pub(super) mod delay;
mod draws;
mod embedded;
mod keys;
mod space;
mod step_batch;
mod table;
mod timed;

use super::code::{Code, Readings};
pub use super::fault::Fault;
use super::fault::Faults;
use super::state::{Layout, State};
use crate::base::lanes::{LANES, Lanes, Mask};
use crate::base::random::{Purpose, Stream, TrialKey};
use crate::base::tick::{Clock, Tick};
use crate::model::{Bool, Domain, Num, Scenario};
pub use chain::Chain;
use commands::{Commands, Event};
use draws::Draws;
pub use embedded::{Embedded, JumpBatch, Stay};
use fearless_simd::Level;
use keys::Keys;
pub use space::Space;
use std::collections::BTreeSet;
pub use step_batch::StepBatch;
use table::MOST_ROWS;
use table::Table;
use timed::{Timed, is_timed};

/// Most jumps between two steps; a trial that needs more is unresolved.
pub const MOST_BETWEEN: u32 = 1 << 20;
/// So many that it is counted which process those after them are of.
const MANY_BETWEEN: u32 = 1 << 12;

/// One process.
#[derive(Clone, Debug)]
struct Machine {
    /// The part of the counter that names it.
    word: u32,
    form: Form,
}

/// How a process is run.
#[derive(Clone, Debug)]
#[allow(clippy::large_enum_variant, reason = "tables are read at every jump, and there are few forms")]
enum Form {
    Table(Table),
    Code(Commands),
}

impl Form {
    /// A table of at most so many rows where that is possible; else code, which is entered into the lists.
    fn of(
        scenario: &Scenario,
        number: usize,
        domains: &[Domain],
        events: &[Event],
        rows: u64,
        (atoms, signals): (&mut Vec<Bool>, &mut Vec<Num>),
    ) -> Self {
        let process = &scenario.processes.list[number];
        Table::of(scenario, number, domains, events, rows)
            .map_or_else(|| Self::Code(Commands::of(number, process, domains, atoms, signals)), Self::Table)
    }
}

/// The processes of a scenario, made ready to run.
#[derive(Clone, Debug)]
pub struct Processes {
    /// Values of the variables at the start.
    pub(super) initial: Vec<f64>,
    machines: Vec<Machine>,
    /// Those with rates and delays.
    timed: Option<Timed>,
    clock: Clock,
    horizon: Tick,
    /// Guards, probabilities and updates of those that are no tables.
    code: Option<Code>,
    level: Level,
    /// All of them as one chain, where they are few and small.
    chain: Option<Chain>,
    /// The one that there is as the chain of its jumps, in continuous time.
    embedded: Option<Embedded>,
}

/// Room to work. It holds no part of the state.
#[derive(Clone, Debug, Default)]
pub(super) struct Scratch {
    readings: Readings,
    next: Vec<Lanes>,
    faults: Faults,
    /// What was read for those with rates and delays.
    timed: Readings,
}

impl Processes {
    /// Prepares the processes of a scenario.
    pub fn new(scenario: &Scenario) -> Self {
        Self::with_tables(scenario, table::MOST_ROWS)
    }

    /// Tables have at most so many rows; with 0 all processes are code. Results have the same bits.
    pub fn with_tables(scenario: &Scenario, rows: u64) -> Self {
        let processes = &scenario.processes;
        let domains: Vec<Domain> = processes.variables.iter().map(|v| v.domain).collect();
        let (mut atoms, mut signals) = (Vec::new(), Vec::new());
        let machines: Vec<Machine> = processes
            .list
            .iter()
            .enumerate()
            .filter(|(_, process)| !is_timed(process))
            .map(|(number, process)| {
                let lists = (&mut atoms, &mut signals);
                let form = Form::of(scenario, number, &domains, &[Event::Step], rows, lists);
                let stream = Stream::of(TrialKey::default(), process.entity, Purpose::Process);
                Machine { word: stream.counter(0)[1], form }
            })
            .collect();
        let timed = Timed::of(scenario, &domains, rows, Level::new());
        // Agents are no part of a chain.
        let alone = scenario.agents.is_empty() && scenario.sources.is_empty();
        let initial: Vec<f64> = processes.variables.iter().map(|v| v.initial).collect();
        let chain = if alone && timed.is_none() { Chain::of(&machines, &initial, &domains) } else { None };
        let single = timed.as_ref().filter(|_| alone && machines.is_empty() && scenario.clock.is_jumps());
        let until = scenario.clock.seconds(scenario.horizon);
        let embedded = single
            .and_then(Timed::alone)
            .and_then(|process| Embedded::of(process, &initial, &domains, until));
        let coded = machines.iter().any(|machine| matches!(machine.form, Form::Code(_)));
        Self {
            initial,
            machines,
            timed,
            clock: scenario.clock,
            horizon: scenario.horizon,
            code: coded.then(|| Code::compile(scenario, &atoms, &signals)),
            level: Level::new(),
            chain,
            embedded,
        }
    }

    /// All of them as one finite chain, if they are small tables that read nothing but variables, there is
    /// nobody else, and no reachable state has an error.
    pub fn chain(&self) -> Option<&Chain> {
        self.chain.as_ref()
    }

    /// The chain of its jumps, if there is one process with rates and few states, nobody else, and no reachable state
    /// has an error.
    pub fn embedded(&self) -> Option<&Embedded> {
        self.embedded.as_ref()
    }

    /// The same processes for the plainest vectors of the machine: the same bits, slower.
    pub fn at_baseline(mut self) -> Self {
        self.level = Level::baseline();
        self.code = self.code.map(Code::at_baseline);
        self.timed = self.timed.map(Timed::at_baseline);
        self.chain = self.chain.map(Chain::at_baseline);
        self.embedded = self.embedded.map(Embedded::at_baseline);
        self
    }

    /// Begins a trial.
    pub(super) fn load(&self, state: &mut State, lane: usize) {
        state.variables.resize(self.initial.len(), Lanes::ZERO);
        for (lanes, &value) in state.variables.iter_mut().zip(&self.initial) {
            lanes.0[lane] = value;
        }
        state.faulty &= !Mask::lane(lane);
        state.faults[lane] = None;
        if let Some(timed) = &self.timed {
            timed.load(state, lane);
        }
    }

    /// Continuous time: the next jump of every occupied lane, if it comes up to and with `until`, s, which is at most
    /// the horizon. These lanes; the time of the jump is in `state.clocks`.
    pub(super) fn jump(
        &self,
        layout: Layout,
        state: &mut State,
        scratch: &mut Scratch,
        until: &[f64; LANES],
    ) -> Mask {
        let Some(timed) = &self.timed else { return Mask::NONE };
        Self::set_clocks(timed, layout, state, scratch);
        let lanes = state.occupied & !state.faulty;
        timed.ring(layout, state, &mut scratch.timed, lanes, until)
    }

    /// Sets the clocks of trials that have just begun.
    fn set_clocks(timed: &Timed, layout: Layout, state: &mut State, scratch: &mut Scratch) {
        let fresh = state.clocks.fresh & state.occupied;
        if !fresh.is_empty() {
            timed.look(layout, state, &mut scratch.timed, fresh);
        }
    }

    /// Continuous time: from `at` on, s, before which nothing more happens under the old one, the trial of a lane
    /// goes on under another key.
    pub(super) fn renew(
        &self,
        layout: Layout,
        state: &mut State,
        scratch: &mut Scratch,
        lane: usize,
        (at, key): (f64, TrialKey),
    ) {
        if let Some(timed) = &self.timed {
            Self::set_clocks(timed, layout, state, scratch);
            state.keys[lane] = key;
            timed.renew(state, lane, at);
        }
    }

    /// The time of the last instant of a trial, s.
    pub(super) fn last(&self) -> f64 {
        self.clock.seconds(self.horizon)
    }

    /// The process with rates or delays that has jumped most often in the trial of a lane, and its present rate, 1/s.
    pub fn busiest(&self, state: &State, lane: usize) -> Option<(u32, f64)> {
        self.timed.as_ref()?.busiest(state, lane)
    }

    /// With a step: lets what is due at once happen in trials that have just been loaded. The first state is the one
    /// that holds at time 0.
    pub(super) fn begin(&self, layout: Layout, state: &mut State, scratch: &mut Scratch, lanes: Mask) {
        let Some(timed) = self.timed.as_ref().filter(|_| !self.clock.is_jumps()) else { return };
        let lanes = lanes & state.occupied & state.clocks.fresh;
        if !lanes.is_empty() {
            timed.look(layout, state, &mut scratch.timed, lanes);
            ring(timed, layout, state, &mut scratch.timed, lanes, &[0.0; LANES]);
        }
    }

    /// One step of all processes. Lanes that are faulty keep their values.
    pub(super) fn step(&self, layout: Layout, state: &mut State, scratch: &mut Scratch) {
        let mut lanes = state.occupied & !state.faulty;
        if (self.machines.is_empty() && self.timed.is_none()) || lanes.is_empty() {
            return;
        }
        let Scratch { readings, next, faults, timed: timed_readings } = scratch;
        if let Some(timed) = &self.timed {
            for lane in lanes.iter() {
                state.clocks.now[lane] = self.clock.seconds(Tick(state.ticks[lane]));
            }
            timed.look(layout, state, timed_readings, lanes);
            lanes &= !state.faulty;
        }
        if let Some(code) = &self.code {
            code.read(layout, state, readings);
        }
        next.clone_from(&state.variables);
        faults.clear();
        for machine in &self.machines {
            let draws = Draws { level: self.level, state, word: machine.word };
            match &machine.form {
                Form::Table(table) => table.step(lanes, state, &draws, next, faults),
                Form::Code(commands) => commands.step(lanes, readings, &draws, next, faults),
            }
        }
        if let Some(timed) = &self.timed {
            // What they read of others is what was there at the last step.
            let until = state.ticks.map(|tick| self.clock.seconds(Tick(tick + 1)));
            ring(timed, layout, state, timed_readings, lanes, &until);
            for &variable in &timed.written {
                next[variable as usize] = state.variables[variable as usize];
            }
            lanes &= !state.faulty;
        }
        let wrong = faults.lanes() & lanes;
        if wrong.is_empty() && state.faulty.is_empty() {
            std::mem::swap(&mut state.variables, next);
            return;
        }
        state.faulty |= wrong;
        for lane in lanes.iter() {
            if wrong.has(lane) {
                state.faults[lane] = faults.of(lane);
                continue;
            }
            for (old, new) in state.variables.iter_mut().zip(next.iter()) {
                old.0[lane] = new.0[lane];
            }
        }
    }
}

/// Lets processes with rates and delays jump up to and with these times.
fn ring(
    timed: &Timed,
    layout: Layout,
    state: &mut State,
    readings: &mut Readings,
    mut lanes: Mask,
    until: &[f64; LANES],
) {
    let mut since = Vec::new();
    for round in 0..MOST_BETWEEN {
        if round == MANY_BETWEEN {
            since.clone_from(&state.clocks.fired);
        }
        lanes = timed.ring(layout, state, readings, lanes & !state.faulty, until);
        if lanes.is_empty() {
            return;
        }
    }
    state.diverged |= lanes;
    state.clocks.jammed |= lanes;
    state.clocks.blame(&since, lanes);
}

// What monitors want to know of the states of a scenario in continuous time, trial by trial: a table where
// it depends on few values of variables, else code over lanes.

/// Truth values and numbers of a state.
#[derive(Clone, Debug)]
pub struct View {
    keys: Option<Keys>,
    code: Code,
    /// Row by row, where there are keys.
    atoms: Vec<bool>,
    signals: Vec<f64>,
    /// Number of atoms and of signals.
    width: (usize, usize),
}

/// What was seen of the states of a batch.
#[derive(Clone, Debug, Default)]
pub struct ViewReadings {
    readings: Readings,
    atoms: Vec<bool>,
    signals: Vec<f64>,
}

impl View {
    /// Prepares to look at the states of a scenario of processes.
    pub fn new(scenario: &Scenario, atoms: &[Bool], signals: &[Num]) -> Self {
        let domains: Vec<Domain> = scenario.processes.variables.iter().map(|v| v.domain).collect();
        let mut read = BTreeSet::new();
        let closed = atoms.iter().fold(true, |so_far, atom| so_far & atom.reads(&mut read))
            & signals.iter().fold(true, |so_far, signal| so_far & signal.reads(&mut read));
        let mut view = Self {
            keys: if closed { Keys::of(&read, &domains, MOST_ROWS) } else { None },
            code: Code::compile(scenario, atoms, signals),
            atoms: Vec::new(),
            signals: Vec::new(),
            width: (atoms.len(), signals.len()),
        };
        if let Some(keys) = &view.keys {
            let (atoms, signals) = (&mut view.atoms, &mut view.signals);
            keys.each_row(&view.code, domains.len(), |readings, lane| {
                atoms.extend(readings.atoms.iter().map(|mask| mask.has(lane)));
                signals.extend(readings.signals.iter().map(|lanes| lanes.0[lane]));
                Some(())
            });
        }
        view
    }

    /// Looks at the states of a batch.
    #[inline]
    pub fn look(&self, state: &State, seen: &mut ViewReadings) {
        if self.keys.is_none() {
            self.code.read(Layout::Trials, state, &mut seen.readings);
        }
    }

    /// The atoms and signals of one lane, of a batch that was looked at.
    #[inline]
    pub fn of<'s>(
        &'s self,
        state: &State,
        seen: &'s mut ViewReadings,
        lane: usize,
    ) -> (&'s [bool], &'s [f64]) {
        let (atoms, signals) = self.width;
        if let Some(keys) = &self.keys {
            let row = keys.row(&state.variables, lane);
            return (&self.atoms[row * atoms..][..atoms], &self.signals[row * signals..][..signals]);
        }
        seen.atoms.clear();
        seen.atoms.extend(seen.readings.atoms.iter().map(|mask| mask.has(lane)));
        seen.signals.clear();
        seen.signals.extend(seen.readings.signals.iter().map(|lanes| lanes.0[lane]));
        (&seen.atoms, &seen.signals)
    }
}
