//! The common case of steering as vector code: parties of a block heading for the same rectangle, disc or
//! point.

use super::person::PASSING;
use super::stage::{Stage, Target};
use crate::base::lanes::{Lanes, Mask};
use crate::kernel::code::lanes::{Truth, Vector, narrow, widen};
use crate::kernel::state::State;
use crate::kernel::state::route::Party;
use crate::model::Parameter;
use fearless_simd::{Simd, prelude::*};

/// Steers the slots of one party; the slots that the plain code must look at.
#[inline(always)]
pub(super) fn steer<S: Simd>(
    simd: S,
    state: &mut State,
    block: usize,
    party: Party,
    stage: &Stage,
    active: Mask,
) -> Mask {
    let slots = party.slots & active;
    if slots.is_empty() {
        return Mask::NONE;
    }
    let over = state.route.advice_over(block, slots, (state.layout, &state.ticks));
    let (x, y, radius) = (
        load(simd, block, &state.motion.x),
        load(simd, block, &state.motion.y),
        load(simd, block, &state.bodies[Parameter::Radius]),
    );
    let (dx, dy, reached): (Vector<S>, Vector<S>, Truth<S>) = match &stage.target {
        Target::Rectangle(bounds) => {
            let (low, high) = (bounds.low, bounds.high);
            let (dx, outside_x) = interval(x, low.x, high.x, radius);
            let (dy, outside_y) = interval(y, low.y, high.y, radius);
            let outside = outside_x.simd_gt(outside_y).select(outside_x, outside_y);
            (dx, dy, outside.simd_le(Vector::splat(simd, 0.0)))
        }
        Target::Disc { centre, radius } => {
            let (dx, dy) = (Vector::splat(simd, centre.x) - x, Vector::splat(simd, centre.y) - y);
            let inside = (dx * dx + dy * dy).simd_le(Vector::splat(simd, radius * radius));
            (dx, dy, inside)
        }
        Target::Point(point) => {
            let (dx, dy) = (Vector::splat(simd, point.x) - x, Vector::splat(simd, point.y) - y);
            let square = dx * dx + dy * dy;
            let mut near = square.simd_le(radius * 4.0 * radius);
            if !stage.last || stage.leaves {
                let (fx, fy) =
                    (load(simd, block, &state.route.from_x), load(simd, block, &state.route.from_y));
                let along =
                    dx * (Vector::splat(simd, point.x) - fx) + dy * (Vector::splat(simd, point.y) - fy);
                near |= along.simd_le(Vector::splat(simd, 0.0))
                    & square.simd_le(Vector::splat(simd, PASSING * PASSING));
            }
            (dx, dy, near)
        }
        Target::Form(ground) => {
            let (dx, dy) = ground.way_to_rim(x, y);
            (dx, dy, ground.contains(x, y))
        }
        // Nothing that a step changes: who goes on, rests or waits has been told once.
        Target::Onward | Target::Rest => return over,
        Target::Pause(_) => {
            return over | state.route.pause_over(block, slots, (state.layout, &state.ticks));
        }
    };
    let square = dx * dx + dy * dy;
    let length = square.sqrt();
    let inverse = Vector::splat(simd, 1.0) / length;
    // Without a direction the last one stays.
    let turns = square.simd_gt(Vector::splat(simd, super::person::NO_LENGTH))
        & square.simd_lt(Vector::splat(simd, f64::INFINITY));
    // Those under advice, or on a plan, are steered elsewhere.
    let led = state.route.advised[block] | state.plans.led(block);
    let walking = widen(simd, slots & !led);
    let (ex, ey) = (load(simd, block, &state.driving.ex), load(simd, block, &state.driving.ey));
    let drive = load(simd, block, &state.driving.speed);
    let speed = load(simd, block, &state.bodies[Parameter::Speed]);
    let turning = walking & turns & !reached;
    turn(simd, state, block, (turning.select(dx * inverse, ex), turning.select(dy * inverse, ey)));
    let wanted = reached.select(Vector::splat(simd, 0.0), speed);
    walking.select(wanted, drive).store_slice(&mut state.driving.speed[block].0);
    // Who makes a step ends no leg before its end.
    let done = slots & narrow(reached) & !state.plans.stepping(block);
    if done.is_empty() || !stage.last || stage.leaves {
        return over | done;
    }
    // Whoever stays at the last goal has finished there, once, and ends the way of points that led there.
    let finished = load(simd, block, &state.progress.done_at).simd_lt(Vector::splat(simd, f64::INFINITY));
    over | done & (state.plans.on_way(block) | !narrow(finished))
}

/// Turns the driving directions of a block. The step just made was driven along the direction at its beginning: half of what
/// the driving force would have been more along the present one is added. Nothing where a step leads past the aim. The
/// difference is +0 where a leg, a rest or advice ended, and changes no bit.
#[inline(always)]
pub(super) fn turn<S: Simd>(
    simd: S,
    state: &mut State,
    block: usize,
    (new_x, new_y): (Vector<S>, Vector<S>),
) {
    let (ex, ey) = (load(simd, block, &state.driving.ex), load(simd, block, &state.driving.ey));
    let drive = load(simd, block, &state.driving.speed);
    new_x.store_slice(&mut state.driving.ex[block].0);
    new_y.store_slice(&mut state.driving.ey[block].0);
    let (zero, one) = (Vector::splat(simd, 0.0), Vector::splat(simd, 1.0));
    let rest = Vector::splat(simd, 0.5) * (one - load(simd, block, &state.bodies.decay)) * drive;
    let rest = (ex * new_x + ey * new_y).simd_gt(zero).select(rest, zero);
    let (vx, vy) = (load(simd, block, &state.motion.vx), load(simd, block, &state.motion.vy));
    (vx - rest * (ex - new_x)).store_slice(&mut state.motion.vx[block].0);
    (vy - rest * (ey - new_y)).store_slice(&mut state.motion.vy[block].0);
}

/// A field of a block.
#[inline(always)]
pub(super) fn load<S: Simd>(simd: S, block: usize, field: &[Lanes]) -> Vector<S> {
    Vector::from_slice(simd, &field[block].0)
}

/// The way to the nearest coordinate a radius inside an interval (to its middle where there is no room), and
/// how far the coordinate is outside the interval itself: not above 0 within.
#[inline(always)]
fn interval<S: Simd>(v: Vector<S>, low: f64, high: f64, radius: Vector<S>) -> (Vector<S>, Vector<S>) {
    let zero = Vector::splat(v.simd, 0.0);
    let half = Vector::splat(v.simd, 0.5 * (high - low));
    let inset = radius.simd_gt(half).select(half, radius);
    let (to_low, to_high) = (Vector::splat(v.simd, low) - v, Vector::splat(v.simd, high) - v);
    let (inner, outer) = (to_low + inset, to_high - inset);
    let way = outer.simd_lt(zero).select(outer, zero);
    let way = inner.simd_gt(zero).select(inner, way);
    let beyond = -to_high;
    (way, to_low.simd_gt(beyond).select(to_low, beyond))
}
