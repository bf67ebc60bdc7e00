//! Following plans, as vector code over the slots of a block; what happens seldom is done for one slot.
//!
//! An agent that is driven along a trajectory `p` has at plan time t the driving velocity `v(t) + tau a(t)`, plus `p(t) - x`
//! over 1 s up to a limit. Under the driving force alone it then moves as planned: the relaxation towards the driving
//! velocity is compensated. The velocity of a step is that in its middle, which is of second order as the step is. An
//! agent that is moved along a trajectory has the velocity that takes it to `p(t + dt)` in one step, no noise and no
//! force, and is set there after the step, so that rounding does not add up.

use super::lanes::{load, turn};
use super::person::{NO_LENGTH, PASSING, Person, way_to};
use super::stage::Drive;
use crate::base::geometry::{Segment, Vec2};
use crate::base::lanes::{LANES, Lanes, Mask};
use crate::base::tick::steps_over;
use crate::kernel::code::lanes::{Truth, Vector, narrow, widen};
use crate::kernel::plan::{Occasion, Plan, Trajectory};
use crate::kernel::state::plans::Course;
use crate::kernel::state::{Slot, State};
use crate::model::sight::ROUNDING;
use crate::model::{Leg, Parameter};
use fearless_simd::{Level, Simd, dispatch, prelude::*};

/// A driver is asked again, and a point looked for, at most once in this time, s.
const AGAIN: f64 = 0.5;

/// Who is slower than this stands, m/s.
const STANDS: f64 = 0.1;

/// An agent that is slower than this share of its driving speed is slowed down by others.
const SLOWED: f64 = 0.6;

/// So many looks in a row, 0.5 s apart, make 2 s.
const LOOKS: u32 = 4;

/// So much later on a trajectory is what has to be in sight, s.
const AHEAD: f64 = 0.7;

/// So many ticks are that.
pub(super) fn again(drive: &Drive) -> f64 {
    steps_over(AGAIN, drive.dt)
}

/// Sets the agents that move by themselves to where their step ends.
pub(super) fn arrive(state: &mut State, moved: &[Mask]) {
    for (block, course) in state.plans.courses.iter().enumerate() {
        for lane in (course.stepped & moved[block]).iter() {
            state.motion.x[block].0[lane] = course.goal_x.0[lane];
            state.motion.y[block].0[lane] = course.goal_y.0[lane];
        }
    }
}

/// Lets the time of all plans go on after a step, and does what is due; the slots of each block that take part.
pub(super) fn go_on(level: Level, drive: &Drive, state: &mut State) -> Vec<Mask> {
    let occupied = state.layout.slots_of(state.occupied);
    let blocks = state.plans.courses.len();
    let active: Vec<Mask> = state.present[..blocks].iter().map(|&here| here & occupied).collect();
    for (block, &active) in active.iter().enumerate() {
        let course = &mut state.plans.courses[block];
        course.fresh = Mask::NONE;
        let watched = active & course.watched & !state.route.advised[block];
        let is_due =
            |&lane: &usize| state.ticks[state.layout.trial_of(lane)] as f64 >= course.next_ask.0[lane];
        for lane in watched.iter().filter(is_due).fold(Mask::NONE, |all, lane| all | Mask::lane(lane)).iter()
        {
            event(drive, state, Slot { block, lane });
        }
        let led = active & state.plans.led(block);
        if !led.is_empty() {
            let events = dispatch!(level, simd => advance(simd, drive, state, block, led));
            for lane in events.iter() {
                event(drive, state, Slot { block, lane });
            }
        }
    }
    active
}

/// Sets driving and velocity of the slots of a block among these that follow a plan.
pub(super) fn pursue_at(level: Level, drive: &Drive, state: &mut State, block: usize, slots: Mask) {
    let slots = slots & state.plans.led(block);
    if !slots.is_empty() {
        dispatch!(level, simd => pursue(simd, drive, state, block, slots));
    }
}

/// The slots that go along their plans by each rule: way, driven, stepped, stands.
fn rules(state: &State, block: usize, slots: Mask) -> [Mask; 4] {
    let course = &state.plans.courses[block];
    let free = slots & !state.route.advised[block];
    let stands = course.stands & (free | course.stepped & slots);
    [course.way & free, course.driven & free, course.stepped & slots, stands]
}

