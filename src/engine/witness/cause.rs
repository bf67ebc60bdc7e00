//! Why a trial is unresolved: it is run again up to there, and what stopped it is said, with what helps.

use crate::base::lanes::Mask;
use crate::base::random::TrialKey;
use crate::base::tick::Tick;
use crate::engine::answer::words;
use crate::engine::trials::prepared::PreparedWorld;
use crate::kernel::process::{self, ViewReadings};
use crate::kernel::start::Overlapped;
use crate::kernel::{Code, End, Program, Readings, Run, State, start};
use crate::model::{AgentId, Scenario, TOP_SPEED};
use crate::trials::budget::Budget;
use crate::trials::cell::{Item, Reading};
use crate::trials::group::ColumnGroup;
use crate::trials::observer::SignalObserver;

/// Most bodies that are named of those that were made smaller.
const MOST_SHRUNK: usize = 3;

/// Jumps between looks at the clock.
const JUMPS_BETWEEN_LOOKS: u64 = 1 << 12;

/// What stopped a trial before a column was decided, and what helps against it; empty where nothing did.
pub(in crate::engine) fn unresolved(
    prepared: &PreparedWorld,
    column: usize,
    item: Item,
    (seed, budget): (u64, &Budget),
) -> String {
    let program = &prepared.program;
    let scenario = &program.scenario;
    let mut run = match Run::of(program, item.address(seed)) {
        Ok((run, _)) => run,
        Err(start::Fault::Program(said)) => return said.to_string(),
        Err(fault) => return format!("cannot start: {}", no_start(scenario, fault)),
    };
    if scenario.clock.is_jumps() {
        return in_continuous_time(prepared, column, &mut run, budget);
    }
    let Ok(mut group) = ColumnGroup::of(prepared, &[column]) else { return String::new() };
    group.start(0);
    let mut missing = None;
    loop {
        let state = run.state();
        let time = words::moment(scenario.clock, Tick(state.ticks[0]));
        let queues = &state.queues;
        let lost_sight = || queues.lost_sight(&scenario.sources, 0).filter(|_| group.follows[0]);
        if let Some(reason) = queues.overrun(&scenario.sources, 0).or_else(lost_sight) {
            return format!("{reason} (at {time})");
        }
        if let Some(agent) = state.undriven(0) {
            return format!("the driver of `{}` failed at {time}", scenario.agents[agent].name);
        }
        if run.end(0) == Some(End::Diverged) {
            return format!("diverged at {time}: {}", divergence(program, state));
        }
        // As for a worker: only where something is looked at in this state that has no value.
        let lost = group.read(&run).has(0);
        let absent = absent(prepared, column, state, &group.readings).map(|name| (name, time.clone()));
        missing = missing.or_else(|| absent.clone());
        if lost {
            return nobody(prepared, column, state, &time);
        }
        let observer = &mut group.observers[0];
        observer.observe(Mask::lane(0), &group.readings);
        if observer.decided().has(0) {
            return match observer.reading(0) {
                Reading::Unresolved => match absent.or(missing) {
                    Some((name, time)) => format!(
                        "`{name}` has not arrived at {time}, so its values are undefined; add the condition `present({name})`"
                    ),
                    None => format!("the metric is NaN at {time}; avoid 0 / 0 and ∞ - ∞ in it"),
                },
                _ => String::new(),
            };
        }
        if budget.is_late() || run.next_state().is_err() {
            return String::new();
        }
    }
}

/// Why a trial diverged, and what helps: somebody left every human speed, or a process jumps without end within a step.
pub fn divergence(program: &Program, state: &State) -> String {
    if state.clocks.jammed.has(0) {
        let most = words::number(f64::from(process::MOST_BETWEEN));
        let busiest = busiest(program, state);
        return format!(
            "more than {most} jumps between two steps{busiest}; use lower rates or longer delays"
        );
    }
    format!("{}; try a smaller step", runaway(&program.scenario, state))
}

/// Who left every human speed, with the speed.
fn runaway(scenario: &Scenario, state: &State) -> String {
    let speed = |agent: usize| {
        let slot = state.slot(agent, 0);
        let v = state.velocity(slot);
        state.is_present(slot).then(|| (v.x * v.x + v.y * v.y).sqrt())
    };
    let beyond = |speed: f64| speed.is_nan() || speed > TOP_SPEED;
    let found = (0..scenario.agents.len()).find_map(|agent| {
        let speed = speed(agent).filter(|speed| beyond(*speed))?;
        Some((state.name_of(scenario, AgentId(agent as u32), 0), speed))
    });
    let most = words::quantity(TOP_SPEED, "m/s");
    match found {
        Some((name, speed)) if speed.is_finite() => {
            format!("{name} exceeded {most}, the limit for a person ({})", words::brief(speed, "m/s"))
        }
        Some((name, _)) => format!("{name} exceeded {most}, the limit for a person"),
        None => format!("an agent exceeded {most}, the limit for a person"),
    }
}

