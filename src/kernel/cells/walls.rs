//! Walls and obstacles of one large crowd.
//!
//! Such a crowd is sparse among walls: eight who follow each other in a strip are metres apart and hardly share a face. So
//! those stand in lanes who are in squares with the same list of faces (`Tiles`).

use super::Cells;
use super::reach::{Reach, Sorted};
use crate::base::geometry::{Bounds, Vec2};
use crate::base::lanes::{LANES, Lanes, Mask};
use crate::kernel::contact::Contacts;
use crate::kernel::force::Forces;
use crate::kernel::force::pair::Sum;
use crate::kernel::force::walls::{AtWalls, Surfaces, Tiles};
use crate::kernel::near::Index;
use crate::kernel::state::State;
use crate::kernel::vector::parts;
use fearless_simd::Simd;
use std::ops::Range;

/// The faces that can stand between two agents.
#[derive(Clone, Debug, Default)]
struct Dividing {
    /// Between any two in here; `None` before the first look at a scene.
    around: Option<Bounds>,
    is: Vec<bool>,
    room: Vec<u32>,
}

impl Dividing {
    /// Looks again if agents have left the rectangle of the last look.
    fn look(&mut self, surfaces: &Surfaces, all: &Bounds) {
        let holds = |old: &Bounds| old.low.inf(&all.low) == old.low && old.high.sup(&all.high) == old.high;
        if self.around.as_ref().is_some_and(holds) {
            return;
        }
        let more = Vec2::repeat(0.5);
        let around = Bounds { low: all.low - more, high: all.high + more };
        surfaces.list_screens(&around, &mut self.room);
        self.is.clear();
        self.is.resize(surfaces.len(), false);
        for &face in &self.room {
            self.is[face as usize] = true;
        }
        self.around = Some(around);
    }
}

/// Who is near which faces, and the force of these.
#[derive(Clone, Debug, Default)]
pub(super) struct Walls {
    tiles: Tiles,
    dividing: Dividing,
    /// Those of the sorted agents who have a list, with their lists.
    listed: Vec<(u32, u32)>,
    /// Where the agents of each list end in `places`.
    ends: Vec<u32>,
    places: Vec<u32>,
    /// Faces that may hide others, and where those of each of the sorted agents begin and end; empty without walls.
    screens: Vec<u32>,
    screens_of: Vec<(u32, u32)>,
    /// Forces, N.
    forces: Vec<(u32, Vec2)>,
}

impl Walls {
    /// The faces that may hide others from one of the sorted agents.
    #[inline(always)]
    pub(super) fn screens(&self, at: usize) -> &[u32] {
        let (from, to) = self.screens_of[at];
        &self.screens[from as usize..to as usize]
    }

    /// Whether any face may hide anybody.
    pub(super) const fn has_screens(&self) -> bool {
        !self.screens.is_empty()
    }

    /// Sorts the agents by their lists, in a list by place.
    fn sort(&mut self, index: &Index) {
        self.listed.clear();
        self.ends.clear();
        self.ends.resize(self.tiles.lists.len(), 0);
        for at in (0..index.grid.strips).flat_map(|strip| index.strip(strip)) {
            let list = self.tiles.at(Vec2::new(index.x[at], index.y[at]));
            if list != 0 {
                self.listed.push((at as u32, list));
                self.ends[list as usize] += 1;
            }
        }
        let mut end = 0;
        for count in &mut self.ends {
            (*count, end) = (end, end + *count);
        }
        self.places.resize(self.listed.len(), 0);
        for &(at, list) in &self.listed {
            let next = &mut self.ends[list as usize];
            self.places[*next as usize] = at;
            *next += 1;
        }
    }
}

impl Cells {
    /// The force of walls on each agent, who may touch which, and which may hide others from whom.
    #[inline(always)]
    pub(super) fn look_at_walls<S: Simd>(
        &mut self,
        simd: S,
        reach: &Reach,
        forces: &Forces,
        state: &State,
        contacts: &mut Contacts,
    ) {
        let walls = &mut self.walls;
        walls.screens.clear();
        walls.screens_of.clear();
        walls.forces.clear();
        if forces.surfaces.is_empty() {
            return;
        }
        let beyond = if self.images.start.is_empty() { 0.0 } else { reach.most };
        if walls.tiles.prepare(&forces.surfaces, reach.most) {
            walls.dividing.around = None;
        }
        walls.dividing.look(&forces.surfaces, &reach.extent.around(beyond));
        walls.sort(&self.index);
        walls.screens_of.resize(self.index.agent.len(), (0, 0));
        let mut from = 0;
        for list in 1..self.walls.ends.len() {
            let end = self.walls.ends[list] as usize;
            if from == end {
                continue;
            }
            let Walls { tiles, dividing, screens, screens_of, places, .. } = &mut self.walls;
            let first = screens.len() as u32;
            screens.extend(tiles.lists[list].iter().filter(|face| dividing.is[**face as usize]));
            for &at in &places[from..end] {
                screens_of[at as usize] = (first, screens.len() as u32);
            }
            while from < end {
                let to = end.min(from + LANES);
                self.push(simd, from..to, list, (forces, state), contacts);
                from = to;
            }
        }
    }

    /// The force of the faces of a list on up to eight agents of it.
    #[inline(always)]
    fn push<S: Simd>(
        &mut self,
        simd: S,
        few: Range<usize>,
        list: usize,
        (forces, state): (&Forces, &State),
        contacts: &mut Contacts,
    ) {
        let Self { index, walls, faces: room, .. } = self;
        let (few, faces) = (&walls.places[few], &walls.tiles.lists[list]);
        // The last one stands in for those who are missing.
        let places: [usize; LANES] = std::array::from_fn(|lane| few[lane.min(few.len() - 1)] as usize);
        let agents = places.map(|at| index.agent[at]);
        let there = Mask((0xff_u32 >> (LANES - few.len())) as u8);
        let surfaces = forces.surfaces(state.doors.sets[0]);
        let (mut fx, mut fy) = (Lanes::ZERO, Lanes::ZERO);
        for part in parts(simd) {
            let of = |field: &[f64]| {
                part.gather(
                    #[inline(always)]
                    |lane| field[places[lane]],
                )
            };
            let place = (of(&index.x), of(&index.y));
            let at = AtWalls::new(part, place, of(&index.r), forces, state, Sorted { part, agents: &agents });
            let touching = |face, lanes| {
                for lane in (part.bits(lanes) & there).iter() {
                    contacts.push_wall(agents[lane], face, Mask::lane(0));
                }
            };
            let (x, y) = surfaces.push(part, faces, &at, forces.margin, room, touching);
            part.store(x, &mut fx);
            part.store(y, &mut fy);
        }
        let each = few.iter().enumerate();
        walls.forces.extend(each.map(|(lane, &at)| (at, Vec2::new(fx.0[lane], fy.0[lane]))));
    }

    /// Adds the force of walls, after those between agents.
    pub(super) fn add_walls(&self, sums: &mut [Sum]) {
        for &(at, force) in &self.walls.forces {
            let agent = self.index.agent[at as usize] as usize;
            let sum = &mut sums[agent / LANES];
            sum.x.0[agent % LANES] += force.x;
            sum.y.0[agent % LANES] += force.y;
        }
    }
}
