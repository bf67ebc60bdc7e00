//! The common case of steering as vector code: parties of a block heading for the same rectangle, disc or
//! point.

use super::person::PASSING;
use super::route::Party;
use super::stage::{Stage, Target};
use crate::base::lanes::{Lanes, Mask};
use crate::kernel::state::State;
use fearless_simd::{Simd, f64x8, mask64x8, prelude::*};

type Vector<S> = f64x8<S>;
type Truth<S> = mask64x8<S>;

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
    let load = |field: &[Lanes]| Vector::from_slice(simd, &field[block].0);
    let splat = |value: f64| Vector::splat(simd, value);
    let slots = party.slots & active;
    if slots.is_empty() {
        return Mask::NONE;
    }
    let (x, y, radius) = (load(&state.x), load(&state.y), load(&state.radius));
    let (dx, dy, reached): (Vector<S>, Vector<S>, Truth<S>) = match &stage.target {
        Target::Rectangle(bounds) => {
            let (low, high) = (bounds.low, bounds.high);
            let aim = |v: Vector<S>, low: f64, high: f64| {
                let middle = splat(0.5 * (low + high));
                let inner = radius + low;
                let inner = inner.simd_gt(middle).select(middle, inner);
                let outer = splat(high) - radius;
                let outer = outer.simd_lt(middle).select(middle, outer);
                let v = v.simd_lt(inner).select(inner, v);
                v.simd_gt(outer).select(outer, v)
            };
            let inside = x.simd_ge(splat(low.x))
                & x.simd_le(splat(high.x))
                & y.simd_ge(splat(low.y))
                & y.simd_le(splat(high.y));
            (aim(x, low.x, high.x) - x, aim(y, low.y, high.y) - y, inside)
        }
        Target::Disc { centre, radius } => {
            let (dx, dy) = (splat(centre.x) - x, splat(centre.y) - y);
            let inside = (dx * dx + dy * dy).simd_le(splat(radius * radius));
            (dx, dy, inside)
        }
        Target::Point(point) => {
            let (dx, dy) = (splat(point.x) - x, splat(point.y) - y);
            let square = dx * dx + dy * dy;
            let mut near = square.simd_le(radius * 4.0 * radius);
            if !stage.last || stage.leaves {
                let (fx, fy) = (load(&state.route.from_x), load(&state.route.from_y));
                let along = dx * (splat(point.x) - fx) + dy * (splat(point.y) - fy);
                near = near | along.simd_le(splat(0.0)) & square.simd_le(splat(PASSING * PASSING));
            }
            (dx, dy, near)
        }
        // Nothing that the next step changes: who goes on or rests has been told once.
        Target::Onward | Target::Rest => return slots & state.route.advised[block],
        Target::Form { .. } | Target::Pause(_) => return slots,
    };
    let square = dx * dx + dy * dy;
    let length = square.sqrt();
    let inverse = splat(1.0) / length;
    // Without a direction the last one stays.
    let turns = square.simd_gt(splat(super::person::NO_LENGTH)) & square.is_finite();
    let advised = state.route.advised[block];
    let walking = Truth::<S>::from_bitmask(simd, u64::from((slots & !advised).0));
    let (ex, ey) = (load(&state.ex), load(&state.ey));
    let drive = load(&state.drive);
    let speed = load(&state.speed);
    let turning = walking & turns & !reached;
    turning.select(dx * inverse, ex).store_slice(&mut state.ex[block].0);
    turning.select(dy * inverse, ey).store_slice(&mut state.ey[block].0);
    let wanted = reached.select(splat(0.0), speed);
    walking.select(wanted, drive).store_slice(&mut state.drive[block].0);
    let done = Mask(reached.to_bitmask() as u8);
    let stays = stage.last && !stage.leaves;
    slots & (advised | if stays { Mask::NONE } else { done })
}
