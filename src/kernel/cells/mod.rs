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

mod grid;
mod pairs;
mod sort;
mod walls;

use super::contact::Contacts;
use super::force::pair::Sum;
use super::force::{Forces, walls as faces, with_pair_terms};
use super::state::State;
use crate::base::lanes::LANES;
use fearless_simd::Simd;
use grid::{Grid, survey};
use pairs::{Task, Touch};
use std::ops::Range;

/// Room for the forces of one large crowd.
#[derive(Clone, Debug, Default)]
pub(super) struct Cells {
    /// Cell of each slot; that of an absent agent means nothing.
    cell: Vec<u32>,
    /// Where each cell starts among the sorted agents; each strip has one more for its end.
    start: Vec<u32>,
    next: Vec<u32>,
    /// All that follows is in sorted order, with padding between the strips.
    agent: Vec<u32>,
    x: Vec<f64>,
    y: Vec<f64>,
    /// Radius; minus infinity in padding, which is so beyond everybody's reach.
    r: Vec<f64>,
    /// What the terms between two bodies keep of each agent: a column for each number.
    columns: Vec<Vec<f64>>,
    /// The forces.
    fx: Vec<f64>,
    fy: Vec<f64>,
    /// Of one strip: the vectors of neighbours, and the sums of its agents over eight lanes.
    tasks: Vec<Task>,
    touches: Vec<Touch>,
    own: Vec<Sum>,
    room: Vec<u32>,
    near: Vec<u32>,
    faces: faces::Room,
    /// As in `Close`.
    edge: f64,
}

impl Cells {
    /// Between two who were not found near enough to touch is a gap of more than this, m.
    pub(super) const fn edge(&self) -> f64 {
        self.edge
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
        let grid = with_pair_terms!(forces, term, survey(simd, term, forces.margin, state));
        self.edge = grid.edge;
        simd.vectorize(
            #[inline(always)]
            || self.sort(simd, &grid, state),
        );
        with_pair_terms!(
            forces,
            term,
            simd.vectorize(
                #[inline(always)]
                || self.keep(simd, term, state),
            )
        );
        // A function for each combination of terms, as in `lanewise`.
        with_pair_terms!(
            forces,
            term,
            simd.vectorize(
                #[inline(always)]
                || self.pairs(simd, &grid, term, forces.margin, contacts),
            )
        );
        simd.vectorize(
            #[inline(always)]
            || self.walls(simd, &grid, forces, state, contacts),
        );
        self.scatter(&grid, sums);
        contacts.arrange();
        forces.add_cohesion(state, sums);
    }

    /// Hands the forces to the agents.
    fn scatter(&self, grid: &Grid, sums: &mut [Sum]) {
        for strip in 0..grid.strips {
            for at in self.strip(grid, strip) {
                let agent = self.agent[at] as usize;
                let sum = &mut sums[agent / LANES];
                sum.x.0[agent % LANES] = self.fx[at];
                sum.y.0[agent % LANES] = self.fy[at];
            }
        }
    }

    /// The sorted agents of a strip.
    #[inline(always)]
    fn strip(&self, grid: &Grid, strip: usize) -> Range<usize> {
        let first = strip * grid.row();
        self.start[first] as usize..self.start[first + grid.columns] as usize
    }
}
