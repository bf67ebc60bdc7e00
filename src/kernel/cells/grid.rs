//! How the plane is cut into strips and cells.

use crate::base::geometry::{Bounds, Vec2};
use crate::base::lanes::{Lanes, Mask};
use crate::kernel::force::pair::{Block, PairTerm};
use crate::kernel::state::State;
use crate::kernel::vector::{Doubles, Part, larger, parts, smaller};
use crate::model::Parameter;
use fearless_simd::Simd;
use fearless_simd::prelude::*;

/// Cells of a strip per reach.
const CELLS_PER_REACH: f64 = 8.0;

/// 2^52: what is added to it is rounded to a whole number, which the low bits show.
const WHOLE: f64 = 4_503_599_627_370_496.0;

/// How the plane is cut.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grid {
    pub(super) x: f64,
    pub(super) y: f64,
    /// How far apart the centres of two bodies can be, at most, that feel each other, m.
    pub(super) reach: f64,
    /// The same, less the radius of the first body.
    beyond: f64,
    /// What rounding may take off a distance, amply, m.
    slack: f64,
    height: f64,
    per_width: f64,
    per_height: f64,
    pub(super) columns: usize,
    pub(super) strips: usize,
    /// Between two who cannot touch within a step is a gap of more than this, m, however it is rounded: see `Close`.
    pub(super) edge: f64,
}

impl Grid {
    /// Entries of a strip among the starts of cells: one more, for its end.
    pub(super) fn row(&self) -> usize {
        self.columns + 1
    }

    /// Column of abscissas, as the low bits of doubles: never falls as the abscissa rises.
    #[inline(always)]
    pub(super) fn column<S: Simd>(&self, part: Part<S>, x: Doubles<S>) -> Doubles<S> {
        whole(part, (x - part.c(self.x)) * part.c(self.per_width), self.columns)
    }

    /// Strip of ordinates, likewise.
    #[inline(always)]
    pub(super) fn strip<S: Simd>(&self, part: Part<S>, y: Doubles<S>) -> Doubles<S> {
        whole(part, (y - part.c(self.y)) * part.c(self.per_height), self.strips)
    }

    /// A rectangle around all that agents at these places can feel, amply.
    pub(super) fn around(&self, x: &[f64], y: &[f64]) -> Bounds {
        let interval = |v: &[f64]| {
            let low = v.iter().fold(f64::INFINITY, |a, &b| if b < a { b } else { a });
            let high = v.iter().fold(f64::NEG_INFINITY, |a, &b| if b > a { b } else { a });
            (low - self.reach - self.slack, high + self.reach + self.slack)
        };
        let (x, y) = (interval(x), interval(y));
        Bounds { low: Vec2::new(x.0, y.0), high: Vec2::new(x.1, y.1) }
    }

    /// How far apart bodies of these radii and any other can be that feel each other.
    #[inline(always)]
    pub(super) fn reach_of<S: Simd>(&self, part: Part<S>, r: Doubles<S>) -> Doubles<S> {
        r + part.c(self.beyond + self.slack)
    }

    /// How far to the side others in the strip above `strip` can be in reach of those at `y` in `strip`: less,
    /// the farther the edge between.
    #[inline(always)]
    pub(super) fn reach_above<S: Simd>(
        &self,
        part: Part<S>,
        strip: usize,
        y: Doubles<S>,
        reach: Doubles<S>,
    ) -> Doubles<S> {
        let edge = self.y + (strip + 1) as f64 * self.height;
        let above = larger::<S>(part.c(edge - self.slack) - y, part.c(0.0));
        larger::<S>(reach * reach - above * above, part.c(0.0)).sqrt() + part.c(self.slack)
    }
}

/// Extent of the crowd and its farthest reach. Bodies nearer than `margin` to touching may touch within a step.
#[inline(always)]
pub(super) fn survey<S: Simd, T: PairTerm>(simd: S, term: T, margin: f64, state: &State) -> Grid {
    let mut low = (Lanes::splat(f64::INFINITY), Lanes::splat(f64::INFINITY));
    let mut high = (Lanes::splat(f64::NEG_INFINITY), Lanes::splat(f64::NEG_INFINITY));
    let (mut widest, mut farthest) = (Lanes::ZERO, Lanes::splat(margin));
    let mut odd = Mask::NONE;
    for part in parts(simd) {
        let (mut low_x, mut low_y) = (part.load(&low.0), part.load(&low.1));
        let (mut high_x, mut high_y) = (part.load(&high.0), part.load(&high.1));
        let (mut wide, mut far) = (part.load(&widest), part.load(&farthest));
        for block in 0..state.motion.x.len() {
            let here = part.mask(state.present[block]);
            let (x, y) = (part.load(&state.motion.x[block]), part.load(&state.motion.y[block]));
            low_x = smaller::<S>(here.select(x, low_x), low_x);
            low_y = smaller::<S>(here.select(y, low_y), low_y);
            high_x = larger::<S>(here.select(x, high_x), high_x);
            high_y = larger::<S>(here.select(y, high_y), high_y);
            let radius = part.load(&state.bodies[Parameter::Radius][block]);
            wide = larger::<S>(here.select(radius, wide), wide);
            // Zero times what is none or infinite is no number.
            odd |= part.bits(here & !((x + y + radius) * part.c(0.0)).simd_eq(part.c(0.0)));
            far = larger::<S>(here.select(term.reach(part, state, Block { part, index: block }), far), far);
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
    let widest = most(widest);
    // A little more, for what rounding may take off a distance.
    let beyond = (widest + most(farthest)) * (1.0 + 1e-9);
    let reach = widest + beyond;
    let (x, y) = (least(low.0), least(low.1));
    let (wide, high) = (most(high.0) - x, most(high.1) - y);
    let slack = 1e-9 * (reach + wide + high);
    let edge = margin - 1e-9 * (2.0 * widest + margin);
    let edge = if odd.is_empty() { edge } else { f64::NEG_INFINITY };
    let mut grid = Grid {
        x,
        y,
        reach,
        beyond,
        slack,
        height: 1.0,
        per_width: 0.0,
        per_height: 0.0,
        columns: 1,
        strips: 1,
        edge,
    };
    if !(wide.is_finite() && high.is_finite() && reach.is_finite() && reach > 0.0) {
        // Nobody there, or somebody infinitely far away: one cell holds all.
        return Grid { x: 0.0, y: 0.0, slack: 0.0, ..grid };
    }
    let mut height = reach;
    let mut width = reach / CELLS_PER_REACH;
    // Someone far away must make neither millions of empty cells nor one of all the others: where there would be too many
    // cells they are laid where nearly all are, and whoever is beyond is in one at the rim.
    let most_cells = 16.0 * state.agents as f64 + 64.0;
    let (mut wide, mut high) = (wide, high);
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
    grid
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
