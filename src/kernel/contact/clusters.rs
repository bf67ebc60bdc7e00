//! The bodies of one trial that may touch something, and the pairs that they form.
//!
//! Gathered once a step. Bodies that hang together by candidates form a cluster (union-find, the smaller
//! index the root). The pairs stand in *turns*: the turn of a pair comes after those of all earlier pairs of
//! either body, and pairs of one turn share no body. So each body meets its neighbours in their order
//! whatever stands between, and the processor works on several pairs at a time.

use super::overlap::{Motion, Touch, Touches};
use super::{Candidates, at, within_reach, within_reach_of_face};
use crate::base::geometry::Vec2;
use crate::base::lanes::Mask;
use crate::base::math;
use crate::kernel::force::walls::Surfaces;
use crate::kernel::force::{Forces, contact};
use crate::kernel::state::{Slot, State};
use crate::model::Parameter;

const NOBODY: u32 = u32::MAX;

/// A body that may touch something.
#[derive(Clone, Copy, Debug)]
struct Body {
    slot: Slot,
    radius: f64,
    k1: f64,
    k2: f64,
    /// One over the mass, 1/kg.
    inverse: f64,
    /// In the end, the root of its cluster.
    parent: u32,
    cluster: u32,
    /// Next free turn.
    turn: u32,
}

/// Bodies that hang together.
#[derive(Clone, Copy, Debug)]
struct Cluster {
    /// Whether something in it can touch now.
    hot: bool,
    /// Largest k1 over mass in it, 1/s^2.
    stiffest: f64,
}

/// The bodies of one trial that may touch something.
#[derive(Clone, Debug, Default)]
pub(super) struct Clusters {
    bodies: Vec<Body>,
    all: Vec<Cluster>,
    /// The pairs in the order of candidates, each with its turn.
    pairs: Vec<(u32, Touch)>,
    walls: Vec<Touch>,
    /// Where the pairs of each turn start.
    starts: Vec<u32>,
    /// Place of each body, m.
    pub(super) x: Vec<Vec2>,
    pub(super) motions: Vec<Motion>,
    /// Pairs of hot clusters, in turns, and bodies of hot clusters at walls.
    pub(super) hot_pairs: Touches,
    pub(super) hot_walls: Touches,
    /// How many clusters those are from.
    listed: usize,
    /// Index of each agent's body.
    index: Vec<u32>,
}

impl Clusters {
    /// Gathers the candidates of a lane.
    pub(super) fn gather(&mut self, forces: &Forces, state: &State, candidates: &Candidates, lane: usize) {
        self.bodies.clear();
        self.pairs.clear();
        self.walls.clear();
        self.index.resize(state.agents, NOBODY);
        for &(i, j) in &candidates.pairs {
            self.index[i as usize] = NOBODY;
            self.index[j as usize] = NOBODY;
        }
        for &(i, _) in &candidates.walls {
            self.index[i as usize] = NOBODY;
        }
        for &(i, j) in &candidates.pairs {
            let (Some(a), Some(b)) = (self.body(state, i, lane), self.body(state, j, lane)) else { continue };
            self.unite(a, b);
            let (one, other) = (&self.bodies[a as usize], &self.bodies[b as usize]);
            if one.inverse + other.inverse == 0.0 {
                continue;
            }
            let friction = &forces.particles.friction;
            let (k1, k2) =
                contact::of_pair(friction, (i as usize, j as usize), (one.k1, one.k2), (other.k1, other.k2));
            let (distance, inverse) = (one.radius + other.radius, one.inverse + other.inverse);
            let turn = one.turn.max(other.turn);
            self.bodies[a as usize].turn = turn + 1;
            self.bodies[b as usize].turn = turn + 1;
            self.pairs.push((turn, Touch { a, b, cluster: 0, distance, k1, k2, inverse }));
        }
        for &(i, face) in &candidates.walls {
            let Some(a) = self.body(state, i, lane) else { continue };
            let Body { radius: distance, k1, k2, inverse, .. } = self.bodies[a as usize];
            if inverse == 0.0 {
                continue;
            }
            self.walls.push(Touch { a, b: face, cluster: 0, distance, k1, k2, inverse });
        }
        self.find_clusters();
        self.listed = 0;
    }

    /// Index of an agent's body; `None` if it is absent.
    #[inline(always)]
    fn body(&mut self, state: &State, agent: u32, lane: usize) -> Option<u32> {
        let known = self.index[agent as usize];
        if known != NOBODY {
            return Some(known);
        }
        self.enter(state, agent, lane)
    }

    fn enter(&mut self, state: &State, agent: u32, lane: usize) -> Option<u32> {
        let slot = state.slot(agent as usize, lane);
        if !state.present[slot.block].has(slot.lane) {
            return None;
        }
        // One that moves by itself does not yield.
        let mass = state.bodies[Parameter::Mass][slot.block].0[slot.lane];
        let inverse = if state.plans.is_stepped(slot) { 0.0 } else { 1.0 / mass };
        let index = self.bodies.len() as u32;
        self.index[agent as usize] = index;
        self.bodies.push(Body {
            slot,
            radius: state.bodies[Parameter::Radius][slot.block].0[slot.lane],
            k1: state.bodies[Parameter::K1][slot.block].0[slot.lane],
            k2: state.bodies[Parameter::K2][slot.block].0[slot.lane],
            inverse,
            parent: index,
            cluster: 0,
            turn: 0,
        });
        Some(index)
    }

    #[inline(always)]
    fn unite(&mut self, a: u32, b: u32) {
        if self.bodies[a as usize].parent != self.bodies[b as usize].parent {
            let (a, b) = (self.root(a), self.root(b));
            self.bodies[a.max(b) as usize].parent = a.min(b);
        }
    }

