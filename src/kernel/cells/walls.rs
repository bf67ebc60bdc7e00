//! Walls and obstacles of one large crowd.

use super::Cells;
use super::grid::Grid;
use super::sort::Sorted;
use crate::base::lanes::{LANES, Mask};
use crate::kernel::contact::Contacts;
use crate::kernel::force::Forces;
use crate::kernel::force::walls::AtWalls;
use crate::kernel::state::State;
use crate::kernel::vector::{Part, parts};
use fearless_simd::Simd;
use fearless_simd::prelude::*;

impl Cells {
    #[inline(always)]
    pub(super) fn walls<S: Simd>(
        &mut self,
        simd: S,
        grid: &Grid,
        forces: &Forces,
        state: &State,
        contacts: &mut Contacts,
    ) {
        if forces.surfaces.is_empty() {
            return;
        }
        let mut room = std::mem::take(&mut self.room);
        for strip in 0..grid.strips {
            let here = self.strip(grid, strip);
            for k in here.clone().step_by(LANES) {
                let group = k..here.end.min(k + LANES);
                let around = grid.around(&self.x[group.clone()], &self.y[group]);
                let near = forces.surfaces.nearby.find(&around, &mut room);
                for part in parts(simd) {
                    self.walls_at(part, grid, (forces, state), near, k, contacts);
                }
            }
        }
        self.room = room;
    }

    /// Force of some faces on the sorted agents `k..k + 8`, of whom some may be padding.
    #[inline(always)]
    fn walls_at<S: Simd>(
        &mut self,
        part: Part<S>,
        grid: &Grid,
        (forces, state): (&Forces, &State),
        near: &[u32],
        k: usize,
        contacts: &mut Contacts,
    ) {
        let surfaces = &forces.surfaces;
        let eight = k..k + LANES;
        let (x, y) = (part.slice(&self.x[eight.clone()]), part.slice(&self.y[eight.clone()]));
        let limit = part.c(grid.reach * grid.reach);
        self.near.clear();
        self.near.extend(
            near.iter().copied().filter(|&face| {
                surfaces.squared_distance_to_bounds(face, part, x, y).simd_le(limit).any_true()
            }),
        );
        if self.near.is_empty() {
            return;
        }
        let agents = Sorted { part, agents: &self.agent[eight.clone()] };
        let at = AtWalls::new(part, (x, y), part.slice(&self.r[eight.clone()]), forces.shared, state, agents);
        let touching = |face, lanes| {
            for lane in part.bits(lanes).iter() {
                contacts.push_wall(self.agent[k + lane], face, Mask::lane(0));
            }
        };
        let (fx, fy) = surfaces.push(part, &self.near, &at, forces.margin, &mut self.faces, touching);
        part.take(-fx, &mut self.fx[eight.clone()]);
        part.take(-fy, &mut self.fy[eight]);
    }
}
