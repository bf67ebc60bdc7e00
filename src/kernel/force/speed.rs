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
use crate::kernel::state::State;
use crate::kernel::vector::{Doubles, Part, Truths, exp2, larger, smaller};
use crate::model::Parameter;
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use std::f64::consts::LOG2_E;

/// Agents whose centres are farther away are not felt, m.
pub(super) const SIGHT: f64 = 3.0;

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
        range.simd_gt(part.c(0.0)).select(part.c(SIGHT), part.c(0.0))
    }

    #[inline(always)]
    fn force<S: Simd>(
        self,
        part: Part<S>,
        pair: &Pair<S>,
        one: &Turned<Doubles<S>>,
        other: &Turned<Doubles<S>>,
    ) -> (Doubles<S>, Doubles<S>) {
        let sees = sees(part, pair);
        let turn = |of: &Turned<Doubles<S>>| {
            let power = smaller::<S>(larger::<S>(pair.gap * of.rate, part.c(POWERS.0)), part.c(POWERS.1));
            sees.select(of.strength * exp2(part, power) * pair.inverse, part.c(0.0))
        };
        (turn(one), turn(other))
    }
}

/// The room ahead limits the speed.
#[derive(Clone, Copy, Debug)]
pub(in crate::kernel) struct Room;

/// Numbers of a body.
#[derive(Clone, Copy)]
pub(in crate::kernel) struct Going<T> {
    /// e
    ex: T,
    ey: T,
    /// T, s; 0 in a body that forces move.
    time: T,
}

impl PairTerm for Room {
    const COUNT: usize = 3;
    const KEEPS_HEADWAY: bool = true;
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
        let wide = pair.gap + pair.distance;
        let room = larger::<S>(-pair.gap, part.c(NO_GAP));
        // `ahead` is how far the other one is along the direction.
        let slowness = |of: &Going<Doubles<S>>, ahead: Doubles<S>| {
            let aside = (pair.dx * of.ey - pair.dy * of.ex).abs();
            let is_ahead = ahead.simd_ge(zero) & aside.simd_le(wide);
            (sees & is_ahead).select(of.time / room, zero)
        };
        let along = |of: &Going<Doubles<S>>| pair.dx * of.ex + pair.dy * of.ey;
        Push {
            one: (zero, zero),
            other: (zero, zero),
            slowness_of_one: slowness(one, -along(one)),
            slowness_of_other: slowness(other, along(other)),
        }
    }
}
