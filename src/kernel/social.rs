//! The social force between two bodies, for both layouts, and the attraction within groups.
//!
//! A Lambda exp(gap/B) n of `forces`, with what hangs on one body alone worked out beforehand: A Lambda is
//! `even` - n . (`ex`, `ey`), and the exponential a power of two.

use super::forces::{Forces, REACH};
use super::state::State;
use super::vector::{Doubles, Part, exp2};
use crate::base::geometry::Vec2;
use crate::base::lanes::Lanes;
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use std::f64::consts::LOG2_E;

/// Largest exponent of two of a social force: what goes beyond has diverged anyway, and stays finite.
const LARGEST_POWER: f64 = 480.0;

/// A force, N.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sum {
    pub(super) x: Lanes,
    pub(super) y: Lanes,
}

/// One exponential term of bodies.
#[derive(Clone, Copy)]
pub(super) struct Term<S: Simd> {
    /// A (1 + lambda)/2
    pub(super) even: Doubles<S>,
    /// A (1 - lambda)/2 times the desired direction
    pub(super) ex: Doubles<S>,
    pub(super) ey: Doubles<S>,
    /// log2(e)/B
    pub(super) rate: Doubles<S>,
}

impl<S: Simd> Term<S> {
    /// From A and lambda, B where it is needed, and the desired direction.
    #[inline(always)]
    pub(super) fn new(
        part: Part<S>,
        (a, lambda): (Doubles<S>, Doubles<S>),
        b: Option<Doubles<S>>,
        (ex, ey): (Doubles<S>, Doubles<S>),
    ) -> Self {
        let (half, one) = (part.c(0.5), part.c(1.0));
        let odd = a * (half * (one - lambda));
        let rate = b.map_or(one, |b| part.c(LOG2_E) / b);
        Self { even: a * (half * (one + lambda)), ex: odd * ex, ey: odd * ey, rate }
    }

    /// A Lambda in a body that the vector (dx, dy) = n/q points to.
    #[inline(always)]
    fn towards(&self, dx: Doubles<S>, dy: Doubles<S>, q: Doubles<S>) -> Doubles<S> {
        self.even - (dx * self.ex + dy * self.ey) * q
    }

    /// A Lambda in a body that it points away from.
    #[inline(always)]
    fn away(&self, dx: Doubles<S>, dy: Doubles<S>, q: Doubles<S>) -> Doubles<S> {
        self.even + (dx * self.ex + dy * self.ey) * q
    }
}

/// Force on the first and on the second of a pair over their distance 1/q; `gap` is their overlap,
/// (dx, dy) = n/q points from the second to the first. With `SHARED` both have the first one's B.
#[inline(always)]
pub(super) fn repel<S: Simd, const SHARED: bool>(
    part: Part<S>,
    gap: Doubles<S>,
    (dx, dy): (Doubles<S>, Doubles<S>),
    q: Doubles<S>,
    (one, other): (&Term<S>, &Term<S>),
) -> (Doubles<S>, Doubles<S>) {
    let e = decay(part, gap * one.rate) * q;
    let e2 = if SHARED { e } else { decay(part, gap * other.rate) * q };
    (e * one.towards(dx, dy, q), e2 * other.away(dx, dy, q))
}

/// The social force F of one body of several persons on another, where D drives that one: F D/(F + D), which is below
/// both. However deep the two overlap, it holds nobody back whose drive is stronger, so that groups pass through each
/// other (Given-Wilson et al. 2017, section 4.2). F is given, and handed back, over the distance.
#[inline(always)]
pub(super) fn bounded<S: Simd>(
    part: Part<S>,
    force: Doubles<S>,
    distance: Doubles<S>,
    drive: Doubles<S>,
) -> Doubles<S> {
    // The last term is for a body that nothing drives and nothing pushes.
    force * (drive / (drive + (force * distance).abs() + part.c(1e-300)))
}

/// Whether `decay` of some lane is above zero.
#[inline(always)]
pub(super) fn is_in_reach<S: Simd>(part: Part<S>, power: Doubles<S>) -> bool {
    power.simd_gt(part.c(-REACH * LOG2_E)).any_true()
}

/// 2^power, zero beyond the reach (and where an agent is absent: there the gap is minus infinity).
#[inline(always)]
pub(super) fn decay<S: Simd>(part: Part<S>, power: Doubles<S>) -> Doubles<S> {
    let in_reach = power.simd_gt(part.c(-REACH * LOG2_E));
    // What `min` makes of NaN does not matter: it is not in reach.
    in_reach.select(exp2(part, power.min(part.c(LARGEST_POWER))), part.c(0.0))
}

/// Attraction within groups (Moussaid, Perozo, Garnier, Helbing, Theraulaz 2010): a constant force towards
/// the centroid of the n members present, on those farther than (n - 1)/2 m from it. Scalar: groups are
/// few, and this is the same for both layouts.
pub(super) fn cohesion(forces: &Forces, state: &State, sums: &mut [Sum]) {
    for group in &forces.groups {
        for lane in state.occupied.iter() {
            let place = |member: u32| {
                let slot = state.slot(member as usize, lane);
                let here = state.present[slot.block].has(slot.lane);
                here.then(|| {
                    (
                        slot,
                        Vec2::new(
                            state.motion.x[slot.block].0[slot.lane],
                            state.motion.y[slot.block].0[slot.lane],
                        ),
                    )
                })
            };
            let (mut n, mut sum) = (0.0, Vec2::zeros());
            for (_, at) in group.members.iter().filter_map(|&member| place(member)) {
                n += 1.0;
                sum += at;
            }
            for (slot, at) in group.members.iter().filter_map(|&member| place(member)) {
                let way = sum / n - at;
                let distance = way.dot(&way).sqrt();
                if distance > 0.0 && distance > 0.5 * (n - 1.0) {
                    let pull = way * (group.attraction / distance);
                    sums[slot.block].x.0[slot.lane] += pull.x;
                    sums[slot.block].y.0[slot.lane] += pull.y;
                }
            }
        }
    }
}
