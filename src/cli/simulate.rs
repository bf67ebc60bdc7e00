//! `smc simulate`: traces of trials as tables.

use super::arguments::{Simulate, TableFormat};
use super::complaint;
use super::inputs;
use super::output;
use super::terminal::{Colors, warn};
use crate::base::geometry::Vec2;
use crate::base::random::{MOST_TRIALS, TrialKey};
use crate::base::tick::{Clock, Tick};
use crate::compile::nearest::nearest;
use crate::data::table::{
    Held, Row, StateRow, write_csv, write_json, write_json_lines, write_states_csv, write_states_json,
    write_states_json_lines,
};
use crate::engine::{no_start, placeable, smaller};
use crate::kernel::driver::straight;
use crate::kernel::{Program, Scratch, Slot, State, dynamics, start};
use crate::model::{AgentId, Domain, Parameter, Scenario};
use crate::report::ExitCode as Exit;
use std::io::{BufWriter, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// One agent in one state.
struct Record<'s> {
    time: f64,
    trial: u64,
    agent: usize,
    /// The name, where it is that of a later person on the place of a source.
    arrival: Option<String>,
    position: Vec2,
    velocity: Vec2,
    /// Whether the agent is in the scene.
    present: bool,
    /// The radius, m, and the values of all variables of processes; truth as 1 or 0.
    signals: Vec<f64>,
    /// States of behaviours, in the order of their declaration; empty in who has none.
    modes: Vec<&'s str>,
}

/// Runs trials one after the other and yields their states.
struct Walk<'p> {
    program: &'p Program,
    arguments: &'p Simulate,
    advice: Option<(usize, usize)>,
    last: u64,
    state: State,
    scratch: Scratch,
    trial: u64,
    agent: usize,
    running: bool,
    /// Jumps since the start of the trial, in continuous time.
    jumps: u64,
    /// Trials in which bodies were made smaller at the start, and the first of them.
    shrunk: (u64, Option<TrialKey>),
    /// Trials that ended before their time.
    notes: Vec<String>,
    /// Whether the model was wrong in one of them.
    is_wrong: bool,
    /// Whether a signal asks to stop.
    interrupted: Arc<AtomicBool>,
}

impl<'p> Walk<'p> {
    fn new(program: &'p Program, arguments: &'p Simulate, advice: Option<(usize, usize)>, last: u64) -> Self {
        Self {
            program,
            arguments,
            advice,
            last,
            state: State::new(program.layout, program.scenario.agents.len()),
            scratch: Scratch::new(),
            trial: arguments.trial,
            agent: 0,
            running: false,
            jumps: 0,
            shrunk: (0, None),
            notes: Vec::new(),
            is_wrong: false,
            interrupted: Arc::default(),
        }
    }

