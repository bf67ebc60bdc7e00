//! One trial on its own: the words for one in which the model is wrong.

use super::cell::Item;
use super::fault::Fault;
use super::subject::Subject;
use crate::base::lanes::Mask;
use crate::base::random::TrialKey;
use crate::base::tick::{Clock, Tick};
use crate::kernel::{Scratch, State, dynamics, process, start};

/// Runs a trial up to its error, and says what is wrong, when, and in which state.
pub(super) fn fault(subject: &Subject, item: Item, seed: u64) -> Fault {
    let program = &subject.program;
    let scenario = &program.scenario;
    let mut state = State::new(program.layout, scenario.agents.len());
    let mut scratch = Scratch::new();
    let key = TrialKey { seed, index: item.index, branch: 0 };
    if start::load(program, &mut state, 0, key, item.advice).is_err() {
        return Fault::Unsuitable;
    }
    dynamics::refresh(program, &mut state, &mut scratch, Mask::lane(0));
    if scenario.clock.is_jumps() {
        while state.faulty.is_empty() && !dynamics::jump(program, &mut state, &mut scratch).is_empty() {}
    }
    while state.faulty.is_empty() && !scenario.clock.is_jumps() && state.ticks[0] < subject.horizon.0 {
        dynamics::step(program, &mut state, &mut scratch);
    }
    let Some(fault) = state.faults[0] else { return Fault::Unsuitable };
    let before = Tick(state.ticks[0].saturating_sub(1));
    let time = match scenario.clock {
        Clock::Steps => format!("step {}", before.0),
        Clock::Stepped(_) => format!("{} s", scenario.clock.seconds(before)),
        Clock::Jumps(_) => format!("{} s", state.clocks.now[0]),
    };
    let what = fault.describe(scenario);
    let values = process::Fault::state(&scenario.processes, |k| state.variables[k].0[0]);
    Fault::Model(format!("trial {} at {time}: {what}\n  the state is {values}", item.index))
}

/// Says which process jumps without end, or which source lets no more people in, where that leaves a trial unresolved.
pub(super) fn overrun(subject: &Subject, index: u64, seed: u64) -> Option<String> {
    let program = &subject.program;
    if program.scenario.clock.is_jumps() {
        return restless(subject, index, seed);
    }
    let sources = &program.scenario.sources;
    if sources.is_empty() {
        return None;
    }
    let mut state = State::new(program.layout, program.scenario.agents.len());
    let mut scratch = Scratch::new();
    start::load(program, &mut state, 0, TrialKey { seed, index, branch: 0 }, None).ok()?;
    dynamics::refresh(program, &mut state, &mut scratch, Mask::lane(0));
    while state.queues.full.is_empty() && state.diverged.is_empty() && state.ticks[0] < subject.horizon.0 {
        dynamics::step(program, &mut state, &mut scratch);
    }
    state.queues.overrun(sources, 0).or_else(|| state.queues.lost_sight(sources, 0))
}

/// Says which process jumps most in a trial that needs more jumps than are possible.
fn restless(subject: &Subject, index: u64, seed: u64) -> Option<String> {
    let program = &subject.program;
    let (mut state, mut scratch) = (State::new(program.layout, 0), Scratch::new());
    start::load(program, &mut state, 0, TrialKey { seed, index, branch: 0 }, None).ok()?;
    while state.clocks.jumps[0] < subject.most_jumps {
        if dynamics::jump(program, &mut state, &mut scratch).is_empty() || !state.faulty.is_empty() {
            return None;
        }
    }
    let (process, rate) = program.processes.busiest(&state, 0)?;
    let name = &program.scenario.processes.list.get(process as usize)?.name;
    let rate = if rate > 0.0 { format!(", now at a rate of {rate} /s") } else { String::new() };
    Some(format!(
        "more than {} jumps by {} s, most of them of `{name}`{rate}; a shorter horizon or slower rates may help",
        subject.most_jumps, state.clocks.now[0]
    ))
}

#[cfg(test)]
mod tests;
