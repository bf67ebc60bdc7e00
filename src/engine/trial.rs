//! One trial on its own: the words for one in which the model is wrong.

use super::cell::Item;
use super::fault::Fault;
use super::flaw::Flaw;
use super::subject::Subject;
use crate::base::tick::{Clock, Tick};
use crate::kernel::{End, Run, State, process};

/// Runs a trial up to its error, and says what is wrong, when, and in which state.
pub(super) fn fault(subject: &Subject, item: Item, seed: u64) -> Fault {
    let Ok((mut run, _)) = Run::of(&subject.program, item.address(seed)) else { return Fault::Unsuitable };
    let end = loop {
        if let Err(end) = run.next() {
            break end;
        }
    };
    let (End::Faulty(fault), state) = (end, run.state()) else { return Fault::Unsuitable };
    let clock = subject.program.scenario.clock;
    let before = Tick(state.ticks[0].saturating_sub(1));
    let time = match clock {
        Clock::Steps => format!("step {}", before.0),
        Clock::Stepped(_) => format!("{} s", clock.seconds(before)),
        Clock::Jumps(_) => format!("{} s", state.clocks.now[0]),
    };
    flaw(subject, fault, (state, 0), format!("trial {} at {time}", item.index))
}

/// What is wrong with the model in the trial of a lane, in words.
pub(super) fn flaw(
    subject: &Subject,
    fault: process::Fault,
    (state, lane): (&State, usize),
    moment: String,
) -> Fault {
    let value = |k: usize| state.variables[k].0[lane];
    Fault::Model(Box::new(Flaw::of(fault, &subject.program.scenario, &subject.origins, moment, value)))
}
