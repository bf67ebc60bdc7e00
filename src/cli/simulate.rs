//! `smc simulate`: traces of trials as tables.

use super::arguments::{Simulate, TableFormat};
use super::complaint;
use super::end::early_end;
use super::inputs;
use super::output;
use super::page::{self, Trials};
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
use crate::gait;
use crate::kernel::{Address, End, Program, Run, Slot, State};
use crate::library;
use crate::model::{AgentId, Domain, Parameter, Scenario};
use crate::report::ExitCode as Exit;
use crate::route::Ways;
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
    /// The trial that is under way, if one is, or that comes next; its state and the one of its agents that comes next.
    run: Run<'p>,
    running: bool,
    trial: u64,
    agent: usize,
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
    fn new(
        program: &'p Program,
        arguments: &'p Simulate,
        advice: Option<(usize, usize)>,
        last: Tick,
    ) -> Self {
        Self {
            program,
            arguments,
            advice,
            run: Run::new(program).until(last),
            running: false,
            trial: arguments.trial,
            agent: 0,
            shrunk: (0, None),
            notes: Vec::new(),
            is_wrong: false,
            interrupted: Arc::default(),
        }
    }

    /// Goes to the next state that is written; false when all trials are done.
    fn advance(&mut self) -> bool {
        let mut since = 0;
        while !self.interrupted.load(Ordering::Relaxed) {
            if !self.running {
                if self.trial >= self.arguments.trial.saturating_add(self.arguments.trials) {
                    return false;
                }
                let key = TrialKey { seed: self.arguments.seed, index: self.trial, branch: 0 };
                match self.run.start(Address { advice: self.advice, ..key.into() }) {
                    Ok(loaded) => {
                        if !loaded.shrunk.is_empty() {
                            self.shrunk = (self.shrunk.0 + 1, self.shrunk.1.or(Some(key)));
                        }
                        self.running = true;
                        return true;
                    }
                    Err(fault) => {
                        let why = no_start(&self.program.scenario, fault);
                        self.notes.push(format!("trial {} cannot start: {why}", self.trial));
                        self.trial += 1;
                    }
                }
                continue;
            }
            match self.run.next_state() {
                Ok(_) => since += 1,
                Err(end) => {
                    self.note(end);
                    (self.running, since) = (false, 0);
                    self.trial += 1;
                }
            }
            if since == self.arguments.every {
                return true;
            }
        }
        false
    }

    /// Notes why a trial ended, if that was before its time.
    fn note(&mut self, end: End) {
        self.is_wrong |= matches!(end, End::Faulty(_));
        if let Some(reason) = early_end(self.program, self.run.state(), end) {
            self.notes.push(format!("trial {} {reason}", self.trial));
        }
    }
}

