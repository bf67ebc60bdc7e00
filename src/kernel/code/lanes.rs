//! Eight lanes as one vector of the machine, and a state seen through it.

use crate::base::lanes::{LANES, Lanes, Mask};
use crate::kernel::state::State;
use fearless_simd::{Simd, f64x8, mask64x8, prelude::*};

/// A number of each lane.
pub(crate) type Vector<S> = f64x8<S>;
/// A truth value of each lane.
pub(crate) type Truth<S> = mask64x8<S>;

/// One bit of each lane.
#[inline(always)]
pub(super) fn narrow<S: Simd>(truth: Truth<S>) -> Mask {
    Mask(truth.to_bitmask() as u8)
}

/// A truth value from one bit of each lane.
#[inline(always)]
pub(super) fn widen<S: Simd>(simd: S, mask: Mask) -> Truth<S> {
    Truth::<S>::from_bitmask(simd, u64::from(mask.0))
}

/// The smaller of two; NaN where one is.
#[inline(always)]
pub(super) fn lesser<S: Simd>(a: Vector<S>, b: Vector<S>) -> Vector<S> {
    // Compare and select: what the machine's own minimum does with a NaN differs between machines.
    (b.simd_lt(a) | b.is_nan()).select(b, a)
}

/// The larger of two; NaN where one is.
#[inline(always)]
pub(super) fn greater<S: Simd>(a: Vector<S>, b: Vector<S>) -> Vector<S> {
    (b.simd_gt(a) | b.is_nan()).select(b, a)
}

/// Lane by lane, for functions that are not vector code.
#[inline(always)]
pub(super) fn by_lane<S: Simd>(mut a: Vector<S>, f: impl Fn(f64) -> f64) -> Vector<S> {
    for k in 0..LANES {
        a[k] = f(a[k]);
    }
    a
}

/// Lane by lane, of two numbers.
#[inline(always)]
pub(super) fn by_lane_of_two<S: Simd>(
    mut a: Vector<S>,
    b: Vector<S>,
    f: impl Fn(f64, f64) -> f64,
) -> Vector<S> {
    for k in 0..LANES {
        a[k] = f(a[k], b[k]);
    }
    a
}

/// A state as eight trials, or as its only trial in all lanes (`ONE`).
#[derive(Clone, Copy)]
pub(super) struct View<'a, S: Simd, const ONE: bool> {
    pub(super) simd: S,
    pub(super) state: &'a State,
    /// Lanes without a trial: whatever is there counts as present, so that full lanes are the rule.
    idle: Mask,
}

impl<'a, S: Simd, const ONE: bool> View<'a, S, ONE> {
    #[inline(always)]
    pub(super) fn new(simd: S, state: &'a State) -> Self {
        Self { simd, state, idle: if ONE { Mask::NONE } else { !state.occupied } }
    }

    /// The same number in every lane.
    #[inline(always)]
    pub(super) fn splat(&self, value: f64) -> Vector<S> {
        Vector::splat(self.simd, value)
    }

    /// A register.
    #[inline(always)]
    pub(super) fn register(&self, lanes: &Lanes) -> Vector<S> {
        Vector::from_slice(self.simd, &lanes.0)
    }

    /// A field of an agent.
    #[inline(always)]
    pub(super) fn load(&self, field: &[Lanes], agent: usize) -> Vector<S> {
        if ONE { self.splat(field[agent / LANES].0[agent % LANES]) } else { self.register(&field[agent]) }
    }

    /// The lanes in which an agent is in the scene.
    #[inline(always)]
    pub(super) fn present(&self, agent: usize) -> Mask {
        if !ONE {
            self.state.present[agent] | self.idle
        } else if self.state.present[agent / LANES].has(agent % LANES) {
            Mask::ALL
        } else {
            Mask::NONE
        }
    }
}
