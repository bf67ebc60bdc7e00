//! Forces where one lane is one trial: all pairs of agents, eight trials at once.
//!
//! Newton's third law serves twice: one distance and (with shared B) one exponential for both bodies of a
//! pair. Sums run over the other agents in ascending order. A list of the pairs that can reach each other
//! in *any* lane is kept from step to step, with a skin, as Verlet 1967 did; a pair beyond the reach adds
//! exactly zero, so the list changes no bit, and nothing of one lane is felt in another.

use super::contact::Contacts;
use super::forces::{Forces, REACH};
use super::nearby::amply_around;
use super::program::Program;
use super::social::{Sum, Term, bounded, cohesion, repel};
use super::state::State;
use super::surfaces::{self, Bodies};
use super::vector::{Doubles, Part, larger, parts};
use crate::base::geometry::{Bounds, Vec2};
use crate::base::lanes::{LANES, Lanes, Mask};
use crate::base::math::at_least;
use crate::base::random::TrialKey;
use crate::model::Parameter;
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use std::f64::consts::LOG2_E;

/// Way that an agent may go before the list is made anew, m; twice that is added to the reach.
const SLACK: f64 = 0.12;

/// An agent as the forces see it.
#[derive(Clone, Copy, Debug, Default)]
struct Walker {
    x: Lanes,
    y: Lanes,
    /// Radius; minus infinity where the agent is absent, so that it is beyond the reach of everybody.
    r: Lanes,
    term: Kept,
}

/// A `Term` of an agent.
#[derive(Clone, Copy, Debug, Default)]
struct Kept {
    even: Lanes,
    ex: Lanes,
    ey: Lanes,
    /// Means nothing where all share B.
    rate: Lanes,
}

impl Kept {
    /// From A and lambda, B where it is needed, and the desired direction.
    #[inline(always)]
    fn fill<S: Simd>(
        &mut self,
        part: Part<S>,
        (a, lambda): (&Lanes, &Lanes),
        b: Option<&Lanes>,
        (ex, ey): (&Lanes, &Lanes),
    ) {
        let b = b.map(|b| part.load(b));
        let e = (part.load(ex), part.load(ey));
        let term = Term::new(part, (part.load(a), part.load(lambda)), b, e);
        part.store(term.even, &mut self.even);
        part.store(term.ex, &mut self.ex);
        part.store(term.ey, &mut self.ey);
        if b.is_some() {
            part.store(term.rate, &mut self.rate);
        }
    }

    /// Into registers; `rate` is that of all where they share one.
    #[inline(always)]
    fn load<S: Simd>(&self, part: Part<S>, rate: Option<Doubles<S>>) -> Term<S> {
        Term {
            even: part.load(&self.even),
            ex: part.load(&self.ex),
            ey: part.load(&self.ey),
            rate: rate.unwrap_or_else(|| part.load(&self.rate)),
        }
    }
}

/// Who can reach whom, at the positions where it was made.
#[derive(Clone, Debug, Default)]
struct Neighbours {
    /// Where the list of each agent starts; one more at the end.
    first: Vec<u32>,
    others: Vec<u32>,
    first_surface: Vec<u32>,
    surfaces: Vec<u32>,
    x: Vec<Lanes>,
    y: Vec<Lanes>,
    present: Vec<Mask>,
    keys: [TrialKey; LANES],
}

/// Room for the forces of a batch of trials.
#[derive(Clone, Debug, Default)]
pub(super) struct Lanewise {
    walkers: Vec<Walker>,
    seconds: Vec<Kept>,
    /// What drives each body, m v0/tau, N. Empty without two bodies of several persons.
    drives: Vec<Lanes>,
    neighbours: Neighbours,
    /// How far beyond touching each body is felt or may be touched, with the skin, m.
    reaches: Vec<Lanes>,
    room: Vec<u32>,
    faces: surfaces::Room,
    stale: bool,
}

impl Lanewise {
    /// Another trial was loaded: its bodies have other radii.
    pub(super) fn forget(&mut self) {
        self.stale = true;
    }