    fn root(&mut self, body: u32) -> u32 {
        let mut body = body;
        loop {
            let parent = self.bodies[body as usize].parent;
            if parent == body {
                return body;
            }
            let above = self.bodies[parent as usize].parent;
            self.bodies[body as usize].parent = above;
            body = above;
        }
    }

    /// Numbers the clusters, and finds how stiff each is.
    fn find_clusters(&mut self) {
        self.all.clear();
        for index in 0..self.bodies.len() {
            let parent = self.bodies[index].parent as usize;
            self.bodies[index].cluster = if parent == index {
                self.all.push(Cluster { hot: false, stiffest: 0.0 });
                self.all.len() as u32 - 1
            } else {
                // Whoever is above came before.
                self.bodies[parent].cluster
            };
        }
        for touch in self.pairs.iter_mut().map(|(_, touch)| touch).chain(&mut self.walls) {
            touch.cluster = self.bodies[touch.a as usize].cluster;
            let stiffest = &mut self.all[touch.cluster as usize].stiffest;
            *stiffest = math::at_least(touch.k1 * touch.inverse, *stiffest);
        }
    }

    /// Takes over the present places and velocities, and finds the clusters in which something can touch
    /// within `h` seconds. False if there is none.
    pub(super) fn heat(&mut self, (forces, surfaces): (&Forces, &Surfaces), state: &State, h: f64) -> bool {
        self.x.clear();
        self.motions.clear();
        for body in &self.bodies {
            self.x.push(at(&state.motion.x, &state.motion.y, body.slot));
            self.motions
                .push(Motion { v: at(&state.motion.vx, &state.motion.vy, body.slot), inverse: body.inverse });
        }
        for cluster in &mut self.all {
            cluster.hot = false;
        }
        let (x, motions) = (&self.x, &self.motions);
        let moving = |body: u32| (x[body as usize], motions[body as usize].v);
        let mut cold = self.all.len();
        for (_, touch) in &self.pairs {
            if cold == 0 {
                break;
            }
            let hot = &mut self.all[touch.cluster as usize].hot;
            let (one, other) = (moving(touch.a), moving(touch.b));
            if !*hot && within_reach(&forces.periods, touch.distance, one, other, h) {
                *hot = true;
                cold -= 1;
            }
        }
        for touch in &self.walls {
            let hot = &mut self.all[touch.cluster as usize].hot;
            if !*hot && within_reach_of_face(surfaces, touch.b, touch.distance, moving(touch.a), h) {
                *hot = true;
                cold -= 1;
            }
        }
        let hot = self.all.len() - cold;
        if hot > 0 && !(hot == self.listed && cold == 0) {
            self.list_hot();
            self.listed = hot;
        }
        hot > 0
    }

    /// Puts the pairs of hot clusters in turns: a counting sort.
    fn list_hot(&mut self) {
        self.starts.clear();
        let all = &self.all;
        let is_hot = |touch: &Touch| all[touch.cluster as usize].hot;
        for (turn, _) in self.pairs.iter().filter(|(_, touch)| is_hot(touch)) {
            if *turn as usize >= self.starts.len() {
                self.starts.resize(*turn as usize + 1, 0);
            }
            self.starts[*turn as usize] += 1;
        }
        let mut total = 0;
        for start in &mut self.starts {
            (*start, total) = (total, total + *start);
        }
        self.hot_pairs.reset(total as usize);
        for (turn, touch) in self.pairs.iter().filter(|(_, touch)| is_hot(touch)) {
            let next = &mut self.starts[*turn as usize];
            self.hot_pairs.set(*next as usize, touch);
            *next += 1;
        }
        self.hot_walls.reset(self.walls.iter().filter(|touch| is_hot(touch)).count());
        for (k, touch) in self.walls.iter().filter(|touch| is_hot(touch)).enumerate() {
            self.hot_walls.set(k, touch);
        }
    }

    /// Largest k1 over mass of the hot clusters, 1/s^2.
    pub(super) fn stiffest(&self) -> f64 {
        let hot = self.all.iter().filter(|cluster| cluster.hot);
        hot.fold(0.0, |stiffest, cluster| math::at_least(cluster.stiffest, stiffest))
    }

    /// Stops the centres that came upon a face. The spring of contact stops only bodies slower than radius sqrt(k1 / mass).
    pub(super) fn stop_at_faces(&mut self, surfaces: &Surfaces, state: &State) {
        for touch in self.walls.iter().filter(|touch| self.all[touch.cluster as usize].hot) {
            let slot = self.bodies[touch.a as usize].slot;
            let (from, to) = (at(&state.motion.x, &state.motion.y, slot), &mut self.x[touch.a as usize]);
            if let Some((place, normal)) = surfaces.stop(touch.b, from, *to) {
                let v = &mut self.motions[touch.a as usize].v;
                (*to, *v) = (place, *v - normal * math::at_most(v.dot(&normal), 0.0));
            }
        }
    }

    /// Hands places and velocities of the bodies of hot clusters back, and marks them in `moved`.
    pub(super) fn hand_back(&self, state: &mut State, moved: &mut [Mask]) {
        for ((body, x), motion) in self.bodies.iter().zip(&self.x).zip(&self.motions) {
            if self.all[body.cluster as usize].hot {
                let Slot { block, lane } = body.slot;
                state.motion.x[block].0[lane] = x.x;
                state.motion.y[block].0[lane] = x.y;
                state.motion.vx[block].0[lane] = motion.v.x;
                state.motion.vy[block].0[lane] = motion.v.y;
                moved[block] |= Mask::lane(lane);
            }
        }
    }
}
