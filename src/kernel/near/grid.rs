//! How the plane is cut into strips and cells.

use crate::base::geometry::{Bounds, Vec2};
use crate::base::lanes::{Lanes, Mask};
use crate::base::math::at_least;
use crate::kernel::state::State;
use crate::kernel::vector::{Doubles, Part, larger, parts, smaller};
use crate::model::Parameter;
use fearless_simd::Simd;
use fearless_simd::prelude::*;

/// Coordinates and radii up to here have squares far from overflow, m.
pub(in crate::kernel) const FARTHEST: f64 = 1e100;

/// 2^52: what is added to it is rounded to a whole number, which the low bits show.
const WHOLE: f64 = 4_503_599_627_370_496.0;

/// The rectangle around the agents that are present.
#[derive(Clone, Copy, Debug)]
pub(in crate::kernel) struct Extent {
    x: f64,
    y: f64,
    pub(in crate::kernel) wide: f64,
    pub(in crate::kernel) high: f64,
    /// Largest radius, m.
    pub(in crate::kernel) widest: f64,
    /// Whether all coordinates and radii are numbers up to `FARTHEST`.
    pub(in crate::kernel) is_sound: bool,
}

impl Extent {
    /// The same rectangle and what is so near to it, m.
    pub(in crate::kernel) fn around(&self, more: f64) -> Bounds {
        let (low, more) = (Vec2::new(self.x, self.y), Vec2::repeat(more));
        Bounds { low: low - more, high: low + Vec2::new(self.wide, self.high) + more }
    }

    /// Of the only trial of a state.
    #[inline(always)]
    pub(in crate::kernel) fn of<S: Simd>(simd: S, state: &State) -> Self {
        let mut low = (Lanes::splat(f64::INFINITY), Lanes::splat(f64::INFINITY));
        let mut high = (Lanes::splat(f64::NEG_INFINITY), Lanes::splat(f64::NEG_INFINITY));
        let (mut widest, mut odd) = (Lanes::ZERO, Mask::NONE);
        for part in parts(simd) {
            let (mut low_x, mut low_y) = (part.load(&low.0), part.load(&low.1));
            let (mut high_x, mut high_y) = (part.load(&high.0), part.load(&high.1));
            let (mut wide, most) = (part.load(&widest), part.c(FARTHEST));
            for block in 0..state.motion.x.len() {
                let here = part.mask(state.present[block]);
                let (x, y) = (part.load(&state.motion.x[block]), part.load(&state.motion.y[block]));
                low_x = smaller::<S>(here.select(x, low_x), low_x);
                low_y = smaller::<S>(here.select(y, low_y), low_y);
                high_x = larger::<S>(here.select(x, high_x), high_x);
                high_y = larger::<S>(here.select(y, high_y), high_y);
                let radius = part.load(&state.bodies[Parameter::Radius][block]);
                wide = larger::<S>(here.select(radius, wide), wide);
                let sound = x.abs().simd_le(most) & y.abs().simd_le(most) & radius.abs().simd_le(most);
                odd |= part.bits(here & !sound);
            }
            part.store(low_x, &mut low.0);
            part.store(low_y, &mut low.1);
            part.store(high_x, &mut high.0);
            part.store(high_y, &mut high.1);
            part.store(wide, &mut widest);
        }
        let least = |lanes: Lanes| lanes.0.into_iter().fold(f64::INFINITY, |a, b| if b < a { b } else { a });
        let (x, y) = (least(low.0), least(low.1));
        Self {
            x,
            y,
            wide: most(&high.0) - x,
            high: most(&high.1) - y,
            widest: most(&widest),
            is_sound: odd.is_empty(),
        }
    }
}

/// The largest of eight numbers.
pub(in crate::kernel) fn most(lanes: &Lanes) -> f64 {
    lanes.0.into_iter().fold(f64::NEG_INFINITY, |a, b| if b > a { b } else { a })
}

/// How the plane is cut. Agents outside count to the cells at the rim, which have no end.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::kernel) struct Grid {
    pub(in crate::kernel) x: f64,
    pub(in crate::kernel) y: f64,
    height: f64,
    per_width: f64,
    per_height: f64,
    pub(in crate::kernel) columns: usize,
    pub(in crate::kernel) strips: usize,
    /// Side of a square with one agent on average, m.
    pub(in crate::kernel) spacing: f64,
}

