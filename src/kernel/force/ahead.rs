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
//! *Manners.* An agent with `oncoming` o feels others (1 - o e . e') times as much: those who come towards it more than
//! those who walk along, by which streams part into lanes (the direction rule of Xu, Chraibi, Seyfried, Transp. Res. C 133,
//! 103464, 2021, weighs the same angle). With `keep_right` s, two who meet take each other for s farther to the left, so that
//! both step to the right; the shift is that of half of s to the right of each. A `berth` is a gap that the headway leaves
//! over. With `follow` f one keeps pace with who walks away: `(g/T + f v')/cos^4 phi` at most, v' the speed of the one ahead
//! along one's own way (safe speeds depend on the leader's: Gipps, Transp. Res. B 15, 105, 1981). In an even stream that is a
//! headway of T (1 - f); at a door, where those ahead get away, more than that gets through. Composure is no matter of
//! pairs: see `composure`.
//!
//! All are felt as far as the social force. With the velocities of the last half kick, the step is of first order here.

use super::pair::{AgentsInLanes, Pair, PairTerm, Push};
use crate::kernel::state::State;
use crate::kernel::vector::{Doubles, Part, larger, smaller};
use crate::model::Parameter;
use fearless_simd::Simd;
use fearless_simd::prelude::*;

/// A gap that is as good as none, m.
const NO_GAP: f64 = 1e-6;

/// The social force, looking ahead. With `SAME` the foresight of all bodies is the same; without `MANNERS` nobody has any.
#[derive(Clone, Copy, Debug)]
pub(in crate::kernel) struct Ahead<A, const SAME: bool, const MANNERS: bool>(pub(in crate::kernel) A);

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
    manners: Manners<T>,
}

/// How a body treats others beyond the social force.
#[derive(Clone, Copy)]
struct Manners<T> {
    /// Gap that it keeps to the one ahead.
    berth: T,
    /// How much more those who come towards it are felt.
    oncoming: T,
    /// Half of the way by which it keeps to the right.
    right_x: T,
    right_y: T,
    /// How much nearer it follows for each m/s of the one ahead, s.
    follow: T,
}

/// The pair at its closest approach, at most so many seconds ahead.
#[inline(always)]
fn foreseen<S: Simd>(
    part: Part<S>,
    pair: &Pair<S>,
    (dx, dy): (Doubles<S>, Doubles<S>),
    (vx, vy): (Doubles<S>, Doubles<S>),
    foresight: Doubles<S>,
) -> Pair<S> {
    let zero = part.c(0.0);
    let closing = -(dx * vx + dy * vy) / (vx * vx + vy * vy + part.c(1e-300));
    let time = smaller::<S>(foresight, larger::<S>(closing, zero));
    let touch = pair.gap + pair.distance;
    let later = Pair::new(part, (dx + vx * time, dy + vy * time), touch);
    // Who touches already is pushed as without foresight.
    let limit = larger::<S>(pair.gap, zero);
    Pair { gap: smaller::<S>(later.gap, limit), ..later }
}

#[expect(clippy::redundant_closure, reason = "only a closure can be marked for inlining")]
impl<A: PairTerm, const SAME: bool, const MANNERS: bool> PairTerm for Ahead<A, SAME, MANNERS> {
    const COUNT: usize = A::COUNT + if MANNERS { 12 } else { 7 };
    const KEEPS_HEADWAY: bool = true;
    type Of<T: Copy> = Looking<A::Of<T>, T>;

