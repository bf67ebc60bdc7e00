//! The bodies of one trial that may touch something, and the pairs that they form.
//!
//! Gathered once a step. Bodies that hang together by candidates form a cluster (union-find, the smaller
//! index the root). The pairs stand in *turns*: the turn of a pair comes after those of all earlier pairs of
//! either body, and pairs of one turn share no body. So each body meets its neighbours in their order
//! whatever stands between, and the processor works on many pairs at a time.

use super::{Candidates, at, within_reach, within_reach_of_surface};
use crate::base::geometry::Vec2;
use crate::base::lanes::Mask;
use crate::base::math;
use crate::kernel::program::Program;
use crate::kernel::state::{Slot, State};

const NOBODY: u32 = u32::MAX;

/// A body that may touch something.
#[derive(Clone, Copy, Debug)]
struct Body {
    slot: Slot,
    radius: f64,
    k1: f64,
    k2: f64,
    cluster: u32,
}

/// How a body moves.
#[derive(Clone, Copy, Debug)]
pub(super) struct Motion {
    pub(super) v: Vec2,
    /// One over the mass, 1/kg.
    pub(super) inverse: f64,
}

/// Two bodies that may touch.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Pair {
    pub(super) a: u32,
    pub(super) b: u32,
    cluster: u32,
    turn: u32,
    /// Distance at which they touch, m.
    pub(super) touch: f64,
    pub(super) k1: f64,
    pub(super) k2: f64,
    /// Sum of the inverse masses, 1/kg.
    pub(super) inverse: f64,
}

/// A body that may touch a surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct AtWall {
    pub(super) body: u32,
    pub(super) surface: u32,
    pub(super) radius: f64,
    pub(super) k1: f64,
    pub(super) k2: f64,
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
pub(super) struct Throng {
    bodies: Vec<Body>,
    clusters: Vec<Cluster>,
    pairs: Vec<Pair>,
    walls: Vec<AtWall>,
    /// Place of each body, m.
    pub(super) x: Vec<Vec2>,
    pub(super) motions: Vec<Motion>,
    /// The pairs of hot clusters, in turns, and their bodies at walls.
    pub(super) hot_pairs: Vec<Pair>,
    pub(super) hot_walls: Vec<AtWall>,
    /// Index of each agent's body.
    index: Vec<u32>,
    parent: Vec<u32>,
    /// Next free turn of each body.
    next: Vec<u32>,
    listed: Vec<Pair>,
    starts: Vec<u32>,
}

