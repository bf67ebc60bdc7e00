//! Forces of one large crowd: a cell list, and vectors of neighbours.
//!
//! The plane is cut into strips as high as the reach of the farthest-reaching body, and each strip into
//! narrow cells. Every step the agents are sorted by strip and cell (a counting sort, in a cell by index),
//! so that the neighbours of an agent lie in three contiguous ranges, read eight at a time without gathers.
//! Each strip ends with absent bodies as padding; bodies that a vector catches beyond its range are out of
//! reach and add zero. Each pair is taken twice, once from either side, so all that is needed of the
//! neighbours is place and radius. Sums run over eight logical lanes whatever the width of the machine.

use super::barrier::Surface;
use super::contact::Contacts;
use super::forces::{Forces, REACH};
use super::lanewise::{Sum, Term, cohesion, decay};
use super::program::Program;
use super::state::State;
use super::vector::{Part, larger, parts, smaller};
use crate::base::lanes::{LANES, Lanes, Mask};
use crate::base::math::at_least;
use fearless_simd::Simd;
use fearless_simd::prelude::*;

/// Cells of a strip per reach.
const CELLS_PER_REACH: f64 = 8.0;

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
    /// What rounding may take off a distance, amply, m.
    slack: f64,
    height: f64,
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

    /// How far to the side others in strip `other` can be in reach of someone at `y` in `strip`: less,
    /// the farther the near edge of that strip.
    #[inline(always)]
    fn reach_into(&self, strip: usize, other: usize, y: f64) -> f64 {
        let edge = self.y + strip.max(other) as f64 * self.height;
        let beside = if other == strip { 0.0 } else { at_least((y - edge).abs() - self.slack, 0.0) };
        let square = at_least(self.reach * self.reach - beside * beside, 0.0);
        square.sqrt() + self.slack
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
        simd.vectorize(
            #[inline(always)]
            || self.sort(simd, &grid, forces, state),
        );
        // A function each, as in `lanewise`.
        match (forces.second, !forces.ties.is_empty()) {
            (false, false) => simd.vectorize(
                #[inline(always)]
                || self.pairs::<S, false, false>(simd, &grid, forces, sums, contacts),
            ),
            (true, false) => simd.vectorize(
                #[inline(always)]
                || self.pairs::<S, true, false>(simd, &grid, forces, sums, contacts),
            ),
            (false, true) => simd.vectorize(
                #[inline(always)]
                || self.pairs::<S, false, true>(simd, &grid, forces, sums, contacts),
            ),
            (true, true) => simd.vectorize(
                #[inline(always)]
                || self.pairs::<S, true, true>(simd, &grid, forces, sums, contacts),
            ),
        }
        simd.vectorize(
            #[inline(always)]
            || self.walls(simd, &grid, forces, sums, contacts),
        );
        contacts.arrange();
        cohesion(forces, state, sums);
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
        self.feelers.resize(total, NOBODY);
        self.agent.resize(total, u32::MAX);
        if forces.second {
            self.seconds.resize(total, Second::default());
        }
        for strip in self.start.chunks_exact(row) {
            let end = strip[grid.columns] as usize;
            self.feelers[end..end + LANES].fill(NOBODY);
            self.agent[end..end + LANES].fill(u32::MAX);
        }
        for block in 0..state.x.len() {
            let e = (&state.ex[block], &state.ey[block]);
            let mut first = Term::default();
            let mut second = Term::default();
            for part in parts(simd) {
                first.fill(part, (&state.a[block], &state.lambda[block]), Some(&state.b[block]), e);
                if forces.second {
                    second.fill(part, (&state.a2[block], &state.lambda2[block]), Some(&state.b2[block]), e);
                }
            }
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
                    even: first.even.0[lane],
                    ex: first.ex.0[lane],
                    ey: first.ey.0[lane],
                    rate: first.rate.0[lane],
                };
                if forces.second {
                    self.seconds[at] = Second {
                        even: second.even.0[lane],
                        ex: second.ex.0[lane],
                        ey: second.ey.0[lane],
                        rate: second.rate.0[lane],
                    };
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
        let row = grid.columns + 1;
        let (xs, ys, rs) = (&self.x[..], &self.y[..], &self.r[..]);
        let margin = -forces.margin;
        for strip in 0..grid.strips {
            let from = self.start[strip * row] as usize;
            let to = self.start[strip * row + grid.columns] as usize;
            for i in from..to {
                let own = &self.feelers[i];
                let mut ranges = [(0, 0); 3];
                let strips = strip.saturating_sub(1)..(strip + 2).min(grid.strips);
                for (range, other) in ranges.iter_mut().zip(strips) {
                    let reach = grid.reach_into(strip, other, own.y);
                    let (left, right) = (grid.column(own.x - reach), grid.column(own.x + reach));
                    let (start, end) = (other * row + left, other * row + right + 1);
                    *range = (self.start[start] as usize, self.start[end] as usize);
                }
                let (mut sum_x, mut sum_y) = (Lanes::ZERO, Lanes::ZERO);
                for part in parts(simd) {
                    let (x, y, r, rate) = (part.c(own.x), part.c(own.y), part.c(own.r), part.c(own.rate));
                    let (even, ex, ey) = (part.c(own.even), part.c(own.ex), part.c(own.ey));
                    let (mut fx, mut fy) = (part.c(0.0), part.c(0.0));
                    for (start, end) in ranges {
                        let mut j = start;
                        while j + part.at() < end {
                            let dx = x - part.slice(&xs[j..j + LANES]);
                            let dy = y - part.slice(&ys[j..j + LANES]);
                            let d = (dx * dx + dy * dy + part.c(1e-300)).sqrt();
                            let q = part.c(1.0) / d;
                            let gap = r + part.slice(&rs[j..j + LANES]) - d;
                            // Each pair is a candidate once, and nobody with themselves.
                            let later = if j > i { 0xff } else { 0xff << (i + 1 - j).min(LANES) };
                            let touching = part.bits(gap.simd_gt(part.c(margin)));
                            let touching = touching & Mask((later & 0xff) as u8);
                            if !touching.is_empty() {
                                self.candidates(i, j, touching, contacts);
                            }
                            let mut f = decay(part, gap * rate) * q * (even - (dx * ex + dy * ey) * q);
                            if SECOND {
                                let own = &self.seconds[i];
                                let weight =
                                    part.c(own.even) - (dx * part.c(own.ex) + dy * part.c(own.ey)) * q;
                                f += decay(part, gap * part.c(own.rate)) * q * weight;
                            }
                            if TIES {
                                let both = part.c(self.tie[i]) + part.slice(&self.tie[j..j + LANES]);
                                let mean = part.c(0.5) * both;
                                f *= mean.simd_eq(mean).select(mean, part.c(1.0));
                            }
                            fx += f * dx;
                            fy += f * dy;
                            j += LANES;
                        }
                    }
                    part.store(fx, &mut sum_x);
                    part.store(fy, &mut sum_y);
                }
                let agent = self.agent[i] as usize;
                let sum = &mut sums[agent / LANES];
                sum.x.0[agent % LANES] = total(&sum_x);
                sum.y.0[agent % LANES] = total(&sum_y);
            }
        }
    }

    #[cold]
    fn candidates(&self, i: usize, j: usize, touching: Mask, contacts: &mut Contacts) {
        for lane in touching.iter() {
            let (a, b) = (self.agent[i], self.agent[j + lane]);
            contacts.push_pair(a.min(b), a.max(b), Mask::lane(0));
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
        let height = grid.height;
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
                for part in parts(simd) {
                    for &(index, surface) in &near {
                        self.wall(part, grid, forces, (index, surface), (k, to), sums, contacts);
                    }
                }
                k += LANES;
            }
        }
    }

    /// Force of one surface on the sorted agents `k..k + 8`, of whom those from `to` on are padding.
    #[inline(always)]
    fn wall<S: Simd>(
        &self,
        part: Part<S>,
        grid: &Grid,
        forces: &Forces,
        (index, surface): (usize, &Surface),
        (k, to): (usize, usize),
        sums: &mut [Sum],
        contacts: &mut Contacts,
    ) {
        let (x, y) = (part.slice(&self.x[k..k + LANES]), part.slice(&self.y[k..k + LANES]));
        let limit = part.c(grid.reach * grid.reach);
        if !surface.squared_distance_to_bounds(part, x, y).simd_le(limit).any_true() {
            return;
        }
        let nearest = surface.nearest(part, x, y);
        let gap = part.slice(&self.r[k..k + LANES]) - nearest.distance;
        for lane in part.bits(gap.simd_gt(part.c(-forces.margin))).iter() {
            contacts.push_wall(self.agent[k + lane], index as u32, Mask::lane(0));
        }
        let own = &self.feelers[k..k + LANES];
        let (mut a, mut rate, mut fx, mut fy) = (Lanes::ZERO, Lanes::ZERO, Lanes::ZERO, Lanes::ZERO);
        for (lane, own) in own.iter().enumerate() {
            a.0[lane] = own.a;
            rate.0[lane] = own.rate;
        }
        let f = part.load(&a) * decay(part, gap * part.load(&rate));
        part.store(f * nearest.nx, &mut fx);
        part.store(f * nearest.ny, &mut fy);
        for lane in part.at()..LANES.min(to - k).min(part.at() + part.len()) {
            let agent = self.agent[k + lane] as usize;
            sums[agent / LANES].x.0[agent % LANES] += fx.0[lane];
            sums[agent / LANES].y.0[agent % LANES] += fy.0[lane];
        }
    }
}