/// Which bodies overlap at the start of a trial and are made smaller, where that happens in some number of trials.
pub fn smaller(program: &Program, key: TrialKey, trials: u64) -> String {
    let shrunk = Run::of(program, key.into()).map(|(_, loaded)| loaded.shrunk).unwrap_or_default();
    let scenario = &program.scenario;
    let agent = |id: AgentId| format!("`{}`", scenario.agents[id.0 as usize].name);
    let mut said: Vec<String> = shrunk
        .iter()
        .take(MOST_SHRUNK)
        .map(|one| {
            let at = match one.at {
                Overlapped::Agent(other) => agent(other),
                Overlapped::Barrier(barrier) => scenario.scene.barriers[barrier.0 as usize].phrase(),
            };
            let (from, to) = (words::brief(one.from, "m"), words::brief(one.to, "m"));
            format!("{} at {at} from a radius of {from} to {to}", agent(one.agent))
        })
        .collect();
    if let Some(more @ 1..) = shrunk.len().checked_sub(MOST_SHRUNK) {
        said.push(format!("and {more} more"));
    }
    let trials = if trials == 1 { "1 trial".to_owned() } else { format!("{trials} trials") };
    format!(
        "radii of bodies that overlapped at the start were reduced in {trials}; in trial {}: {}",
        key.index,
        said.join(", ")
    )
}

/// Who has no way to a goal in a trial, where that happens in some number of trials.
pub(in crate::engine) fn stranded(program: &Program, key: TrialKey, trials: u64) -> String {
    let trials = if trials == 1 { "1 trial".to_owned() } else { format!("{trials} trials") };
    let in_trials = format!("somebody had no way to a goal in {trials}");
    let Ok((mut run, _)) = Run::of(program, key.into()) else { return in_trials };
    while run.state().no_way.is_empty() {
        if run.next_state().is_err() {
            return in_trials;
        }
    }
    let state = run.state();
    let scenario = &program.scenario;
    let who = (0..scenario.agents.len()).find(|&agent| state.plans.is_stranded(state.slot(agent, 0)));
    let Some(agent) = who else { return in_trials };
    let at = state.position(state.slot(agent, 0));
    format!(
        "{in_trials}; in trial {}, `{}` at {} at {}",
        key.index,
        scenario.agents[agent].name,
        scenario.scene.storeys.place(at),
        words::moment(scenario.clock, Tick(state.ticks[0])),
    )
}

/// Why a trial cannot start, and what helps.
pub fn no_start(scenario: &Scenario, fault: start::Fault) -> String {
    let name = |agent: AgentId| {
        scenario.agents.get(agent.0 as usize).map_or("an agent", |agent| agent.name.as_str())
    };
    let of = |agent: AgentId, said: &str| format!("{} {said}", name(agent));
    match fault {
        start::Fault::Parameter { agent, name: parameter, value } => format!(
            "the drawn `{parameter}` of {} is {}, which is invalid; truncate the distribution: `normal(…) in low .. high`",
            name(agent),
            words::brief(value, "")
        ),
        start::Fault::Nowhere { agent } => of(agent, "has no free place to start; use a larger start area"),
        start::Fault::Far { agent } => {
            of(agent, "has no free place within the given distance; use a larger distance")
        }
        start::Fault::Inside { agent } => {
            of(agent, "has no place outside obstacles and walls; use a larger start area")
        }
        start::Fault::Together { agents: (one, other) } => format!(
            "{} and {} have only the same point to start at; use a larger start area",
            name(one),
            name(other)
        ),
        start::Fault::Order { agent } => of(agent, "starts near an agent that is placed later"),
        start::Fault::Advice { .. } => String::new(),
        start::Fault::Program(said) => said.to_string(),
    }
}

