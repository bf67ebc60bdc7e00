//! A force between two bodies along the line between their centres, written once for both layouts.
//!
//! A term works out beforehand the numbers of a body that do not depend on the other one. Both layouts keep these as columns,
//! and hand those of a pair back in registers, whether the lanes are eight trials or eight agents of one trial.

#![allow(clippy::redundant_closure, reason = "a reference to a closure is not inlined where vectors need it")]

use crate::base::lanes::Lanes;
use crate::kernel::state::State;
use crate::kernel::vector::{Doubles, Part, larger};
use fearless_simd::Simd;
use fearless_simd::prelude::*;

/// A force, N, and the largest slowness that those ahead impose, s/m: 0 where nobody keeps a headway.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::kernel) struct Sum {
    pub(in crate::kernel) x: Lanes,
    pub(in crate::kernel) y: Lanes,
    pub(in crate::kernel) slowness: Lanes,
}

/// What two bodies do to each other: the force that pushes the first away and minus the force on the second, N, and the
/// slowness, one over the driving speed that it has at most, that each imposes on the other, s/m.
#[derive(Clone, Copy)]
pub(in crate::kernel) struct Push<S: Simd> {
    pub(in crate::kernel) one: (Doubles<S>, Doubles<S>),
    pub(in crate::kernel) other: (Doubles<S>, Doubles<S>),
    pub(in crate::kernel) slowness_of_one: Doubles<S>,
    pub(in crate::kernel) slowness_of_other: Doubles<S>,
}

/// The agents of the lanes.
pub(in crate::kernel) trait AgentsInLanes<S: Simd>: Copy {
    /// A field of the state.
    fn field(self, field: &[Lanes]) -> Doubles<S>;
    /// Numbers that agents have in all trials.
    fn of_agents(self, numbers: &[f64]) -> Doubles<S>;
}

/// A block of the state.
#[derive(Clone, Copy)]
pub(in crate::kernel) struct Block<S: Simd> {
    pub(in crate::kernel) part: Part<S>,
    pub(in crate::kernel) index: usize,
}

impl<S: Simd> AgentsInLanes<S> for Block<S> {
    #[inline(always)]
    fn field(self, field: &[Lanes]) -> Doubles<S> {
        self.part.load(&field[self.index])
    }

    #[inline(always)]
    fn of_agents(self, numbers: &[f64]) -> Doubles<S> {
        self.part.c(numbers[self.index])
    }
}

/// Two bodies in each lane.
#[derive(Clone, Copy)]
pub(in crate::kernel) struct Pair<S: Simd> {
    /// Way from the second to the first, m.
    pub(in crate::kernel) dx: Doubles<S>,
    pub(in crate::kernel) dy: Doubles<S>,
    /// Its length, and one over that.
    pub(in crate::kernel) distance: Doubles<S>,
    pub(super) inverse: Doubles<S>,
    /// How deep they overlap, m; minus infinity where one is absent.
    pub(in crate::kernel) gap: Doubles<S>,
}

/// Whether nobody of a pair does anything to the other one, at such a way, in any lane.
#[inline(always)]
pub(in crate::kernel) fn is_idle<S: Simd, T: PairTerm>(
    part: Part<S>,
    term: T,
    (dx, dy): (Doubles<S>, Doubles<S>),
    touch: Doubles<S>,
    margin: f64,
) -> bool {
    term.farthest(part, touch).is_some_and(
        #[inline(always)]
        |far| {
            let far = if T::FINDS_TOUCH { larger::<S>(touch + part.c(margin), far) } else { far };
            // An absent one is infinitely far from touching.
            let far = larger::<S>(far, part.c(0.0));
            !((dx * dx + dy * dy).simd_le(far * far) & touch.simd_gt(part.c(f64::NEG_INFINITY))).any_true()
        },
    )
}

impl<S: Simd> Pair<S> {
    /// Of two bodies that touch at a distance of `touch`.
    #[inline(always)]
    pub(in crate::kernel) fn new(
        part: Part<S>,
        (dx, dy): (Doubles<S>, Doubles<S>),
        touch: Doubles<S>,
    ) -> Self {
        let distance = (dx * dx + dy * dy + part.c(1e-300)).sqrt();
        Self { dx, dy, distance, inverse: part.c(1.0) / distance, gap: touch - distance }
    }
}

/// A term of the force between two bodies.
pub(in crate::kernel) trait PairTerm: Copy + Sync {
    /// How many numbers it keeps of a body.
    const COUNT: usize;
    /// Whether bodies keep a headway.
    const KEEPS_HEADWAY: bool = false;
    /// Whether those who may touch are found on the way.
    const FINDS_TOUCH: bool = true;
    /// These numbers, each as a `T`: a vector, or a column of all bodies.
    type Of<T: Copy>: Copy;

