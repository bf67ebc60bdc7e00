//! Forces where one lane is one trial: all pairs of agents, eight trials at once.
//!
//! Newton's third law serves twice: one distance and (with shared B) one exponential for both bodies of a
//! pair. Sums run over the other agents in ascending order. A list of the pairs that can reach each other
//! in *any* lane is kept from step to step, with a skin, as Verlet 1967 did; a pair beyond the reach adds
//! exactly zero, so the list changes no bit, and nothing of one lane is felt in another.

use super::contact::Contacts;
use super::forces::{Forces, REACH};
use super::program::Program;
use super::state::State;
use super::vector::{bits, exp2, larger, load, mask, smaller, splat, store};
use crate::base::lanes::{LANES, Lanes, Mask};
use crate::base::random::TrialKey;
use fearless_simd::prelude::*;
use fearless_simd::{Simd, f64x8};
use std::f64::consts::LOG2_E;

/// Way that an agent may go before the list is made anew, m; twice that is added to the reach.
const SLACK: f64 = 0.2;

/// Largest exponent of two of a social force: what goes beyond has diverged anyway, and stays finite.
pub(super) const LARGEST_POWER: f64 = 480.0;

/// An agent as the forces see it.
#[derive(Clone, Copy, Debug, Default)]
struct Walker {
    x: Lanes,
    y: Lanes,
    /// Radius; minus infinity where the agent is absent, so that it is beyond the reach of everybody.
    r: Lanes,
    term: Term,
}

/// One exponential term: A Lambda = `even` - n . (`ex`, `ey`).
#[derive(Clone, Copy, Debug, Default)]
struct Term {
    /// A (1 + lambda)/2
    even: Lanes,
    /// A (1 - lambda)/2 times the desired direction
    ex: Lanes,
    ey: Lanes,
    /// log2(e)/B
    rate: Lanes,
}

