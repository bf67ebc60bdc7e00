//! Who stands holds its place.
//!
//! An agent that stands, and so has no driving velocity of its own, is driven back to where it came to rest: there it would
//! come by itself at the moment when its driving ends, so that whoever stops undisturbed stops as before. With `x + v tau`
//! for where it would come to rest now, its driving velocity is `(rest - x - v tau)/tau`, at most `hold`: a displacement
//! fades out with the relaxation time and without a swing.

use super::state::{State, Still};
use super::vector::{Doubles, Part};
use crate::base::lanes::Mask;
use crate::model::Parameter;
use fearless_simd::Simd;
use fearless_simd::prelude::*;

/// The driving velocity with which those who stand return to where they came to rest.
#[inline(always)]
pub(super) fn back<S: Simd>(
    part: Part<S>,
    still: &Still<'_>,
    block: usize,
    (x, y): (Doubles<S>, Doubles<S>),
    (vx, vy): (Doubles<S>, Doubles<S>),
) -> (Doubles<S>, Doubles<S>) {
    let tau = part.load(&still.bodies[Parameter::Tau][block]);
    let dx = part.load(&still.driving.rest_x[block]) - (x + vx * tau);
    let dy = part.load(&still.driving.rest_y[block]) - (y + vy * tau);
    let pace = (dx * dx + dy * dy).sqrt() / tau;
    let limit = part.load(&still.bodies[Parameter::Hold][block]);
    let rate = pace.simd_gt(limit).select(limit / pace, part.c(1.0)) / tau;
    (dx * rate, dy * rate)
}

/// Notes where those came or come to rest who began to stand with the last state, and forgets it of those who do not stand.
#[inline(always)]
pub(super) fn rest<S: Simd>(part: Part<S>, state: &mut State, block: usize, moving: Mask) {
    let none = part.c(f64::INFINITY);
    let stands = part.load(&state.driving.speed[block]).simd_eq(part.c(0.0));
    let old = part.load(&state.driving.rest_x[block]);
    let rests = old.simd_lt(none);
    let (here, changed) = (part.mask(moving), stands ^ rests);
    if (here & changed).any_true() {
        let tau = part.load(&state.bodies[Parameter::Tau][block]);
        let x = part.load(&state.motion.x[block]) + part.load(&state.motion.vx[block]) * tau;
        let y = part.load(&state.motion.y[block]) + part.load(&state.motion.vy[block]) * tau;
        part.store_in(here & changed, stands.select(x, none), &mut state.driving.rest_x[block]);
        part.store_in(here & changed, stands.select(y, none), &mut state.driving.rest_y[block]);
    }
}
