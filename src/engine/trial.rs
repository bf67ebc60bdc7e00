//! One trial on its own: the words for one in which the model is wrong.

use super::cell::Item;
use super::fault::Fault;
use super::flaw::Flaw;
use super::subject::Subject;
use crate::base::lanes::Mask;
use crate::base::random::TrialKey;
use crate::base::tick::{Clock, Tick};
use crate::kernel::{Scratch, State, dynamics, start};

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
    let moment = format!("trial {} at {time}", item.index);
    Fault::Model(Box::new(Flaw::of(fault, scenario, &subject.origins, moment, |k| state.variables[k].0[0])))
}
