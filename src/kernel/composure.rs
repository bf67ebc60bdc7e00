//! Composed agents: nobody pushes them beyond the speed that they want, and where they are held up they stand.
//!
//! Those behind push as hard as those ahead where lambda is 1. That lets a crowd flow through a door, and makes a slow person
//! in it faster than it wants. So the push may make up for what the headway takes from the driving force, and no more:
//!
//! ```text
//! F . e <= m (v0 - v)/tau      v: the driving speed that the headway leaves
//! ```
//!
//! and the noise of who is held up is v/v0 times as strong.

use super::state::Still;
use super::vector::{Doubles, Part, larger};
use crate::model::Parameter;
use fearless_simd::Simd;
use fearless_simd::prelude::*;

/// A social force as composed agents follow it: of what would make one faster than it wants, a share is left out.
#[inline(always)]
pub(super) fn followed<S: Simd>(
    part: Part<S>,
    still: &Still<'_>,
    block: usize,
    (x, y): (Doubles<S>, Doubles<S>),
    slowness: Doubles<S>,
) -> (Doubles<S>, Doubles<S>) {
    let (ex, ey) = (part.load(&still.driving.ex[block]), part.load(&still.driving.ey[block]));
    let speed = part.load(&still.driving.speed[block]);
    let body = |parameter| part.load(&still.bodies[parameter][block]);
    // The force that makes up for what the headway takes from the driving force.
    let most = body(Parameter::Mass) / body(Parameter::Tau) * (speed - allowed(part, speed, slowness));
    let beyond = larger::<S>(x * ex + y * ey - most, part.c(0.0)) * body(Parameter::Composure);
    let moves = speed.simd_gt(part.c(0.0));
    (moves.select(x - beyond * ex, x), moves.select(y - beyond * ey, y))
}

/// The driving speed that a slowness leaves.
#[inline(always)]
pub(super) fn allowed<S: Simd>(part: Part<S>, speed: Doubles<S>, slowness: Doubles<S>) -> Doubles<S> {
    (slowness * speed).simd_gt(part.c(1.0)).select(part.c(1.0) / slowness, speed)
}

/// The share of its noise that an agent has at a driving speed of which so much is left.
#[inline(always)]
pub(super) fn liveliness<S: Simd>(
    part: Part<S>,
    still: &Still<'_>,
    block: usize,
    (speed, left): (Doubles<S>, Doubles<S>),
) -> Doubles<S> {
    let one = part.c(1.0);
    let held = speed.simd_gt(part.c(0.0)).select(one - left / speed, one);
    one - part.load(&still.bodies[Parameter::Composure][block]) * held
}
