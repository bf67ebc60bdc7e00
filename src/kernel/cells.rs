//! Forces of one large crowd: a cell list, and vectors of neighbours.
//!
//! The plane is cut into strips as high as the reach of the farthest-reaching body, and each strip into
//! narrow cells. Every step the agents are sorted by strip and cell (a counting sort, in a cell by index),
//! so that the neighbours of an agent lie in three contiguous ranges, read eight at a time without gathers.
//! Each strip ends with absent bodies as padding; bodies that a vector catches beyond its range are out of
//! reach and add zero. Each pair is taken twice, once from either side, so all that is needed of the
//! neighbours is place and radius. Sums run over eight logical lanes whatever the width of the machine.

use super::contact::Contacts;
use super::forces::{Forces, REACH};
use super::lanewise::{Sum, cohesion, decay};
use super::program::Program;
use super::state::State;
use super::vector::{bits, larger, load, mask, smaller, splat};
use crate::base::lanes::{LANES, Lanes, Mask};
use fearless_simd::prelude::*;
use fearless_simd::{Simd, f64x8};
use std::f64::consts::LOG2_E;

/// Cells of a strip per reach.
const CELLS_PER_REACH: f64 = 4.0;

/// What is needed of an agent as the one who feels the forces.
#[derive(Clone, Copy, Debug)]
struct Feeler {
    x: f64,
    y: f64,
    r: f64,
    a: f64,
    /// A (1 + lambda)/2, and A (1 - lambda)/2 times the desired direction.
    even: f64,
    ex: f64,
    ey: f64,
    /// log2(e)/B
    rate: f64,
}

const NOBODY: Feeler =
    Feeler { x: 0.0, y: 0.0, r: f64::NEG_INFINITY, a: 0.0, even: 0.0, ex: 0.0, ey: 0.0, rate: 1.0 };

/// The second term of an agent.
#[derive(Clone, Copy, Debug, Default)]
struct Second {
    even: f64,
    ex: f64,
    ey: f64,
    rate: f64,
}

/// How the plane is cut.
#[derive(Clone, Copy, Debug)]
struct Grid {
    x: f64,
    y: f64,
    reach: f64,
    per_width: f64,
    per_height: f64,
    columns: usize,
    strips: usize,
}

impl Grid {
    /// Column of an abscissa: never falls as the abscissa rises.
    #[inline(always)]
    fn column(&self, x: f64) -> usize {
        // The cast saturates, and takes NaN to 0.
        (((x - self.x) * self.per_width) as usize).min(self.columns - 1)
    }

    #[inline(always)]
    fn strip(&self, y: f64) -> usize {
        (((y - self.y) * self.per_height) as usize).min(self.strips - 1)
    }
}

/// Room for the forces of one large crowd.
#[derive(Clone, Debug, Default)]
pub(super) struct Cells {
    /// Cell of each agent; `u32::MAX` in one who is absent.
    cell: Vec<u32>,
    /// Where each cell starts among the sorted agents; each strip has one more for its end.
    start: Vec<u32>,
    next: Vec<u32>,
    feelers: Vec<Feeler>,
    seconds: Vec<Second>,
    agent: Vec<u32>,
    x: Vec<f64>,
    y: Vec<f64>,
    r: Vec<f64>,
    /// Factor of the social force towards bodies of several persons; NaN in a single person.
    tie: Vec<f64>,
}