#[inline(always)]
fn of<S: Simd>(simd: S, lanes: &Lanes) -> Vector<S> {
    Vector::from_slice(simd, &lanes.0)
}

/// Seconds of the plan for each second: more or less than 1 where a behaviour has changed the speed.
#[inline(always)]
fn rate<S: Simd>(simd: S, state: &State, block: usize, driven: Mask) -> Vector<S> {
    let speed = load(simd, block, &state.bodies[Parameter::Speed]);
    let own = of(simd, &state.plans.courses[block].own_speed);
    widen(simd, driven).select(speed / own, Vector::splat(simd, 1.0))
}

/// The time of the plan that the next step needs: its middle where the agent is driven, its end where it is moved.
#[inline(always)]
fn ahead<S: Simd>(
    (time, rate): (Vector<S>, Vector<S>),
    stepped: Truth<S>,
    late: Truth<S>,
    dt: f64,
) -> Vector<S> {
    let simd = time.simd;
    let step = stepped.select(Vector::splat(simd, dt), rate * Vector::splat(simd, 0.5 * dt));
    late.select(time, time + step)
}

/// A coordinate of the trajectory with its first two derivatives.
#[inline(always)]
fn cubic<S: Simd>(c: &[Lanes; 4], t: Vector<S>) -> [Vector<S>; 3] {
    let simd = t.simd;
    let [a, b, c, d] = [of(simd, &c[0]), of(simd, &c[1]), of(simd, &c[2]), of(simd, &c[3])];
    let (two, three) = (Vector::splat(simd, 2.0), Vector::splat(simd, 3.0));
    [a + t * (b + t * (c + t * d)), b + t * (two * c + t * (three * d)), two * (c + three * d * t)]
}

/// Lets the time of the plans of a block go on; the slots in which something happens.
#[inline(always)]
fn advance<S: Simd>(simd: S, drive: &Drive, state: &mut State, block: usize, active: Mask) -> Mask {
    let [way, driven, stepped, stands] = rules(state, block, active);
    let mut now = Lanes::ZERO;
    let mut looked_at = Mask::NONE;
    for lane in 0..LANES {
        now.0[lane] = state.ticks[state.layout.trial_of(lane)] as f64;
        if is_look(drive, now.0[lane]) {
            looked_at |= Mask::lane(lane);
        }
    }
    let course = &state.plans.courses[block];
    let due = of(simd, &now).simd_ge(of(simd, &course.next_ask));
    let (x, y) = (load(simd, block, &state.motion.x), load(simd, block, &state.motion.y));
    let square = |x: Vector<S>, y: Vector<S>| x * x + y * y;

    let rate = rate(simd, state, block, driven);
    let runs = widen(simd, (driven & !course.late) | stepped);
    let before = of(simd, &course.time);
    let time = runs.select(before + Vector::splat(simd, drive.dt) * rate, before);
    let since = time - of(simd, &course.from);
    let behind = square(cubic(&course.x, since)[0] - x, cubic(&course.y, since)[0] - y);
    let beyond = |limit: &Lanes| behind.simd_gt(of(simd, limit) * of(simd, limit));
    let late = beyond(&course.lag) & widen(simd, driven);
    let left = beyond(&course.leave) & due;
    let over = ahead((time, rate), widen(simd, stepped), late, drive.dt).simd_gt(of(simd, &course.until));

    let (goal_x, goal_y) = (of(simd, &course.goal_x), of(simd, &course.goal_y));
    let (dx, dy) = (goal_x - x, goal_y - y);
    let radius = load(simd, block, &state.bodies[Parameter::Radius]);
    let along = dx * (goal_x - of(simd, &course.start_x)) + dy * (goal_y - of(simd, &course.start_y));
    let passes = along.simd_le(Vector::splat(simd, 0.0))
        & square(dx, dy).simd_le(Vector::splat(simd, PASSING * PASSING));
    let near = square(dx, dy).simd_le(radius * radius * Vector::splat(simd, 4.0)) | passes;

    let course = &mut state.plans.courses[block];
    time.store_slice(&mut course.time.0);
    course.late = narrow(late);
    driven & (narrow(over | left) | looked_at)
        | stepped & narrow(over)
        | way & narrow(near | due)
        | stands & narrow(due)
}

