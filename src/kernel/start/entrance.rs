//! Entering the scene: agents at the start of a trial, and people from sources while it runs.

use super::arrival::SLACK;
use super::placement::{ATTEMPTS, Ground};
use super::sampler::Sampler;
use crate::base::geometry::Vec2;
use crate::base::lanes::{Lanes, Mask};
use crate::base::random::{Purpose, Stream};
use crate::kernel::driver;
use crate::kernel::parameters::Values;
use crate::kernel::plan::Occasion;
use crate::kernel::process::delay::after;
use crate::kernel::program::Program;
use crate::kernel::state::{Layout, Motion, State};
use crate::model::{AgentId, Move, Parameter, Position};

/// Puts an agent into the scene, at the beginning of its way.
pub(super) fn enter(
    program: &Program,
    state: &mut State,
    (agent, lane): (usize, usize),
    (occasion, advice): (Occasion, Option<(Move, u64)>),
    body: &Values,
    at: Vec2,
) {
    let slot = state.slot(agent, lane);
    state.bodies.put(slot, body, Parameter::ALL.into_iter());
    let velocity = program.scenario.agents[agent].start.velocity;
    let at = program.forces.periods.wrap(at);
    let put = |field: &mut [Lanes], value| field[slot.block].0[slot.lane] = value;
    put(&mut state.motion.x, at.x);
    put(&mut state.motion.y, at.y);
    put(&mut state.motion.vx, velocity.x);
    put(&mut state.motion.vy, velocity.y);
    let Motion { travelled, fx, fy, slowness, .. } = &mut state.motion;
    for field in [travelled, fx, fy, slowness] {
        put(field, 0.0);
    }
    if !program.stairwells.is_empty() {
        program.stairwells.begin(program, state, slot, at);
    }
    state.driving.move_on(slot);
    state.present[slot.block] |= Mask::lane(slot.lane);
    state.passages.begin(slot);
    driver::begin(&program.drive, state, (agent, lane), occasion, advice);
    program.behaviours.begin((&program.drive, &program.parameters), state, agent, lane);
}

/// Lets in who comes at time 0.
pub(super) fn open(program: &Program, state: &mut State, lane: usize) {
    let now = SLACK * program.dt;
    for source in 0..program.arrivals.doors.len() {
        if state.queues.next[source].0[lane] <= now {
            arrive(program, state, source, lane, now);
        }
    }
}

/// Lets in who has arrived; to be called with the ticks and positions after a step. Whether somebody came in.
pub(in crate::kernel) fn step(program: &Program, state: &mut State) -> bool {
    let mut came = false;
    for source in 0..program.arrivals.doors.len() {
        for lane in state.occupied.iter() {
            let now = (state.ticks[lane] as f64 + SLACK) * program.dt;
            let due = state.queues.next[source].0[lane] <= now;
            if due || state.queues.entered[source][lane] < state.queues.arrived[source][lane] {
                came |= arrive(program, state, source, lane, now);
            }
        }
    }
    if came {
        driver::ask(&program.drive, state);
    }
    came
}

fn arrive(program: &Program, state: &mut State, source: usize, lane: usize, now: f64) -> bool {
    let mut came = false;
    let door = &program.arrivals.doors[source];
    let key = state.keys[lane];
    while state.queues.next[source].0[lane] <= now {
        let arrived = &mut state.queues.arrived[source][lane];
        let most = if program.arrivals.once { door.members.len() as u32 } else { door.most };
        if *arrived >= most {
            state.queues.full |= Mask::lane(lane);
            state.queues.which[lane] = source as u32;
            return came;
        }
        *arrived += 1;
        let next = &mut state.queues.next[source].0[lane];
        *next = after(*next, door.interval(key, *arrived), program.scenario.clock);
    }
    while state.queues.entered[source][lane] < state.queues.arrived[source][lane] {
        let number = state.queues.entered[source][lane];
        let Some(place) = door.place(state, lane, number) else {
            state.queues.full |= Mask::lane(lane);
            state.queues.which[lane] = source as u32;
            return came;
        };
        let (member, later) = (door.members[place], number - place as u32);
        let entity = program.scenario.agents[member.0 as usize].entity + later;
        let Ok(body) = program.parameters.draw((member, later), key) else {
            // Nobody can move like that; such laws are refused when they are compiled.
            state.diverged |= Mask::lane(lane);
            return came;
        };
        let tries = state.queues.tries[source][lane];
        let Some(at) =
            free_place(program, state, lane, (member, entity), body[Parameter::Radius as usize], tries)
        else {
            state.queues.tries[source][lane] += 1;
            return came;
        };
        state.queues.tries[source][lane] = 0;
        state.queues.entered[source][lane] += 1;
        state.queues.later[member.0 as usize][lane] = later;
        if later > 0 && !state.queues.reused.has(lane) {
            state.queues.reused |= Mask::lane(lane);
            state.queues.which[lane] = source as u32;
        }
        enter(program, state, (member.0 as usize, lane), (Occasion::Enters, None), &body, at);
        let slot = state.slot(member.0 as usize, lane);
        state.prepare(slot, program.dt);
        state.forget_noise(slot);
        came = true;
    }
    came
}

/// A place for an agent that touches nobody, in the `tries`-th attempt to come in. Near somebody who is not there
/// is no place yet.
fn free_place(
    program: &Program,
    state: &State,
    lane: usize,
    (member, entity): (AgentId, u32),
    radius: f64,
    tries: u32,
) -> Option<Vec2> {
    let agent = &program.scenario.agents[member.0 as usize];
    let around;
    let sampler = match &agent.start.position {
        Position::Point(point) => {
            let free = is_free(program, &all_present(state, lane), *point, radius);
            return free.then_some(*point);
        }
        Position::Within(_) => program.starts.sampler(member.0 as usize)?,
        Position::Near { agent, within } => {
            let slot = state.slot(agent.0 as usize, lane);
            if !state.is_present(slot) {
                return None;
            }
            around = Sampler::Disc { centre: state.position(slot), radius: *within };
            &around
        }
    };
    let stream = Stream::of(state.keys[lane], entity, Purpose::Placement);
    let others = all_present(state, lane);
    for attempt in 0..ATTEMPTS {
        let draw = tries.wrapping_mul(ATTEMPTS).wrapping_add(attempt);
        let point = sampler.point(stream.uniform_pair(draw))?;
        if is_free(program, &others, point, radius) {
            return Some(point);
        }
    }
    None
}

/// Places and radii of all who are present.
fn all_present(state: &State, lane: usize) -> Vec<(f64, f64, f64)> {
    let mut out = Vec::new();
    for block in 0..state.motion.x.len() {
        let slots = match state.layout {
            Layout::Trials => Mask::lane(lane),
            Layout::Agents => Mask::ALL,
        };
        for slot in (state.present[block] & slots).iter() {
            out.push((
                state.motion.x[block].0[slot],
                state.motion.y[block].0[slot],
                state.bodies[Parameter::Radius][block].0[slot],
            ));
        }
    }
    out
}

fn is_free(program: &Program, others: &[(f64, f64, f64)], p: Vec2, radius: f64) -> bool {
    let apart = |&(x, y, r): &(f64, f64, f64)| {
        let (dx, dy, touch) = (p.x - x, p.y - y, radius + r);
        dx * dx + dy * dy >= touch * touch
    };
    let ground = Ground::of(&program.scenario.scene, &program.starts);
    others.iter().all(apart) && ground.near(p, radius).all(|barrier| barrier.distance(p) >= radius)
}
