//! Bodies in contact: the fast force, advanced in sub-steps.
//!
//! Where two bodies (or a body and a wall) overlap by g > 0, compression k1 g pushes them apart and
//! sliding friction k2 g slows their relative tangential velocity (Helbing, Farkas, Vicsek 2000;
//! Given-Wilson et al. 2017, equations (4) to (6), each term once). Both are stiff: friction relaxes
//! within milliseconds. So the drift of a step is not a straight line for such bodies but the flow of
//! contact alone (`flow`; reversible multiple time steps, Tuckerman, Berne, Martyna 1992).
//!
//! The forces list who may touch whom within a step, lane by lane. Where something then can touch
//! within a drift, the lane's candidates are gathered (`clusters`), and all bodies that hang together by
//! candidates with a pair that can touch move in sub-steps.
//!
//! Everything here looks at one lane at a time: which bodies take sub-steps, how many, and in what order
//! depends on that lane alone.

mod clusters;
mod overlap;
#[cfg(test)]
mod plain;

use super::force::Forces;
use super::force::walls::Surfaces;
use super::state::{Slot, State};
use crate::base::geometry::Vec2;
use crate::base::lanes::{LANES, Lanes, Mask};
use crate::base::math;
use crate::model::{Parameter, Periods};
use clusters::Clusters;
use fearless_simd::Simd;
use overlap::exchange;

/// Candidates of contact of each lane, and room to work.
#[derive(Clone, Debug, Default)]
pub(super) struct Contacts {
    candidates: [Candidates; LANES],
    /// Lanes that have any.
    listed: Mask,
    /// The same, gathered; up to date in these lanes.
    clusters: [Clusters; LANES],
    gathered: Mask,
}

/// Who may touch what within a step, in one lane.
#[derive(Clone, Debug, Default)]
struct Candidates {
    pairs: Vec<(u32, u32)>,
    /// An agent and a face.
    walls: Vec<(u32, u32)>,
}

impl Contacts {
    /// Forgets all candidates.
    pub(super) fn clear(&mut self) {
        for lane in self.listed.iter() {
            self.candidates[lane].pairs.clear();
            self.candidates[lane].walls.clear();
        }
        self.listed = Mask::NONE;
        self.gathered = Mask::NONE;
    }

    /// Whether there is no candidate in any lane.
    pub(super) fn is_empty(&self) -> bool {
        self.listed.is_empty()
    }

    /// Pairs of the only trial.
    pub(super) fn pairs(&self) -> &[(u32, u32)] {
        &self.candidates[0].pairs
    }

    /// Agents `i` and `j` may touch within a step in these lanes.
    #[inline]
    pub(super) fn push_pair(&mut self, i: u32, j: u32, lanes: Mask) {
        self.listed |= lanes;
        for lane in lanes.iter() {
            self.candidates[lane].pairs.push((i, j));
        }
    }

    /// Agent `i` may touch a face within a step in these lanes.
    #[inline]
    pub(super) fn push_wall(&mut self, i: u32, face: u32, lanes: Mask) {
        self.listed |= lanes;
        for lane in lanes.iter() {
            self.candidates[lane].walls.push((i, face));
        }
    }

    /// Puts the candidates of the only trial into ascending order: they were found in an order that
    /// depends on the width of the machine's vectors.
    pub(super) fn arrange(&mut self) {
        let in_order = |&(a, b): &(u32, u32)| u64::from(a) << 32 | u64::from(b);
        self.candidates[0].pairs.sort_unstable_by_key(in_order);
        self.candidates[0].walls.sort_unstable_by_key(in_order);
    }

    /// Moves, over `h` seconds, all bodies that touch something or may be touched by someone who does,
    /// and marks them in `moved`. All others are free: the caller drifts them. Candidates and the
    /// parameters of bodies are the same in all calls between two of `clear`.
    #[inline(always)]
    pub(super) fn advance<S: Simd>(
        &mut self,
        simd: S,
        forces: &Forces,
        state: &mut State,
        moved: &mut [Mask],
        h: f64,
    ) {
        for lane in (state.occupied & self.listed).iter() {
            let surfaces = forces.surfaces(state.doors.sets[lane]);
            let candidates = &self.candidates[lane];
            let clusters = &mut self.clusters[lane];
            if !self.gathered.has(lane) {
                if !candidates.can_touch((forces, surfaces), state, lane, h) {
                    continue;
                }
                clusters.gather(forces, state, candidates, lane);
                self.gathered |= Mask::lane(lane);
            }
            if clusters.heat((forces, surfaces), state, h) {
                flow(simd, (forces, surfaces), clusters, h);
                clusters.stop_at_faces(surfaces, state);
                clusters.hand_back(state, moved);
            }
        }
    }
}