/// Sets driving and velocity of some slots of a block for the next step.
#[inline(always)]
fn pursue<S: Simd>(simd: S, drive: &Drive, state: &mut State, block: usize, slots: Mask) {
    let [way, driven, stepped, stands] = rules(state, block, slots);
    let course = &state.plans.courses[block];
    let (is_driven, is_stepped) = (widen::<S>(simd, driven), widen::<S>(simd, stepped));
    let splat = |value: f64| Vector::splat(simd, value);
    let (x, y) = (load(simd, block, &state.motion.x), load(simd, block, &state.motion.y));
    let (time, rate) = (of(simd, &course.time), rate(simd, state, block, driven));
    let from = of(simd, &course.from);
    let ahead = ahead((time, rate), is_stepped, widen(simd, course.late), drive.dt) - from;
    let ([px, vx, ax], [py, vy, ay]) = (cubic(&course.x, ahead), cubic(&course.y, ahead));
    let (dx, dy) = (cubic(&course.x, time - from)[0] - x, cubic(&course.y, time - from)[0] - y);
    let (far, limit) = ((dx * dx + dy * dy).sqrt(), of(simd, &course.correction));
    let share = far.simd_gt(limit).select(limit / far, splat(1.0));
    let bend = load(simd, block, &state.bodies[Parameter::Tau]) * rate * rate;
    let wish = (vx * rate + bend * ax + dx * share, vy * rate + bend * ay + dy * share);
    let pace = ((px - x) / splat(drive.dt), (py - y) / splat(drive.dt));
    let (goal_x, goal_y) = (of(simd, &course.goal_x), of(simd, &course.goal_y));
    let along_x = is_stepped.select(pace.0, is_driven.select(wish.0, goal_x - x));
    let along_y = is_stepped.select(pace.1, is_driven.select(wish.1, goal_y - y));

    let square = along_x * along_x + along_y * along_y;
    let length = square.sqrt();
    let turns = square.simd_gt(splat(NO_LENGTH)) & square.simd_lt(splat(f64::INFINITY));
    let (unit_x, unit_y) = (along_x / length, along_y / length);
    // Where the plan is the one of the step before, the turn of the direction counts as on routes.
    let turning = turns & widen(simd, way & !course.fresh);
    let set = turns & widen(simd, way | driven | stepped);
    let (ex, ey) = (load(simd, block, &state.driving.ex), load(simd, block, &state.driving.ey));
    turn(simd, state, block, (turning.select(unit_x, ex), turning.select(unit_y, ey)));
    set.select(unit_x, ex).store_slice(&mut state.driving.ex[block].0);
    set.select(unit_y, ey).store_slice(&mut state.driving.ey[block].0);

    let own = load(simd, block, &state.bodies[Parameter::Speed]);
    let length = turns.select(length, splat(0.0));
    let speed = widen(simd, way).select(own, widen(simd, driven | stepped).select(length, splat(0.0)));
    let old = load(simd, block, &state.driving.speed);
    let any = widen(simd, way | driven | stepped | stands);
    any.select(speed, old).store_slice(&mut state.driving.speed[block].0);
    let old = (load(simd, block, &state.motion.vx), load(simd, block, &state.motion.vy));
    is_stepped.select(pace.0, old.0).store_slice(&mut state.motion.vx[block].0);
    is_stepped.select(pace.1, old.1).store_slice(&mut state.motion.vy[block].0);
    let course: &mut Course = &mut state.plans.courses[block];
    is_stepped.select(px, goal_x).store_slice(&mut course.goal_x.0);
    is_stepped.select(py, goal_y).store_slice(&mut course.goal_y.0);
}