impl Cells {
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
        sums.resize(state.x.len(), Sum::default());
        contacts.clear(state.agents);
        if !state.occupied.has(0) {
            return;
        }
        let grid = survey(simd, forces, state);
        self.sort(simd, &grid, forces, state);
        match (forces.second, forces.ties.is_empty()) {
            (false, true) => self.pairs::<S, false, false>(simd, &grid, forces, sums, contacts),
            (true, true) => self.pairs::<S, true, false>(simd, &grid, forces, sums, contacts),
            (false, false) => self.pairs::<S, false, true>(simd, &grid, forces, sums, contacts),
            (true, false) => self.pairs::<S, true, true>(simd, &grid, forces, sums, contacts),
        }
        self.walls(simd, &grid, forces, sums, contacts);
        cohesion(simd, forces, state, sums);
    }

    /// Sorts the agents who are present by strip and cell.
    #[inline(always)]
    fn sort<S: Simd>(&mut self, simd: S, grid: &Grid, forces: &Forces, state: &State) {
        let row = grid.columns + 1;
        self.start.clear();
        self.start.resize(grid.strips * row, 0);
        self.cell.clear();
        for agent in 0..state.agents {
            let slot = state.slot(agent, 0);
            let cell = if state.present[slot.block].has(slot.lane) {
                let x = state.x[slot.block].0[slot.lane];
                let y = state.y[slot.block].0[slot.lane];
                let cell = grid.strip(y) * row + grid.column(x);
                self.start[cell] += 1;
                cell as u32
            } else {
                u32::MAX
            };
            self.cell.push(cell);
        }
        let mut total = 0;
        for strip in self.start.chunks_exact_mut(row) {
            for start in strip.iter_mut() {
                let count = *start;
                *start = total;
                total += count;
            }
            total += LANES as u32;
        }
        let total = total as usize;
        self.next.clone_from(&self.start);
        self.feelers.clear();
        self.feelers.resize(total, NOBODY);
        self.agent.clear();
        self.agent.resize(total, u32::MAX);
        if forces.second {
            self.seconds.clear();
            self.seconds.resize(total, Second::default());
        }
        let half = splat(simd, 0.5);
        let one = splat(simd, 1.0);
        for block in 0..state.x.len() {
            let (ex, ey) = (load(simd, &state.ex[block]), load(simd, &state.ey[block]));
            let term = |a: &Lanes, lambda: &Lanes, b: &Lanes| {
                let (a, lambda) = (load(simd, a), load(simd, lambda));
                let odd = a * (half * (one - lambda));
                let even = a * (half * (one + lambda));
                let rate = splat(simd, LOG2_E) / load(simd, b);
                [even.to_array(), (odd * ex).to_array(), (odd * ey).to_array(), rate.to_array()]
            };
            let [even, tx, ty, rate] = term(&state.a[block], &state.lambda[block], &state.b[block]);
            let second =
                forces.second.then(|| term(&state.a2[block], &state.lambda2[block], &state.b2[block]));
            for lane in 0..LANES.min(state.agents - block * LANES) {
                let agent = block * LANES + lane;
                let cell = self.cell[agent];
                if cell == u32::MAX {
                    continue;
                }
                let at = self.next[cell as usize] as usize;
                self.next[cell as usize] += 1;
                self.agent[at] = agent as u32;
                self.feelers[at] = Feeler {
                    x: state.x[block].0[lane],
                    y: state.y[block].0[lane],
                    r: state.radius[block].0[lane],
                    a: state.a[block].0[lane],
                    even: even[lane],
                    ex: tx[lane],
                    ey: ty[lane],
                    rate: rate[lane],
                };
                if let Some([even, ex, ey, rate]) = &second {
                    self.seconds[at] =
                        Second { even: even[lane], ex: ex[lane], ey: ey[lane], rate: rate[lane] };
                }
            }
        }
        self.x.clear();
        self.y.clear();
        self.r.clear();
        self.x.extend(self.feelers.iter().map(|feeler| feeler.x));
        self.y.extend(self.feelers.iter().map(|feeler| feeler.y));
        self.r.extend(self.feelers.iter().map(|feeler| feeler.r));
        if !forces.ties.is_empty() {
            self.tie.clear();
            self.tie.extend(self.agent.iter().map(|&agent| {
                forces.ties.get(agent as usize).copied().flatten().map_or(f64::NAN, |tie| tie.repulsion)
            }));
        }
    }

    /// Social forces between agents.
    #[inline(always)]
    fn pairs<S: Simd, const SECOND: bool, const TIES: bool>(
        &self,
        simd: S,
        grid: &Grid,
        forces: &Forces,
        sums: &mut [Sum],
        contacts: &mut Contacts,
    ) {
        let c = |value: f64| splat(simd, value);
        let row = grid.columns + 1;
        let minus_margin = c(-forces.margin);
        let tiny = c(1e-300);
        let one = c(1.0);
        for strip in 0..grid.strips {
            let from = self.start[strip * row] as usize;
            let to = self.start[strip * row + grid.columns] as usize;
            for i in from..to {
                let own = self.feelers[i];
                let (x, y, r, rate) = (c(own.x), c(own.y), c(own.r), c(own.rate));
                let (even, ex, ey) = (c(own.even), c(own.ex), c(own.ey));
                let (left, right) = (grid.column(own.x - grid.reach), grid.column(own.x + grid.reach));
                let (mut fx, mut fy) = (c(0.0), c(0.0));
                for other in strip.saturating_sub(1)..(strip + 2).min(grid.strips) {
                    let mut j = self.start[other * row + left] as usize;
                    let end = self.start[other * row + right + 1] as usize;
                    while j < end {
                        let dx = x - f64x8::from_slice(simd, &self.x[j..j + LANES]);
                        let dy = y - f64x8::from_slice(simd, &self.y[j..j + LANES]);
                        let d = (dx * dx + dy * dy + tiny).sqrt();
                        let q = one / d;
                        let gap = r + f64x8::from_slice(simd, &self.r[j..j + LANES]) - d;
                        // Each pair is a candidate once, and nobody with themselves.
                        let later = if j > i { 0xff } else { 0xff << (i + 1 - j).min(LANES) };
                        let touching = bits(gap.simd_gt(minus_margin)) & Mask((later & 0xff) as u8);
                        for lane in touching.iter() {
                            let pair = (self.agent[i], self.agent[j + lane]);
                            contacts.push_pair(pair.0.min(pair.1), pair.0.max(pair.1), Mask::lane(0));
                        }
                        let mut f = decay(simd, gap * rate) * q * (even - (dx * ex + dy * ey) * q);
                        if SECOND {
                            let own = self.seconds[i];
                            let weight = c(own.even) - (dx * c(own.ex) + dy * c(own.ey)) * q;
                            f = f + decay(simd, gap * c(own.rate)) * q * weight;
                        }
                        if TIES {
                            let mean =
                                c(0.5) * (c(self.tie[i]) + f64x8::from_slice(simd, &self.tie[j..j + LANES]));
                            f = f * mean.simd_eq(mean).select(mean, one);
                        }
                        fx = fx + f * dx;
                        fy = fy + f * dy;
                        j += LANES;
                    }
                }
                let agent = self.agent[i] as usize;
                let sum = &mut sums[agent / LANES];
                sum.x.0[agent % LANES] = fx.reduce_sum();
                sum.y.0[agent % LANES] = fy.reduce_sum();
            }
        }
    }

    #[inline(always)]
    fn walls<S: Simd>(
        &self,
        simd: S,
        grid: &Grid,
        forces: &Forces,
        sums: &mut [Sum],
        contacts: &mut Contacts,
    ) {
        if forces.surfaces.is_empty() {
            return;
        }
        let row = grid.columns + 1;
        let minus_margin = splat(simd, -forces.margin);
        let limit = splat(simd, grid.reach * grid.reach);
        let height = 1.0 / grid.per_height;
        let mut near = Vec::new();
        for strip in 0..grid.strips {
            // The last strip holds all that is above, the first all that is below.
            let low = if strip == 0 { f64::NEG_INFINITY } else { grid.y + (strip as f64 - 0.5) * height };
            let last = strip + 1 == grid.strips;
            let high = if last { f64::INFINITY } else { grid.y + (strip as f64 + 1.5) * height };
            near.clear();
            near.extend(forces.surfaces.iter().enumerate().filter(|(_, surface)| {
                surface.bounds.high.y >= low - grid.reach && surface.bounds.low.y <= high + grid.reach
            }));
            let mut k = self.start[strip * row] as usize;
            let to = self.start[strip * row + grid.columns] as usize;
            while k < to {
                let x = f64x8::from_slice(simd, &self.x[k..k + LANES]);
                let y = f64x8::from_slice(simd, &self.y[k..k + LANES]);
                let r = f64x8::from_slice(simd, &self.r[k..k + LANES]);
                for &(index, surface) in &near {
                    if !surface.squared_distance_to_bounds(simd, x, y).simd_le(limit).any_true() {
                        continue;
                    }
                    let nearest = surface.nearest(simd, x, y);
                    let gap = r - nearest.distance;
                    for lane in bits(gap.simd_gt(minus_margin)).iter() {
                        contacts.push_wall(self.agent[k + lane], index as u32, Mask::lane(0));
                    }
                    let own = &self.feelers[k..k + LANES];
                    let a = f64x8::from_fn(simd, |lane| own[lane].a);
                    let rate = f64x8::from_fn(simd, |lane| own[lane].rate);
                    let f = a * decay(simd, gap * rate);
                    let (fx, fy) = ((f * nearest.nx).to_array(), (f * nearest.ny).to_array());
                    for lane in 0..LANES.min(to - k) {
                        let agent = self.agent[k + lane] as usize;
                        sums[agent / LANES].x.0[agent % LANES] += fx[lane];
                        sums[agent / LANES].y.0[agent % LANES] += fy[lane];
                    }
                }
                k += LANES;
            }
        }
    }
}