    /// Goes to the next state that is written; false when all trials are done.
    fn advance(&mut self) -> bool {
        loop {
            if self.interrupted.load(Ordering::Relaxed) {
                return false;
            }
            if !self.running {
                if self.trial >= self.arguments.trial.saturating_add(self.arguments.trials) {
                    return false;
                }
                let key = TrialKey { seed: self.arguments.seed, index: self.trial, branch: 0 };
                match start::load(self.program, &mut self.state, 0, key, self.advice) {
                    Ok(loaded) => {
                        if !loaded.shrunk.is_empty() {
                            self.shrunk = (self.shrunk.0 + 1, self.shrunk.1.or(Some(key)));
                        }
                        let lanes = crate::base::lanes::Mask::lane(0);
                        dynamics::refresh(self.program, &mut self.state, &mut self.scratch, lanes);
                        self.running = true;
                        self.jumps = 0;
                        return true;
                    }
                    Err(fault) => {
                        let why = no_start(&self.program.scenario, fault);
                        self.notes.push(format!("trial {} cannot start: {why}", self.trial));
                        self.trial += 1;
                        continue;
                    }
                }
            }
            let tick = self.state.ticks[0];
            let clock = self.program.scenario.clock;
            if clock.is_jumps() && self.state.faulty.is_empty() {
                let jumped = dynamics::jump(self.program, &mut self.state, &mut self.scratch);
                let end = clock.seconds(Tick(self.last));
                if !jumped.is_empty() && self.state.faulty.is_empty() && self.state.clocks.now[0] <= end {
                    self.jumps += 1;
                    if self.jumps.is_multiple_of(self.arguments.every) {
                        return true;
                    }
                } else if self.state.faulty.is_empty() {
                    self.running = false;
                    self.trial += 1;
                }
                continue;
            }
            let later = clock.is_jumps() && self.state.clocks.now[0] > clock.seconds(Tick(self.last));
            if later && !self.state.faulty.is_empty() {
                // Wrong after what is asked for.
                self.running = false;
                self.trial += 1;
                continue;
            }
            if let Some(fault) = self.state.faults[0].filter(|_| !self.state.faulty.is_empty()) {
                let what = fault.describe(&self.program.scenario);
                self.is_wrong = true;
                self.notes.push(format!("trial {} ends in an error of the model: {what}", self.trial));
                self.running = false;
                self.trial += 1;
                continue;
            }
            if let Some(reason) = self.state.queues.overrun(&self.program.scenario.sources, 0) {
                let time = self.program.scenario.clock.seconds(crate::base::tick::Tick(tick));
                self.notes.push(format!("trial {} is unresolved at {time} s: {reason}", self.trial));
                self.running = false;
                self.trial += 1;
                continue;
            }
            if tick >= self.last || !self.state.diverged.is_empty() {
                if !self.state.diverged.is_empty() {
                    let time = self.program.scenario.clock.seconds(Tick(tick));
                    self.notes.push(format!(
                        "trial {} diverged at {time} s: {}",
                        self.trial,
                        crate::engine::divergence(self.program, &self.state)
                    ));
                }
                self.running = false;
                self.trial += 1;
                continue;
            }
            dynamics::step(self.program, &mut self.state, &mut self.scratch);
            // A step in which the model is wrong leads to no state.
            if self.state.faulty.is_empty() && self.state.ticks[0].is_multiple_of(self.arguments.every) {
                return true;
            }
        }
    }
}

impl Walk<'_> {
    /// Seconds since the start of the trial (steps where steps have no length).
    fn time(&self) -> f64 {
        match self.program.scenario.clock {
            Clock::Jumps(_) => self.state.clocks.now[0],
            clock => clock.seconds(Tick(self.state.ticks[0])),
        }
    }

    /// The present state, where there are no people.
    fn state_row(&self) -> StateRow {
        let variables = self.program.scenario.processes.variables.iter().zip(&self.state.variables);
        let values = variables.map(|(variable, lanes)| match variable.domain {
            Domain::Truth => Held::Truth(lanes.0[0] != 0.0),
            _ => Held::Number(lanes.0[0]),
        });
        StateRow { time: self.time(), trial: self.trial, values: values.collect() }
    }
}

impl<'p> Iterator for Walk<'p> {
    type Item = Record<'p>;

    fn next(&mut self) -> Option<Record<'p>> {
        let agents = self.program.scenario.agents.len();
        // An agent of a source, which keeps many more places than are taken, has rows while it is in the scene.
        let (slot, present) = loop {
            if self.agent == 0 && !self.advance() || agents == 0 {
                return None;
            }
            let slot = self.state.slot(self.agent, 0);
            let present = self.state.present[slot.block].has(slot.lane);
            if present || !self.program.arrivals.comes(self.agent) {
                break (slot, present);
            }
            self.agent = (self.agent + 1) % agents;
        };
        let at = |field: &[crate::base::lanes::Lanes]| field[slot.block].0[slot.lane];
        let record = Record {
            time: self.time(),
            trial: self.trial,
            agent: self.agent,
            arrival: self.state.queues.arrival(&self.program.scenario.sources, AgentId(self.agent as u32), 0),
            position: Vec2::new(at(&self.state.motion.x), at(&self.state.motion.y)),
            velocity: Vec2::new(at(&self.state.motion.vx), at(&self.state.motion.vy)),
            present,
            signals: std::iter::once(if present {
                at(&self.state.bodies[Parameter::Radius])
            } else {
                f64::NAN
            })
            .chain(self.state.variables.iter().map(|lanes| lanes.0[0]))
            .collect(),
            modes: modes(self.program, &self.state, present.then_some(slot)),
        };
        self.agent = (self.agent + 1) % agents;
        Some(record)
    }
}