/// Something happens to the plan of one slot.
fn event(drive: &Drive, state: &mut State, slot: Slot) {
    let Slot { block, lane } = slot;
    let tick = state.ticks[state.layout.trial_of(lane)] as f64;
    let course = &mut state.plans.courses[block];
    let is_due = tick >= course.next_ask.0[lane];
    let is_driven = course.driven.has(lane);
    if is_due && !is_driven {
        course.next_ask.0[lane] = tick + again(drive);
    }
    let time = course.time.0[lane];
    let held = state.plans.held(slot);
    match held.plan.clone() {
        Plan::Way(_) if is_due && chooses_again(drive, state, slot) => state.plans.ask(slot, Occasion::Looks),
        Plan::Way(points) => pass(drive, state, slot, &points, (is_due, true)),
        Plan::Through(points) => pass(drive, state, slot, &points, (is_due, false)),
        Plan::Follow(trajectory, _) => {
            let course = &mut state.plans.courses[block];
            let rate = state.bodies[Parameter::Speed][block].0[lane] / course.own_speed.0[lane];
            let ahead = if course.late.has(lane) { time } else { time + rate * (0.5 * drive.dt) };
            if ahead > course.until.0[lane] {
                course.set_piece(lane, &trajectory.piece(ahead));
                if ahead > trajectory.duration() {
                    state.plans.ask(slot, Occasion::Ended);
                }
            } else if is_off(drive, state, slot, &trajectory, time) && is_due {
                state.plans.ask(slot, Occasion::Left);
            }
        }
        Plan::Step(trajectory) => {
            let ahead = time + drive.dt;
            state.plans.courses[block].set_piece(lane, &trajectory.piece(ahead));
            if ahead > trajectory.duration() {
                state.plans.ask(slot, Occasion::Ended);
            }
        }
        Plan::Stand(_) => state.plans.ask(slot, Occasion::Ended),
        Plan::Straight => {
            if is_due && is_hidden(drive, state, slot) {
                state.plans.ask(slot, Occasion::Left);
            }
        }
        Plan::Keep | Plan::NoWay | Plan::There | Plan::Failed(_) => {}
    }
}

/// Whether someone on the way to one of several exits looks for the quickest again, every 2 s.
fn chooses_again(drive: &Drive, state: &mut State, slot: Slot) -> bool {
    let stage = &drive.stages[state.route.way(slot.block, slot.lane).stage as usize];
    let leg = drive.routes[stage.route as usize].legs().get(stage.at);
    if !matches!(leg, Some(Leg::To(goal)) if drive.scenario.scene.chooses(goal)) {
        return false;
    }
    let held = state.plans.held_mut(slot);
    held.stuck = (held.stuck + 1) % LOOKS;
    held.stuck == 0
}

/// Whether driven agents are looked at in a tick.
fn is_look(drive: &Drive, tick: f64) -> bool {
    (tick / again(drive)).fract() == 0.0
}

/// Whether someone who is driven needs another trajectory: is too far from it, or, looked at every 0.5 s, has stood for 2 s
/// while it moved, or has a barrier in between.
fn is_off(drive: &Drive, state: &mut State, slot: Slot, trajectory: &Trajectory, time: f64) -> bool {
    let Slot { block, lane } = slot;
    let (vx, vy) = (state.motion.vx[block].0[lane], state.motion.vy[block].0[lane]);
    let leave = state.plans.courses[block].leave.0[lane];
    let person = Person::new(drive, state, slot);
    let (at, radius) = (person.at(), person.radius());
    let [planned, pace, _] = trajectory.at(time);
    let is_far = (planned - at).norm_squared() > leave * leave;
    if is_far || !is_look(drive, state.ticks[state.layout.trial_of(lane)] as f64) {
        return is_far;
    }
    let stands = vx * vx + vy * vy < STANDS * STANDS && pace.norm_squared() > STANDS * STANDS;
    let held = state.plans.held_mut(slot);
    held.stuck = if stands { held.stuck + 1 } else { 0 };
    let is_stuck = held.stuck > LOOKS;
    let closed = state.closed_doors(lane);
    is_stuck || !drive.sees(closed, (at, trajectory.at(time + AHEAD)[0]), radius)
}

/// Whether the goal of someone who goes straight is out of sight.
fn is_hidden(drive: &Drive, state: &mut State, slot: Slot) -> bool {
    let person = Person::new(drive, state, slot);
    let (at, radius) = (person.at(), person.radius());
    let way = way_to(person.target(), at, radius);
    way.is_some_and(|way| !drive.sees(state.closed_doors(slot.lane), (at, at + way), radius))
}