    #[inline(always)]
    fn load<T: Copy>(column: impl Fn(usize) -> T) -> Self::Of<T> {
        let term = A::load(
            #[inline(always)]
            |k| column(k),
        );
        let n = A::COUNT;
        // Without manners the numbers mean nothing, and are not read.
        let more = |k: usize| column(if MANNERS { n + k } else { n });
        let manners = Manners {
            berth: more(7),
            oncoming: more(8),
            right_x: more(9),
            right_y: more(10),
            follow: more(11),
        };
        Looking {
            term,
            manners,
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
        let Looking { vx, vy, foresight, headway, unfelt, ex, ey, manners, .. } = *of;
        let Manners { berth, oncoming, right_x, right_y, follow } = manners;
        let manners = Manners {
            berth: f(berth),
            oncoming: f(oncoming),
            right_x: f(right_x),
            right_y: f(right_y),
            follow: f(follow),
        };
        Looking {
            term,
            manners,
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
        let (ex, ey) = (towards(&state.driving.ex), towards(&state.driving.ey));
        put(n + 5, ex);
        put(n + 6, ey);
        if MANNERS {
            let aside = part.c(0.5) * agents.field(&state.bodies[Parameter::KeepRight]);
            put(n + 7, agents.field(&state.bodies[Parameter::Berth]));
            put(n + 8, agents.field(&state.bodies[Parameter::Oncoming]));
            put(n + 9, aside * ey);
            put(n + 10, -aside * ex);
            let follow = agents.field(&state.bodies[Parameter::Follow]);
            put(n + 11, follow * agents.field(&state.bodies[Parameter::Headway]));
        }
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
        // The cosine between both driving directions.
        let along = one.ex * other.ex + one.ey * other.ey;
        let mut d = (pair.dx, pair.dy);
        if MANNERS {
            // Of two who walk the same way both shifts are the same, of two who meet they add up.
            d.0 += one.manners.right_x - other.manners.right_x;
            d.1 += one.manners.right_y - other.manners.right_y;
        }
        let later = foreseen(part, pair, d, v, one.foresight);
        let (mut on_one, mut on_other) = self.force_at(part, &later, one, other);
        let to_one = (later.dx, later.dy);
        let mut to_other = to_one;
        if !SAME {
            let later = foreseen(part, pair, d, v, other.foresight);
            on_other = self.force_at(part, &later, one, other).1;
            to_other = (later.dx, later.dy);
        }
        if MANNERS {
            on_one *= part.c(1.0) - one.manners.oncoming * along;
            on_other *= part.c(1.0) - other.manners.oncoming * along;
        }
        let (on_one, on_other) = (felt_by_one.select(on_one, zero), felt_by_other.select(on_other, zero));
        let same_way = along.simd_gt(zero);
        let one_slower = slowness::<S, _, MANNERS>(part, pair, [one, other], -1.0);
        let other_slower = slowness::<S, _, MANNERS>(part, pair, [other, one], 1.0);
        Push {
            one: (on_one * to_one.0, on_one * to_one.1),
            other: (on_other * to_other.0, on_other * to_other.1),
            slowness_of_one: (same_way & felt_by_one).select(one_slower, zero),
            slowness_of_other: (same_way & felt_by_other).select(other_slower, zero),
        }
    }
}

/// The slowness that the other one of a pair imposes by the headway, s/m; `sign` is that of the way to it. In front is who
/// looks against the way between them.
#[inline(always)]
fn slowness<S: Simd, A, const MANNERS: bool>(
    part: Part<S>,
    pair: &Pair<S>,
    [of, leader]: [&Looking<A, Doubles<S>>; 2],
    sign: f64,
) -> Doubles<S> {
    let ahead = (pair.dx * of.ex + pair.dy * of.ey) * part.c(sign);
    let cosine = larger::<S>(ahead * pair.inverse, part.c(0.0));
    let square = cosine * cosine;
    if MANNERS {
        let gap = larger::<S>(-pair.gap - of.manners.berth, part.c(NO_GAP));
        let leads = larger::<S>(leader.vx * of.ex + leader.vy * of.ey, part.c(0.0));
        of.headway * square * square / (gap + of.manners.follow * leads)
    } else {
        of.headway * square * square / larger::<S>(-pair.gap, part.c(NO_GAP))
    }
}

impl<A: PairTerm, const SAME: bool, const MANNERS: bool> Ahead<A, SAME, MANNERS> {
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
