//! Where agents go: the seam for higher floors, and the routes of the scenario as its first user.
//!
//! A route is a list of stages. Without a driver an agent heads straight for the goal of its stage: the nearest point of a
//! goal's region a body radius inside (of a polygon that is no upright rectangle, on its rim); the driving velocity is zero
//! inside the last goal. A region is reached when the centre is inside, a point within two radii, or when the line across
//! it, perpendicular to the way from where the leg began, has been passed within 2 m of it. Advice replaces direction and
//! speed for its time; waypoints passed meanwhile count. A route that is left for another goes on with the stage it was on, a
//! pause with what is left of it.
//!
//! An agent with a [`Driver`] follows plans instead (`plan`, `follow`). Its driver is asked in order of agents, when all
//! positions of a state are known, and not at every step.

mod ask;
mod drivers;
mod follow;
mod lanes;
mod person;
mod reciprocal;
mod situation;
mod stage;

pub use super::plan::{Limits, Memory, Occasion, Plan, Sample, Trajectory};
pub use drivers::{Driver, Drivers, MakeDrivers, straight};
pub use situation::{Other, Situation};
pub use stage::Drive;

use super::state::route::Halt;
use super::state::{Slot, State};
use crate::base::lanes::Mask;
use crate::model::{Move, Parameter};
use fearless_simd::{Level, Simd, dispatch};
use person::Person;
use stage::Target;

/// Puts agent `agent` of the trial in lane `lane` at the beginning of its way: direction, driving speed and
/// route. Position, parameters, key and tick of the trial must be in the state. `advice` is a move and the
/// number of ticks for which it holds.
pub(super) fn begin(
    drive: &Drive,
    state: &mut State,
    (agent, lane): (usize, usize),
    occasion: Occasion,
    advice: Option<(Move, u64)>,
) {
    let slot = state.slot(agent, lane);
    state.progress.begin(slot, drive.most_legs);
    if drive.drivers.of(agent).is_some() {
        state.plans.reserve(state.motion.x.len());
        state.plans.clear(slot);
        let speed = state.bodies[Parameter::Speed][slot.block].0[slot.lane];
        state.plans.courses[slot.block].own_speed.0[slot.lane] = if speed > 0.0 { speed } else { 1.0 };
        state.plans.held_mut(slot).path = match advice {
            Some((Move::Path(class), _)) => Some(class),
            _ => None,
        };
        state.plans.ask(slot, occasion);
    }
    let start = &drive.scenario.agents[agent].start;
    Person::new(drive, state, slot).begin(start, advice);
}

/// Where the one in a slot is on the route, to be left and gone on with later.
pub(super) fn halt(drive: &Drive, state: &State, slot: Slot) -> Halt {
    let way = state.route.way(slot.block, slot.lane);
    let stage = drive.stages.get(way.stage as usize);
    let pausing = stage.is_some_and(|stage| matches!(stage.target, Target::Pause(_)));
    let tick = state.ticks[state.layout.trial_of(slot.lane)];
    Halt { stage: way.stage, left: pausing.then(|| way.until.saturating_sub(tick)) }
}

/// Sends someone, who perhaps just `comes`, along a route from a stage of it on, the `round`-th time.
pub(super) fn divert(drive: &Drive, state: &mut State, slot: Slot, (from, round): (Halt, u32), comes: bool) {
    Person::new(drive, state, slot).divert(from, round, comes);
}

/// Someone's driving speed has changed.
pub(super) fn renew(drive: &Drive, state: &mut State, slot: Slot) {
    Person::new(drive, state, slot).renew();
}

/// Everybody in the trial of a lane who is on a way is to be asked again: doors have opened or closed.
pub(super) fn look_for_ways(drive: &Drive, state: &mut State, lane: usize) {
    if state.plans.is_empty() {
        return;
    }
    for agent in (0..state.agents).filter(|&agent| drive.drivers.of(agent).is_some()) {
        let slot = state.slot(agent, lane);
        let is_here = state.present[slot.block].has(slot.lane);
        if is_here
            && matches!(
                state.plans.plan(slot),
                Some(Plan::Way(_) | Plan::Through(_) | Plan::Straight | Plan::NoWay)
            )
        {
            let held = state.plans.held_mut(slot);
            (held.free, held.blocker) = (None, None);
            state.plans.ask(slot, Occasion::Doors);
        }
    }
}

/// Moves agents that move by themselves to where their step ends; to be called with the positions after a step, before
/// anything looks at them.
pub(super) fn arrive(state: &mut State, moved: &[Mask]) {
    if !state.plans.is_empty() {
        follow::arrive(state, moved);
    }
}

/// Asks the drivers of all agents that need another plan.
pub(super) fn ask(drive: &Drive, state: &mut State) {
    if !state.plans.is_empty() {
        ask::all(drive, state);
    }
}

/// Updates driving direction, driving speed and presence of all agents in all occupied lanes, and velocities by what the
/// turn of the direction in the step adds. To be called once a step, with the new positions and the ticks that belong to them.
pub fn steer(drive: &Drive, state: &mut State) {
    steer_at(Level::new(), drive, state);
}

/// The same with vectors of a level.
pub(super) fn steer_at(level: Level, drive: &Drive, state: &mut State) {
    dispatch!(level, simd => steer_all(simd, drive, state));
    if !state.plans.is_empty() {
        let active = follow::go_on(level, drive, state);
        ask::all(drive, state);
        for (block, active) in active.into_iter().enumerate() {
            follow::pursue_at(level, drive, state, block, active & state.present[block]);
            reciprocal::avoid(drive, state, block, active & state.present[block]);
        }
    }
}

#[inline(always)]
fn steer_all<S: Simd>(simd: S, drive: &Drive, state: &mut State) {
    let occupied = state.layout.slots_of(state.occupied);
    for block in 0..state.route.blocks() {
        let active = state.present[block] & occupied;
        let mut events = Mask::NONE;
        for number in 0..state.route.count(block) {
            let party = state.route.party(block, number);
            let Some(stage) = drive.stages.get(party.stage as usize) else { continue };
            events |= lanes::steer(simd, state, block, party, stage, active);
        }
        if !events.is_empty() {
            for lane in events.iter() {
                Person::new(drive, state, Slot { block, lane }).step();
            }
        }
    }
}