impl Walk<'_> {
    /// Seconds since the start of the trial (steps where steps have no length).
    fn time(&self) -> f64 {
        match self.program.scenario.clock {
            Clock::Jumps(_) => self.run.state().clocks.now[0],
            clock => clock.seconds(Tick(self.run.state().ticks[0])),
        }
    }

    /// The present state, where there are no people.
    fn state_row(&self) -> StateRow {
        let variables = self.program.scenario.processes.variables.iter().zip(&self.run.state().variables);
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
        let scenario = &self.program.scenario;
        let agents = scenario.agents.len();
        // An agent of a source, which keeps many more places than are taken, has rows while it is in the scene.
        let (slot, present) = loop {
            if self.agent == 0 && !self.advance() || agents == 0 {
                return None;
            }
            let state = self.run.state();
            let slot = state.slot(self.agent, 0);
            let present = state.present[slot.block].has(slot.lane);
            if present || !self.program.arrivals.comes(self.agent) {
                break (slot, present);
            }
            self.agent = (self.agent + 1) % agents;
        };
        let state = self.run.state();
        let at = |field: &[crate::base::lanes::Lanes]| field[slot.block].0[slot.lane];
        let record = Record {
            time: self.time(),
            trial: self.trial,
            agent: self.agent,
            arrival: state.queues.arrival(&scenario.sources, AgentId(self.agent as u32), 0),
            position: Vec2::new(at(&state.motion.x), at(&state.motion.y)),
            velocity: Vec2::new(at(&state.motion.vx), at(&state.motion.vy)),
            present,
            signals: std::iter::once(if present { at(&state.bodies[Parameter::Radius]) } else { f64::NAN })
                .chain(state.variables.iter().map(|lanes| lanes.0[0]))
                .collect(),
            modes: modes(self.program, state, present.then_some(slot)),
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
    // A path is known by its number, too: its length depends on the roadmap.
    let is_meant = |name: &str| {
        name == wanted
            || name.strip_prefix(wanted).is_some_and(|rest| wanted.contains("path") && rest.starts_with(" ("))
    };
    if let Some(found) = all().find(|of| scenario.move_name(*of).is_some_and(|name| is_meant(&name))) {
        return Ok(found);
    }
    let label = |(declaration, at): (usize, usize)| scenario.moves[declaration].options[at].0.as_str();
    let same: Vec<String> = all()
        .filter(|of| is_meant(label(*of)))
        .filter_map(|of| Some(format!("`{}`", scenario.move_name(of)?)))
        .collect();
    if !same.is_empty() {
        return Err((
            format!("several agents have a move `{wanted}`"),
            format!("write one of {}", same.join(", ")),
        ));
    }
    let labels: Vec<String> = all().filter_map(|of| scenario.move_name(of)).collect();
    let hint = match nearest(wanted, labels.iter().map(String::as_str)) {
        _ if labels.is_empty() => "the scenario declares no moves".to_owned(),
        // Of numbers that differ, none is meant more than another.
        Some(near) if !wanted.contains(|c: char| c.is_ascii_digit()) => format!("did you mean `{near}`?"),
        _ => format!("the moves are {}", labels.join(", ")),
    };
    Err((format!("unknown move `{wanted}`"), hint))
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
        return refuse(format!("`{option}` must be positive (got 0)"), "write a number from 1", colors);
    }
    if arguments.trial.saturating_add(arguments.trials) > MOST_TRIALS {
        let hint = format!("trials are numbered from 0 to {}", MOST_TRIALS - 1);
        return refuse("the trial number is out of range", hint, colors);
    }
    let inputs::Loaded { inputs, paths, .. } = inputs::load(&arguments.model, &[]);
    complaint::diagnose(&inputs, colors);
    let Some(study) = &inputs.study else { return Exit::Wrong };
    for written in [&arguments.output, &arguments.report] {
        if let Err(error) = output::guard(written.as_deref(), &paths) {
            complaint::tell(&error, &[], colors);
            return Exit::Wrong;
        }
    }
    let Some(world) = study.worlds.last() else { return Exit::Wrong };
    if study.worlds.len() > 2 {
        return refuse("a trace cannot be written for a sweep", "write `--set name=value`", colors);
    }
    let ways = Ways::default();
    let mut scenario: Arc<Scenario> = world.scenario.clone();
    if scenario.moves.iter().any(|moves| moves.paths.is_some()) {
        library::find_paths(Arc::make_mut(&mut scenario), arguments.seed, &ways);
    }
    let advice = match arguments.advice.as_deref().map(|name| option(&scenario, name)) {
        Some(Err((reason, hint))) => return refuse(reason, hint, colors),
        Some(Ok(advice)) => Some(advice),
        None => None,
    };
    if let Err(fault) = placeable(world) {
        complaint::tell(&library::refusal(&fault), &inputs.sources, colors);
        return Exit::Wrong;
    }
    let mut last = scenario.horizon;
    if let Some(until) = arguments.until {
        if until.is_nan() || until < 0.0 {
            return refuse(
                format!("`--until` must be a time that is not negative (got {until})"),
                "write a number of seconds",
                colors,
            );
        }
        let end = scenario.clock.seconds(scenario.horizon);
        if until > end * (1.0 + 1e-12) {
            let unit = if scenario.clock == Clock::Steps { "steps" } else { "s" };
            let hint = format!("the horizon of the scenario is {end} {unit}");
            return refuse(format!("`--until` must not exceed the horizon (got {until})"), hint, colors);
        }
        // The longest time that is a whole number of ticks, in continuous time of very short ones.
        last = last.min(Tick(match scenario.clock {
            Clock::Jumps(tick) => (until / tick.to_f64()).floor() as u64,
            // In spite of rounding, and never beyond what was asked for.
            clock => (until / clock.step_seconds() * (1.0 + 1e-12)).floor() as u64,
        }));
    }
    let program = Program::driven(scenario.clone(), gait::drivers(&ways, &scenario, arguments.seed));
    if let Some(path) = &arguments.report {
        let Simulate { seed, trial, trials, .. } = *arguments;
        let option = arguments.advice.as_ref().map_or(String::new(), |name| format!(" --move '{name}'"));
        let line = page::line(&arguments.model, arguments.velocity).simulate(&[], seed, trial);
        let trials = Trials {
            program: &program,
            scenario: &arguments.model.scenario,
            sources: &inputs.sources,
            seed,
            list: &mut (trial..trial + trials).map(|index| (index, advice)),
            last,
            replay: format!("{line} -n {trials}{option}"),
        };
        let exit = trials.write(path, colors);
        if arguments.output.is_none() || exit != Exit::Success {
            return exit;
        }
    }
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
                Some(path) => complaint::unwritten(path, &error),
                None => complaint::output(error.to_string()),
            };
            complaint::tell(&error, &[], colors);
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