impl Candidates {
    /// Whether anything in the lane can touch within `h` seconds.
    fn can_touch(
        &self,
        (forces, surfaces): (&Forces, &Surfaces),
        state: &State,
        lane: usize,
        h: f64,
    ) -> bool {
        let place =
            |slot| (at(&state.motion.x, &state.motion.y, slot), at(&state.motion.vx, &state.motion.vy, slot));
        let radius = |slot: Slot| state.bodies[Parameter::Radius][slot.block].0[slot.lane];
        let here = |slot: Slot| state.present[slot.block].has(slot.lane);
        let pair = |&(i, j): &(u32, u32)| {
            let (a, b) = (state.slot(i as usize, lane), state.slot(j as usize, lane));
            here(a) && here(b) && within_reach(&forces.periods, radius(a) + radius(b), place(a), place(b), h)
        };
        let wall = |&(i, face): &(u32, u32)| {
            let a = state.slot(i as usize, lane);
            here(a) && within_reach_of_face(surfaces, face, radius(a), place(a), h)
        };
        self.pairs.iter().any(pair) || self.walls.iter().any(wall)
    }
}

/// Whether two bodies with these places and velocities, which touch at a distance of `touch`, can do so
/// within `h` seconds.
#[inline(always)]
fn within_reach(
    periods: &Periods,
    touch: f64,
    (x, v): (Vec2, Vec2),
    (other_x, other_v): (Vec2, Vec2),
    h: f64,
) -> bool {
    let (d, v) = (periods.way(x - other_x), v - other_v);
    let reach = touch + length(v) * h;
    d.dot(&d) < reach * reach
}

/// Whether a body of some radius can touch a face within `h` seconds.
fn within_reach_of_face(surfaces: &Surfaces, face: u32, radius: f64, (x, v): (Vec2, Vec2), h: f64) -> bool {
    surfaces.nearest_to(face, x).near < radius + length(v) * h
}

fn at(x: &[Lanes], y: &[Lanes], slot: Slot) -> Vec2 {
    Vec2::new(x[slot.block].0[slot.lane], y[slot.block].0[slot.lane])
}

fn length(v: Vec2) -> f64 {
    v.dot(&v).sqrt()
}

// The flow of contact alone, in sub-steps of position Verlet.
//
// Half a drift, friction, compression, friction, half a drift. Friction is solved exactly pair by pair (`force::contact`).
// It can therefore never reverse a slip, and never adds energy. Pairs are visited in order and then in reverse order,
// which keeps it symmetric.

/// Frequency of the stiffest contact times the sub-step: an eighteenth of its period at most (2 pi / 0.35).
const PHASE: f64 = 0.35;
/// Contacts of one body in a dense packing stiffen each other by about this factor.
const PACKING: f64 = 4.0;
/// More would help nobody: such constants diverge.
const MOST_SUBSTEPS: f64 = 1000.0;

/// Moves the bodies of the hot clusters over `h` seconds. (Others may drift along, idly.)
#[inline(always)]
fn flow<S: Simd>(simd: S, (forces, surfaces): (&Forces, &Surfaces), clusters: &mut Clusters, h: f64) {
    let wanted = (h * (PACKING * clusters.stiffest()).sqrt() / PHASE).ceil();
    let count = math::at_most(math::at_least(wanted, 1.0), MOST_SUBSTEPS) as u32;
    let t = h / f64::from(count);
    let Clusters { hot_pairs: pairs, hot_walls: walls, x, motions, .. } = clusters;
    let mut drift = 0.5 * t;
    for k in 0..=count {
        for (x, motion) in x.iter_mut().zip(motions.iter()) {
            *x += motion.v * drift;
        }
        if k < count {
            pairs.find(simd, &forces.periods, x, t);
            walls.find_at_walls(simd, surfaces, x, t);
            exchange(pairs, walls, motions);
            drift = if k + 1 < count { t } else { 0.5 * t };
        }
    }
}
