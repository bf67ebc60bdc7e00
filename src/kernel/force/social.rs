//! The social force between two bodies.
//!
//! Repulsion of a body i by a body j (Helbing, Farkas, Vicsek 2000; Given-Wilson et al. 2017, equation (3)):
//! `A_i exp((r_i + r_j - d)/B_i) Lambda n`, with n from j to i and, after Helbing and Johansson, Lambda = lambda + (1 -
//! lambda)(1 + cos phi)/2, cos phi = -n . e, e the *desired* direction (so Lambda is defined in a body that stands). It is
//! zero by definition beyond touching distance + `REACH` B, where e^-16 of the force at touch is left: so both layouts sum
//! the same pairs. A second exponential term of the same form acts between bodies alone.
//!
//! What depends on one body alone is worked out beforehand: A Lambda is `even` - n . (`ex`, `ey`), and the exponential a
//! power of two. Between two bodies of several persons the sum of both terms is bounded.

#![allow(clippy::redundant_closure, reason = "a reference to a closure is not inlined where vectors need it")]

use super::pair::{AgentsInLanes, Pair, PairTerm};
use crate::kernel::state::State;
use crate::kernel::vector::{Doubles, Part, exp2};
use crate::model::{Parameter, Particle, Scenario};
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use std::f64::consts::LOG2_E;

/// Range of the social force beyond touching distance, in units of B.
pub(super) const REACH: f64 = 16.0;

/// Largest exponent of two of a social force: what goes beyond has diverged anyway, and stays finite.
const LARGEST_POWER: f64 = 480.0;

/// 2^power, zero beyond the reach (and where an agent is absent: there the gap is minus infinity).
#[inline(always)]
pub(super) fn decay<S: Simd>(part: Part<S>, power: Doubles<S>) -> Doubles<S> {
    decay_to(part, power, part.c(-REACH * LOG2_E))
}

/// 2^power, zero where that is no more than the `least`.
#[inline(always)]
pub(super) fn decay_to<S: Simd>(part: Part<S>, power: Doubles<S>, least: Doubles<S>) -> Doubles<S> {
    let in_reach = power.simd_gt(least);
    // What `min` makes of NaN does not matter: it is not in reach.
    in_reach.select(exp2(part, power.min(part.c(LARGEST_POWER))), part.c(0.0))
}

/// One exponential term: the first, or with `SECOND` the second. With `SHARED` all bodies have the same B.
#[derive(Clone, Copy, Debug)]
pub(in crate::kernel) struct Social<const SECOND: bool, const SHARED: bool> {
    /// log2(e)/B of all, 1/m.
    rate: f64,
}

impl<const SECOND: bool> Social<SECOND, true> {
    /// Where all bodies have this B, m.
    pub(in crate::kernel) fn with_range(b: f64) -> Self {
        Self { rate: LOG2_E / b }
    }
}

impl<const SECOND: bool> Social<SECOND, false> {
    /// Where each body has its own B.
    pub(in crate::kernel) const fn with_own_ranges() -> Self {
        Self { rate: 1.0 }
    }
}

/// Numbers of a body.
#[derive(Clone, Copy)]
pub(in crate::kernel) struct Felt<T> {
    /// A (1 + lambda)/2
    even: T,
    /// A (1 - lambda)/2 times the desired direction
    ex: T,
    ey: T,
    /// log2(e)/B; means nothing where all share B.
    rate: T,
}

impl<const SECOND: bool, const SHARED: bool> PairTerm for Social<SECOND, SHARED> {
    const COUNT: usize = 4;
    type Of<T: Copy> = Felt<T>;

    #[inline(always)]
    fn load<T: Copy>(column: impl Fn(usize) -> T) -> Felt<T> {
        Felt { even: column(0), ex: column(1), ey: column(2), rate: column(3) }
    }

    #[inline(always)]
    fn map<T: Copy, U: Copy>(of: &Felt<T>, f: impl Fn(T) -> U) -> Felt<U> {
        Felt { even: f(of.even), ex: f(of.ex), ey: f(of.ey), rate: f(of.rate) }
    }

    #[inline(always)]
    fn keep<S: Simd>(
        self,
        part: Part<S>,
        state: &State,
        agents: impl AgentsInLanes<S>,
        mut put: impl FnMut(usize, Doubles<S>),
    ) {
        let (a, b, lambda) = if SECOND {
            (&state.bodies[Parameter::A2], &state.bodies[Parameter::B2], &state.bodies[Parameter::Lambda2])
        } else {
            (&state.bodies[Parameter::A], &state.bodies[Parameter::B], &state.bodies[Parameter::Lambda])
        };
        let (a, lambda) = (agents.field(a), agents.field(lambda));
        let (half, one) = (part.c(0.5), part.c(1.0));
        let odd = a * (half * (one - lambda));
        put(0, a * (half * (one + lambda)));
        put(1, odd * agents.field(&state.driving.ex));
        put(2, odd * agents.field(&state.driving.ey));
        put(3, if SHARED { one } else { part.c(LOG2_E) / agents.field(b) });
    }

    #[inline(always)]
    fn reach<S: Simd>(self, part: Part<S>, state: &State, agents: impl AgentsInLanes<S>) -> Doubles<S> {
        part.c(REACH)
            * agents.field(if SECOND { &state.bodies[Parameter::B2] } else { &state.bodies[Parameter::B] })
    }