impl Throng {
    /// Gathers the candidates of a lane.
    pub(super) fn gather(
        &mut self,
        program: &Program,
        state: &State,
        candidates: &Candidates,
        lane: usize,
    ) {
        self.bodies.clear();
        self.motions.clear();
        self.parent.clear();
        self.next.clear();
        self.listed.clear();
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
            let (one, other) = (&self.bodies[a as usize], &self.bodies[b as usize]);
            // The constants of a pair are the means of the two bodies'. Two bodies of several persons do
            // not compress each other and have their own friction constant.
            let (k1, k2) = match program.forces.friction(i as usize, j as usize) {
                Some(friction) => (0.0, friction),
                None => (0.5 * (one.k1 + other.k1), 0.5 * (one.k2 + other.k2)),
            };
            let touch = one.radius + other.radius;
            let inverse = self.motions[a as usize].inverse + self.motions[b as usize].inverse;
            let turn = self.next[a as usize].max(self.next[b as usize]);
            self.next[a as usize] = turn + 1;
            self.next[b as usize] = turn + 1;
            self.listed.push(Pair { a, b, cluster: 0, turn, touch, k1, k2, inverse });
            self.unite(a, b);
        }
        for &(i, surface) in &candidates.walls {
            let Some(body) = self.body(state, i, lane) else { continue };
            let Body { radius, k1, k2, .. } = self.bodies[body as usize];
            self.walls.push(AtWall { body, surface, radius, k1, k2 });
        }
        self.find_clusters();
        self.take_turns();
    }

    /// Index of an agent's body; `None` if it is absent.
    fn body(&mut self, state: &State, agent: u32, lane: usize) -> Option<u32> {
        let known = self.index[agent as usize];
        if known != NOBODY {
            return Some(known);
        }
        let slot = state.slot(agent as usize, lane);
        if !state.present[slot.block].has(slot.lane) {
            return None;
        }
        let index = self.bodies.len() as u32;
        self.index[agent as usize] = index;
        self.bodies.push(Body {
            slot,
            radius: state.radius[slot.block].0[slot.lane],
            k1: state.k1[slot.block].0[slot.lane],
            k2: state.k2[slot.block].0[slot.lane],
            cluster: 0,
        });
        let inverse = 1.0 / state.mass[slot.block].0[slot.lane];
        self.motions.push(Motion { v: Vec2::zeros(), inverse });
        self.parent.push(index);
        self.next.push(0);
        Some(index)
    }

    fn unite(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.parent[a.max(b) as usize] = a.min(b);
    }

    fn root(&mut self, body: u32) -> u32 {
        let mut root = body;
        while self.parent[root as usize] != root {
            let above = self.parent[self.parent[root as usize] as usize];
            self.parent[root as usize] = above;
            root = above;
        }
        root
    }

    /// Numbers the clusters, and finds how stiff each is.
    fn find_clusters(&mut self) {
        self.clusters.clear();
        for body in 0..self.bodies.len() {
            let root = self.root(body as u32) as usize;
            self.bodies[body].cluster = if root == body {
                self.clusters.push(Cluster { hot: false, stiffest: 0.0 });
                self.clusters.len() as u32 - 1
            } else {
                // The root came before.
                self.bodies[root].cluster
            };
        }
        let mut stiffen = |cluster: u32, by: f64| {
            let stiffest = &mut self.clusters[cluster as usize].stiffest;
            *stiffest = math::at_least(by, *stiffest);
        };
        for pair in &mut self.listed {
            pair.cluster = self.bodies[pair.a as usize].cluster;
            stiffen(pair.cluster, pair.k1 * pair.inverse);
        }
        for wall in &self.walls {
            let body = wall.body as usize;
            stiffen(self.bodies[body].cluster, wall.k1 * self.motions[body].inverse);
        }
    }

    /// Puts the pairs in turns: a counting sort.
    fn take_turns(&mut self) {
        self.starts.clear();
        for pair in &self.listed {
            let turn = pair.turn as usize;
            if turn >= self.starts.len() {
                self.starts.resize(turn + 1, 0);
            }
            self.starts[turn] += 1;
        }
        let mut total = 0;
        for start in &mut self.starts {
            (*start, total) = (total, total + *start);
        }
        self.pairs.resize(self.listed.len(), Pair::default());
        for pair in &self.listed {
            let next = &mut self.starts[pair.turn as usize];
            self.pairs[*next as usize] = *pair;
            *next += 1;
        }
    }

    /// Takes over the present places and velocities, and finds the clusters in which something can touch
    /// within `h` seconds. False if there is none.
    pub(super) fn heat(&mut self, program: &Program, state: &State, h: f64) -> bool {
        self.x.clear();
        for (body, motion) in self.bodies.iter().zip(&mut self.motions) {
            self.x.push(at(&state.x, &state.y, body.slot));
            motion.v = at(&state.vx, &state.vy, body.slot);
        }
        for cluster in &mut self.clusters {
            cluster.hot = false;
        }
        let (x, motions) = (&self.x, &self.motions);
        let moving = |body: u32| (x[body as usize], motions[body as usize].v);
        let mut any = false;
        for pair in &self.pairs {
            let hot = &mut self.clusters[pair.cluster as usize].hot;
            if !*hot && within_reach(pair.touch, moving(pair.a), moving(pair.b), h) {
                (*hot, any) = (true, true);
            }
        }
        for wall in &self.walls {
            let hot = &mut self.clusters[self.bodies[wall.body as usize].cluster as usize].hot;
            if !*hot && within_reach_of_surface(program, wall.surface, wall.radius, moving(wall.body), h) {
                (*hot, any) = (true, true);
            }
        }
        if any {
            let (bodies, clusters) = (&self.bodies, &self.clusters);
            let is_hot = |cluster: u32| clusters[cluster as usize].hot;
            self.hot_pairs.clear();
            self.hot_pairs.extend(self.pairs.iter().filter(|pair| is_hot(pair.cluster)));
            self.hot_walls.clear();
            let at_hot = |wall: &&AtWall| is_hot(bodies[wall.body as usize].cluster);
            self.hot_walls.extend(self.walls.iter().filter(at_hot));
        }
        any
    }

    /// Largest k1 over mass of the hot clusters, 1/s^2.
    pub(super) fn stiffest(&self) -> f64 {
        let hot = self.clusters.iter().filter(|cluster| cluster.hot);
        hot.fold(0.0, |stiffest, cluster| math::at_least(cluster.stiffest, stiffest))
    }

    /// Hands places and velocities of the bodies of hot clusters back, and marks them in `moved`.
    pub(super) fn hand_back(&self, state: &mut State, moved: &mut [Mask]) {
        for ((body, x), motion) in self.bodies.iter().zip(&self.x).zip(&self.motions) {
            if self.clusters[body.cluster as usize].hot {
                let Slot { block, lane } = body.slot;
                state.x[block].0[lane] = x.x;
                state.y[block].0[lane] = x.y;
                state.vx[block].0[lane] = motion.v.x;
                state.vy[block].0[lane] = motion.v.y;
                moved[block] |= Mask::lane(lane);
            }
        }
    }
}
