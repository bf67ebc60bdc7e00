//! Walls and obstacles of one large crowd.

use super::Cells;
use super::reach::{Reach, Sorted};
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
        reach: &Reach,
        forces: &Forces,
        state: &State,
        contacts: &mut Contacts,
    ) {
        if forces.surfaces.is_empty() {
            return;
        }
        let mut room = std::mem::take(&mut self.room);
        for strip in 0..self.index.grid.strips {
            let here = self.index.strip(strip);
            for k in here.clone().step_by(LANES) {
                let group = k..here.end.min(k + LANES);
                let around = reach.around(&self.index.x[group.clone()], &self.index.y[group]);
                let near = forces.surfaces.nearby.find(&around, &mut room);
                for part in parts(simd) {
                    self.walls_at(part, reach, (forces, state), near, k, contacts);
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
        reach: &Reach,
        (forces, state): (&Forces, &State),
        near: &[u32],
        k: usize,
        contacts: &mut Contacts,
    ) {
        let surfaces = &forces.surfaces;
        let eight = k..k + LANES;
        let (x, y) = (part.slice(&self.index.x[eight.clone()]), part.slice(&self.index.y[eight.clone()]));
        let limit = part.c(reach.most * reach.most);
        self.near.clear();
        self.near.extend(
            near.iter().copied().filter(|&face| {
                surfaces.squared_distance_to_bounds(face, part, x, y).simd_le(limit).any_true()
            }),
        );
        if self.near.is_empty() {
            return;
        }
        let agents = Sorted { part, agents: &self.index.agent[eight.clone()] };
        let at = AtWalls::new(part, (x, y), part.slice(&self.index.r[eight.clone()]), forces, state, agents);
        let touching = |face, lanes| {
            for lane in part.bits(lanes).iter() {
                contacts.push_wall(self.index.agent[k + lane], face, Mask::lane(0));
            }
        };
        let (fx, fy) = surfaces.push(part, &self.near, &at, forces.margin, &mut self.faces, touching);
        part.take(-fx, &mut self.fx[eight.clone()]);
        part.take(-fy, &mut self.fy[eight]);
    }
}
