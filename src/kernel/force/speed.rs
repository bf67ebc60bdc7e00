//! The collision-free speed model: others turn the direction of an agent, and the room ahead limits its speed.
//!
//! Tordeux, Chraibi, Seyfried, "Collision-free speed model for pedestrian dynamics", Traffic and Granular Flow '15, 225
//! (2016), in the second version of `JuPedSim` 1.4.2, in which each agent has numbers of its own. It is of first order:
//! from one state to the next an agent has the velocity `v e`,
//!
//! ```text
//! e = (e0 + sum over others of a exp((r + r_j - d_j)/D) n_j + sum over walls of a_w exp((r - d_w)/D_w) n_w) / |...|
//! v = min(v0, max(0, s/T))
//! ```
//!
//! with n from the other one to the agent, and s the least gap `d_j - r - r_j` to those ahead: in front of the agent along e,
//! and no farther to the side than the two radii together. Nobody is felt beyond [`SIGHT`] or behind a wall. A speed is
//! never negative and never above the wanted one, so nobody is pushed; a crowd clogs where nobody can go on.
//!
//! Two terms of pairs: [`Swerve`] sums the direction, and [`Room`], once that is known, the slowness `T/s`.

use super::pair::{AgentsInLanes, Pair, PairTerm, Push};
use crate::base::lanes::LANES;
use crate::base::math::at_least;
use crate::kernel::state::State;
use crate::kernel::vector::{Doubles, Part, Truths, exp2, larger, smaller};
use crate::model::Parameter;
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use std::f64::consts::LOG2_E;

/// Agents whose centres are farther away are not felt, m.
pub(super) const SIGHT: f64 = 3.0;

/// Walls are felt as far as this, in their ranges: as far as a turn changes a double.
const WALLS_AT: f64 = 37.0;

/// For what rounding may take off a distance.
const AMPLY: f64 = 1.0 + 1e-9;

/// A gap that is no gap, m: whoever has it stands.
const NO_GAP: f64 = 1e-300;

/// Powers of two that are numbers.
const POWERS: (f64, f64) = (-1000.0, 480.0);

/// Where the two of a pair see each other; one that a wall hides is infinitely far away.
#[inline(always)]
fn sees<S: Simd>(part: Part<S>, pair: &Pair<S>) -> Truths<S> {
    pair.distance.simd_le(part.c(SIGHT)) & pair.gap.simd_gt(part.c(-SIGHT))
}

/// Others turn the direction.
#[derive(Clone, Copy, Debug)]
pub(in crate::kernel) struct Swerve;

/// Numbers of a body.
#[derive(Clone, Copy)]
pub(in crate::kernel) struct Turned<T> {
    /// a; 0 in a body that forces move.
    strength: T,
    /// log2(e)/D, 1/m.
    rate: T,
}

/// How much the other one of a pair turns the direction where both touch at the strength of 1.
#[inline(always)]
fn turn<S: Simd>(part: Part<S>, pair: &Pair<S>, rate: Doubles<S>) -> Doubles<S> {
    exp2(part, smaller::<S>(larger::<S>(pair.gap * rate, part.c(POWERS.0)), part.c(POWERS.1)))
}

impl PairTerm for Swerve {
    const COUNT: usize = 2;
    type Of<T: Copy> = Turned<T>;

    #[inline(always)]
    fn load<T: Copy>(column: impl Fn(usize) -> T) -> Turned<T> {
        Turned { strength: column(0), rate: column(1) }
    }

    #[inline(always)]
    fn map<T: Copy, U: Copy>(of: &Turned<T>, f: impl Fn(T) -> U) -> Turned<U> {
        Turned { strength: f(of.strength), rate: f(of.rate) }
    }

    #[inline(always)]
    fn keep<S: Simd>(
        self,
        part: Part<S>,
        state: &State,
        agents: impl AgentsInLanes<S>,
        mut put: impl FnMut(usize, Doubles<S>),
    ) {
        let range = agents.field(&state.bodies[Parameter::SwerveRange]);
        let rate = part.c(LOG2_E) / range;
        put(0, agents.field(&state.bodies[Parameter::Swerve]));
        put(1, range.simd_gt(part.c(0.0)).select(rate, part.c(1.0)));
    }

    #[inline(always)]
    fn reach<S: Simd>(self, part: Part<S>, state: &State, agents: impl AgentsInLanes<S>) -> Doubles<S> {
        let range = agents.field(&state.bodies[Parameter::SwerveRange]);
        // Less the own radius: two that see each other are no farther beyond touching.
        let others = part.c(SIGHT) - agents.field(&state.bodies[Parameter::Radius]);
        let walls = part.c(WALLS_AT) * agents.field(&state.bodies[Parameter::WallRange]);
        range.simd_gt(part.c(0.0)).select(larger::<S>(walls, others), part.c(0.0))
    }