    /// Forces at the present positions into `sums`, and who may touch whom into `contacts`.
    #[inline(always)]
    pub(super) fn forces<S: Simd>(
        &mut self,
        simd: S,
        program: &Program,
        state: &State,
        sums: &mut Vec<Sum>,
        contacts: &mut Contacts,
    ) {
        let forces = &program.forces;
        self.prepare(simd, forces, state);
        if self.is_outdated(simd, state) {
            simd.vectorize(
                #[inline(always)]
                || self.find_neighbours(simd, forces, state),
            );
        }
        sums.clear();
        sums.resize(state.agents, Sum::default());
        contacts.clear();
        let all = forces.shared.unwrap_or((1.0, 1.0));
        // A function each: four loops in one would share its registers badly.
        match (forces.shared.is_some(), forces.second) {
            (true, false) => simd.vectorize(
                #[inline(always)]
                || self.pairs::<S, true, false>(simd, forces, all, sums, contacts),
            ),
            (true, true) => simd.vectorize(
                #[inline(always)]
                || self.pairs::<S, true, true>(simd, forces, all, sums, contacts),
            ),
            (false, false) => simd.vectorize(
                #[inline(always)]
                || self.pairs::<S, false, false>(simd, forces, all, sums, contacts),
            ),
            (false, true) => simd.vectorize(
                #[inline(always)]
                || self.pairs::<S, false, true>(simd, forces, all, sums, contacts),
            ),
        }
        simd.vectorize(
            #[inline(always)]
            || self.walls(simd, forces, state, sums, contacts),
        );
        cohesion(forces, state, sums);
    }

    #[inline(always)]
    fn prepare<S: Simd>(&mut self, simd: S, forces: &Forces, state: &State) {
        self.walkers.resize(state.agents, Walker::default());
        if forces.second {
            self.seconds.resize(state.agents, Kept::default());
        }
        self.drives.resize(forces.ties.len(), Lanes::ZERO);
        for (i, drive) in self.drives.iter_mut().enumerate() {
            for part in parts(simd) {
                let of = |field: &[Lanes]| part.load(&field[i]);
                part.store(
                    (of(&state.bodies[Parameter::Mass]) * of(&state.bodies[Parameter::Speed])
                        / of(&state.bodies[Parameter::Tau]))
                    .abs(),
                    drive,
                );
            }
        }
        for (i, walker) in self.walkers.iter_mut().enumerate() {
            walker.x = state.motion.x[i];
            walker.y = state.motion.y[i];
            for part in parts(simd) {
                let here = part.mask(state.present[i] & state.occupied);
                let radius =
                    here.select(part.load(&state.bodies[Parameter::Radius][i]), part.c(f64::NEG_INFINITY));
                part.store(radius, &mut walker.r);
                let e = (&state.driving.ex[i], &state.driving.ey[i]);
                let own = forces.shared.is_none();
                walker.term.fill(
                    part,
                    (&state.bodies[Parameter::A][i], &state.bodies[Parameter::Lambda][i]),
                    own.then_some(&state.bodies[Parameter::B][i]),
                    e,
                );
                if let Some(second) = self.seconds.get_mut(i) {
                    second.fill(
                        part,
                        (&state.bodies[Parameter::A2][i], &state.bodies[Parameter::Lambda2][i]),
                        own.then_some(&state.bodies[Parameter::B2][i]),
                        e,
                    );
                }
            }
        }
    }

    #[inline(always)]
    fn is_outdated<S: Simd>(&mut self, simd: S, state: &State) -> bool {
        let old = &self.neighbours;
        if self.stale || old.x.len() != state.agents || old.keys != state.keys {
            return true;
        }
        let mut newcomers = Mask::NONE;
        for (&now, &then) in state.present.iter().zip(&old.present) {
            newcomers |= now & state.occupied & !then;
        }
        if !newcomers.is_empty() {
            return true;
        }
        for part in parts(simd) {
            let mut farthest = part.c(0.0);
            for i in 0..state.agents {
                let dx = part.load(&state.motion.x[i]) - part.load(&old.x[i]);
                let dy = part.load(&state.motion.y[i]) - part.load(&old.y[i]);
                farthest = larger::<S>(dx * dx + dy * dy, farthest);
            }
            if farthest.simd_gt(part.c(SLACK * SLACK)).any_true() {
                return true;
            }
        }
        false
    }

