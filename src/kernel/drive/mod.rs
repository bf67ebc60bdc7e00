//! The driver of social-force agents: where each wants to go and how fast.
//!
//! A route is a list of stages. The aim is the nearest point of a goal's region a body radius inside (of a polygon
//! that is no upright rectangle, on its rim);
//! driving velocity is zero inside the last goal. A region is reached when the centre is inside, a point
//! within two radii, or when the line across it, perpendicular to the way from where the leg began, has
//! been passed within 2 m of it. Advice replaces direction and speed for its time; waypoints passed
//! meanwhile count. A route that is left for another goes on with the stage it was on, a pause with what is
//! left of it.

mod lanes;
mod person;
mod stage;

pub use stage::Drive;

use super::program::Program;
use super::state::route::Halt;
use super::state::{Slot, State};
use crate::base::lanes::Mask;
use crate::model::Move;
use fearless_simd::{Level, Simd, dispatch};
use person::Person;
use stage::Target;

/// Puts agent `agent` of the trial in lane `lane` at the beginning of its way: direction, driving speed and
/// route. Position, parameters, key and tick of the trial must be in the state. `advice` is a move and the
/// number of ticks for which it holds.
pub fn begin(program: &Program, state: &mut State, agent: usize, lane: usize, advice: Option<(Move, u64)>) {
    let slot = state.slot(agent, lane);
    let start = &program.scenario.agents[agent].start;
    Person::new(program, state, slot.block, slot.lane).begin(start, advice);
}

/// Where the one in a slot is on the route, to be left and gone on with later.
pub(super) fn halt(program: &Program, state: &State, slot: Slot) -> Halt {
    let way = state.route.way(slot.block, slot.lane);
    let stage = program.drive.stages.get(way.stage as usize);
    let pausing = stage.is_some_and(|stage| matches!(stage.target, Target::Pause(_)));
    let tick = state.ticks[state.layout.trial_of(slot.lane)];
    Halt { stage: way.stage, left: pausing.then(|| way.until.saturating_sub(tick)) }
}

/// Sends someone, who perhaps just `comes`, along a route from a stage of it on, the `round`-th time.
pub(super) fn divert(
    program: &Program,
    state: &mut State,
    slot: Slot,
    (from, round): (Halt, u32),
    comes: bool,
) {
    Person::new(program, state, slot.block, slot.lane).divert(from, round, comes);
}

/// Someone's driving speed has changed.
pub(super) fn renew(program: &Program, state: &mut State, slot: Slot) {
    Person::new(program, state, slot.block, slot.lane).renew();
}

/// Updates driving direction, driving speed and presence of all agents in all occupied lanes, and velocities by what the
/// turn of the direction in the step adds. To be called once a step, with the new positions and the ticks that belong to them.
pub fn steer(program: &Program, state: &mut State) {
    steer_at(Level::new(), program, state);
}

/// The same with vectors of a level.
pub(super) fn steer_at(level: Level, program: &Program, state: &mut State) {
    dispatch!(level, simd => steer_all(simd, program, state));
}

#[inline(always)]
fn steer_all<S: Simd>(simd: S, program: &Program, state: &mut State) {
    let occupied = state.layout.slots_of(state.occupied);
    for block in 0..state.route.blocks() {
        let active = state.present[block] & occupied;
        let mut events = Mask::NONE;
        for number in 0..state.route.count(block) {
            let party = state.route.party(block, number);
            let Some(stage) = program.drive.stages.get(party.stage as usize) else { continue };
            events |= lanes::steer(simd, state, block, party, stage, active);
        }
        if !events.is_empty() {
            for lane in events.iter() {
                Person::new(program, state, block, lane).step();
            }
        }
    }
}
