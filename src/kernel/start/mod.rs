//! The beginning of a trial: parameters are drawn, bodies placed, routes begun.
//!
//! Every draw is addressed by the agent's entity and the parameter's name, so an agent, a parameter or a
//! move more changes nobody else's. Placement is random sequential (Widom 1966) with a fixed number of
//! attempts, then relaxation; what still overlaps, or was recorded so, shrinks to touch.

mod area;
mod arrival;
mod crowd;
mod entrance;
mod outcome;
mod placement;
mod relaxation;
mod sampler;

pub use area::{Crowding, JAMMED, check_area};
pub use arrival::Arrivals;
pub(super) use entrance::step;
pub use outcome::{Fault, Loaded, Overlapped, Shrunk};
pub use placement::Starts;

use super::driver;
use super::plan::Occasion;
use super::program::Program;
use super::state::{Layout, State};
use crate::base::geometry::Vec2;
use crate::base::lanes::Mask;
use crate::base::random::TrialKey;
use crate::model::{AgentId, Parameter};
use entrance::enter;

/// Loads the initial state of a trial into a lane (in `Layout::Agents`: as the only trial). No other lane is
/// touched, and on a fault nothing is. `advice` is a declaration of moves and one of its options.
pub fn load(
    program: &Program,
    state: &mut State,
    lane: usize,
    key: TrialKey,
    advice: Option<(usize, usize)>,
) -> Result<Loaded, Fault> {
    let scenario = &program.scenario;
    if scenario.agents.is_empty() && advice.is_none() {
        begin(program, state, lane, key);
        return Ok(Loaded::default());
    }
    let advised = match advice {
        None => Default::default(),
        Some((declaration, option)) => {
            let singles = scenario.singles((declaration, option));
            singles.ok_or(Fault::Advice { declaration, option })?
        }
    };
    // Of a group each member decides for itself.
    let advice_of = |k: usize| {
        advised.into_iter().flatten().find_map(|(declaration, option)| {
            let moves = &scenario.moves[declaration];
            let is_heeded = moves.agents().any(|agent| agent.0 as usize == k)
                && program.behaviours.heeds(&program.processes.initial, key, k);
            is_heeded.then(|| (moves.options[option].1, moves.duration.0))
        })
    };
    let mut bodies = Vec::with_capacity(scenario.agents.len());
    for k in 0..scenario.agents.len() {
        let here = !program.arrivals.comes(k);
        let draw = || program.parameters.draw((AgentId(k as u32), 0), key);
        bodies.push(here.then(draw).transpose()?);
    }
    let radii = bodies
        .iter()
        .map(|body| body.as_ref().map_or(0.0, |body| body[Parameter::Radius as usize]))
        .collect();
    let placed = placement::place(scenario, &program.starts, key, radii)?;

    let lane = if state.layout == Layout::Agents { 0 } else { lane };
    begin(program, state, lane, key);
    for (k, body) in bodies.into_iter().enumerate() {
        let Some(mut body) = body else { continue };
        body[Parameter::Radius as usize] = placed.radii[k];
        enter(program, state, (k, lane), (Occasion::Begins, advice_of(k)), &body, placed.positions[k]);
    }
    entrance::open(program, state, lane);
    driver::ask(&program.drive, state);
    Ok(placed.counts)
}

/// Loads a state that is given from outside into lane 0: everybody has drawn parameters and begins a route, and nobody is
/// there yet.
pub fn load_absent(program: &Program, state: &mut State, key: TrialKey) -> Result<(), Fault> {
    begin(program, state, 0, key);
    for k in 0..program.scenario.agents.len() {
        let body = program.parameters.draw((AgentId(k as u32), 0), key)?;
        enter(program, state, (k, 0), (Occasion::Begins, None), &body, Vec2::zeros());
        let slot = state.slot(k, 0);
        state.present[slot.block] &= !Mask::lane(slot.lane);
    }
    Ok(())
}

/// Begins a trial that is played back, in which nobody is there yet.
pub(super) fn load_played(program: &Program, state: &mut State, key: TrialKey) {
    begin(program, state, 0, key);
}

/// Somebody is seen for the first time in a trial that is played back.
pub(super) fn appear(program: &Program, state: &mut State, agent: usize, at: Vec2) -> Result<(), Fault> {
    let body = program.parameters.draw((AgentId(agent as u32), 0), state.keys[0])?;
    enter(program, state, (agent, 0), (Occasion::Begins, None), &body, at);
    Ok(())
}

/// The trial itself and its processes.
fn begin(program: &Program, state: &mut State, lane: usize, key: TrialKey) {
    state.keys[lane] = key;
    state.ticks[lane] = 0;
    state.occupied |= Mask::lane(lane);
    state.diverged &= !Mask::lane(lane);
    state.no_way &= !Mask::lane(lane);
    program.processes.load(state, lane);
    program.doors.load(state, lane, key);
    program.arrivals.load(state, lane, key);
    let slots = state.layout.slots_of(Mask::lane(lane));
    state.passages.load(&program.scenario.scene, state.present.len(), (lane, slots));
}
