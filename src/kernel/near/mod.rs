//! Which agents of one large crowd are near: all that are present, by strip and cell of the plane.
//!
//! The forces sort the agents every step (a counting sort, in a cell by index); whatever asks about the same state uses that
//! order. Each strip ends with absent bodies as padding, so that vectors may begin at any agent.

mod grid;

pub(super) use grid::{Extent, FARTHEST, Grid, low_bits, most};

use super::state::State;
use super::vector::parts;
use crate::base::geometry::Vec2;
use crate::base::geometry::amply_around;
use crate::base::lanes::{LANES, Lanes};
use crate::model::Parameter;
use fearless_simd::{Level, Simd, dispatch};
use std::ops::{Range, RangeInclusive};

/// What the forces found out about a state of one large crowd: whatever asks the same of that state need not search again.
#[derive(Clone, Copy, Debug)]
pub struct Close<'a> {
    /// Agents that may touch within a step, the smaller number first, each pair once.
    pub(super) pairs: &'a [(u32, u32)],
    /// Between any other two that are in the scene is a gap of more than this, m, however it is rounded.
    pub(super) edge: f64,
    /// All that are in the scene.
    pub(super) index: Option<&'a Index>,
}

/// Where agents may be that are not farther than a reach from a place.
#[derive(Clone, Debug)]
pub(super) struct Area {
    strips: RangeInclusive<usize>,
    columns: RangeInclusive<usize>,
}

/// The agents that are present, in sorted order.
#[derive(Clone, Debug, Default)]
pub(super) struct Index {
    pub(super) grid: Grid,
    /// Cell of each slot; that of an absent agent means nothing.
    cell: Vec<u32>,
    /// Where each cell starts among the sorted agents; each strip has one more for its end.
    pub(super) start: Vec<u32>,
    next: Vec<u32>,
    /// All that follows is in sorted order, with padding between the strips.
    pub(super) agent: Vec<u32>,
    pub(super) x: Vec<f64>,
    pub(super) y: Vec<f64>,
    /// Radius; minus infinity in padding, which is so beyond everybody's reach.
    pub(super) r: Vec<f64>,
    /// Largest radius, m.
    pub(super) widest: f64,
}

impl Index {
    /// Sorts the agents of a state for questions, where the forces have not done so. False where a coordinate or a radius
    /// is beyond reason.
    pub(super) fn sort_alone(&mut self, state: &State) -> bool {
        dispatch!(Level::new(), simd => self.sort_by_spacing(simd, state))
    }

    #[inline(always)]
    fn sort_by_spacing<S: Simd>(&mut self, simd: S, state: &State) -> bool {
        let extent = Extent::of(simd, state);
        if extent.is_sound {
            self.sort(simd, &extent, Grid::by_spacing(&extent, state), state);
        }
        extent.is_sound
    }

    /// Sorts the agents who are present by strip and cell.
    #[inline(always)]
    pub(super) fn sort<S: Simd>(&mut self, simd: S, extent: &Extent, grid: Grid, state: &State) {
        self.grid = grid;
        self.widest = extent.widest;
        self.count(simd, state);
        self.reserve();
        // Within a cell by index.
        for (block, &here) in state.present.iter().enumerate() {
            for lane in here.iter() {
                let next = &mut self.next[self.cell[block * LANES + lane] as usize];
                self.agent[*next as usize] = (block * LANES + lane) as u32;
                *next += 1;
            }
        }
        for strip in 0..grid.strips {
            for at in self.strip(strip) {
                let agent = self.agent[at] as usize;
                let (block, lane) = (agent / LANES, agent % LANES);
                let of = |field: &[Lanes]| field[block].0[lane];
                self.x[at] = of(&state.motion.x);
                self.y[at] = of(&state.motion.y);
                self.r[at] = of(&state.bodies[Parameter::Radius]);
            }
        }
    }

    /// Finds the cell of each agent and where the cells start.
    #[inline(always)]
    fn count<S: Simd>(&mut self, simd: S, state: &State) {
        let grid = self.grid;
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
    fn reserve(&mut self) {
        let grid = self.grid;
        let row = grid.row();
        let total = (self.start[grid.strips * row - 1] as usize + LANES).next_multiple_of(LANES);
        self.agent.resize(total, 0);
        for field in [&mut self.x, &mut self.y, &mut self.r] {
            field.resize(total, 0.0);
        }
        for strip in 0..grid.strips {
            let end = self.strip(strip).end;
            let padding = end..if strip + 1 < grid.strips { end + LANES } else { total };
            self.agent[padding.clone()].fill(0);
            self.x[padding.clone()].fill(grid.x);
            self.y[padding.clone()].fill(grid.y);
            self.r[padding].fill(f64::NEG_INFINITY);
        }
    }

    /// The sorted agents of a strip.
    #[inline(always)]
    pub(super) fn strip(&self, strip: usize) -> Range<usize> {
        let first = strip * self.grid.row();
        self.start[first] as usize..self.start[first + self.grid.columns] as usize
    }

    /// Where all are that are not farther than `reach` from a place.
    #[inline(always)]
    pub(super) fn area(&self, at: Vec2, reach: f64) -> Area {
        let around = amply_around(at, reach);
        let (grid, low, high) = (&self.grid, around.low, around.high);
        Area {
            strips: grid.strip_of(low.y)..=grid.strip_of(high.y),
            columns: grid.column_of(low.x)..=grid.column_of(high.x),
        }
    }

    /// Whether an area holds all.
    #[inline(always)]
    pub(super) fn is_all(&self, area: &Area) -> bool {
        area.strips.clone().count() == self.grid.strips && area.columns.clone().count() == self.grid.columns
    }

    /// The places of the agents of an area in the sorted order, strip by strip.
    #[inline(always)]
    pub(super) fn places(&self, area: &Area) -> impl Iterator<Item = Range<usize>> {
        let (first, last) = (*area.columns.start(), *area.columns.end());
        area.strips.clone().map(move |strip| {
            let row = strip * self.grid.row();
            self.start[row + first] as usize..self.start[row + last + 1] as usize
        })
    }
}