    /// Puts together what `keep` has kept.
    fn load<T: Copy>(column: impl Fn(usize) -> T) -> Self::Of<T>;

    /// The same from the lanes of one agent among those of all.
    #[inline(always)]
    fn of_agent<S: Simd>(part: Part<S>, kept: &[Lanes], agent: usize) -> Self::Of<Doubles<S>> {
        let kept = &kept[agent * Self::COUNT..][..Self::COUNT];
        Self::load(
            #[inline(always)]
            |k| part.load(&kept[k]),
        )
    }

    /// The same of each number.
    fn map<T: Copy, U: Copy>(of: &Self::Of<T>, f: impl Fn(T) -> U) -> Self::Of<U>;

    /// Works out the numbers of bodies, and hands each to `put`.
    fn keep<S: Simd>(
        self,
        part: Part<S>,
        state: &State,
        agents: impl AgentsInLanes<S>,
        put: impl FnMut(usize, Doubles<S>),
    );

    /// How far beyond touching others are felt, m.
    fn reach<S: Simd>(self, part: Part<S>, state: &State, agents: impl AgentsInLanes<S>) -> Doubles<S>;

    /// Beyond which distance of their centres bodies that touch at `touch` do nothing to each other, m. `None` if a pair
    /// costs less than to ask.
    #[inline(always)]
    fn farthest<S: Simd>(self, _part: Part<S>, _touch: Doubles<S>) -> Option<Doubles<S>> {
        None
    }

    /// The force that pushes the first body away from the second, and that which pushes the second away from the first, over
    /// their distance, N/m. Zero where the gap is minus infinity.
    fn force<S: Simd>(
        self,
        part: Part<S>,
        pair: &Pair<S>,
        one: &Self::Of<Doubles<S>>,
        other: &Self::Of<Doubles<S>>,
    ) -> (Doubles<S>, Doubles<S>);

    /// All that the two do to each other.
    #[inline(always)]
    fn push<S: Simd>(
        self,
        part: Part<S>,
        pair: &Pair<S>,
        one: &Self::Of<Doubles<S>>,
        other: &Self::Of<Doubles<S>>,
    ) -> Push<S> {
        let (on_one, on_other) = self.force(part, pair, one, other);
        Push {
            one: (on_one * pair.dx, on_one * pair.dy),
            other: (on_other * pair.dx, on_other * pair.dy),
            slowness_of_one: part.c(0.0),
            slowness_of_other: part.c(0.0),
        }
    }
}

/// Two terms.
#[derive(Clone, Copy, Debug)]
pub(in crate::kernel) struct Both<A, B>(pub(in crate::kernel) A, pub(in crate::kernel) B);

impl<A: PairTerm, B: PairTerm> PairTerm for Both<A, B> {
    const COUNT: usize = A::COUNT + B::COUNT;
    type Of<T: Copy> = (A::Of<T>, B::Of<T>);

    #[inline(always)]
    fn load<T: Copy>(column: impl Fn(usize) -> T) -> Self::Of<T> {
        (
            A::load(
                #[inline(always)]
                |k| column(k),
            ),
            B::load(
                #[inline(always)]
                |k| column(A::COUNT + k),
            ),
        )
    }

    #[inline(always)]
    fn map<T: Copy, U: Copy>(of: &Self::Of<T>, f: impl Fn(T) -> U) -> Self::Of<U> {
        (
            A::map(
                &of.0,
                #[inline(always)]
                |number| f(number),
            ),
            B::map(
                &of.1,
                #[inline(always)]
                |number| f(number),
            ),
        )
    }

    #[inline(always)]
    fn keep<S: Simd>(
        self,
        part: Part<S>,
        state: &State,
        agents: impl AgentsInLanes<S>,
        mut put: impl FnMut(usize, Doubles<S>),
    ) {
        self.0.keep(
            part,
            state,
            agents,
            #[inline(always)]
            |k, numbers| put(k, numbers),
        );
        self.1.keep(
            part,
            state,
            agents,
            #[inline(always)]
            |k, numbers| put(A::COUNT + k, numbers),
        );
    }

    #[inline(always)]
    fn reach<S: Simd>(self, part: Part<S>, state: &State, agents: impl AgentsInLanes<S>) -> Doubles<S> {
        larger::<S>(self.1.reach(part, state, agents), self.0.reach(part, state, agents))
    }

    #[inline(always)]
    fn force<S: Simd>(
        self,
        part: Part<S>,
        pair: &Pair<S>,
        one: &Self::Of<Doubles<S>>,
        other: &Self::Of<Doubles<S>>,
    ) -> (Doubles<S>, Doubles<S>) {
        let first = self.0.force(part, pair, &one.0, &other.0);
        let second = self.1.force(part, pair, &one.1, &other.1);
        (first.0 + second.0, first.1 + second.1)
    }
}
