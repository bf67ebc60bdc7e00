//! Forces where one lane is one trial: all pairs of agents, eight trials at once.
//!
//! Newton's third law serves twice: one distance and (with shared B) one exponential for both bodies of a
//! pair. Sums run over the other agents in ascending order. A list of the pairs that can reach each other
//! in *any* lane is kept from step to step, with a skin, as Verlet 1967 did; a pair beyond the reach adds
//! exactly zero, so the list changes no bit, and nothing of one lane is felt in another.

use super::contact::Contacts;
use super::force::pair::{Block, Pair, PairTerm, Sum, is_idle};
use super::force::walls::{self, AtWalls, Surfaces};
use super::force::{Forces, Room, with_pair_terms};
use super::plane::{Open, Plane};
use super::state::State;
use super::vector::{larger, parts};
use crate::base::geometry::amply_around;
use crate::base::geometry::{Bounds, Vec2};
use crate::base::lanes::{LANES, Lanes, Mask};
use crate::base::math::at_least;
use crate::base::random::TrialKey;
use crate::model::{Parameter, Periods};
use fearless_simd::Simd;
use fearless_simd::prelude::*;

/// Way that an agent may go before the list is made anew, m; twice that is added to the reach.
const SLACK: f64 = 0.12;

/// An agent as the forces see it.
#[derive(Clone, Copy, Debug, Default)]
struct Agent {
    x: Lanes,
    y: Lanes,
    /// Radius; minus infinity where the agent is absent, so that it is beyond the reach of everybody.
    r: Lanes,
}

impl Agent {
    /// Where it is in the lanes in which it is present.
    fn places(&self) -> impl Iterator<Item = Vec2> + '_ {
        let present = (0..LANES).filter(|&lane| self.r.0[lane] > f64::NEG_INFINITY);
        present.map(|lane| Vec2::new(self.x.0[lane], self.y.0[lane]))
    }

    /// Its image in the lanes in which that is in the scene, or will be before anybody has gone too far; none without any.
    fn image(&self, way: Vec2, periods: &Periods) -> Option<Self> {
        let mut out = *self;
        for lane in 0..LANES {
            let p = Vec2::new(self.x.0[lane], self.y.0[lane]) + way;
            (out.x.0[lane], out.y.0[lane]) = (p.x, p.y);
            if !periods.hold(p, SLACK) {
                out.r.0[lane] = f64::NEG_INFINITY;
            }
        }
        let is_anywhere = out.places().next().is_some();
        is_anywhere.then_some(out)
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
    /// Which faces may come between the two of each pair, in the order of `others`: where their list starts, and one more at
    /// the end. Empty where no face comes between anybody.
    first_screen: Vec<u32>,
    screens: Vec<u32>,
    x: Vec<Lanes>,
    y: Vec<Lanes>,
    present: Vec<Mask>,
    keys: [TrialKey; LANES],
}

impl Neighbours {
    /// Which faces may come between the two of a pair.
    #[inline(always)]
    fn screens_of(&self, at: usize) -> Option<&[u32]> {
        let first = self.first_screen.get(at..at + 2)?;
        (first[0] < first[1]).then(|| &self.screens[first[0] as usize..first[1] as usize])
    }
}

