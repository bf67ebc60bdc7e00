//! Velocities of agents of the collision-free speed model: direction and speed follow from where all are
//! (`force::speed`), and hold from one state to the next.
//!
//! Noise is a velocity of its own, which is added: an Ornstein-Uhlenbeck process with the standard deviation `noise` of each
//! component, as in agents that forces move, and the relaxation time [`FORGETS`]. The model of the paper has none.

use super::composure::allowed;
use super::force::pair::Sum;
use super::state::{State, Still};
use super::vector::{Doubles, Part, Truths};
use crate::base::lanes::Mask;
use crate::model::Parameter;
use fearless_simd::Simd;
use fearless_simd::prelude::*;

/// The relaxation time of the noise, s: that of the social force model of Helbing, Farkas, Vicsek (2000).
pub(super) const FORGETS: f64 = 0.5;

/// Both components.
type Vector<S> = (Doubles<S>, Doubles<S>);

/// Which of a block are agents of the model.
#[inline(always)]
fn those<S: Simd>(part: Part<S>, state: &State, block: usize, lanes: Mask) -> Truths<S> {
    let range = part.load(&state.bodies[Parameter::SwerveRange][block]);
    part.mask(state.present[block] & lanes) & range.simd_gt(part.c(0.0))
}

/// The direction: the driving direction and the sum of turns. Where both cancel, the last one stays.
#[inline(always)]
pub(super) fn turn<S: Simd>(part: Part<S>, state: &mut State, block: usize, lanes: Mask) {
    let here = those(part, state, block, lanes);
    let x = part.load(&state.driving.ex[block]) + part.load(&state.motion.fx[block]);
    let y = part.load(&state.driving.ey[block]) + part.load(&state.motion.fy[block]);
    let length = (x * x + y * y).sqrt();
    let turns = here & length.simd_gt(part.c(0.0));
    part.store_in(turns, x / length, &mut state.driving.course_x[block]);
    part.store_in(turns, y / length, &mut state.driving.course_y[block]);
}

/// The velocity: along the direction, as fast as is wanted and as the room ahead allows.
#[inline(always)]
pub(super) fn go<S: Simd>(part: Part<S>, state: &mut State, block: usize, lanes: Mask, room: &Sum) {
    let here = those(part, state, block, lanes);
    let (wanted, slowness) = (part.load(&state.driving.speed[block]), part.load(&room.slowness));
    let speed = allowed(part, wanted, slowness);
    let (x, y) = (part.load(&state.driving.course_x[block]), part.load(&state.driving.course_y[block]));
    let (go_x, go_y) = (speed * x, speed * y);
    // What is left of the velocity is its noise.
    let vx = part.load(&state.motion.vx[block]) - part.load(&state.driving.go_x[block]);
    let vy = part.load(&state.motion.vy[block]) - part.load(&state.driving.go_y[block]);
    part.store_in(here, go_x + vx, &mut state.motion.vx[block]);
    part.store_in(here, go_y + vy, &mut state.motion.vy[block]);
    part.store_in(here, go_x, &mut state.driving.go_x[block]);
    part.store_in(here, go_y, &mut state.driving.go_y[block]);
}

/// Velocities after a step: those of agents of the model keep what is left of their noise, others are given.
#[inline(always)]
pub(super) fn with_noise<S: Simd>(
    part: Part<S>,
    still: &Still<'_>,
    block: usize,
    ((vx, vy), others): (Vector<S>, Vector<S>),
    left: f64,
) -> Vector<S> {
    let here = part.load(&still.bodies[Parameter::SwerveRange][block]).simd_gt(part.c(0.0));
    let (go_x, go_y) = (part.load(&still.driving.go_x[block]), part.load(&still.driving.go_y[block]));
    let left = part.c(left);
    (here.select(go_x + (vx - go_x) * left, others.0), here.select(go_y + (vy - go_y) * left, others.1))
}
