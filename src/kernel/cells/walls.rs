//! Walls and obstacles of one large crowd.

use super::Cells;
use super::grid::Grid;
use crate::base::lanes::{LANES, Mask};
use crate::kernel::contact::Contacts;
use crate::kernel::forces::Forces;
use crate::kernel::social::{decay, is_in_reach};
use crate::kernel::vector::{Part, parts};
use fearless_simd::Simd;
use fearless_simd::prelude::*;

impl Cells {
    #[inline(always)]
    pub(super) fn walls<S: Simd>(&mut self, simd: S, grid: &Grid, forces: &Forces, contacts: &mut Contacts) {
        if forces.surfaces.is_empty() {
            return;
        }
        let mut room = std::mem::take(&mut self.room);
        for strip in 0..grid.strips {
            let here = self.strip(grid, strip);
            for k in here.clone().step_by(LANES) {
                let group = k..here.end.min(k + LANES);
                let around = grid.around(&self.x[group.clone()], &self.y[group]);
                for &index in forces.surfaces.nearby.find(&around, &mut room) {
                    for part in parts(simd) {
                        self.wall(part, grid, forces, index, k, contacts);
                    }
                }
            }
        }
        self.room = room;
    }

    /// Force of one surface on the sorted agents `k..k + 8`, of whom some may be padding.
    #[inline(always)]
    fn wall<S: Simd>(
        &mut self,
        part: Part<S>,
        grid: &Grid,
        forces: &Forces,
        index: u32,
        k: usize,
        contacts: &mut Contacts,
    ) {
        let surface = forces.surfaces.at(index);
        let eight = k..k + LANES;
        let (x, y) = (part.slice(&self.x[eight.clone()]), part.slice(&self.y[eight.clone()]));
        let limit = part.c(grid.reach * grid.reach);
        if !surface.squared_distance_to_bounds(part, x, y).simd_le(limit).any_true() {
            return;
        }
        let nearest = surface.nearest(part, x, y);
        let r = part.slice(&self.r[eight.clone()]);
        let gap = r - nearest.distance;
        for lane in part.bits(gap.simd_gt(part.c(-forces.margin))).iter() {
            contacts.push_wall(self.agent[k + lane], index, Mask::lane(0));
        }
        let rate = part.slice(&self.term.rate[eight.clone()]);
        let mut power = gap * rate;
        if is_in_reach(part, power) {
            power = (r - forces.surfaces.felt(index, part, (x, y), &nearest)) * rate;
        }
        let f = part.slice(&self.a[eight.clone()]) * decay(part, power);
        part.take(f * -nearest.nx, &mut self.fx[eight.clone()]);
        part.take(f * -nearest.ny, &mut self.fy[eight]);
    }
}