impl Grid {
    /// Cuts the plane around a crowd into strips of this height and cells of this width, or larger ones.
    pub(in crate::kernel) fn new(
        extent: &Extent,
        (mut width, mut height): (f64, f64),
        state: &State,
    ) -> Self {
        let mut grid = Self { height: 1.0, columns: 1, strips: 1, spacing: 1.0, ..Self::default() };
        let Extent { x, y, mut wide, mut high, .. } = *extent;
        if !(wide.is_finite() && high.is_finite() && height.is_finite() && height > 0.0) {
            // No agent is there, or one is infinitely far away: one cell holds all.
            return grid;
        }
        (grid.x, grid.y) = (x, y);
        // An agent far away must make neither millions of empty cells nor one of all the others: where there would be too
        // many cells they are laid where nearly all are.
        let most_cells = 16.0 * state.agents as f64 + 64.0;
        if (wide / width + 1.0) * (high / height + 1.0) > most_cells
            && let (Some((left, right)), Some((bottom, top))) =
                (middle(state, &state.motion.x), middle(state, &state.motion.y))
        {
            (grid.x, grid.y, wide, high) = (left, bottom, right - left, top - bottom);
        }
        while (wide / width + 1.0) * (high / height + 1.0) > most_cells {
            height *= 2.0;
            width *= 2.0;
        }
        grid.height = height;
        grid.per_width = 1.0 / width;
        grid.per_height = 1.0 / height;
        grid.columns = (wide * grid.per_width) as usize + 1;
        grid.strips = (high * grid.per_height) as usize + 1;
        grid.spacing = spacing((wide, high), state);
        grid
    }

    /// Cuts the plane into squares with one agent on average, where nearly all are.
    pub(super) fn by_spacing(extent: &Extent, state: &State) -> Self {
        let length = |(low, high): (f64, f64)| high - low;
        let wide = middle(state, &state.motion.x).map_or(0.0, length);
        let side = spacing((wide, middle(state, &state.motion.y).map_or(0.0, length)), state);
        Self::new(extent, (side, side), state)
    }

    /// Entries of a strip among the starts of cells: one more, for its end.
    pub(in crate::kernel) fn row(&self) -> usize {
        self.columns + 1
    }

    /// Column of abscissas, as the low bits of doubles: never falls as the abscissa rises.
    #[inline(always)]
    pub(in crate::kernel) fn column<S: Simd>(&self, part: Part<S>, x: Doubles<S>) -> Doubles<S> {
        whole(part, (x - part.c(self.x)) * part.c(self.per_width), self.columns)
    }

    /// Strip of ordinates, likewise.
    #[inline(always)]
    pub(in crate::kernel) fn strip<S: Simd>(&self, part: Part<S>, y: Doubles<S>) -> Doubles<S> {
        whole(part, (y - part.c(self.y)) * part.c(self.per_height), self.strips)
    }

    /// Column of one abscissa.
    #[inline(always)]
    pub(in crate::kernel) fn column_of(&self, x: f64) -> usize {
        whole_of((x - self.x) * self.per_width, self.columns)
    }

    /// Strip of one ordinate.
    #[inline(always)]
    pub(in crate::kernel) fn strip_of(&self, y: f64) -> usize {
        whole_of((y - self.y) * self.per_height, self.strips)
    }

    /// Ordinate of the edge above a strip, m.
    pub(in crate::kernel) fn edge_above(&self, strip: usize) -> f64 {
        self.y + (strip + 1) as f64 * self.height
    }
}

/// The whole number that `Grid::column` and `Grid::strip` hide in a double.
#[inline(always)]
pub(in crate::kernel) fn low_bits(whole: f64) -> u32 {
    whole.to_bits() as u32
}

/// The same as `whole` of one number.
#[inline(always)]
fn whole_of(v: f64, count: usize) -> usize {
    let (v, last) = (v - 0.5, (count - 1) as f64);
    let v = if v > 0.0 { v } else { 0.0 };
    let v = if v < last { v } else { last };
    low_bits(v + WHOLE) as usize
}

/// Side of a square with one agent on average in a rectangle, m.
fn spacing((wide, high): (f64, f64), state: &State) -> f64 {
    let count = state.agents as f64;
    let side = at_least((wide * high / count).sqrt(), (wide + high) / (2.0 * count));
    if side > 1e-9 && side < FARTHEST { side } else { 1.0 }
}

/// Between which coordinates all but a hundredth at either end are, if anybody is there.
#[cold]
fn middle(state: &State, coordinates: &[Lanes]) -> Option<(f64, f64)> {
    let of_block =
        |(lanes, &here): (&Lanes, &Mask)| here.iter().map(|lane| lanes.0[lane]).collect::<Vec<_>>();
    let all = coordinates.iter().zip(&state.present).flat_map(of_block);
    let mut all: Vec<f64> = all.filter(|coordinate| coordinate.is_finite()).collect();
    let last = all.len().checked_sub(1)?;
    let mut at = |place: usize| *all.select_nth_unstable_by(place, f64::total_cmp).1;
    Some((at(last / 100), at(last - last / 100)))
}

/// Which of `count` whole intervals from 0 on, as the low bits of doubles.
#[inline(always)]
fn whole<S: Simd>(part: Part<S>, v: Doubles<S>, count: usize) -> Doubles<S> {
    let v = smaller::<S>(larger::<S>(v - part.c(0.5), part.c(0.0)), part.c((count - 1) as f64));
    v + part.c(WHOLE)
}
