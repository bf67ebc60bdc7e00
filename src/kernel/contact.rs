//! Bodies in contact: the fast force, advanced in sub-steps.
//!
//! Where two bodies (or a body and a wall) overlap by g > 0, compression k1 g pushes them apart and
//! sliding friction k2 g slows their relative tangential velocity (Helbing, Farkas, Vicsek 2000;
//! Given-Wilson et al. 2017, equations (4) to (6), each term once). Both are stiff: friction relaxes
//! within milliseconds. So the drift of a step is not a straight line for such bodies but the flow of
//! contact alone (reversible multiple time steps, Tuckerman, Berne, Martyna 1992), taken in sub-steps of
//! position Verlet: half a drift, friction, compression, friction, half a drift. Friction is solved
//! exactly pair by pair: over a time t the relative tangential speed of a pair decays by
//! `exp(-k2 g (1/m_i + 1/m_j) t)`, at a wall by exp(-k2 g t/m). It can therefore never reverse a slip, and
//! never adds energy. Pairs are visited in order and then in reverse order, which keeps it symmetric.
//!
//! The constants of a pair are the means of the two bodies'. Two bodies of several persons do not
//! compress each other and have their own friction constant.
//!
//! Everything here is scalar and looks at one lane at a time: which bodies take sub-steps, how many, and
//! in what order depends on that lane alone.

use super::program::Program;
use super::state::{Slot, State};
use crate::base::geometry::Vec2;
use crate::base::lanes::{LANES, Lanes, Mask};
use crate::base::math;

/// Frequency of the stiffest contact times the sub-step: an eighteenth of its period at most (2 pi / 0.35).
const PHASE: f64 = 0.35;
/// Contacts of one body in a dense packing stiffen each other by about this factor.
const PACKING: f64 = 4.0;
/// More would help nobody: such constants diverge.
const MOST_SUBSTEPS: f64 = 1000.0;
const NOBODY: u32 = u32::MAX;

/// A body that moves in sub-steps.
#[derive(Clone, Copy, Debug)]
struct Body {
    slot: Slot,
    x: Vec2,
    v: Vec2,
    /// One over the mass, 1/kg.
    inverse: f64,
    radius: f64,
    k1: f64,
    k2: f64,
}

/// Two bodies, or a body and a surface, that may touch.
#[derive(Clone, Copy, Debug)]
struct Pair {
    a: u32,
    /// The other body, or `NOBODY` at a surface.
    b: u32,
    surface: u32,
    touch: f64,
    k1: f64,
    k2: f64,
    /// Sum of the inverse masses.
    inverse: f64,
}

/// An overlap during a sub-step.
#[derive(Clone, Copy, Debug)]
struct Overlap {
    pair: u32,
    normal: Vec2,
    gap: f64,
    /// Share of the slip that half a sub-step takes away.
    share: f64,
}

/// Candidates of contact of each lane, and room to work.
#[derive(Clone, Debug, Default)]
pub(super) struct Contacts {
    pairs: [Vec<(u32, u32)>; LANES],
    walls: [Vec<(u32, u32)>; LANES],
    parent: Vec<u32>,
    hot: Vec<bool>,
    place: Vec<u32>,
    bodies: Vec<Body>,
    near: Vec<Pair>,
    overlaps: Vec<Overlap>,
}

impl Contacts {
    /// Forgets all candidates.
    pub(super) fn clear(&mut self, agents: usize) {
        for list in self.pairs.iter_mut().chain(&mut self.walls) {
            list.clear();
        }
        self.parent.resize(agents, 0);
        self.hot.resize(agents, false);
        self.place.resize(agents, NOBODY);
    }

    /// Whether there is no candidate in any lane.
    pub(super) fn is_empty(&self) -> bool {
        self.pairs.iter().chain(&self.walls).all(Vec::is_empty)
    }

    /// Agents `i` and `j` may touch within a step in these lanes.
    #[inline]
    pub(super) fn push_pair(&mut self, i: u32, j: u32, lanes: Mask) {
        for lane in lanes.iter() {
            self.pairs[lane].push((i, j));
        }
    }

    /// Agent `i` may touch surface `surface` within a step in these lanes.
    #[inline]
    pub(super) fn push_wall(&mut self, i: u32, surface: u32, lanes: Mask) {
        for lane in lanes.iter() {
            self.walls[lane].push((i, surface));
        }
    }

    /// Puts the candidates of the only trial into ascending order: they were found in an order that
    /// depends on the width of the machine's vectors.
    pub(super) fn arrange(&mut self) {
        self.pairs[0].sort_unstable();
        self.walls[0].sort_unstable();
    }