/// Room for the forces of a batch of trials.
#[derive(Clone, Debug, Default)]
pub(super) struct Lanewise {
    agents: Vec<Agent>,
    /// What the terms between two bodies keep of each agent, one after the other.
    kept: Vec<Lanes>,
    neighbours: Neighbours,
    /// How far beyond touching each body is felt or may be touched, with the skin, m.
    reaches: Vec<Lanes>,
    room: Vec<u32>,
    faces: walls::Room,
    /// Faces that can stand between any two, and those of them that are near one agent.
    dividing: Vec<u32>,
    dividing_near: Vec<u32>,
    /// An agent and its images.
    images: Vec<Agent>,
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
        forces: &Forces,
        state: &State,
        sums: &mut Vec<Sum>,
        contacts: &mut Contacts,
    ) {
        with_pair_terms!(forces, term, _, self.prepare(simd, term, forces.margin, state));
        match forces.closed {
            None => self.look_around(simd, Open, forces, state),
            Some(plane) => self.look_around(simd, plane, forces, state),
        }
        sums.clear();
        sums.resize(state.agents, Sum::default());
        contacts.clear();
        // A function for each combination of terms: several loops in one would share its registers badly.
        let (all, some) = ([(&forces.surfaces, Mask::ALL)], forces.by_doors(state));
        let surfaces: &[_] = if some.is_empty() { &all } else { &some };
        with_pair_terms!(
            forces,
            term,
            plane,
            simd.vectorize(
                #[inline(always)]
                || self.pairs(simd, (term, plane), (forces, surfaces), sums, contacts),
            )
        );
        for &surfaces in surfaces {
            simd.vectorize(
                #[inline(always)]
                || self.walls(simd, (forces, surfaces), state, sums, contacts),
            );
        }
        forces.add_cohesion(state, sums);
    }

    /// The slowness that the room ahead imposes, at the places that `forces` saw, into `sums`.
    #[inline(always)]
    pub(super) fn rooms<S: Simd>(
        &mut self,
        simd: S,
        forces: &Forces,
        state: &State,
        sums: &mut Vec<Sum>,
        contacts: &mut Contacts,
    ) {
        sums.clear();
        sums.resize(state.agents, Sum::default());
        let room = Room::of(state);
        let (all, some) = ([(&forces.surfaces, Mask::ALL)], forces.by_doors(state));
        let surfaces: &[_] = if some.is_empty() { &all } else { &some };
        self.kept.resize(state.agents * Room::COUNT, Lanes::ZERO);
        for (index, kept) in self.kept.chunks_exact_mut(Room::COUNT).enumerate() {
            for part in parts(simd) {
                room.keep(
                    part,
                    state,
                    Block { part, index },
                    #[inline(always)]
                    |k, numbers| part.store(numbers, &mut kept[k]),
                );
            }
        }
        match forces.closed {
            None => simd.vectorize(
                #[inline(always)]
                || self.pairs(simd, (room, Open), (forces, surfaces), sums, contacts),
            ),
            Some(plane) => simd.vectorize(
                #[inline(always)]
                || self.pairs(simd, (room, plane), (forces, surfaces), sums, contacts),
            ),
        }
    }

    /// Makes the list anew where somebody has gone too far.
    #[inline(always)]
    fn look_around<S: Simd, P: Plane>(&mut self, simd: S, plane: P, forces: &Forces, state: &State) {
        if self.is_outdated(simd, plane, state) {
            simd.vectorize(
                #[inline(always)]
                || self.find_neighbours(simd, plane, forces, state),
            );
        }
    }

    #[inline(always)]
    fn prepare<S: Simd, T: PairTerm>(&mut self, simd: S, term: T, margin: f64, state: &State) {
        self.agents.resize(state.agents, Agent::default());
        self.reaches.resize(state.agents, Lanes::ZERO);
        self.kept.resize(state.agents * T::COUNT, Lanes::ZERO);
        for (index, agent) in self.agents.iter_mut().enumerate() {
            agent.x = state.motion.x[index];
            agent.y = state.motion.y[index];
            let kept = &mut self.kept[index * T::COUNT..][..T::COUNT];
            for part in parts(simd) {
                let here = part.mask(state.present[index] & state.occupied);
                let radius = here
                    .select(part.load(&state.bodies[Parameter::Radius][index]), part.c(f64::NEG_INFINITY));
                part.store(radius, &mut agent.r);
                let block = Block { part, index };
                let far = larger::<S>(term.reach(part, state, block), part.c(margin));
                part.store(far + part.c(2.0 * SLACK), &mut self.reaches[index]);
                term.keep(
                    part,
                    state,
                    block,
                    #[inline(always)]
                    |k, numbers| part.store(numbers, &mut kept[k]),
                );
            }
        }
    }

    #[inline(always)]
    fn is_outdated<S: Simd, P: Plane>(&mut self, simd: S, plane: P, state: &State) -> bool {
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
                let (dx, dy) = plane.way(part, (dx, dy));
                farthest = larger::<S>(dx * dx + dy * dy, farthest);
            }
            if farthest.simd_gt(part.c(SLACK * SLACK)).any_true() {
                return true;
            }
        }
        false
    }

    #[inline(always)]
    fn find_neighbours<S: Simd, P: Plane>(&mut self, simd: S, plane: P, forces: &Forces, state: &State) {
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
        list.first_screen.clear();
        list.screens.clear();
        let reaches = &self.reaches;
        // How far from its centre somebody feels others, at most.
        let mut farthest = Lanes::ZERO;
        self.dividing.clear();
        if !forces.surfaces.is_empty() {
            for part in parts(simd) {
                let mut far = part.c(0.0);
                for (reach, one) in reaches.iter().zip(&self.agents) {
                    far = larger::<S>(part.load(reach) + part.load(&one.r), far);
                }
                part.store(far, &mut farthest);
            }
            let all = self.agents.iter().flat_map(Agent::places);
            if let Some(Bounds { low, high }) = Bounds::around(all) {
                let slack = Vec2::repeat(SLACK);
                // Whoever is felt across the end of a period is that far beyond it.
                let beyond = farthest.0.into_iter().fold(0.0, |a, b| if b > a { b } else { a });
                let slack = if P::IS_CLOSED { slack + Vec2::repeat(beyond) } else { slack };
                let all = Bounds { low: low - slack, high: high + slack };
                forces.surfaces.list_screens(&all, &mut self.dividing);
            }
        }
        let ways = if P::IS_CLOSED { forces.periods.images() } else { Vec::new() };
        for (i, one) in self.agents.iter().enumerate() {
            list.first.push(list.others.len() as u32);
            // Where it may be, in the scene, before the list is made anew.
            let images = &mut self.images;
            images.clear();
            images.push(*one);
            images.extend(ways.iter().skip(1).filter_map(|way| one.image(*way, &forces.periods)));
            let near_one = &mut self.dividing_near;
            near_one.clear();
            if !self.dividing.is_empty() {
                for one in images.iter() {
                    let near = forces.surfaces.nearby.find(&around(one, &farthest), &mut self.room);
                    near_one.extend(
                        near.iter().copied().filter(|face| self.dividing.binary_search(face).is_ok()),
                    );
                }
                arrange(near_one, 0, images.len());
            }
            for (j, other) in self.agents.iter().enumerate().skip(i + 1) {
                let mut near = false;
                for part in parts(simd) {
                    let dx = part.load(&one.x) - part.load(&other.x);
                    let dy = part.load(&one.y) - part.load(&other.y);
                    let (dx, dy) = plane.way(part, (dx, dy));
                    let touch = part.load(&one.r) + part.load(&other.r);
                    let reach = larger::<S>(part.load(&reaches[i]), part.load(&reaches[j]));
                    let limit = larger::<S>(touch + reach, part.c(0.0));
                    near |= (dx * dx + dy * dy).simd_lt(limit * limit).any_true();
                }
                if near {
                    list.others.push(j as u32);
                    if !self.dividing.is_empty() {
                        list.first_screen.push(list.screens.len() as u32);
                        list.screens.extend(near_one.iter().copied().filter(|&face| {
                            images.iter().any(|one| {
                                parts(simd).any(|part| {
                                    let place = (part.load(&one.x), part.load(&one.y));
                                    let there = (part.load(&other.x), part.load(&other.y));
                                    let there = if P::IS_CLOSED {
                                        let way = plane.way(part, (place.0 - there.0, place.1 - there.1));
                                        (place.0 - way.0, place.1 - way.1)
                                    } else {
                                        there
                                    };
                                    forces.surfaces.may_hide(face, part, place, there, SLACK).any_true()
                                })
                            })
                        }));
                    }
                }
            }
            list.first_surface.push(list.surfaces.len() as u32);
            let from = list.surfaces.len();
            for one in images.iter() {
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
            arrange(&mut list.surfaces, from, images.len());
        }
        list.first.push(list.others.len() as u32);
        list.first_surface.push(list.surfaces.len() as u32);
        if list.screens.is_empty() {
            list.first_screen.clear();
        } else {
            list.first_screen.push(list.screens.len() as u32);
        }
    }

    /// Forces between agents.
    #[inline(always)]
    fn pairs<S: Simd, T: PairTerm, P: Plane>(
        &self,
        simd: S,
        (term, plane): (T, P),
        (forces, surfaces): (&Forces, &[(&Surfaces, Mask)]),
        sums: &mut [Sum],
        contacts: &mut Contacts,
    ) {
        let n = self.agents.len();
        let agents = &self.agents[..n];
        let kept = &self.kept[..n * T::COUNT];
        let sums = &mut sums[..n];
        let first = &self.neighbours.first[..=n];
        let others = &self.neighbours.others;
        for part in parts(simd) {
            let minus_margin = part.c(-forces.margin);
            for i in 0..n {
                let agent = &agents[i];
                let (x, y, r) = (part.load(&agent.x), part.load(&agent.y), part.load(&agent.r));
                let own = T::of_agent(part, kept, i);
                let (mut fx, mut fy) = (part.load(&sums[i].x), part.load(&sums[i].y));
                let mut slowness = part.load(&sums[i].slowness);
                for at in first[i] as usize..first[i + 1] as usize {
                    let j = others[at];
                    let other = &agents[j as usize];
                    let way = plane.way(part, (x - part.load(&other.x), y - part.load(&other.y)));
                    let touch = r + part.load(&other.r);
                    if is_idle(part, term, way, touch, forces.margin) {
                        continue;
                    }
                    let mut pair = Pair::new(part, way, touch);
                    if T::FINDS_TOUCH {
                        let touching = pair.gap.simd_gt(minus_margin);
                        if touching.any_true() {
                            contacts.push_pair(i as u32, j, part.bits(touching));
                        }
                    }
                    if let Some(screens) = self.neighbours.screens_of(at) {
                        let there = if P::IS_CLOSED {
                            (x - way.0, y - way.1)
                        } else {
                            (part.load(&other.x), part.load(&other.y))
                        };
                        let hidden = match surfaces {
                            [(surfaces, _)] => surfaces.hide(screens, part, (x, y), there),
                            _ => walls::hidden_by_doors(simd, surfaces, screens, part, (x, y), there),
                        };
                        pair.gap = hidden.select(part.c(f64::NEG_INFINITY), pair.gap);
                    }
                    let push = term.push(part, &pair, &own, &T::of_agent(part, kept, j as usize));
                    fx += push.one.0;
                    fy += push.one.1;
                    let sum = &mut sums[j as usize];
                    part.store(part.load(&sum.x) - push.other.0, &mut sum.x);
                    part.store(part.load(&sum.y) - push.other.1, &mut sum.y);
                    if T::KEEPS_HEADWAY {
                        slowness = larger::<S>(push.slowness_of_one, slowness);
                        let most = larger::<S>(push.slowness_of_other, part.load(&sum.slowness));
                        part.store(most, &mut sum.slowness);
                    }
                }
                part.store(fx, &mut sums[i].x);
                part.store(fy, &mut sums[i].y);
                if T::KEEPS_HEADWAY {
                    part.store(slowness, &mut sums[i].slowness);
                }
            }
        }
    }

    /// The force of walls in the lanes in which a set of doors is closed.
    #[inline(always)]
    fn walls<S: Simd>(
        &mut self,
        simd: S,
        (forces, (surfaces, there)): (&Forces, (&Surfaces, Mask)),
        state: &State,
        sums: &mut [Sum],
        contacts: &mut Contacts,
    ) {
        let list = &self.neighbours;
        for (i, agent) in self.agents.iter().enumerate() {
            let near = &list.surfaces[list.first_surface[i] as usize..list.first_surface[i + 1] as usize];
            if near.is_empty() {
                continue;
            }
            for part in parts(simd) {
                let place = (part.load(&agent.x), part.load(&agent.y));
                let at =
                    AtWalls::new(part, place, part.load(&agent.r), forces, state, Block { part, index: i });
                let touching = |k, lanes| contacts.push_wall(i as u32, k, part.bits(lanes) & there);
                let (fx, fy) = surfaces.push(part, near, &at, forces.margin, &mut self.faces, touching);
                let (zero, there) = (part.c(0.0), part.mask(there));
                let (fx, fy) = (there.select(fx, zero), there.select(fy, zero));
                part.store(part.load(&sums[i].x) + fx, &mut sums[i].x);
                part.store(part.load(&sums[i].y) + fy, &mut sums[i].y);
            }
        }
    }
}

/// Puts what several images have listed from a place on into order, each once.
fn arrange(list: &mut Vec<u32>, from: usize, images: usize) {
    if images > 1 {
        let mut tail = list.split_off(from);
        tail.sort_unstable();
        tail.dedup();
        list.append(&mut tail);
    }
}

/// A rectangle around all that an agent can reach in any lane, amply.
fn around(one: &Agent, reach: &Lanes) -> Bounds {
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