    #[inline(always)]
    fn find_neighbours<S: Simd>(&mut self, simd: S, forces: &Forces, state: &State) {
        let list = &mut self.neighbours;
        self.stale = false;
        list.keys = state.keys;
        list.x.clone_from(&state.motion.x);
        list.y.clone_from(&state.motion.y);
        list.present.clear();
        list.present.extend(state.present.iter().map(|&here| here & state.occupied));
        list.first.clear();
        list.others.clear();
        list.first_surface.clear();
        list.surfaces.clear();
        let reaches = &mut self.reaches;
        reaches.resize(state.agents, Lanes::ZERO);
        for (i, reach) in reaches.iter_mut().enumerate() {
            for part in parts(simd) {
                let mut range = part.load(&state.bodies[Parameter::B][i]);
                if forces.second {
                    range = larger::<S>(range, part.load(&state.bodies[Parameter::B2][i]));
                }
                let far = larger::<S>(part.c(REACH) * range, part.c(forces.margin));
                part.store(far + part.c(2.0 * SLACK), reach);
            }
        }
        for (i, one) in self.walkers.iter().enumerate() {
            list.first.push(list.others.len() as u32);
            for (j, other) in self.walkers.iter().enumerate().skip(i + 1) {
                let mut near = false;
                for part in parts(simd) {
                    let dx = part.load(&one.x) - part.load(&other.x);
                    let dy = part.load(&one.y) - part.load(&other.y);
                    let touch = part.load(&one.r) + part.load(&other.r);
                    let reach = larger::<S>(part.load(&reaches[i]), part.load(&reaches[j]));
                    let limit = larger::<S>(touch + reach, part.c(0.0));
                    near |= (dx * dx + dy * dy).simd_lt(limit * limit).any_true();
                }
                if near {
                    list.others.push(j as u32);
                }
            }
            list.first_surface.push(list.surfaces.len() as u32);
            let around = around(one, &reaches[i]);
            for &k in forces.surfaces.nearby.find(&around, &mut self.room) {
                let mut near = false;
                for part in parts(simd) {
                    let limit = larger::<S>(part.load(&one.r) + part.load(&reaches[i]), part.c(0.0));
                    let (x, y) = (part.load(&one.x), part.load(&one.y));
                    let square = forces.surfaces.squared_distance_to_bounds(k, part, x, y);
                    near |= square.simd_lt(limit * limit).any_true();
                }
                if near {
                    list.surfaces.push(k);
                }
            }
        }
        list.first.push(list.others.len() as u32);
        list.first_surface.push(list.surfaces.len() as u32);
    }

