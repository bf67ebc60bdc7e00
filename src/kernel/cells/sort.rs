//! The order of one large crowd: by strip and cell.

use super::Cells;
use super::grid::Grid;
use crate::base::lanes::{LANES, Lanes};
use crate::kernel::force::pair::{AgentsInLanes, PairTerm};
use crate::kernel::state::State;
use crate::kernel::vector::{Doubles, Part, parts};
use crate::model::Parameter;
use fearless_simd::Simd;

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

impl Cells {
    /// Sorts the agents who are present by strip and cell.
    #[inline(always)]
    pub(super) fn sort<S: Simd>(&mut self, simd: S, grid: &Grid, state: &State) {
        self.count(simd, grid, state);
        self.reserve(grid);
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
            }
        }
    }

    /// Takes over what a term keeps of each agent.
    #[inline(always)]
    pub(super) fn keep<S: Simd, T: PairTerm>(&mut self, simd: S, term: T, state: &State) {
        let total = self.agent.len();
        self.columns.resize_with(T::COUNT, Vec::new);
        for column in &mut self.columns {
            column.resize(total, 0.0);
        }
        let Self { agent, columns, .. } = self;
        for (k, agents) in agent.chunks_exact(LANES).enumerate() {
            for part in parts(simd) {
                term.keep(
                    part,
                    state,
                    Sorted { part, agents },
                    #[inline(always)]
                    |column, numbers| part.put(numbers, &mut columns[column][k * LANES..]),
                );
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

    /// Makes room for all agents and the padding, in whole blocks, and clears both. Padding has the numbers of the first
    /// agent, but is beyond everybody's reach.
    #[inline(always)]
    fn reserve(&mut self, grid: &Grid) {
        let row = grid.row();
        let total = (self.start[grid.strips * row - 1] as usize + LANES).next_multiple_of(LANES);
        self.agent.resize(total, 0);
        for field in [&mut self.x, &mut self.y, &mut self.r] {
            field.resize(total, 0.0);
        }
        for field in [&mut self.fx, &mut self.fy] {
            field.clear();
            field.resize(total, 0.0);
        }
        for strip in 0..grid.strips {
            let end = self.strip(grid, strip).end;
            let padding = end..if strip + 1 < grid.strips { end + LANES } else { total };
            self.agent[padding.clone()].fill(0);
            self.x[padding.clone()].fill(grid.x);
            self.y[padding.clone()].fill(grid.y);
            self.r[padding].fill(f64::NEG_INFINITY);
        }
    }
}

/// The whole number that `Grid::column` and `Grid::strip` hide in a double.
#[inline(always)]
pub(super) fn low_bits(whole: f64) -> u32 {
    whole.to_bits() as u32
}
