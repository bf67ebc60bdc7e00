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

mod pairs;
mod reach;
mod walls;

use super::contact::Contacts;
use super::force::pair::{PairTerm, Sum};
use super::force::{Forces, Room, walls as faces, with_pair_terms};
use super::near::{Close, Grid, Index};
use super::plane::Open;
use super::state::State;
use super::vector::parts;
use crate::base::geometry::Vec2;
use crate::base::lanes::LANES;
use crate::model::Periods;
use fearless_simd::Simd;
use pairs::{Task, Touch};
use reach::Reach;
use reach::Sorted;
use walls::Walls;

/// Room for the forces of one large crowd.
#[derive(Clone, Debug, Default)]
pub(super) struct Cells {
    /// The order of the agents, which that of the columns and of the forces follows.
    index: Index,
    images: Images,
    /// What the terms between two bodies keep of each agent: a column for each number.
    columns: Vec<Vec<f64>>,
    /// The forces.
    fx: Vec<f64>,
    fy: Vec<f64>,
    /// The slowness that those ahead impose; empty where nobody keeps a headway.
    slowness: Vec<f64>,
    /// Of one strip: the vectors of neighbours, and the sums of its agents over eight lanes.
    tasks: Vec<Task>,
    touches: Vec<Touch>,
    own: Vec<Sum>,
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
        with_pair_terms!(
            forces,
            term,
            _,
            simd.vectorize(
                #[inline(always)]
                || self.keep(simd, term, state),
            )
        );
        simd.vectorize(
            #[inline(always)]
            || self.look_at_walls(simd, &reach, forces, state, contacts),
        );
        let surfaces = forces.surfaces(state.doors.sets[0]);
        // A function for each combination of terms, as in `lanewise`.
        with_pair_terms!(
            forces,
            term,
            plane,
            simd.vectorize(
                #[inline(always)]
                || self.pairs(simd, &reach, (term, plane), (forces, surfaces), contacts),
            )
        );
        self.add_walls();
        self.scatter(sums);
        self.reach = Some(reach);
        contacts.arrange();
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
        sums.resize(state.motion.x.len(), Sum::default());
        let Some(reach) = self.reach.filter(|_| state.occupied.has(0)) else { return };
        let (room, surfaces) = (Room::of(state), forces.surfaces(state.doors.sets[0]));
        simd.vectorize(
            #[inline(always)]
            || self.keep(simd, room, state),
        );
        match forces.closed {
            None => simd.vectorize(
                #[inline(always)]
                || self.pairs(simd, &reach, (room, Open), (forces, surfaces), contacts),
            ),
            Some(plane) => simd.vectorize(
                #[inline(always)]
                || self.pairs(simd, &reach, (room, plane), (forces, surfaces), contacts),
            ),
        }
        self.scatter(sums);
    }

    /// Hands the forces to the agents.
    fn scatter(&self, sums: &mut [Sum]) {
        for strip in 0..self.index.grid.strips {
            for at in self.index.strip(strip) {
                let agent = self.index.agent[at] as usize;
                let sum = &mut sums[agent / LANES];
                sum.x.0[agent % LANES] = self.fx[at];
                sum.y.0[agent % LANES] = self.fy[at];
                if let Some(slowness) = self.slowness.get(at) {
                    sum.slowness.0[agent % LANES] = *slowness;
                }
            }
        }
        for at in self.image_places().filter(|&at| self.index.r[at] > f64::NEG_INFINITY) {
            let agent = self.index.agent[at] as usize;
            let (sum, lane) = (&mut sums[agent / LANES], agent % LANES);
            sum.x.0[lane] += self.fx[at];
            sum.y.0[lane] += self.fy[at];
            if let Some(&slowness) = self.slowness.get(at) {
                let most = &mut sum.slowness.0[lane];
                *most = if slowness > *most { slowness } else { *most };
            }
        }
    }

    /// Takes over what a term keeps of each agent, and makes room for the forces.
    #[inline(always)]
    fn keep<S: Simd, T: PairTerm>(&mut self, simd: S, term: T, state: &State) {
        let total = self.index.agent.len();
        for field in [&mut self.fx, &mut self.fy] {
            field.clear();
            field.resize(total, 0.0);
        }
        self.slowness.clear();
        self.slowness.resize(if T::KEEPS_HEADWAY { total } else { 0 }, 0.0);
        self.columns.resize_with(T::COUNT, Vec::new);
        for column in &mut self.columns {
            column.resize(total, 0.0);
        }
        let Self { index, columns, .. } = self;
        for (k, agents) in index.agent.chunks_exact(LANES).enumerate() {
            for part in parts(simd) {
                term.keep(
                    part,
                    state,
                    Sorted { part, agents },
                    #[inline(always)]
                    |column, numbers| part.put(numbers, &mut columns[column][k * LANES..]),
                );
            }
        }
    }
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

    /// The places of the images among the sorted agents, padding among them.
    fn image_places(&self) -> std::ops::Range<usize> {
        let end = self.index.agent.len();
        if self.images.start.is_empty() { end..end } else { self.images.first..end }
    }
}