    #[inline(always)]
    fn farthest<S: Simd>(self, part: Part<S>, _: Doubles<S>) -> Option<Doubles<S>> {
        Some(part.c(SIGHT * AMPLY))
    }

    #[inline(always)]
    fn force<S: Simd>(
        self,
        part: Part<S>,
        pair: &Pair<S>,
        one: &Turned<Doubles<S>>,
        other: &Turned<Doubles<S>>,
    ) -> (Doubles<S>, Doubles<S>) {
        let (sees, zero) = (sees(part, pair), part.c(0.0));
        let on_one = turn(part, pair, one.rate);
        // Most have the same range: then one exponential serves both.
        let is_shared = one.rate.simd_eq(other.rate).all_true();
        let on_other = if is_shared { on_one } else { turn(part, pair, other.rate) };
        (
            sees.select(one.strength * on_one * pair.inverse, zero),
            sees.select(other.strength * on_other * pair.inverse, zero),
        )
    }
}

/// The room ahead limits the speed.
#[derive(Clone, Copy, Debug)]
pub(in crate::kernel) struct Room {
    /// The largest gap that limits the speed of anybody, v0 T, m.
    gap: f64,
}

impl Room {
    /// Among the agents of a state.
    pub(in crate::kernel) fn of(state: &State) -> Self {
        let times = &state.bodies[Parameter::TimeGap];
        let gaps = state
            .driving
            .speed
            .iter()
            .zip(times)
            .flat_map(|(speed, time)| (0..LANES).map(|lane| speed.0[lane] * time.0[lane]));
        Self { gap: gaps.fold(0.0, at_least) * AMPLY }
    }
}

/// Numbers of a body.
#[derive(Clone, Copy)]
pub(in crate::kernel) struct Going<T> {
    /// e
    ex: T,
    ey: T,
    /// T, s; 0 in a body that forces move.
    time: T,
}

/// The slowness that the other one of a pair imposes, s/m, where it is in front: so far along the direction, with `sign` for
/// the way to it, and no farther to the side than both radii.
#[inline(always)]
fn slowness<S: Simd>(
    part: Part<S>,
    pair: &Pair<S>,
    sees: Truths<S>,
    sign: f64,
    of: &Going<Doubles<S>>,
) -> Doubles<S> {
    let ahead = (pair.dx * of.ex + pair.dy * of.ey) * part.c(sign);
    let aside = (pair.dx * of.ey - pair.dy * of.ex).abs();
    let meets = ahead.simd_ge(part.c(0.0)) & aside.simd_le(pair.gap + pair.distance);
    (sees & meets).select(of.time / larger::<S>(-pair.gap, part.c(NO_GAP)), part.c(0.0))
}

impl PairTerm for Room {
    const COUNT: usize = 3;
    const KEEPS_HEADWAY: bool = true;
    const FINDS_TOUCH: bool = false;
    type Of<T: Copy> = Going<T>;

    #[inline(always)]
    fn load<T: Copy>(column: impl Fn(usize) -> T) -> Going<T> {
        Going { ex: column(0), ey: column(1), time: column(2) }
    }

    #[inline(always)]
    fn map<T: Copy, U: Copy>(of: &Going<T>, f: impl Fn(T) -> U) -> Going<U> {
        Going { ex: f(of.ex), ey: f(of.ey), time: f(of.time) }
    }

    #[inline(always)]
    fn keep<S: Simd>(
        self,
        _: Part<S>,
        state: &State,
        agents: impl AgentsInLanes<S>,
        mut put: impl FnMut(usize, Doubles<S>),
    ) {
        put(0, agents.field(&state.driving.course_x));
        put(1, agents.field(&state.driving.course_y));
        put(2, agents.field(&state.bodies[Parameter::TimeGap]));
    }

    #[inline(always)]
    fn reach<S: Simd>(self, part: Part<S>, state: &State, agents: impl AgentsInLanes<S>) -> Doubles<S> {
        Swerve.reach(part, state, agents)
    }

    #[inline(always)]
    fn farthest<S: Simd>(self, part: Part<S>, touch: Doubles<S>) -> Option<Doubles<S>> {
        Some(touch + part.c(self.gap))
    }

    #[inline(always)]
    fn force<S: Simd>(
        self,
        part: Part<S>,
        _: &Pair<S>,
        _: &Going<Doubles<S>>,
        _: &Going<Doubles<S>>,
    ) -> (Doubles<S>, Doubles<S>) {
        (part.c(0.0), part.c(0.0))
    }

    #[inline(always)]
    fn push<S: Simd>(
        self,
        part: Part<S>,
        pair: &Pair<S>,
        one: &Going<Doubles<S>>,
        other: &Going<Doubles<S>>,
    ) -> Push<S> {
        let zero = part.c(0.0);
        let sees = sees(part, pair);
        Push {
            one: (zero, zero),
            other: (zero, zero),
            slowness_of_one: slowness(part, pair, sees, -1.0, one),
            slowness_of_other: slowness(part, pair, sees, 1.0, other),
        }
    }
}