    /// Moves, over `h` seconds, all bodies that touch something or may be touched by someone who does,
    /// and marks them in `moved`. All others are free: the caller drifts them.
    pub(super) fn advance(&mut self, program: &Program, state: &mut State, moved: &mut [Mask], h: f64) {
        for lane in state.occupied.iter() {
            let some = !(self.pairs[lane].is_empty() && self.walls[lane].is_empty());
            if some && self.mark_touching(program, state, lane, h) {
                self.gather(program, state, lane);
                self.flow(program, h);
                for body in &self.bodies {
                    let Slot { block, lane } = body.slot;
                    state.x[block].0[lane] = body.x.x;
                    state.y[block].0[lane] = body.x.y;
                    state.vx[block].0[lane] = body.v.x;
                    state.vy[block].0[lane] = body.v.y;
                    moved[block] |= Mask::lane(lane);
                }
            }
        }
    }

    /// Whether anything in the lane can touch within `h` seconds; if so, marks the bodies concerned: all
    /// that hang together by candidates with a pair that can.
    fn mark_touching(&mut self, program: &Program, state: &State, lane: usize, h: f64) -> bool {
        let mut any = false;
        for &(i, j) in &self.pairs[lane] {
            self.parent[i as usize] = i;
            self.parent[j as usize] = j;
            self.hot[i as usize] = false;
            self.hot[j as usize] = false;
        }
        for &(i, _) in &self.walls[lane] {
            self.parent[i as usize] = i;
            self.hot[i as usize] = false;
        }
        for &(i, j) in &self.pairs[lane] {
            let (a, b) = (state.slot(i as usize, lane), state.slot(j as usize, lane));
            if !(state.present[a.block].has(a.lane) && state.present[b.block].has(b.lane)) {
                continue;
            }
            let d = at(&state.x, &state.y, a) - at(&state.x, &state.y, b);
            let v = at(&state.vx, &state.vy, a) - at(&state.vx, &state.vy, b);
            let reach = state.radius[a.block].0[a.lane] + state.radius[b.block].0[b.lane] + length(v) * h;
            if d.dot(&d) < reach * reach {
                self.hot[i as usize] = true;
                any = true;
            }
        }
        for &(i, surface) in &self.walls[lane] {
            let a = state.slot(i as usize, lane);
            if !state.present[a.block].has(a.lane) {
                continue;
            }
            let (_, distance) =
                program.forces.surfaces[surface as usize].nearest_to(at(&state.x, &state.y, a));
            if distance < state.radius[a.block].0[a.lane] + length(at(&state.vx, &state.vy, a)) * h {
                self.hot[i as usize] = true;
                any = true;
            }
        }
        if !any {
            return false;
        }
        for k in 0..self.pairs[lane].len() {
            let (i, j) = self.pairs[lane][k];
            let (a, b) = (self.root(i), self.root(j));
            // The smaller index stays the root and takes the mark over.
            let (low, high) = if a < b { (a, b) } else { (b, a) };
            self.parent[high as usize] = low;
            self.hot[low as usize] |= self.hot[high as usize];
        }
        true
    }

    fn root(&mut self, agent: u32) -> u32 {
        let mut root = agent;
        while self.parent[root as usize] != root {
            let above = self.parent[self.parent[root as usize] as usize];
            self.parent[root as usize] = above;
            root = above;
        }
        root
    }

    /// Collects the marked bodies of a lane and the pairs that they form.
    fn gather(&mut self, program: &Program, state: &State, lane: usize) {
        self.bodies.clear();
        self.near.clear();
        for &(i, j) in &self.pairs[lane] {
            self.place[i as usize] = NOBODY;
            self.place[j as usize] = NOBODY;
        }
        for &(i, _) in &self.walls[lane] {
            self.place[i as usize] = NOBODY;
        }
        for k in 0..self.pairs[lane].len() {
            let (i, j) = self.pairs[lane][k];
            let root = self.root(i) as usize;
            if !self.hot[root] {
                continue;
            }
            let (Some(a), Some(b)) = (self.body(state, i, lane), self.body(state, j, lane)) else { continue };
            let (one, other) = (&self.bodies[a as usize], &self.bodies[b as usize]);
            let (k1, k2) = match program.forces.friction(i as usize, j as usize) {
                Some(friction) => (0.0, friction),
                None => (0.5 * (one.k1 + other.k1), 0.5 * (one.k2 + other.k2)),
            };
            let (touch, inverse) = (one.radius + other.radius, one.inverse + other.inverse);
            self.near.push(Pair { a, b, surface: 0, touch, k1, k2, inverse });
        }
        for k in 0..self.walls[lane].len() {
            let (i, surface) = self.walls[lane][k];
            let root = self.root(i) as usize;
            if !self.hot[root] {
                continue;
            }
            let Some(a) = self.body(state, i, lane) else { continue };
            let one = &self.bodies[a as usize];
            let (touch, k1, k2, inverse) = (one.radius, one.k1, one.k2, one.inverse);
            self.near.push(Pair { a, b: NOBODY, surface, touch, k1, k2, inverse });
        }
    }

