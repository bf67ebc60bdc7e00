//! Forces of one large crowd: a cell list, and vectors of neighbours.
//!
//! The plane is cut into strips as high as the reach of the farthest-reaching body, and each strip into
//! narrow cells. Every step the agents are sorted by strip and cell (a counting sort, in a cell by index),
//! so that the neighbours of an agent lie in contiguous ranges, read eight at a time without gathers. Newton's
//! third law serves as in `lanewise`: each agent looks only at those behind it in the order, the rest of its
//! strip and one range of the next, and one distance and (with shared B) one exponential do for both bodies.
//! Each strip ends with absent bodies as padding; bodies that a vector catches beyond its range are out of
//! reach and add zero. An agent's own vectors are summed over eight logical lanes whatever the width of the
//! machine; what others add to it comes in their order.
//!
//! Threads share the strips (`share`). Into how many shares they are cut changes no bit.

mod pairs;
mod reach;
mod share;
mod walls;

use super::contact::Contacts;
use super::force::pair::{PairTerm, Sum};
use super::force::walls::Surfaces;
use super::force::{Forces, Room, walls as faces, with_pair_terms};
use super::near::{Close, Grid, Index};
use super::plane::{Open, Plane};
use super::state::State;
use crate::base::geometry::Vec2;
use crate::base::lanes::{LANES, Mask};
use crate::model::Periods;
use fearless_simd::Simd;
use rayon::prelude::*;
use reach::Reach;
use share::Share;
use walls::Walls;

/// Room for the forces of one large crowd.
#[derive(Clone, Debug, Default)]
pub(super) struct Cells {
    /// The order of the agents, which that of the columns and of the forces follows.
    index: Index,
    images: Images,
    /// The strips, some to each thread.
    shares: Vec<Share>,
    faces: faces::Room,
    walls: Walls,
    /// As in `Close`.
    edge: f64,
    /// How far agents feel each other at the places that were last seen.
    reach: Option<Reach>,
}

impl Cells {
    /// What was found out about the state that was last seen, with the pairs that may touch; `None` where some place is no
    /// number or beyond reason.
    pub(super) fn close<'a>(&'a self, pairs: &'a [(u32, u32)]) -> Option<Close<'a>> {
        (self.edge > f64::NEG_INFINITY).then_some(Close { pairs, edge: self.edge, index: Some(&self.index) })
    }

    /// Forces at the present positions into `sums`, and who may touch whom into `contacts`; on so many threads.
    #[inline(always)]
    pub(super) fn forces<S: Simd>(
        &mut self,
        simd: S,
        (forces, threads): (&Forces, usize),
        state: &State,
        sums: &mut Vec<Sum>,
        contacts: &mut Contacts,
    ) {
        sums.clear();
        sums.resize(state.motion.x.len(), Sum::default());
        contacts.clear();
        self.edge = f64::NEG_INFINITY;
        if !state.occupied.has(0) {
            return;
        }
        let reach = with_pair_terms!(forces, term, _, Reach::of(simd, term, forces.margin, state));
        self.edge = reach.edge;
        simd.vectorize(
            #[inline(always)]
            || self.index.sort(simd, &reach.extent, Grid::new(&reach.extent, reach.cell(), state), state),
        );
        self.add_images(&reach, &forces.periods);
        // The images are behind the agents, and felt in all strips.
        Share::cut(&mut self.shares, &self.index, if self.images.start.is_empty() { threads } else { 1 });
        simd.vectorize(
            #[inline(always)]
            || self.look_at_walls(simd, &reach, forces, state, contacts),
        );
        let surfaces = forces.surfaces(state.doors.sets[0]);
        with_pair_terms!(
            forces,
            term,
            plane,
            self.pairs(simd, &reach, (term, plane), (forces, surfaces), state)
        );
        for &(one, other) in self.shares.iter().flat_map(|share| &share.close) {
            contacts.push_pair(one, other, Mask::lane(0));
        }
        self.scatter(sums);
        self.add_walls(sums);
        self.scatter_images(sums);
        self.reach = Some(reach);
        contacts.arrange();
        forces.add_cohesion(state, sums);
    }

    /// The slowness that the room ahead imposes, at the places that `forces` saw, into `sums`.
    #[inline(always)]
    pub(super) fn rooms<S: Simd>(&mut self, simd: S, forces: &Forces, state: &State, sums: &mut Vec<Sum>) {
        sums.clear();
        sums.resize(state.motion.x.len(), Sum::default());
        let Some(reach) = self.reach.filter(|_| state.occupied.has(0)) else { return };
        let (room, surfaces) = (Room::of(state), forces.surfaces(state.doors.sets[0]));
        match forces.closed {
            None => self.pairs(simd, &reach, (room, Open), (forces, surfaces), state),
            Some(plane) => self.pairs(simd, &reach, (room, plane), (forces, surfaces), state),
        }
        self.scatter(sums);
        self.scatter_images(sums);
    }

    /// All that agents do to each other.
    #[inline(always)]
    fn pairs<S: Simd, T: PairTerm, P: Plane>(
        &mut self,
        simd: S,
        reach: &Reach,
        (term, plane): (T, P),
        of: (&Forces, &Surfaces),
        state: &State,
    ) {
        let Self { index, images, shares, walls, .. } = self;
        let around = Around { index, images, walls, reach };
        // A function for each combination of terms, as in `lanewise`.
        let work = |share: &mut Share| {
            simd.vectorize(
                #[inline(always)]
                || share.keep(simd, term, index, state),
            );
            simd.vectorize(
                #[inline(always)]
                || share.pairs(simd, &around, (term, plane), of),
            );
        };
        on_each(shares, &work);
    }