/// Extent of the crowd and its farthest reach.
#[inline(always)]
fn survey<S: Simd>(simd: S, forces: &Forces, state: &State) -> Grid {
    let c = |value: f64| splat(simd, value);
    let (mut low_x, mut low_y) = (c(f64::INFINITY), c(f64::INFINITY));
    let (mut high_x, mut high_y) = (c(f64::NEG_INFINITY), c(f64::NEG_INFINITY));
    let (mut widest, mut farthest) = (c(0.0), c(forces.margin));
    for block in 0..state.x.len() {
        let here = mask(simd, state.present[block]);
        let (x, y) = (load(simd, &state.x[block]), load(simd, &state.y[block]));
        low_x = smaller(here.select(x, low_x), low_x);
        high_x = larger(here.select(x, high_x), high_x);
        low_y = smaller(here.select(y, low_y), low_y);
        high_y = larger(here.select(y, high_y), high_y);
        widest = larger(here.select(load(simd, &state.radius[block]), widest), widest);
        let mut range = load(simd, &state.b[block]);
        if forces.second {
            range = larger(range, load(simd, &state.b2[block]));
        }
        farthest = larger(here.select(c(REACH) * range, farthest), farthest);
    }
    let least = |v: f64x8<S>| v.to_array().into_iter().fold(f64::INFINITY, |a, b| if b < a { b } else { a });
    let most =
        |v: f64x8<S>| v.to_array().into_iter().fold(f64::NEG_INFINITY, |a, b| if b > a { b } else { a });
    // A little more, for what rounding may take off a distance.
    let reach = (2.0 * most(widest) + most(farthest)) * (1.0 + 1e-9);
    let (x, y) = (least(low_x), least(low_y));
    let (wide, high) = (most(high_x) - x, most(high_y) - y);
    let mut grid = Grid { x, y, reach, per_width: 0.0, per_height: 0.0, columns: 1, strips: 1 };
    if !(wide.is_finite() && high.is_finite() && reach.is_finite() && reach > 0.0) {
        // Nobody there, or somebody infinitely far away: one cell holds all.
        return Grid { x: 0.0, y: 0.0, ..grid };
    }
    let mut height = reach;
    let mut width = reach / CELLS_PER_REACH;
    // Someone far away must not make millions of empty cells.
    let most_cells = 8.0 * state.agents as f64 + 64.0;
    while (wide / width + 1.0) * (high / height + 1.0) > most_cells {
        height *= 2.0;
        width *= 2.0;
    }
    grid.per_width = 1.0 / width;
    grid.per_height = 1.0 / height;
    grid.columns = (wide * grid.per_width) as usize + 1;
    grid.strips = (high * grid.per_height) as usize + 1;
    grid
}
