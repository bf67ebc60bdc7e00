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
pub(in crate::kernel) fn narrow<S: Simd>(truth: Truth<S>) -> Mask {
    Mask(truth.to_bitmask() as u8)
}

/// A truth value from one bit of each lane.
#[inline(always)]
pub(in crate::kernel) fn widen<S: Simd>(simd: S, mask: Mask) -> Truth<S> {
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

/// Who is read.
#[derive(Clone, Copy, Debug)]
pub(super) enum Body {
    /// An agent; in a state of one trial the same in every lane.
    One(usize),
    /// In a state of one trial, an agent of each lane: those of a block.
    Block(usize),
    /// In a state of one trial, an agent of each lane.
    Eight([u32; LANES]),
}

impl Body {
    /// The agent of a lane, in a state of one trial.
    #[inline(always)]
    pub(super) fn agent(self, lane: usize) -> usize {
        match self {
            Self::One(agent) => agent,
            Self::Block(block) => block * LANES + lane,
            Self::Eight(agents) => agents[lane] as usize,
        }
    }
}

/// A state as eight trials, or as its only trial in all lanes (`ONE`): the same of it in each, or what eight of its
/// agents have.
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

    /// A field of whoever is read.
    #[inline(always)]
    pub(super) fn read(&self, field: &[Lanes], body: Body) -> Vector<S> {
        match body {
            Body::One(agent) => self.load(field, agent),
            Body::Block(block) => self.register(&field[block]),
            Body::Eight(agents) => {
                let of = |agent: u32| field[agent as usize / LANES].0[agent as usize % LANES];
                self.register(&Lanes(agents.map(of)))
            }
        }
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

    /// The lanes in which whoever is read is in the scene.
    #[inline(always)]
    pub(super) fn shows(&self, body: Body) -> Mask {
        match body {
            Body::One(agent) => self.present(agent),
            Body::Block(block) => self.state.present[block],
            Body::Eight(agents) => {
                let mut here = Mask::NONE;
                for (lane, agent) in agents.into_iter().enumerate() {
                    if !self.present(agent as usize).is_empty() {
                        here |= Mask::lane(lane);
                    }
                }
                here
            }
        }
    }
}
