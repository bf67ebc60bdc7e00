//! Looking ahead: the social force of where two bodies will be, and the headway that a body keeps.
//!
//! *Foresight.* A body with a foresight s feels the social force (with its second term) of the place where it and the other
//! one are nearest to each other, if both keep their velocities, but at most s seconds ahead: n and d are those of
//! `dx + dv t`, `t = min(s, max(0, -dx . dv / dv^2))`, and the bodies overlap by no more than touching. People who walk side
//! by side feel what they felt before; people who are about to collide step aside while there is time (the force at the
//! closest approach is that of Zanlungo, Ikeda, Kanda, EPL 93, 68005, 2011, who take the earliest approach of all).
//!
//! *Headway.* A body with a headway T drives itself no faster than it could stop within T of what is ahead: at
//! `g / (T cos^4 phi)` at most, g the gap to another one in the direction phi from its driving direction, for each other in
//! front who drives itself the same way (e . e' > 0). In single file that is the required length of Seyfried, Steffen, Lippert (Physica A
//! 368, 232, 2006), which grows with the speed, as a limit of the driving speed (Tordeux, Chraibi, Seyfried, arXiv
//! 1512.05597); cos^4 lets it end gradually at the side. It pushes nobody back, so that a stream of people
//! with lambda = 1 slows down and never walks backwards. Those who stand or come towards one are passed by the social force.
//!
//! Both are felt as far as the social force. With the velocities of the last half kick, the step is of first order here.

use super::pair::{AgentsInLanes, Pair, PairTerm, Push};
use crate::kernel::state::State;
use crate::kernel::vector::{Doubles, Part, larger, smaller};
use crate::model::Parameter;
use fearless_simd::Simd;
use fearless_simd::prelude::*;

/// A gap that is as good as none, m.
const NO_GAP: f64 = 1e-6;

/// The social force, looking ahead. With `SAME` the foresight of all bodies is the same.
#[derive(Clone, Copy, Debug)]
pub(in crate::kernel) struct Ahead<A, const SAME: bool>(pub(in crate::kernel) A);

/// Numbers of a body.
#[derive(Clone, Copy)]
pub(in crate::kernel) struct Looking<A, T> {
    term: A,
    vx: T,
    vy: T,
    foresight: T,
    headway: T,
    /// Minus the distance beyond touching from which on it feels nobody, m.
    unfelt: T,
    /// Driving direction; none in a body that stands.
    ex: T,
    ey: T,
}

/// The pair at its closest approach, at most so many seconds ahead.
#[inline(always)]
fn foreseen<S: Simd>(
    part: Part<S>,
    pair: &Pair<S>,
    (vx, vy): (Doubles<S>, Doubles<S>),
    foresight: Doubles<S>,
) -> Pair<S> {
    let zero = part.c(0.0);
    let closing = -(pair.dx * vx + pair.dy * vy) / (vx * vx + vy * vy + part.c(1e-300));
    let time = smaller::<S>(foresight, larger::<S>(closing, zero));
    let touch = pair.gap + pair.distance;
    let later = Pair::new(part, (pair.dx + vx * time, pair.dy + vy * time), touch);
    // Who touches already is pushed as without foresight.
    let limit = larger::<S>(pair.gap, zero);
    Pair { gap: smaller::<S>(later.gap, limit), ..later }
}

#[expect(clippy::redundant_closure, reason = "only a closure can be marked for inlining")]
impl<A: PairTerm, const SAME: bool> PairTerm for Ahead<A, SAME> {
    const COUNT: usize = A::COUNT + 7;
    const KEEPS_HEADWAY: bool = true;
    type Of<T: Copy> = Looking<A::Of<T>, T>;

    #[inline(always)]
    fn load<T: Copy>(column: impl Fn(usize) -> T) -> Self::Of<T> {
        let term = A::load(
            #[inline(always)]
            |k| column(k),
        );
        let n = A::COUNT;
        Looking {
            term,
            vx: column(n),
            vy: column(n + 1),
            foresight: column(n + 2),
            headway: column(n + 3),
            unfelt: column(n + 4),
            ex: column(n + 5),
            ey: column(n + 6),
        }
    }

