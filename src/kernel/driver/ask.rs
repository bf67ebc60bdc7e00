//! Asking drivers, and putting their plans into the state.

use super::follow;
use super::person::Person;
use super::situation::Situation;
use super::stage::Drive;
use crate::base::geometry::Vec2;
use crate::base::lanes::{Lanes, Mask};
use crate::base::tick::{Tick, steps_over};
use crate::kernel::plan::{Occasion, Plan};
use crate::kernel::state::{Slot, State};
use crate::model::{AgentId, Parameter, Route};
use fearless_simd::Level;

/// Asks for all agents that need it, in order of agents.
pub(super) fn all(drive: &Drive, state: &mut State) {
    for block in 0..state.plans.courses.len() {
        let asks = std::mem::take(&mut state.plans.courses[block].asks);
        for lane in (asks & state.present[block]).iter() {
            one(drive, state, Slot { block, lane });
        }
    }
}

fn one(drive: &Drive, state: &mut State, slot: Slot) {
    let agent = state.layout.agent_of(slot);
    let Some(driver) = drive.drivers.of(agent) else { return };
    let Slot { block, lane } = slot;
    let trial = state.layout.trial_of(lane);
    let way = state.route.way(block, lane);
    let stage = &drive.stages[way.stage as usize];
    let (legs, then_leave) = match &drive.routes[stage.route as usize] {
        Route::Legs { legs, then_leave } => (&legs[stage.at.min(legs.len())..], *then_leave),
        Route::OneOf { legs, .. } => (legs.get(stage.at..=stage.at).unwrap_or_default(), false),
        Route::Onward => (&[][..], false),
    };
    let held = state.plans.held(slot);
    let at = |x: &[Lanes], y: &[Lanes]| Vec2::new(x[block].0[lane], y[block].0[lane]);
    let (mut position, mut velocity) =
        (at(&state.motion.x, &state.motion.y), at(&state.motion.vx, &state.motion.vy));
    let mut after = 0.0;
    if let (Occasion::Ended, Plan::Follow(trajectory, _) | Plan::Step(trajectory)) =
        (held.occasion, &held.plan)
    {
        let left = trajectory.duration() - state.plans.courses[block].time.0[lane];
        after = if left > 0.0 { left } else { 0.0 };
        [position, velocity, _] = trajectory.at(trajectory.duration());
    }
    let situation = Situation {
        occasion: held.occasion,
        agent: AgentId(agent as u32),
        entity: drive.scenario.agents[agent].entity + state.queues.later(agent, trial),
        key: state.keys[trial],
        asked: held.asked,
        time: drive.scenario.clock.seconds(Tick(state.ticks[trial])),
        dt: drive.dt,
        after,
        position,
        velocity,
        legs,
        then_leave,
        advice: (way.advised_until > 0).then_some(way.advice),
        own_speed: state.plans.courses[block].own_speed.0[lane],
        path: held.path,
        plan: &held.plan,
        scenario: &drive.scenario,
        state,
        slot,
    };
    let mut memory = held.memory.clone();
    let plan = driver.plan(&situation, &mut memory);
    state.plans.held_mut(slot).memory = memory;
    if let Plan::Failed(fault) = plan {
        let here = Mask::lane(trial);
        if fault.is_some() {
            (state.faults[trial], state.faulty) = (fault, state.faulty | here);
        }
        state.diverged |= here;
        state.plans.held_mut(slot).plan = plan;
        return;
    }
    take_over(drive, state, slot, plan, after);
}

/// Begins a plan, `after` seconds after the present state.
fn take_over(drive: &Drive, state: &mut State, slot: Slot, plan: Plan, after: f64) {
    let Slot { block, lane } = slot;
    let tick = state.ticks[state.layout.trial_of(lane)] as f64;
    let held = state.plans.held_mut(slot);
    held.asked = held.asked.wrapping_add(1);
    state.plans.courses[block].next_ask.0[lane] = tick + follow::again(drive);
    if plan == Plan::Keep {
        return;
    }
    let was_stepped = state.plans.is_stepped(slot);
    if state.plans.stepping(block).has(lane) && state.plans.held(slot).occasion == Occasion::Ended {
        state.progress.steps[block].0[lane] += 1.0;
    }
    state.plans.end(slot);
    let person = Person::new(drive, state, slot);
    let (at, has_arrived) = (person.at(), person.has_arrived());
    let rate = state.bodies[Parameter::Speed][block].0[lane] / state.plans.courses[block].own_speed.0[lane];
    let is_alone = drive.scenario.agents[state.layout.agent_of(slot)].body.stepper.is_some();
    let course = &mut state.plans.courses[block];
    let here = Mask::lane(lane);
    course.fresh |= here;
    course.time.0[lane] = -after;
    match &plan {
        Plan::Keep | Plan::Failed(_) => {}
        Plan::Straight => course.watched |= here,
        Plan::NoWay => {
            course.stands |= here;
            if is_alone {
                course.rest(lane, at);
            }
            course.stranded |= here;
            course.next_ask.0[lane] = f64::INFINITY;
        }
        Plan::There => {
            course.stands |= here;
            course.rest(lane, at);
            course.next_ask.0[lane] = f64::INFINITY;
        }
        Plan::Stand(seconds) => {
            course.stands |= here;
            if is_alone {
                course.rest(lane, at);
            }
            course.next_ask.0[lane] = tick + steps_over(*seconds, drive.dt);
        }
        Plan::Way(points) | Plan::Through(points) => {
            if let (Some(first), false) = (points.first(), has_arrived) {
                course.way |= here;
                course.set_goal(lane, *first, at);
            }
        }
        Plan::Follow(trajectory, limits) => {
            course.driven |= here;
            course.correction.0[lane] = limits.correction;
            course.lag.0[lane] = limits.lag;
            course.leave.0[lane] = limits.leave;
            course.set_piece(lane, &trajectory.piece(rate * (0.5 * drive.dt) - after));
        }
        Plan::Step(trajectory) => {
            course.stepped |= here;
            course.set_piece(lane, &trajectory.piece(drive.dt - after));
        }
    }
    if plan == Plan::NoWay {
        state.no_way |= Mask::lane(state.layout.trial_of(lane));
    }
    let is_there = plan == Plan::There;
    let held = state.plans.held_mut(slot);
    (held.plan, held.point, held.stuck) = (plan, 0, 0);
    if was_stepped != state.plans.is_stepped(slot) {
        state.prepare(slot, drive.dt);
    }
    if is_there {
        Person::new(drive, state, slot).step();
        return;
    }
    Person::new(drive, state, slot).renew();
    follow::pursue_at(Level::baseline(), drive, state, block, here);
}