/// The names of the states of all behaviours in a slot; empty without one.
fn modes<'p>(program: &'p Program, state: &State, slot: Option<Slot>) -> Vec<&'p str> {
    let declared = &program.scenario.behaviours.declared;
    let modes = &state.behaviours.modes;
    declared
        .iter()
        .enumerate()
        .filter(|(_, behaviour)| !behaviour.states.is_empty())
        .map(|(k, behaviour)| {
            let here = modes.get(k).zip(slot);
            let mode = here.map_or(-1.0, |(modes, slot)| modes[slot.block].0[slot.lane]);
            // Nobody is in a state with a negative number.
            let name = if mode < 0.0 { None } else { behaviour.states.get(mode as usize) };
            name.map_or("", String::as_str)
        })
        .collect()
}

/// The option of a name, with whose it is where several people have one of that name: `stop`, `user: stop`.
fn option(scenario: &Scenario, name: &str) -> Result<(usize, usize), (String, String)> {
    let wanted = name.trim();
    let all = || {
        let declarations = scenario.moves.iter().enumerate();
        declarations
            .flat_map(|(declaration, moves)| (0..moves.options.len()).map(move |at| (declaration, at)))
    };
    if let Some(found) = all().find(|of| scenario.move_name(*of).as_deref() == Some(wanted)) {
        return Ok(found);
    }
    let label = |(declaration, at): (usize, usize)| scenario.moves[declaration].options[at].0.as_str();
    let same: Vec<String> = all()
        .filter(|of| label(*of) == wanted)
        .filter_map(|of| Some(format!("`{}`", scenario.move_name(of)?)))
        .collect();
    if !same.is_empty() {
        return Err((
            format!("several people have a move `{wanted}`"),
            format!("say whose: {}", same.join(", ")),
        ));
    }
    let labels: Vec<String> = all().filter_map(|of| scenario.move_name(of)).collect();
    let hint = match nearest(wanted, labels.iter().map(String::as_str)) {
        _ if labels.is_empty() => "the scenario declares no moves".to_owned(),
        // Of numbers that differ, none is meant more than another.
        Some(near) if !wanted.contains(|c: char| c.is_ascii_digit()) => format!("did you mean `{near}`?"),
        _ => format!("there are {}", labels.join(", ")),
    };
    Err((format!("there is no move `{wanted}`"), hint))
}

/// The call is wrong.
fn refuse(reason: impl Into<String>, hint: impl Into<String>, colors: Colors) -> Exit {
    complaint::tell(&complaint::argument(reason, hint), &[], colors);
    Exit::Wrong
}

