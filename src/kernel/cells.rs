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

use super::barrier::Surface;
use super::contact::Contacts;
use super::forces::{Forces, REACH};
use super::lanewise::{Sum, Term, cohesion, decay};
use super::program::Program;
use super::state::State;
use super::vector::{Doubles, Part, larger, parts, smaller};
use crate::base::lanes::{LANES, Lanes, Mask};
use crate::base::math::at_least;
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use std::f64::consts::LOG2_E;
use std::ops::Range;

/// Cells of a strip per reach.
const CELLS_PER_REACH: f64 = 8.0;

/// One exponential term of the sorted agents, as in `lanewise::Term`.
#[derive(Clone, Debug, Default)]
struct Terms {
    even: Vec<f64>,
    ex: Vec<f64>,
    ey: Vec<f64>,
    rate: Vec<f64>,
}

impl Terms {
    fn resize(&mut self, total: usize) {
        for field in [&mut self.even, &mut self.ex, &mut self.ey, &mut self.rate] {
            field.resize(total, 0.0);
        }
    }

    #[inline(always)]
    fn put(&mut self, at: usize, term: &Term, lane: usize) {
        self.even[at] = term.even.0[lane];
        self.ex[at] = term.ex.0[lane];
        self.ey[at] = term.ey.0[lane];
        self.rate[at] = term.rate.0[lane];
    }
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
    /// All that follows is in sorted order, with padding between the strips.
    agent: Vec<u32>,
    x: Vec<f64>,
    y: Vec<f64>,
    /// Radius; minus infinity in padding, which is so beyond everybody's reach.
    r: Vec<f64>,
    a: Vec<f64>,
    term: Terms,
    second: Terms,
    /// Factor of the social force towards bodies of several persons; NaN in a single person.
    tie: Vec<f64>,
    /// The forces.
    fx: Vec<f64>,
    fy: Vec<f64>,
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
        self.scatter(sums);
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
        self.agent.resize(total, u32::MAX);
        for field in [&mut self.x, &mut self.y, &mut self.r, &mut self.a] {
            field.resize(total, 0.0);
        }
        self.term.resize(total);
        if forces.second {
            self.second.resize(total);
        }
        for field in [&mut self.fx, &mut self.fy] {
            field.clear();
            field.resize(total, 0.0);
        }
        for strip in self.start.chunks_exact(row) {
            let end = strip[grid.columns] as usize;
            // What else padding holds does not matter, as long as it is finite.
            self.r[end..end + LANES].fill(f64::NEG_INFINITY);
            self.x[end..end + LANES].fill(grid.x);
            self.y[end..end + LANES].fill(grid.y);
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
                self.x[at] = state.x[block].0[lane];
                self.y[at] = state.y[block].0[lane];
                self.r[at] = state.radius[block].0[lane];
                self.a[at] = state.a[block].0[lane];
                self.term.put(at, &first, lane);
                if forces.second {
                    self.second.put(at, &second, lane);
                }
            }
        }
        if !forces.ties.is_empty() {
            self.tie.clear();
            self.tie.extend(self.agent.iter().map(|&agent| {
                forces.ties.get(agent as usize).copied().flatten().map_or(f64::NAN, |tie| tie.repulsion)
            }));
        }
    }

    /// Social forces between agents. With `SHARED` one B for all; with `SECOND` the second term too; with
    /// `TIES` a factor for pairs of bodies of several persons.
    #[inline(always)]
    fn pairs<S: Simd, const SHARED: bool, const SECOND: bool, const TIES: bool>(
        &mut self,
        simd: S,
        grid: &Grid,
        forces: &Forces,
        contacts: &mut Contacts,
    ) {
        let row = grid.columns + 1;
        let margin = -forces.margin;
        let shared = forces.shared.unwrap_or((1.0, 1.0));
        let shared = (LOG2_E / shared.0, LOG2_E / shared.1);
        for strip in 0..grid.strips {
            let from = self.start[strip * row] as usize;
            let to = self.start[strip * row + grid.columns] as usize;
            for i in from..to {
                // Those behind in the own strip, and those in reach in the next.
                let mut ranges = [(i + 1, i + 1); 2];
                for (range, other) in ranges.iter_mut().zip(strip..(strip + 2).min(grid.strips)) {
                    let reach = grid.reach_into(strip, other, self.y[i]);
                    let (left, right) = (grid.column(self.x[i] - reach), grid.column(self.x[i] + reach));
                    let (start, end) = (other * row + left, other * row + right + 1);
                    let start = if other == strip { i + 1 } else { self.start[start] as usize };
                    *range = (start, self.start[end] as usize);
                }
                let (mut sum_x, mut sum_y) = (Lanes::ZERO, Lanes::ZERO);
                for part in parts(simd) {
                    let (x, y, r) = (part.c(self.x[i]), part.c(self.y[i]), part.c(self.r[i]));
                    let own = Loaded::splat(part, &self.term, i, SHARED.then_some(shared.0));
                    let own2 =
                        if SECOND { Loaded::splat(part, &self.second, i, SHARED.then_some(shared.1)) } else { own };
                    let (mut fx, mut fy) = (part.c(0.0), part.c(0.0));
                    for (start, end) in ranges {
                        let mut j = start;
                        while j + part.at() < end {
                            let eight = j..j + LANES;
                            let dx = x - part.slice(&self.x[eight.clone()]);
                            let dy = y - part.slice(&self.y[eight.clone()]);
                            let d = (dx * dx + dy * dy + part.c(1e-300)).sqrt();
                            let q = part.c(1.0) / d;
                            let gap = r + part.slice(&self.r[eight.clone()]) - d;
                            let touching = gap.simd_gt(part.c(margin));
                            if touching.any_true() {
                                self.candidates(i, j, part.bits(touching), contacts);
                            }
                            let theirs = Loaded::of(part, &self.term, eight.clone(), SHARED.then_some(shared.0));
                            let (mut on_i, mut on_j) = repel::<S, SHARED>(part, gap, (dx, dy), q, &own, &theirs);
                            if SECOND {
                                let theirs2 =
                                    Loaded::of(part, &self.second, eight.clone(), SHARED.then_some(shared.1));
                                let more = repel::<S, SHARED>(part, gap, (dx, dy), q, &own2, &theirs2);
                                on_i += more.0;
                                on_j += more.1;
                            }
                            if TIES {
                                let both = part.c(self.tie[i]) + part.slice(&self.tie[eight.clone()]);
                                let mean = part.c(0.5) * both;
                                let factor = mean.simd_eq(mean).select(mean, part.c(1.0));
                                on_i *= factor;
                                on_j *= factor;
                            }
                            fx += on_i * dx;
                            fy += on_i * dy;
                            part.take(on_j * dx, &mut self.fx[eight.clone()]);
                            part.take(on_j * dy, &mut self.fy[eight]);
                            j += LANES;
                        }
                    }
                    part.store(fx, &mut sum_x);
                    part.store(fy, &mut sum_y);
                }
                self.fx[i] += total(&sum_x);
                self.fy[i] += total(&sum_y);
            }
        }
    }

    /// Hands the forces to the agents.
    fn scatter(&self, sums: &mut [Sum]) {
        for ((&agent, &fx), &fy) in self.agent.iter().zip(&self.fx).zip(&self.fy) {
            if let Some(sum) = sums.get_mut(agent as usize / LANES) {
                sum.x.0[agent as usize % LANES] = fx;
                sum.y.0[agent as usize % LANES] = fy;
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
        &mut self,
        simd: S,
        grid: &Grid,
        forces: &Forces,
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
                        self.wall(part, grid, forces, (index, surface), k, contacts);
                    }
                }
                k += LANES;
            }
        }
    }

    /// Force of one surface on the sorted agents `k..k + 8`, of whom some may be padding.
    #[inline(always)]
    fn wall<S: Simd>(
        &mut self,
        part: Part<S>,
        grid: &Grid,
        forces: &Forces,
        (index, surface): (usize, &Surface),
        k: usize,
        contacts: &mut Contacts,
    ) {
        let eight = k..k + LANES;
        let (x, y) = (part.slice(&self.x[eight.clone()]), part.slice(&self.y[eight.clone()]));
        let limit = part.c(grid.reach * grid.reach);
        if !surface.squared_distance_to_bounds(part, x, y).simd_le(limit).any_true() {
            return;
        }
        let nearest = surface.nearest(part, x, y);
        let gap = part.slice(&self.r[eight.clone()]) - nearest.distance;
        for lane in part.bits(gap.simd_gt(part.c(-forces.margin))).iter() {
            contacts.push_wall(self.agent[k + lane], index as u32, Mask::lane(0));
        }
        let rate = part.slice(&self.term.rate[eight.clone()]);
        let f = part.slice(&self.a[eight.clone()]) * decay(part, gap * rate);
        part.take(f * -nearest.nx, &mut self.fx[eight.clone()]);
        part.take(f * -nearest.ny, &mut self.fy[eight]);
    }
}