/// Sum of eight lanes, always in the same order.
#[inline(always)]
fn total(lanes: &Lanes) -> f64 {
    let l = &lanes.0;
    ((l[0] + l[4]) + (l[2] + l[6])) + ((l[1] + l[5]) + (l[3] + l[7]))
}

/// Extent of the crowd and its farthest reach.
#[inline(always)]
fn survey<S: Simd>(simd: S, forces: &Forces, state: &State) -> Grid {
    let mut low = (Lanes::splat(f64::INFINITY), Lanes::splat(f64::INFINITY));
    let mut high = (Lanes::splat(f64::NEG_INFINITY), Lanes::splat(f64::NEG_INFINITY));
    let (mut widest, mut farthest) = (Lanes::ZERO, Lanes::splat(forces.margin));
    for part in parts(simd) {
        let (mut low_x, mut low_y) = (part.load(&low.0), part.load(&low.1));
        let (mut high_x, mut high_y) = (part.load(&high.0), part.load(&high.1));
        let (mut wide, mut far) = (part.load(&widest), part.load(&farthest));
        for block in 0..state.x.len() {
            let here = part.mask(state.present[block]);
            let (x, y) = (part.load(&state.x[block]), part.load(&state.y[block]));
            low_x = smaller::<S>(here.select(x, low_x), low_x);
            low_y = smaller::<S>(here.select(y, low_y), low_y);
            high_x = larger::<S>(here.select(x, high_x), high_x);
            high_y = larger::<S>(here.select(y, high_y), high_y);
            wide = larger::<S>(here.select(part.load(&state.radius[block]), wide), wide);
            let mut range = part.load(&state.b[block]);
            if forces.second {
                range = larger::<S>(range, part.load(&state.b2[block]));
            }
            far = larger::<S>(here.select(part.c(REACH) * range, far), far);
        }
        part.store(low_x, &mut low.0);
        part.store(low_y, &mut low.1);
        part.store(high_x, &mut high.0);
        part.store(high_y, &mut high.1);
        part.store(wide, &mut widest);
        part.store(far, &mut farthest);
    }
    let least = |lanes: Lanes| lanes.0.into_iter().fold(f64::INFINITY, |a, b| if b < a { b } else { a });
    let most = |lanes: Lanes| lanes.0.into_iter().fold(f64::NEG_INFINITY, |a, b| if b > a { b } else { a });
    // A little more, for what rounding may take off a distance.
    let reach = (2.0 * most(widest) + most(farthest)) * (1.0 + 1e-9);
    let (x, y) = (least(low.0), least(low.1));
    let (wide, high) = (most(high.0) - x, most(high.1) - y);
    let slack = 1e-9 * (reach + wide + high);
    let mut grid =
        Grid { x, y, reach, slack, height: 1.0, per_width: 0.0, per_height: 0.0, columns: 1, strips: 1 };
    if !(wide.is_finite() && high.is_finite() && reach.is_finite() && reach > 0.0) {
        // Nobody there, or somebody infinitely far away: one cell holds all.
        return Grid { x: 0.0, y: 0.0, slack: 0.0, ..grid };
    }
    let mut height = reach;
    let mut width = reach / CELLS_PER_REACH;
    // Someone far away must not make millions of empty cells.
    let most_cells = 16.0 * state.agents as f64 + 64.0;
    while (wide / width + 1.0) * (high / height + 1.0) > most_cells {
        height *= 2.0;
        width *= 2.0;
    }
    grid.height = height;
    grid.per_width = 1.0 / width;
    grid.per_height = 1.0 / height;
    grid.columns = (wide * grid.per_width) as usize + 1;
    grid.strips = (high * grid.per_height) as usize + 1;
    grid
}