/// A force, N.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sum {
    pub(super) x: Lanes,
    pub(super) y: Lanes,
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
    seconds: Vec<Term>,
    neighbours: Neighbours,
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
            self.find_neighbours(simd, forces, state);
        }
        sums.clear();
        sums.resize(state.agents, Sum::default());
        contacts.clear(state.agents);
        match (forces.shared, forces.second) {
            (Some(shared), false) => {
                self.pairs::<S, true, false>(simd, forces, shared, sums, contacts);
            }
            (Some(shared), true) => self.pairs::<S, true, true>(simd, forces, shared, sums, contacts),
            (None, false) => self.pairs::<S, false, false>(simd, forces, (1.0, 1.0), sums, contacts),
            (None, true) => self.pairs::<S, false, true>(simd, forces, (1.0, 1.0), sums, contacts),
        }
        self.walls(simd, forces, state, sums, contacts);
        cohesion(simd, forces, state, sums);
    }

    #[inline(always)]
    fn prepare<S: Simd>(&mut self, simd: S, forces: &Forces, state: &State) {
        let half = splat(simd, 0.5);
        let one = splat(simd, 1.0);
        let log2_e = splat(simd, LOG2_E);
        self.walkers.resize(state.agents, Walker::default());
        if forces.second {
            self.seconds.resize(state.agents, Term::default());
        }
        let term = |a: &Lanes, lambda: &Lanes, b: &Lanes, ex: f64x8<S>, ey: f64x8<S>, out: &mut Term| {
            let (a, lambda) = (load(simd, a), load(simd, lambda));
            let odd = a * (half * (one - lambda));
            store(a * (half * (one + lambda)), &mut out.even);
            store(odd * ex, &mut out.ex);
            store(odd * ey, &mut out.ey);
            if forces.shared.is_none() {
                store(log2_e / load(simd, b), &mut out.rate);
            }
        };
        for (i, walker) in self.walkers.iter_mut().enumerate() {
            walker.x = state.x[i];
            walker.y = state.y[i];
            let here = mask(simd, state.present[i] & state.occupied);
            store(here.select(load(simd, &state.radius[i]), splat(simd, f64::NEG_INFINITY)), &mut walker.r);
            let (ex, ey) = (load(simd, &state.ex[i]), load(simd, &state.ey[i]));
            term(&state.a[i], &state.lambda[i], &state.b[i], ex, ey, &mut walker.term);
            if forces.second {
                term(&state.a2[i], &state.lambda2[i], &state.b2[i], ex, ey, &mut self.seconds[i]);
            }
        }
    }

    #[inline(always)]
    fn is_outdated<S: Simd>(&mut self, simd: S, state: &State) -> bool {
        let old = &self.neighbours;
        if self.stale || old.x.len() != state.agents || old.keys != state.keys {
            return true;
        }
        let mut farthest = splat(simd, 0.0);
        let mut newcomers = Mask::NONE;
        for i in 0..state.agents {
            let here = state.present[i] & state.occupied;
            newcomers |= here & !old.present[i];
            let dx = load(simd, &state.x[i]) - load(simd, &old.x[i]);
            let dy = load(simd, &state.y[i]) - load(simd, &old.y[i]);
            farthest = larger(dx * dx + dy * dy, farthest);
        }
        !newcomers.is_empty() || farthest.simd_gt(splat(simd, SLACK * SLACK)).any_true()
    }

    #[inline(always)]
    fn find_neighbours<S: Simd>(&mut self, simd: S, forces: &Forces, state: &State) {
        let list = &mut self.neighbours;
        self.stale = false;
        list.keys = state.keys;
        list.x.clone_from(&state.x);
        list.y.clone_from(&state.y);
        list.present.clear();
        list.present.extend(state.present.iter().map(|&here| here & state.occupied));
        list.first.clear();
        list.others.clear();
        list.first_surface.clear();
        list.surfaces.clear();
        let reach = splat(simd, REACH);
        let reach_of = |i: usize| {
            let mut range = load(simd, &state.b[i]);
            if forces.second {
                range = larger(range, load(simd, &state.b2[i]));
            }
            larger(reach * range, splat(simd, forces.margin)) + splat(simd, 2.0 * SLACK)
        };
        for (i, walker) in self.walkers.iter().enumerate() {
            let (x, y, r) = (load(simd, &walker.x), load(simd, &walker.y), load(simd, &walker.r));
            let own = reach_of(i);
            list.first.push(list.others.len() as u32);
            for (j, other) in self.walkers.iter().enumerate().skip(i + 1) {
                let dx = x - load(simd, &other.x);
                let dy = y - load(simd, &other.y);
                let limit = r + load(simd, &other.r) + larger(own, reach_of(j));
                let limit = larger(limit, splat(simd, 0.0));
                if (dx * dx + dy * dy).simd_lt(limit * limit).any_true() {
                    list.others.push(j as u32);
                }
            }
            list.first_surface.push(list.surfaces.len() as u32);
            for (k, surface) in forces.surfaces.iter().enumerate() {
                let limit = larger(r + own, splat(simd, 0.0));
                if surface.squared_distance_to_bounds(simd, x, y).simd_lt(limit * limit).any_true() {
                    list.surfaces.push(k as u32);
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
        let (rate, rate2) = (splat(simd, LOG2_E / shared.0), splat(simd, LOG2_E / shared.1));
        let tiny = splat(simd, 1e-300);
        let one = splat(simd, 1.0);
        let minus_margin = splat(simd, -forces.margin);
        for i in 0..n {
            let w = &walkers[i];
            let (x, y, r) = (load(simd, &w.x), load(simd, &w.y), load(simd, &w.r));
            let own = Loaded::of(simd, &w.term);
            let own2 = if SECOND { Loaded::of(simd, &seconds[i]) } else { own };
            let (mut fx, mut fy) = (load(simd, &sums[i].x), load(simd, &sums[i].y));
            for &j in &self.neighbours.others[first[i] as usize..first[i + 1] as usize] {
                let o = &walkers[j as usize];
                let dx = x - load(simd, &o.x);
                let dy = y - load(simd, &o.y);
                let d = (dx * dx + dy * dy + tiny).sqrt();
                let q = one / d;
                let gap = r + load(simd, &o.r) - d;
                let touching = gap.simd_gt(minus_margin);
                if touching.any_true() {
                    contacts.push_pair(i as u32, j, bits(touching));
                }
                let theirs = Loaded::of(simd, &o.term);
                let (mut on_i, mut on_j) = if SHARED {
                    let e = decay(simd, gap * rate) * q;
                    (e * own.towards(dx, dy, q), e * theirs.away(dx, dy, q))
                } else {
                    let factor = q * splat(simd, forces.factor(i, j as usize));
                    (
                        decay(simd, gap * own.rate) * factor * own.towards(dx, dy, q),
                        decay(simd, gap * theirs.rate) * factor * theirs.away(dx, dy, q),
                    )
                };
                if SECOND {
                    let theirs2 = Loaded::of(simd, &seconds[j as usize]);
                    if SHARED {
                        let e = decay(simd, gap * rate2) * q;
                        on_i += e * own2.towards(dx, dy, q);
                        on_j += e * theirs2.away(dx, dy, q);
                    } else {
                        let factor = q * splat(simd, forces.factor(i, j as usize));
                        on_i += decay(simd, gap * own2.rate) * factor * own2.towards(dx, dy, q);
                        on_j += decay(simd, gap * theirs2.rate) * factor * theirs2.away(dx, dy, q);
                    }
                }
                fx += on_i * dx;
                fy += on_i * dy;
                let sum = &mut sums[j as usize];
                store(load(simd, &sum.x) - on_j * dx, &mut sum.x);
                store(load(simd, &sum.y) - on_j * dy, &mut sum.y);
            }
            store(fx, &mut sums[i].x);
            store(fy, &mut sums[i].y);
        }
    }

    #[inline(always)]
    fn walls<S: Simd>(
        &self,
        simd: S,
        forces: &Forces,
        state: &State,
        sums: &mut [Sum],
        contacts: &mut Contacts,
    ) {
        let list = &self.neighbours;
        let minus_margin = splat(simd, -forces.margin);
        for (i, walker) in self.walkers.iter().enumerate() {
            let near = &list.surfaces[list.first_surface[i] as usize..list.first_surface[i + 1] as usize];
            if near.is_empty() {
                continue;
            }
            let (x, y, r) = (load(simd, &walker.x), load(simd, &walker.y), load(simd, &walker.r));
            let a = load(simd, &state.a[i]);
            let rate = splat(simd, LOG2_E) / load(simd, &state.b[i]);
            let (mut fx, mut fy) = (load(simd, &sums[i].x), load(simd, &sums[i].y));
            for &k in near {
                let nearest = forces.surfaces[k as usize].nearest(simd, x, y);
                let gap = r - nearest.distance;
                let touching = gap.simd_gt(minus_margin);
                if touching.any_true() {
                    contacts.push_wall(i as u32, k, bits(touching));
                }
                let f = a * decay(simd, gap * rate);
                fx += f * nearest.nx;
                fy += f * nearest.ny;
            }
            store(fx, &mut sums[i].x);
            store(fy, &mut sums[i].y);
        }
    }
}

/// A term in registers.
#[derive(Clone, Copy)]
struct Loaded<S: Simd> {
    even: f64x8<S>,
    ex: f64x8<S>,
    ey: f64x8<S>,
    rate: f64x8<S>,
}

impl<S: Simd> Loaded<S> {
    #[inline(always)]
    fn of(simd: S, term: &Term) -> Self {
        Self {
            even: load(simd, &term.even),
            ex: load(simd, &term.ex),
            ey: load(simd, &term.ey),
            rate: load(simd, &term.rate),
        }
    }

    /// A Lambda in a body that the vector (dx, dy) = n/q points to.
    #[inline(always)]
    fn towards(&self, dx: f64x8<S>, dy: f64x8<S>, q: f64x8<S>) -> f64x8<S> {
        self.even - (dx * self.ex + dy * self.ey) * q
    }

    /// A Lambda in a body that it points away from.
    #[inline(always)]
    fn away(&self, dx: f64x8<S>, dy: f64x8<S>, q: f64x8<S>) -> f64x8<S> {
        self.even + (dx * self.ex + dy * self.ey) * q
    }
}

/// 2^power, zero beyond the reach (and where an agent is absent: there the gap is minus infinity).
#[inline(always)]
pub(super) fn decay<S: Simd>(simd: S, power: f64x8<S>) -> f64x8<S> {
    let in_reach = power.simd_gt(splat(simd, -REACH * LOG2_E));
    in_reach.select(exp2(simd, smaller(power, splat(simd, LARGEST_POWER))), splat(simd, 0.0))
}

/// Attraction within groups (Moussaid, Perozo, Garnier, Helbing, Theraulaz 2010): a constant force towards
/// the centroid of the n members present, on those farther than (n - 1)/2 m from it.
#[inline(always)]
pub(super) fn cohesion<S: Simd>(simd: S, forces: &Forces, state: &State, sums: &mut [Sum]) {
    let c = |value: f64| splat(simd, value);
    for group in &forces.groups {
        let (mut n, mut cx, mut cy) = (c(0.0), c(0.0), c(0.0));
        for &member in &group.members {
            let i = member as usize;
            let here = mask(simd, state.present_in(i) & state.occupied);
            n += here.select(c(1.0), c(0.0));
            cx += here.select(load(simd, &state.lanes_of(&state.x, i)), c(0.0));
            cy += here.select(load(simd, &state.lanes_of(&state.y, i)), c(0.0));
        }
        let some = n.simd_gt(c(0.0)).select(n, c(1.0));
        let (cx, cy) = (cx / some, cy / some);
        let free = c(0.5) * (n - c(1.0));
        for &member in &group.members {
            let i = member as usize;
            let here = mask(simd, state.present_in(i) & state.occupied);
            let dx = cx - load(simd, &state.lanes_of(&state.x, i));
            let dy = cy - load(simd, &state.lanes_of(&state.y, i));
            let d = (dx * dx + dy * dy).sqrt();
            let pulled = d.simd_gt(free) & d.simd_gt(c(0.0)) & here;
            let pull = pulled.select(c(group.attraction) / pulled.select(d, c(1.0)), c(0.0));
            let (px, py) = (pull * dx, pull * dy);
            let slot = state.slot(i, 0);
            match state.layout {
                super::state::Layout::Trials => {
                    let sum = &mut sums[slot.block];
                    store(load(simd, &sum.x) + px, &mut sum.x);
                    store(load(simd, &sum.y) + py, &mut sum.y);
                }
                super::state::Layout::Agents => {
                    let sum = &mut sums[slot.block];
                    sum.x.0[slot.lane] += px.to_array()[0];
                    sum.y.0[slot.lane] += py.to_array()[0];
                }
            }
        }
    }
}