/// Somebody who has not come yet, and of whom a number is asked that is none for it.
fn absent(prepared: &PreparedWorld, column: usize, state: &State, readings: &Readings) -> Option<String> {
    let (mut found, scenario) = (None, &prepared.program.scenario);
    for k in prepared.signals_of(column) {
        if readings.signals.get(k).is_none_or(|signal| !signal.0[0].is_nan()) {
            continue;
        }
        prepared.signals[k].mentions(&mut |agent| {
            // Who has left is where they left.
            let mut sources = scenario.sources.iter().zip(&state.queues.entered);
            let is_to_come = sources.any(|(source, entered)| {
                source.members.binary_search(&agent).is_ok_and(|number| entered[0] as usize <= number)
            });
            if found.is_none() && is_to_come {
                found = scenario.agents.get(agent.0 as usize).map(|agent| agent.name.clone());
            }
        });
    }
    found
}

/// A mean or a middle of nobody: in which condition or number of those that a column looks at now.
fn nobody(prepared: &PreparedWorld, column: usize, state: &State, time: &str) -> String {
    let Ok(needs) = prepared.needs(&[column]) else { return String::new() };
    let tick = state.ticks[0];
    let scenario = &prepared.program.scenario;
    let lost = |code: &Code| {
        let mut readings = Readings::default();
        code.run(&prepared.program, state, &mut readings);
        readings.unresolved.has(0)
    };
    let atoms = prepared.atoms_of(column).into_iter().filter(|k| needs.atom(*k, tick)).find_map(|k| {
        let code = Code::compile(scenario, std::slice::from_ref(&prepared.atoms[k]), &[]);
        lost(&code).then(|| prepared.texts.atoms.get(k).cloned())?
    });
    let text = atoms.or_else(|| {
        prepared.signals_of(column).into_iter().filter(|k| needs.signal(*k, tick)).find_map(|k| {
            let code = Code::compile(scenario, &[], std::slice::from_ref(&prepared.signals[k]));
            lost(&code).then(|| prepared.texts.signals.get(k).map(|(text, _)| text.clone()))?
        })
    });
    let of = text.map_or(String::new(), |text| format!(" in `{text}`"));
    if scenario.scene.counted.is_empty() {
        return format!(
            "a mean or a centroid{of} is over an empty set at {time}; add the condition `count(a in …) > 0 & …`"
        );
    }
    format!(
        "a flow{of} has no complete time window at {time}, or a mean or a centroid is over an empty set; begin later, for \
         example `G[10 s, 60 s] (…)`, or add the condition `count(a in …) > 0 & …`"
    )
}

/// In continuous time only what has to be remembered, and the number of jumps, can leave a trial unresolved.
fn in_continuous_time(prepared: &PreparedWorld, column: usize, run: &mut Run<'_>, budget: &Budget) -> String {
    let view = prepared.view(&[column]);
    let Ok(mut monitor) = SignalObserver::of(prepared, column) else { return String::new() };
    let mut seen = ViewReadings::default();
    let enough = prepared.most_jumps.min(prepared.jumps_again);
    while run.state().clocks.jumps[0] < enough {
        let state = run.state();
        if state.clocks.jumps[0].is_multiple_of(JUMPS_BETWEEN_LOOKS) && budget.is_late() {
            return String::new();
        }
        view.look(state, &mut seen);
        let (atoms, signals) = view.of(state, &mut seen, 0);
        let now = state.clocks.instant(0);
        let time = words::quantity(now.seconds, "s");
        let reading = match monitor.jump(now, atoms, signals) {
            Some(reading) => reading,
            None if run.next_state().is_ok() => continue,
            None => monitor.finish(),
        };
        return match reading {
            Reading::Unresolved if monitor.is_no_number() => {
                format!("the metric is NaN at {time}; avoid 0 / 0 and ∞ - ∞ in it")
            }
            Reading::Unresolved => {
                format!("the formula has too many pieces to store at {time}; use shorter bounds")
            }
            _ => String::new(),
        };
    }
    let state = run.state();
    let time = words::quantity(state.clocks.now[0], "s");
    let busiest = busiest(&prepared.program, state);
    let said = if enough < prepared.most_jumps {
        "the cause was not found in the part that was run again"
    } else {
        "the trial has too many jumps"
    };
    format!("{said}: {enough} jumps by {time}{busiest}; use a shorter horizon, lower rates or longer delays")
}

/// `, most of them of ‹process›, now at a rate of …`, or nothing where no process jumps by itself.
fn busiest(program: &Program, state: &State) -> String {
    let found = program.processes.busiest(state, 0).and_then(|(process, rate)| {
        let name = &program.scenario.processes.list.get(process as usize)?.name;
        let rate = if rate > 0.0 { format!(", now at a rate of {rate} /s") } else { String::new() };
        Some(format!(", most of them of `{name}`{rate}"))
    });
    found.unwrap_or_default()
}

#[cfg(test)]
mod tests;
