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
use super::program::Program;
use super::social::{Sum, cohesion};
use super::state::State;
use super::surfaces;
use crate::base::lanes::LANES;
use fearless_simd::Simd;
use grid::{Grid, survey};
use pairs::{Task, Touch};
use std::ops::Range;

/// One exponential term of the sorted agents, as in `social::Term`.
#[derive(Clone, Debug, Default)]
struct Terms {
    even: Vec<f64>,
    ex: Vec<f64>,
    ey: Vec<f64>,
    rate: Vec<f64>,
}

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
    a: Vec<f64>,
    a2: Vec<f64>,
    term: Terms,
    second: Terms,
    /// Factor of the bounded social force towards bodies of several persons; NaN in a single person.
    tie: Vec<f64>,
    /// What drives each body, m v0/tau, N. Empty without two bodies of several persons, as `tie` is.
    drive: Vec<f64>,
    /// The forces.
    fx: Vec<f64>,
    fy: Vec<f64>,
    /// Of one strip: the vectors of neighbours, and the sums of its agents over eight lanes.
    tasks: Vec<Task>,
    touches: Vec<Touch>,
    own: Vec<Sum>,
    room: Vec<u32>,
    near: Vec<u32>,
    faces: surfaces::Room,
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
        program: &Program,
        state: &State,
        sums: &mut Vec<Sum>,
        contacts: &mut Contacts,
    ) {
        let forces = &program.forces;
        sums.clear();
        sums.resize(state.motion.x.len(), Sum::default());
        contacts.clear();
        self.edge = f64::NEG_INFINITY;
        if !state.occupied.has(0) {
            return;
        }
        let grid = survey(simd, forces, state);
        self.edge = grid.edge;
        simd.vectorize(
            #[inline(always)]
            || self.sort(simd, &grid, forces, state),
        );
        // A function each, as in `lanewise`.
        match (forces.shared.is_some(), forces.second, !forces.ties.is_empty()) {
            (true, false, _) => simd.vectorize(
                #[inline(always)]
                || self.pairs::<S, true, false, false>(simd, &grid, forces, contacts),
            ),
            (true, true, _) => simd.vectorize(
                #[inline(always)]
                || self.pairs::<S, true, true, false>(simd, &grid, forces, contacts),
            ),
            (false, false, false) => simd.vectorize(
                #[inline(always)]
                || self.pairs::<S, false, false, false>(simd, &grid, forces, contacts),
            ),
            (false, true, false) => simd.vectorize(
                #[inline(always)]
                || self.pairs::<S, false, true, false>(simd, &grid, forces, contacts),
            ),
            (false, false, true) => simd.vectorize(
                #[inline(always)]
                || self.pairs::<S, false, false, true>(simd, &grid, forces, contacts),
            ),
            (false, true, true) => simd.vectorize(
                #[inline(always)]
                || self.pairs::<S, false, true, true>(simd, &grid, forces, contacts),
            ),
        }
        simd.vectorize(
            #[inline(always)]
            || self.walls(simd, &grid, forces, contacts),
        );
        self.scatter(&grid, sums);
        contacts.arrange();
        cohesion(forces, state, sums);
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
