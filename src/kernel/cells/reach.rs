//! How far the agents of one large crowd feel each other, and how they are read in sorted order.

use crate::base::lanes::{LANES, Lanes};
use crate::kernel::force::pair::{AgentsInLanes, Block, PairTerm};
use crate::kernel::near::{Extent, Grid, most};
use crate::kernel::state::State;
use crate::kernel::vector::{Doubles, Part, larger, parts};
use fearless_simd::Simd;
use fearless_simd::prelude::*;

/// Cells of a strip per reach.
const CELLS_PER_REACH: f64 = 8.0;

/// How far agents feel each other.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reach {
    pub(super) extent: Extent,
    /// How far apart the centres of two bodies can be, at most, that feel each other, m.
    pub(super) most: f64,
    /// The same, less the radius of the first body.
    beyond: f64,
    /// What rounding may take off a distance, amply, m.
    slack: f64,
    /// Between two that cannot touch within a step is a gap of more than this, m, however it is rounded: see `Close`.
    pub(super) edge: f64,
}

impl Reach {
    /// In a state. Bodies nearer than `margin` to touching may touch within a step.
    #[inline(always)]
    pub(super) fn of<S: Simd, T: PairTerm>(simd: S, term: T, margin: f64, state: &State) -> Self {
        let extent = Extent::of(simd, state);
        let mut farthest = Lanes::splat(margin);
        for part in parts(simd) {
            let mut far = part.load(&farthest);
            for index in 0..state.motion.x.len() {
                let here = part.mask(state.present[index]);
                let reach = term.reach(part, state, Block { part, index });
                far = larger::<S>(here.select(reach, far), far);
            }
            part.store(far, &mut farthest);
        }
        let Extent { wide, high, widest, is_sound, .. } = extent;
        // A little more, for what rounding may take off a distance.
        let beyond = (widest + most(&farthest)) * (1.0 + 1e-9);
        let reach = widest + beyond;
        let slack = 1e-9 * (reach + wide + high);
        let edge = if is_sound { margin - 1e-9 * (2.0 * widest + margin) } else { f64::NEG_INFINITY };
        Self { extent, most: reach, beyond, slack: if slack.is_finite() { slack } else { 0.0 }, edge }
    }

    /// Width and height of a cell, m.
    pub(super) fn cell(&self) -> (f64, f64) {
        (self.most / CELLS_PER_REACH, self.most)
    }

    /// How far apart bodies of these radii and any other can be that feel each other.
    #[inline(always)]
    pub(super) fn of_radius<S: Simd>(&self, part: Part<S>, r: Doubles<S>) -> Doubles<S> {
        r + part.c(self.beyond + self.slack)
    }

    /// How far to the side others in the strip above `strip` can be in reach of those at `y` in `strip`: less,
    /// the farther the edge between.
    #[inline(always)]
    pub(super) fn above<S: Simd>(
        &self,
        part: Part<S>,
        grid: &Grid,
        strip: usize,
        y: Doubles<S>,
        reach: Doubles<S>,
    ) -> Doubles<S> {
        let edge = grid.edge_above(strip);
        let above = larger::<S>(part.c(edge - self.slack) - y, part.c(0.0));
        larger::<S>(reach * reach - above * above, part.c(0.0)).sqrt() + part.c(self.slack)
    }
}

/// Eight of the sorted agents.
#[derive(Clone, Copy)]
pub(super) struct Sorted<'a, S: Simd> {
    pub(super) part: Part<S>,
    pub(super) agents: &'a [u32],
}

impl<S: Simd> AgentsInLanes<S> for Sorted<'_, S> {
    #[inline(always)]
    fn field(self, field: &[Lanes]) -> Doubles<S> {
        self.part.gather(
            #[inline(always)]
            |lane| {
                let agent = self.agents[lane] as usize;
                field[agent / LANES].0[agent % LANES]
            },
        )
    }

    #[inline(always)]
    fn of_agents(self, numbers: &[f64]) -> Doubles<S> {
        self.part.gather(
            #[inline(always)]
            |lane| numbers[self.agents[lane] as usize],
        )
    }
}