    /// Hands the forces to the agents.
    fn scatter(&self, sums: &mut [Sum]) {
        for share in &self.shares {
            for at in share.strips.clone().flat_map(|strip| self.index.strip(strip)) {
                let agent = self.index.agent[at] as usize;
                let (sum, lane, from) = (&mut sums[agent / LANES], agent % LANES, at - share.first);
                sum.x.0[lane] = share.fx[from];
                sum.y.0[lane] = share.fy[from];
                if let Some(slowness) = share.slowness.get(from) {
                    sum.slowness.0[lane] = *slowness;
                }
            }
        }
    }

    /// Adds the forces on the images of agents.
    fn scatter_images(&self, sums: &mut [Sum]) {
        let Some(share) = self.shares.first() else { return };
        for at in self.images.places(&self.index).filter(|&at| self.index.r[at] > f64::NEG_INFINITY) {
            let agent = self.index.agent[at] as usize;
            let (sum, lane) = (&mut sums[agent / LANES], agent % LANES);
            sum.x.0[lane] += share.fx[at];
            sum.y.0[lane] += share.fy[at];
            if let Some(&slowness) = share.slowness.get(at) {
                let most = &mut sum.slowness.0[lane];
                *most = if slowness > *most { slowness } else { *most };
            }
        }
    }
}

/// Works on each share, on a thread of its own where there are several. Not generic: else the pool is compiled for each
/// combination of terms and width of vectors, which takes a quarter of the build.
fn on_each(shares: &mut [Share], work: &(dyn Fn(&mut Share) + Sync)) {
    match shares {
        [all] => work(all),
        some => some.par_iter_mut().with_max_len(1).for_each(work),
    }
}

/// What a share reads of the whole crowd.
#[derive(Clone, Copy)]
struct Around<'a> {
    index: &'a Index,
    images: &'a Images,
    walls: &'a Walls,
    reach: &'a Reach,
}

// Images of agents on a closed plane: those that someone near the end of a period feels behind it.
//
// They stand behind the agents in rows of their own, strip by strip. Of two opposite images one is listed, and an image
// looks at nobody: so each pair is found once, by the agent of the two that has the other's image.

/// Where the images of each cell start; each strip has one more for its end. Empty on an open plane.
#[derive(Clone, Debug, Default)]
struct Images {
    start: Vec<u32>,
    /// All of them, with padding.
    first: usize,
}

impl Images {
    /// The images in the strip of an agent and those beside it that may be in reach.
    fn near(&self, row: usize, strip: usize, columns: (usize, usize)) -> impl Iterator<Item = (u32, u32)> {
        let rows = self.start.chunks_exact(row).skip(strip.saturating_sub(1));
        let spans = rows.take(if strip == 0 { 2 } else { 3 });
        spans.map(move |start| (start[columns.0], start[columns.1 + 1])).filter(|(from, to)| from < to)
    }

    /// Their places among the sorted agents, padding among them.
    fn places(&self, index: &Index) -> std::ops::Range<usize> {
        let end = index.agent.len();
        if self.start.is_empty() { end..end } else { self.first..end }
    }
}

impl Cells {
    /// Puts the images behind the sorted agents.
    fn add_images(&mut self, reach: &Reach, periods: &Periods) {
        self.images.start.clear();
        if periods.are_none() {
            return;
        }
        let Self { index, images, .. } = self;
        let grid = index.grid;
        let is_one_of_two = |way: &Vec2| way.y > 0.0 || (way.y == 0.0 && way.x > 0.0);
        let mut found = Vec::new();
        for way in periods.images().into_iter().filter(is_one_of_two) {
            for at in (0..grid.strips).flat_map(|strip| index.strip(strip)) {
                let p = Vec2::new(index.x[at], index.y[at]) + way;
                if periods.hold(p, reach.most) {
                    found.push(((grid.strip_of(p.y), grid.column_of(p.x), index.agent[at]), p, index.r[at]));
                }
            }
        }
        found.sort_by_key(|(cell, ..)| *cell);
        images.first = index.agent.len();
        let mut put = |agent: u32, p: Vec2, r: f64| {
            index.agent.push(agent);
            index.x.push(p.x);
            index.y.push(p.y);
            index.r.push(r);
            index.agent.len() as u32
        };
        let (mut end, mut next) = (images.first as u32, found.into_iter().peekable());
        for strip in 0..grid.strips {
            for column in 0..grid.columns {
                images.start.push(end);
                while let Some(((_, _, agent), p, r)) =
                    next.next_if(|((s, c, _), ..)| (*s, *c) == (strip, column))
                {
                    end = put(agent, p, r);
                }
            }
            images.start.push(end);
            for _ in 0..LANES {
                end = put(0, Vec2::new(grid.x, grid.y), f64::NEG_INFINITY);
            }
        }
        while !(end as usize).is_multiple_of(LANES) {
            end = put(0, Vec2::new(grid.x, grid.y), f64::NEG_INFINITY);
        }
    }
}