/// On a way of points: passes the present one where the next is in sight, and, unless each is to be passed in turn, at times any
/// point before one in sight; looks for the present one if that is due.
fn pass(drive: &Drive, state: &mut State, slot: Slot, points: &[Vec2], (is_due, skips): (bool, bool)) {
    let Slot { block, lane } = slot;
    let person = Person::new(drive, state, slot);
    let (at, radius) = (person.at(), person.radius());
    let leg = way_to(person.target(), at, radius).map_or(at, |way| at + way);
    let first = person.point();
    let course = &state.plans.courses[block];
    let start = Vec2::new(course.start_x.0[lane], course.start_y.0[lane]);
    let goal = Vec2::new(course.goal_x.0[lane], course.goal_y.0[lane]);
    let (d, along) = (goal - at, goal - start);
    let square = d.x * d.x + d.y * d.y;
    let passes = d.x * along.x + d.y * along.y <= 0.0 && square <= PASSING * PASSING;
    let (closed, mut blocker) = (state.closed_doors(lane), state.plans.held(slot).blocker);
    let mut point = first;
    let is_reached = square <= radius * radius * 4.0 || passes;
    // An agent that keeps a lane turns at its end.
    if is_reached && !skips {
        point += 1;
    } else if is_reached || is_due && skips && goal == points[first] {
        while point < points.len() {
            let next = points.get(point + 1).copied().unwrap_or(leg);
            let found = drive.blocker(closed, (at, next), radius, blocker);
            if found.is_some() {
                blocker = found;
                break;
            }
            point += 1;
        }
        state.plans.held_mut(slot).blocker = blocker;
    }
    if let Some(next) = points.get(point) {
        if point > first {
            state.plans.held_mut(slot).point = point;
            state.plans.courses[block].set_goal(lane, *next, at);
            state.plans.courses[block].fresh |= Mask::lane(lane);
        } else if is_due && !sees(drive, state, slot, points[first]) {
            state.plans.ask(slot, Occasion::Left);
        } else if is_due && skips {
            keep_lane(drive, state, slot, (start, *next, points.get(first + 1).copied().unwrap_or(leg)));
        }
    } else {
        state.plans.end(slot);
        state.plans.watch(slot);
        Person::new(drive, state, slot).renew();
    }
}

/// An agent that is slowed down on its way to a corner keeps its lane from then on, and turns where the lane meets the line that
/// halves the corner. So a crowd uses the width of a corridor, where the shortest way is a single file.
fn keep_lane(drive: &Drive, state: &mut State, slot: Slot, (start, corner, next): (Vec2, Vec2, Vec2)) {
    let Slot { block, lane } = slot;
    let person = Person::new(drive, state, slot);
    let (at, radius) = (person.at(), person.radius());
    let (vx, vy) = (state.motion.vx[block].0[lane], state.motion.vy[block].0[lane]);
    let least = SLOWED * state.bodies[Parameter::Speed][block].0[lane];
    let ahead = (corner - start).normalize();
    let outward = (ahead + (corner - next).normalize()).normalize();
    // Both lines meet where at + t ahead = corner + aside outward.
    let aside = ahead.perp(&(at - corner)) / ahead.perp(&outward);
    let place = corner + aside * outward;
    let (closed, course) = (state.closed_doors(lane), &state.plans.courses[block]);
    let has_lane = (course.goal_x.0[lane], course.goal_y.0[lane]) != (corner.x, corner.y);
    let keeps = (has_lane || vx * vx + vy * vy < least * least)
        && aside > 0.0
        && aside.is_finite()
        && drive.sees(closed, (at, place), radius)
        && drive.sees(closed, (place, next), radius);
    let place = if keeps { place } else { corner };
    let course = &mut state.plans.courses[block];
    if (course.goal_x.0[lane], course.goal_y.0[lane]) != (place.x, place.y) {
        course.set_goal(lane, place, start);
        course.fresh |= Mask::lane(lane);
    }
}

/// Whether the point of a way is in sight. Whoever walks along a line that was free is hardly ever tested again.
fn sees(drive: &Drive, state: &mut State, slot: Slot, point: Vec2) -> bool {
    let person = Person::new(drive, state, slot);
    let (at, radius) = (person.at(), person.radius());
    let held = state.plans.held(slot);
    let is_near = |(line, clearance): (Segment, f64)| {
        line.b == point && line.distance(at) < clearance - 0.5 * radius - ROUNDING
    };
    if held.free.is_some_and(is_near) {
        return true;
    }
    let line = Segment::new(at, point);
    let closed = state.closed_doors(slot.lane);
    let clearance = drive.clearance(closed, &line, radius);
    let sees = clearance >= 0.5 * radius || drive.sees(closed, (at, point), radius);
    state.plans.held_mut(slot).free = sees.then_some((line, clearance));
    sees
}