    /// Social forces between agents. With `SHARED` one B for all; with `SECOND` the second term too.
    #[inline(always)]
    fn pairs<S: Simd, const SHARED: bool, const SECOND: bool>(
        &self,
        simd: S,
        forces: &Forces,
        shared: (f64, f64),
        sums: &mut [Sum],
        contacts: &mut Contacts,
    ) {
        let n = self.walkers.len();
        let walkers = &self.walkers[..n];
        let seconds = if SECOND { &self.seconds[..n] } else { &[] };
        let sums = &mut sums[..n];
        let first = &self.neighbours.first[..=n];
        for part in parts(simd) {
            let rate = SHARED.then(|| part.c(LOG2_E / shared.0));
            let rate2 = SHARED.then(|| part.c(LOG2_E / shared.1));
            let minus_margin = part.c(-forces.margin);
            for i in 0..n {
                let w = &walkers[i];
                let (x, y, r) = (part.load(&w.x), part.load(&w.y), part.load(&w.r));
                let own = w.term.load(part, rate);
                let own2 = if SECOND { seconds[i].load(part, rate2) } else { own };
                let (mut fx, mut fy) = (part.load(&sums[i].x), part.load(&sums[i].y));
                for &j in &self.neighbours.others[first[i] as usize..first[i + 1] as usize] {
                    let o = &walkers[j as usize];
                    let dx = x - part.load(&o.x);
                    let dy = y - part.load(&o.y);
                    let d = (dx * dx + dy * dy + part.c(1e-300)).sqrt();
                    let q = part.c(1.0) / d;
                    let gap = r + part.load(&o.r) - d;
                    let touching = gap.simd_gt(minus_margin);
                    if touching.any_true() {
                        contacts.push_pair(i as u32, j, part.bits(touching));
                    }
                    let theirs = o.term.load(part, rate);
                    let (mut on_i, mut on_j) = repel::<S, SHARED>(part, gap, (dx, dy), q, (&own, &theirs));
                    if SECOND {
                        let theirs = seconds[j as usize].load(part, rate2);
                        let more = repel::<S, SHARED>(part, gap, (dx, dy), q, (&own2, &theirs));
                        on_i += more.0;
                        on_j += more.1;
                    }
                    // Without a shared B: bodies of several persons may be among them.
                    if !SHARED && let Some(repulsion) = forces.repulsion(i, j as usize) {
                        let drive = |k: usize| part.load(&self.drives[k]);
                        on_i = bounded(part, on_i, d, drive(i)) * part.c(repulsion);
                        on_j = bounded(part, on_j, d, drive(j as usize)) * part.c(repulsion);
                    }
                    fx += on_i * dx;
                    fy += on_i * dy;
                    let sum = &mut sums[j as usize];
                    part.store(part.load(&sum.x) - on_j * dx, &mut sum.x);
                    part.store(part.load(&sum.y) - on_j * dy, &mut sum.y);
                }
                part.store(fx, &mut sums[i].x);
                part.store(fy, &mut sums[i].y);
            }
        }
    }

    #[inline(always)]
    fn walls<S: Simd>(
        &mut self,
        simd: S,
        forces: &Forces,
        state: &State,
        sums: &mut [Sum],
        contacts: &mut Contacts,
    ) {
        let (list, surfaces) = (&self.neighbours, &forces.surfaces);
        for (i, walker) in self.walkers.iter().enumerate() {
            let near = &list.surfaces[list.first_surface[i] as usize..list.first_surface[i + 1] as usize];
            if near.is_empty() {
                continue;
            }
            for part in parts(simd) {
                let (x, y, r) = (part.load(&walker.x), part.load(&walker.y), part.load(&walker.r));
                let a = part.load(&state.bodies[Parameter::A][i]);
                let rate = match forces.shared {
                    Some((b, _)) => part.c(LOG2_E / b),
                    None => part.load(&walker.term.rate),
                };
                let (mut fx, mut fy) = (part.load(&sums[i].x), part.load(&sums[i].y));
                let bodies = Bodies { place: (x, y), r, a, rate };
                let touching = |k, lanes| contacts.push_wall(i as u32, k, part.bits(lanes));
                let (wx, wy) = surfaces.push(part, near, &bodies, forces.margin, &mut self.faces, touching);
                fx += wx;
                fy += wy;
                part.store(fx, &mut sums[i].x);
                part.store(fy, &mut sums[i].y);
            }
        }
    }
}

/// A rectangle around all that an agent can reach in any lane, amply.
fn around(one: &Walker, reach: &Lanes) -> Bounds {
    let mut low = Vec2::repeat(f64::INFINITY);
    let mut high = Vec2::repeat(f64::NEG_INFINITY);
    for lane in 0..LANES {
        let at = Vec2::new(one.x.0[lane], one.y.0[lane]);
        let reach = at_least(one.r.0[lane] + reach.0[lane], 0.0);
        let here = amply_around(at, reach);
        // Where something is no number, nothing is in reach.
        low = low.inf(&here.low);
        high = high.sup(&here.high);
    }
    Bounds { low, high }
}