/// Runs the command.
pub(super) fn run(arguments: &Simulate, colors: Colors) -> Exit {
    if arguments.every == 0 || arguments.trials == 0 {
        let option = if arguments.every == 0 { "--every" } else { "--trials" };
        return refuse(format!("`{option} 0` writes nothing"), "it takes a number from 1", colors);
    }
    if arguments.trial.saturating_add(arguments.trials) > MOST_TRIALS {
        let hint = format!("they are numbered from 0 to {}", MOST_TRIALS - 1);
        return refuse("a seed has no such trials", hint, colors);
    }
    let inputs = inputs::load(&arguments.model, &[]);
    super::diagnose(&inputs, colors);
    let Some(study) = &inputs.study else { return Exit::Wrong };
    if let Err(error) = output::guard(arguments.output.as_deref(), &inputs.paths) {
        complaint::tell(&error, &[], colors);
        return Exit::Wrong;
    }
    let Some(world) = study.worlds.last() else { return Exit::Wrong };
    if study.worlds.len() > 2 {
        return refuse(
            "a sweep has several settings, and a trace is of one",
            "write `--set name=value`",
            colors,
        );
    }
    let scenario: Arc<Scenario> = world.scenario.clone();
    let advice = match arguments.advice.as_deref().map(|name| option(&scenario, name)) {
        Some(Err((reason, hint))) => return refuse(reason, hint, colors),
        Some(Ok(advice)) => Some(advice),
        None => None,
    };
    if let Err(fault) = placeable(world) {
        complaint::tell(&complaint::refusal(&fault), &inputs.sources, colors);
        return Exit::Wrong;
    }
    let mut last = scenario.horizon.0;
    if let Some(until) = arguments.until {
        if until.is_nan() || until < 0.0 {
            return refuse(format!("`--until {until}` is no time"), "it takes a number of seconds", colors);
        }
        let end = scenario.clock.seconds(scenario.horizon);
        if until > end * (1.0 + 1e-12) {
            let unit = if scenario.clock == Clock::Steps { "steps" } else { "s" };
            let hint = format!("the horizon of the scenario is {end} {unit}");
            return refuse(format!("`--until {until}` lies beyond the horizon"), hint, colors);
        }
        // The longest time that is a whole number of ticks, in continuous time of very short ones.
        last = last.min(match scenario.clock {
            Clock::Jumps(tick) => (until / tick.to_f64()).floor() as u64,
            // In spite of rounding, and never beyond what was asked for.
            clock => (until / clock.step_seconds() * (1.0 + 1e-12)).floor() as u64,
        });
    }
    let program = Program::driven(scenario.clone(), straight(&scenario, arguments.seed));
    let mut walk = Walk::new(&program, arguments, advice, last);
    if arguments.output.is_some() {
        // The file gets its name only when it is complete: the first signal ends the table, the second one the process.
        let interrupted = Arc::clone(&walk.interrupted);
        let _ = ctrlc::set_handler(move || {
            if interrupted.swap(true, Ordering::Relaxed) {
                std::process::exit(i32::from(Exit::Interrupted.code()));
            }
        });
    }
    let written = match &arguments.output {
        Some(path) => output::write(path, |out| write(arguments.format, out, &scenario, &mut walk)),
        None => write(arguments.format, BufWriter::new(std::io::stdout().lock()), &scenario, &mut walk),
    };
    if let (trials, Some(first)) = walk.shrunk {
        warn(&format!("warning: {}\n", smaller(&program, first, trials)));
    }
    for note in &walk.notes {
        warn(&format!("warning: {note}\n"));
    }
    match written {
        // As a check of the same trial would.
        Ok(_) if walk.is_wrong => Exit::Wrong,
        Ok(_) if walk.interrupted.load(Ordering::Relaxed) => Exit::Interrupted,
        Ok(_) => Exit::Success,
        Err(error) if error.kind() == std::io::ErrorKind::BrokenPipe => Exit::Success,
        Err(error) => {
            let error = match &arguments.output {
                Some(path) => format!("`{}` cannot be written: {error}", path.display()),
                None => error.to_string(),
            };
            complaint::tell(&complaint::output(error), &[], colors);
            Exit::Wrong
        }
    }
}

fn write(
    format: TableFormat,
    out: impl Write,
    scenario: &Scenario,
    walk: &mut Walk<'_>,
) -> std::io::Result<u64> {
    if scenario.agents.is_empty() {
        let names: Vec<&str> = scenario.processes.variables.iter().map(|v| v.name.as_str()).collect();
        let rows = std::iter::from_fn(|| walk.advance().then(|| walk.state_row()));
        return match format {
            TableFormat::Csv => write_states_csv(out, &names, rows),
            TableFormat::Json => write_states_json(out, &names, rows),
            TableFormat::Jsonl => write_states_json_lines(out, &names, rows),
        };
    }
    let rows = walk.map(|record| Row {
        time: record.time,
        trial: record.trial,
        agent: match record.arrival {
            Some(name) => name.into(),
            None => scenario.agents[record.agent].name.as_str().into(),
        },
        position: record.position,
        velocity: record.velocity,
        present: record.present,
        signals: record.signals.into(),
        words: record.modes,
    });
    let declared = scenario.behaviours.declared.iter().filter(|behaviour| !behaviour.states.is_empty());
    let variables = scenario.processes.variables.iter().map(|variable| variable.name.as_str());
    let names: Vec<&str> = std::iter::once("radius")
        .chain(variables)
        .chain(declared.map(|behaviour| behaviour.name.as_str()))
        .collect();
    match format {
        TableFormat::Csv => write_csv(out, &names, rows),
        TableFormat::Json => write_json(out, &names, rows),
        TableFormat::Jsonl => write_json_lines(out, &names, rows),
    }
}
