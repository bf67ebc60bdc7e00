//! Why a trial ended before its time, in words.

use crate::base::tick::Tick;
use crate::engine::divergence;
use crate::kernel::{End, Program, State};

/// Why a trial ended, if that was before its time.
pub(super) fn early_end(program: &Program, state: &State, end: End) -> Option<String> {
    let scenario = &program.scenario;
    let time = scenario.clock.seconds(Tick(state.ticks[0]));
    match end {
        End::Horizon => None,
        End::Faulty(fault) => Some(format!("ended with an error of the model: {}", fault.describe(scenario))),
        End::Full => {
            let reason = state.queues.overrun(&scenario.sources, 0).unwrap_or_default();
            Some(format!("is unresolved at {time} s: {reason}"))
        }
        End::Diverged => Some(format!("diverged at {time} s: {}", divergence(program, state))),
    }
}
