//! One trial on its own: the words for one in which the model is wrong.

use crate::base::tick::{Clock, Tick};
use crate::engine::fault::Fault;
use crate::engine::flaw::Flaw;
use crate::engine::trials::prepared::PreparedWorld;
use crate::kernel::{End, Run, State, process};
use crate::trials::cell::{Item, Series};

/// Runs a trial up to its error, and says what is wrong, when, and in which state.
pub(in crate::engine) fn fault(prepared: &PreparedWorld, item: Item, series: Series) -> Fault {
    let Ok((mut run, _)) = Run::of(&prepared.program, item.address(series)) else { return Fault::Unsuitable };
    let end = loop {
        if let Err(end) = run.next_state() {
            break end;
        }
    };
    let (End::Faulty(fault), state) = (end, run.state()) else { return Fault::Unsuitable };
    let clock = prepared.program.scenario.clock;
    let before = Tick(state.ticks[0].saturating_sub(1));
    let time = match clock {
        Clock::Steps => format!("step {}", before.0),
        Clock::Stepped(_) => format!("{} s", clock.seconds(before)),
        Clock::Jumps(_) => format!("{} s", state.clocks.now[0]),
    };
    flaw(prepared, fault, (state, 0), format!("trial {} at {time}", item.index))
}

/// What is wrong with the model in the trial of a lane, in words.
pub(in crate::engine) fn flaw(
    prepared: &PreparedWorld,
    fault: process::Fault,
    (state, lane): (&State, usize),
    moment: String,
) -> Fault {
    let value = |k: usize| state.variables[k].0[lane];
    Fault::Model(Box::new(Flaw::of(fault, &prepared.program.scenario, &prepared.origins, moment, value)))
}
