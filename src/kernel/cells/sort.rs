//! The order of one large crowd: by strip and cell.

use super::grid::Grid;
use super::{Cells, Terms};
use crate::base::lanes::{LANES, Lanes};
use crate::kernel::forces::Forces;
use crate::kernel::social::Term;
use crate::kernel::state::State;
use crate::kernel::vector::{Part, parts};
use crate::model::Parameter;
use fearless_simd::Simd;
use std::ops::Range;

impl Terms {
    fn resize(&mut self, total: usize) {
        for field in [&mut self.even, &mut self.ex, &mut self.ey, &mut self.rate] {
            field.resize(total, 0.0);
        }
    }

    fn clear(&mut self, padding: Range<usize>) {
        self.even[padding.clone()].fill(0.0);
        self.ex[padding.clone()].fill(0.0);
        self.ey[padding.clone()].fill(0.0);
        self.rate[padding].fill(1.0);
    }

    /// Takes over what an agent has: lambda, B, and the desired direction, for `finish`.
    #[inline(always)]
    fn put(&mut self, at: usize, lambda: f64, b: f64, e: (f64, f64)) {
        self.even[at] = lambda;
        self.ex[at] = e.0;
        self.ey[at] = e.1;
        self.rate[at] = b;
    }

    /// Makes the terms of eight agents of what `put` took over.
    #[inline(always)]
    fn finish<S: Simd>(&mut self, part: Part<S>, k: usize, a: &[f64], with_rate: bool) {
        let eight = k..k + LANES;
        let force = (part.slice(&a[eight.clone()]), part.slice(&self.even[eight.clone()]));
        let e = (part.slice(&self.ex[eight.clone()]), part.slice(&self.ey[eight.clone()]));
        let b = with_rate.then(|| part.slice(&self.rate[eight.clone()]));
        let term = Term::new(part, force, b, e);
        part.put(term.even, &mut self.even[eight.clone()]);
        part.put(term.ex, &mut self.ex[eight.clone()]);
        part.put(term.ey, &mut self.ey[eight.clone()]);
        if with_rate {
            part.put(term.rate, &mut self.rate[eight]);
        }
    }
}

impl Cells {
    /// Sorts the agents who are present by strip and cell.
    #[inline(always)]
    pub(super) fn sort<S: Simd>(&mut self, simd: S, grid: &Grid, forces: &Forces, state: &State) {
        self.count(simd, grid, state);
        let total = self.reserve(grid, forces);
        // Within a cell by index.
        for (block, &here) in state.present.iter().enumerate() {
            for lane in here.iter() {
                let next = &mut self.next[self.cell[block * LANES + lane] as usize];
                self.agent[*next as usize] = (block * LANES + lane) as u32;
                *next += 1;
            }
        }
        for strip in 0..grid.strips {
            for at in self.strip(grid, strip) {
                let agent = self.agent[at] as usize;
                let (block, lane) = (agent / LANES, agent % LANES);
                let of = |field: &[Lanes]| field[block].0[lane];
                self.x[at] = of(&state.motion.x);
                self.y[at] = of(&state.motion.y);
                self.r[at] = of(&state.bodies[Parameter::Radius]);
                self.a[at] = of(&state.bodies[Parameter::A]);
                let e = (of(&state.driving.ex), of(&state.driving.ey));
                self.term.put(at, of(&state.bodies[Parameter::Lambda]), of(&state.bodies[Parameter::B]), e);
                if forces.second {
                    self.a2[at] = of(&state.bodies[Parameter::A2]);
                    self.second.put(
                        at,
                        of(&state.bodies[Parameter::Lambda2]),
                        of(&state.bodies[Parameter::B2]),
                        e,
                    );
                }
            }
        }
        // Walls need the rates even where all agents share B.
        let rates = forces.shared.is_none() || !forces.surfaces.is_empty();
        for k in (0..total).step_by(LANES) {
            for part in parts(simd) {
                self.term.finish(part, k, &self.a, rates);
                if forces.second {
                    self.second.finish(part, k, &self.a2, forces.shared.is_none());
                }
            }
        }
        if !forces.ties.is_empty() {
            self.tie.clear();
            self.drive.clear();
            for agent in self.agent.iter().map(|&agent| agent as usize) {
                let tie = forces.ties.get(agent).copied().flatten();
                let of = |field: &[Lanes]| field[agent / LANES].0[agent % LANES];
                let drive = || {
                    (of(&state.bodies[Parameter::Mass]) * of(&state.bodies[Parameter::Speed])
                        / of(&state.bodies[Parameter::Tau]))
                    .abs()
                };
                self.tie.push(tie.map_or(f64::NAN, |tie| tie.repulsion));
                self.drive.push(tie.map_or(0.0, |_| drive()));
            }
        }
    }

    /// Finds the cell of each agent and where the cells start.
    #[inline(always)]
    fn count<S: Simd>(&mut self, simd: S, grid: &Grid, state: &State) {
        let row = grid.row();
        self.start.clear();
        self.start.resize(grid.strips * row, 0);
        self.cell.resize(state.motion.x.len() * LANES, 0);
        for (block, cells) in self.cell.chunks_exact_mut(LANES).enumerate() {
            let (mut strips, mut columns) = (Lanes::ZERO, Lanes::ZERO);
            for part in parts(simd) {
                part.store(grid.strip(part, part.load(&state.motion.y[block])), &mut strips);
                part.store(grid.column(part, part.load(&state.motion.x[block])), &mut columns);
            }
            for (cell, (strip, column)) in cells.iter_mut().zip(strips.0.into_iter().zip(columns.0)) {
                *cell = low_bits(strip) * row as u32 + low_bits(column);
            }
            for lane in state.present[block].iter() {
                self.start[cells[lane] as usize] += 1;
            }
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
        self.next.clone_from(&self.start);
    }

    /// Makes room for all agents and the padding, and clears both. Gives the size, in whole blocks.
    #[inline(always)]
    fn reserve(&mut self, grid: &Grid, forces: &Forces) -> usize {
        let row = grid.row();
        let total = (self.start[grid.strips * row - 1] as usize + LANES).next_multiple_of(LANES);
        self.agent.resize(total, u32::MAX);
        for field in [&mut self.x, &mut self.y, &mut self.r, &mut self.a] {
            field.resize(total, 0.0);
        }
        self.term.resize(total);
        if forces.second {
            self.a2.resize(total, 0.0);
            self.second.resize(total);
        }
        for field in [&mut self.fx, &mut self.fy] {
            field.clear();
            field.resize(total, 0.0);
        }
        for strip in 0..grid.strips {
            let end = self.strip(grid, strip).end;
            let padding = end..if strip + 1 < grid.strips { end + LANES } else { total };
            self.agent[padding.clone()].fill(u32::MAX);
            self.x[padding.clone()].fill(grid.x);
            self.y[padding.clone()].fill(grid.y);
            self.r[padding.clone()].fill(f64::NEG_INFINITY);
            self.a[padding.clone()].fill(0.0);
            self.term.clear(padding.clone());
            if forces.second {
                self.a2[padding.clone()].fill(0.0);
                self.second.clear(padding);
            }
        }
        total
    }
}

/// The whole number that `Grid::column` and `Grid::strip` hide in a double.
#[inline(always)]
pub(super) fn low_bits(whole: f64) -> u32 {
    whole.to_bits() as u32
}