    #[inline(always)]
    fn force<S: Simd>(
        self,
        part: Part<S>,
        pair: &Pair<S>,
        one: &Felt<Doubles<S>>,
        other: &Felt<Doubles<S>>,
    ) -> (Doubles<S>, Doubles<S>) {
        let Pair { dx, dy, inverse, gap, .. } = *pair;
        let rate = if SHARED { part.c(self.rate) } else { one.rate };
        let of_one = decay(part, gap * rate) * inverse;
        let of_other = if SHARED { of_one } else { decay(part, gap * other.rate) * inverse };
        (
            of_one * (one.even - (dx * one.ex + dy * one.ey) * inverse),
            of_other * (other.even + (dx * other.ex + dy * other.ey) * inverse),
        )
    }
}

/// Bodies of several persons, by agents: NaN in all others. Empty if there are not two of them.
#[derive(Clone, Debug, Default)]
pub(in crate::kernel) struct Particles {
    /// Factor of the bounded social force towards another such body.
    pub(in crate::kernel) repulsion: Vec<f64>,
    /// Friction constant towards another such body, kg/(m s).
    pub(in crate::kernel) friction: Vec<f64>,
}

impl Particles {
    /// Of a scenario.
    pub(super) fn new(scenario: &Scenario) -> Self {
        let particles = || scenario.agents.iter().map(|agent| agent.particle.filter(|one| one.persons > 1));
        if particles().flatten().count() < 2 {
            return Self::default();
        }
        let all = |of: fn(Particle) -> f64| particles().map(|one| one.map_or(f64::NAN, of)).collect();
        Self { repulsion: all(|one| one.repulsion), friction: all(|one| one.friction) }
    }
}

/// The social force, bounded between two bodies of several persons: F D/(F + D), which is below both F and D, where D
/// drives a body. However deep the two overlap, it holds back no body whose drive is stronger, so that groups pass
/// through each other (Given-Wilson et al. 2017, section 4.2).
#[derive(Clone, Copy, Debug)]
pub(in crate::kernel) struct Bounded<'a, T> {
    pub(in crate::kernel) term: T,
    /// As in `Particles`.
    pub(in crate::kernel) repulsion: &'a [f64],
}

/// Numbers of a body.
#[derive(Clone, Copy)]
pub(in crate::kernel) struct Driven<A, T> {
    term: A,
    /// NaN in a single person.
    repulsion: T,
    /// What drives it, m v0/tau, N.
    drive: T,
}

impl<A: PairTerm> PairTerm for Bounded<'_, A> {
    const COUNT: usize = A::COUNT + 2;
    type Of<T: Copy> = Driven<A::Of<T>, T>;

    #[inline(always)]
    fn load<T: Copy>(column: impl Fn(usize) -> T) -> Self::Of<T> {
        let term = A::load(
            #[inline(always)]
            |k| column(k),
        );
        Driven { term, repulsion: column(A::COUNT), drive: column(A::COUNT + 1) }
    }

    #[inline(always)]
    fn map<T: Copy, U: Copy>(of: &Self::Of<T>, f: impl Fn(T) -> U) -> Self::Of<U> {
        let term = A::map(
            &of.term,
            #[inline(always)]
            |number| f(number),
        );
        Driven { term, repulsion: f(of.repulsion), drive: f(of.drive) }
    }

    #[inline(always)]
    fn keep<S: Simd>(
        self,
        part: Part<S>,
        state: &State,
        agents: impl AgentsInLanes<S>,
        mut put: impl FnMut(usize, Doubles<S>),
    ) {
        self.term.keep(
            part,
            state,
            agents,
            #[inline(always)]
            |k, numbers| put(k, numbers),
        );
        let drive = agents.field(&state.bodies[Parameter::Mass])
            * agents.field(&state.bodies[Parameter::Speed])
            / agents.field(&state.bodies[Parameter::Tau]);
        put(A::COUNT, agents.of_agents(self.repulsion));
        put(A::COUNT + 1, drive.abs());
    }

    #[inline(always)]
    fn reach<S: Simd>(self, part: Part<S>, state: &State, agents: impl AgentsInLanes<S>) -> Doubles<S> {
        self.term.reach(part, state, agents)
    }

    #[inline(always)]
    fn force<S: Simd>(
        self,
        part: Part<S>,
        pair: &Pair<S>,
        one: &Self::Of<Doubles<S>>,
        other: &Self::Of<Doubles<S>>,
    ) -> (Doubles<S>, Doubles<S>) {
        let (of_one, of_other) = self.term.force(part, pair, &one.term, &other.term);
        let mean = part.c(0.5) * (one.repulsion + other.repulsion);
        let is_bounded = mean.simd_eq(mean);
        // For a body that nothing drives and nothing pushes.
        let rest = part.c(1e-300);
        let of_one_bounded =
            of_one * (one.drive / (one.drive + (of_one * pair.distance).abs() + rest)) * mean;
        let of_other_bounded =
            of_other * (other.drive / (other.drive + (of_other * pair.distance).abs() + rest)) * mean;
        (is_bounded.select(of_one_bounded, of_one), is_bounded.select(of_other_bounded, of_other))
    }
}