    #[inline(always)]
    fn map<T: Copy, U: Copy>(of: &Self::Of<T>, f: impl Fn(T) -> U) -> Self::Of<U> {
        let term = A::map(
            &of.term,
            #[inline(always)]
            |number| f(number),
        );
        let Looking { vx, vy, foresight, headway, unfelt, ex, ey, .. } = *of;
        Looking {
            term,
            vx: f(vx),
            vy: f(vy),
            foresight: f(foresight),
            headway: f(headway),
            unfelt: f(unfelt),
            ex: f(ex),
            ey: f(ey),
        }
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
        let moves = agents.field(&state.driving.speed).simd_gt(part.c(0.0));
        let towards = |field| moves.select(agents.field(field), part.c(0.0));
        let n = A::COUNT;
        put(n, agents.field(&state.motion.vx));
        put(n + 1, agents.field(&state.motion.vy));
        put(n + 2, agents.field(&state.bodies[Parameter::Foresight]));
        put(n + 3, agents.field(&state.bodies[Parameter::Headway]));
        put(n + 4, -self.0.reach(part, state, agents));
        put(n + 5, towards(&state.driving.ex));
        put(n + 6, towards(&state.driving.ey));
    }

    #[inline(always)]
    fn reach<S: Simd>(self, part: Part<S>, state: &State, agents: impl AgentsInLanes<S>) -> Doubles<S> {
        self.0.reach(part, state, agents)
    }

    #[inline(always)]
    fn force<S: Simd>(
        self,
        part: Part<S>,
        pair: &Pair<S>,
        one: &Self::Of<Doubles<S>>,
        other: &Self::Of<Doubles<S>>,
    ) -> (Doubles<S>, Doubles<S>) {
        self.0.force(part, pair, &one.term, &other.term)
    }

    #[inline(always)]
    fn push<S: Simd>(
        self,
        part: Part<S>,
        pair: &Pair<S>,
        one: &Self::Of<Doubles<S>>,
        other: &Self::Of<Doubles<S>>,
    ) -> Push<S> {
        let v = (one.vx - other.vx, one.vy - other.vy);
        let zero = part.c(0.0);
        let (felt_by_one, felt_by_other) = (pair.gap.simd_gt(one.unfelt), pair.gap.simd_gt(other.unfelt));
        let later = foreseen(part, pair, v, one.foresight);
        let (on_one, mut on_other) = self.force_at(part, &later, one, other);
        let mut way = (later.dx, later.dy);
        let on_one = felt_by_one.select(on_one, zero);
        let push = (on_one * way.0, on_one * way.1);
        if !SAME {
            let later = foreseen(part, pair, v, other.foresight);
            on_other = self.force_at(part, &later, one, other).1;
            way = (later.dx, later.dy);
        }
        let on_other = felt_by_other.select(on_other, zero);
        let push_back = (on_other * way.0, on_other * way.1);
        // In front is the other one of who looks against the way between them.
        let gap = larger::<S>(-pair.gap, part.c(NO_GAP));
        let same_way = (one.ex * other.ex + one.ey * other.ey).simd_gt(zero);
        let slowness = |of: &Self::Of<Doubles<S>>, ahead: Doubles<S>| {
            let cosine = larger::<S>(ahead * pair.inverse, zero);
            let square = cosine * cosine;
            of.headway * square * square / gap
        };
        let along = |of: &Self::Of<Doubles<S>>| pair.dx * of.ex + pair.dy * of.ey;
        Push {
            one: push,
            other: push_back,
            slowness_of_one: (same_way & felt_by_one).select(slowness(one, -along(one)), zero),
            slowness_of_other: (same_way & felt_by_other).select(slowness(other, along(other)), zero),
        }
    }
}

impl<A: PairTerm, const SAME: bool> Ahead<A, SAME> {
    #[inline(always)]
    fn force_at<S: Simd>(
        self,
        part: Part<S>,
        pair: &Pair<S>,
        one: &<Self as PairTerm>::Of<Doubles<S>>,
        other: &<Self as PairTerm>::Of<Doubles<S>>,
    ) -> (Doubles<S>, Doubles<S>) {
        self.0.force(part, pair, &one.term, &other.term)
    }
}