/// A term in registers.
#[derive(Clone, Copy)]
struct Loaded<S: Simd> {
    even: Doubles<S>,
    ex: Doubles<S>,
    ey: Doubles<S>,
    rate: Doubles<S>,
}

impl<S: Simd> Loaded<S> {
    /// Of one agent, in every lane.
    #[inline(always)]
    fn splat(part: Part<S>, terms: &Terms, i: usize, rate: Option<f64>) -> Self {
        Self {
            even: part.c(terms.even[i]),
            ex: part.c(terms.ex[i]),
            ey: part.c(terms.ey[i]),
            rate: part.c(rate.unwrap_or(terms.rate[i])),
        }
    }

    /// Of eight agents.
    #[inline(always)]
    fn of(part: Part<S>, terms: &Terms, eight: Range<usize>, rate: Option<f64>) -> Self {
        Self {
            even: part.slice(&terms.even[eight.clone()]),
            ex: part.slice(&terms.ex[eight.clone()]),
            ey: part.slice(&terms.ey[eight.clone()]),
            rate: rate.map_or_else(|| part.slice(&terms.rate[eight]), |rate| part.c(rate)),
        }
    }
}

/// Force on the first and on the second of a pair over their distance; `gap` is their overlap, (dx, dy) = n/q
/// points from the second to the first.
#[inline(always)]
fn repel<S: Simd, const SHARED: bool>(
    part: Part<S>,
    gap: Doubles<S>,
    (dx, dy): (Doubles<S>, Doubles<S>),
    q: Doubles<S>,
    one: &Loaded<S>,
    other: &Loaded<S>,
) -> (Doubles<S>, Doubles<S>) {
    let e = decay(part, gap * one.rate) * q;
    let e2 = if SHARED { e } else { decay(part, gap * other.rate) * q };
    (
        e * (one.even - (dx * one.ex + dy * one.ey) * q),
        e2 * (other.even + (dx * other.ex + dy * other.ey) * q),
    )
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