    /// Place of an agent's body among those collected; `None` if it is absent.
    fn body(&mut self, state: &State, agent: u32, lane: usize) -> Option<u32> {
        let slot = state.slot(agent as usize, lane);
        if !state.present[slot.block].has(slot.lane) {
            return None;
        }
        if self.place[agent as usize] == NOBODY {
            self.place[agent as usize] = self.bodies.len() as u32;
            self.bodies.push(Body {
                slot,
                x: at(&state.x, &state.y, slot),
                v: at(&state.vx, &state.vy, slot),
                inverse: 1.0 / state.mass[slot.block].0[slot.lane],
                radius: state.radius[slot.block].0[slot.lane],
                k1: state.k1[slot.block].0[slot.lane],
                k2: state.k2[slot.block].0[slot.lane],
            });
        }
        Some(self.place[agent as usize])
    }

    /// The flow of contact over `h` seconds.
    fn flow(&mut self, program: &Program, h: f64) {
        let mut stiffest = 0.0;
        for pair in &self.near {
            stiffest = math::at_least(pair.k1 * pair.inverse, stiffest);
        }
        let wanted = (h * (PACKING * stiffest).sqrt() / PHASE).ceil();
        let count = math::at_most(math::at_least(wanted, 1.0), MOST_SUBSTEPS) as u32;
        let t = h / f64::from(count);
        self.drift(0.5 * t);
        for k in 0..count {
            self.find_overlaps(program, 0.5 * t);
            for o in 0..self.overlaps.len() {
                self.rub(o);
            }
            for o in 0..self.overlaps.len() {
                self.press(o, t);
            }
            for o in (0..self.overlaps.len()).rev() {
                self.rub(o);
            }
            self.drift(if k + 1 < count { t } else { 0.5 * t });
        }
    }

    fn drift(&mut self, t: f64) {
        for body in &mut self.bodies {
            body.x += body.v * t;
        }
    }

    fn find_overlaps(&mut self, program: &Program, half: f64) {
        self.overlaps.clear();
        for (k, pair) in self.near.iter().enumerate() {
            let x = self.bodies[pair.a as usize].x;
            let (normal, distance) = if pair.b == NOBODY {
                program.forces.surfaces[pair.surface as usize].nearest_to(x)
            } else {
                let d = x - self.bodies[pair.b as usize].x;
                let square = d.dot(&d);
                if square >= pair.touch * pair.touch {
                    continue;
                }
                let distance = (square + 1e-300).sqrt();
                (d / distance, distance)
            };
            let gap = pair.touch - distance;
            if gap > 0.0 {
                let share = 1.0 - math::exp(-pair.k2 * gap * pair.inverse * half);
                self.overlaps.push(Overlap { pair: k as u32, normal, gap, share });
            }
        }
    }

    /// Friction of one overlap over half a sub-step.
    fn rub(&mut self, overlap: usize) {
        let Overlap { pair, normal, share, .. } = self.overlaps[overlap];
        let pair = self.near[pair as usize];
        let tangent = Vec2::new(-normal.y, normal.x);
        let slip = self.relative_velocity(pair).dot(&tangent);
        self.exchange(pair, tangent * (-slip * share / pair.inverse));
    }

    /// Compression of one overlap over a sub-step.
    fn press(&mut self, overlap: usize, t: f64) {
        let Overlap { pair, normal, gap, .. } = self.overlaps[overlap];
        let pair = self.near[pair as usize];
        self.exchange(pair, normal * (pair.k1 * gap * t));
    }

    fn relative_velocity(&self, pair: Pair) -> Vec2 {
        let v = self.bodies[pair.a as usize].v;
        if pair.b == NOBODY { v } else { v - self.bodies[pair.b as usize].v }
    }

    /// Gives the first body of a pair an impulse and the second, if it is one, the opposite.
    fn exchange(&mut self, pair: Pair, impulse: Vec2) {
        let a = &mut self.bodies[pair.a as usize];
        a.v += impulse * a.inverse;
        if pair.b != NOBODY {
            let b = &mut self.bodies[pair.b as usize];
            b.v -= impulse * b.inverse;
        }
    }
}

fn at(x: &[Lanes], y: &[Lanes], slot: Slot) -> Vec2 {
    Vec2::new(x[slot.block].0[slot.lane], y[slot.block].0[slot.lane])
}

fn length(v: Vec2) -> f64 {
    v.dot(&v).sqrt()
}
