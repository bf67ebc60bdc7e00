//! The floor of a walk: exact tests of steps against the barriers, of which the grid answers most.

use super::placed::PlacedStep;
use crate::base::geometry::{Segment, Vec2};
use crate::route::grid::ClearanceGrid;
use crate::route::roadmap::FreeSpace;

/// Lines by which the path of a step is tested.
const LINES: usize = 12;

/// The body keeps this distance in addition to its radius, m. The path may be that far from its lines.
const MARGIN: f64 = 1e-3;

/// So often at most a goal is moved beside a barrier.
const MOVES: usize = 4;

/// Somebody nearer to a barrier than that comes no nearer than this, m: more than rounding, and a turn on the spot.
const NEARER: f64 = 2e-8;

/// The free space of a scene for bodies of one radius, with its grid.
#[derive(Clone, Debug)]
pub struct Ground {
    free: FreeSpace,
    grid: ClearanceGrid,
}

impl Ground {
    /// The ground of a free space; `grid` is a grid of the same free space.
    pub fn new(free: FreeSpace, grid: ClearanceGrid) -> Self {
        Self { free, grid }
    }

    /// The free space.
    pub fn free(&self) -> &FreeSpace {
        &self.free
    }

    /// The grid.
    pub fn grid(&self) -> &ClearanceGrid {
        &self.grid
    }

    /// Whether a step can end at a place: a body keeps 1 mm from all barriers there.
    pub fn is_free(&self, p: Vec2) -> bool {
        let keep = self.free.reach() + MARGIN;
        let place = Segment::new(p, p);
        self.free.is_free(p) && !self.free.sight().any_along(&place, keep, |piece| piece.distance(p) < keep)
    }

    /// A place itself, or where it is a hair too near to a barrier for a step to end there, one beside it.
    pub fn beside(&self, mut p: Vec2) -> Vec2 {
        let keep = self.free.reach() + MARGIN;
        for _ in 0..MOVES {
            let near = self.free.sight().near(p, keep);
            let Some(nearest) = near
                .iter()
                .map(|piece| piece.nearest(p))
                .min_by(|a, b| (p - a).norm_squared().total_cmp(&(p - b).norm_squared()))
            else {
                return p;
            };
            let distance = (p - nearest).norm();
            if distance >= keep || distance < keep - 2.0 * MARGIN {
                return p;
            }
            p = nearest + (p - nearest) * (keep * (1.0 + 1e-9) / distance);
        }
        p
    }

    /// Whether a body meets no barrier on the whole path of a step: its center keeps the radius at every point of the curve.
    /// A body that begins nearer to a barrier must not come nearer to it.
    pub fn is_clear(&self, step: &PlacedStep) -> bool {
        // Between points of a curve with second derivative b at distance h, the curve is within b h²/8 of its chord.
        let finer = step.bend() / (8.0 * MARGIN * (LINES * LINES) as f64);
        let lines = if finer <= 1.0 { LINES } else { LINES * (finer.sqrt().ceil() as usize) };
        if lines > 16 * LINES {
            return false;
        }
        let keep = self.free.reach() + MARGIN;
        let middle = step.place(0.5);
        let first = step.start;
        // A step is rarely longer than twice the distance of its ends from its middle; the exact bound follows below.
        let room = self.grid.clearance(middle) - keep;
        let mut from = first;
        (1..=lines).all(|k| {
            let to = if k == lines { step.end() } else { step.place(k as f64 / lines as f64) };
            let line = Segment::new(from, to);
            let is_inside = |p: Vec2| (p - middle).norm() <= room;
            let is_clear = (is_inside(from) && is_inside(to)) || self.keeps(&line, first, keep);
            from = to;
            is_clear
        })
    }

    /// Whether a line keeps a distance from all barriers, and from those nearer to `first` the distance of `first`.
    fn keeps(&self, line: &Segment, first: Vec2, keep: f64) -> bool {
        let half = 0.5 * (line.b - line.a);
        let is_far = self.grid.clearance(line.a + half) >= keep + half.norm();
        is_far
            || !self.free.sight().any_along(line, keep, |piece| {
                let distance = piece.distance_to(line);
                distance < keep && distance < piece.distance(first) - NEARER
            })
    }

    /// Whether a body can stand at the end of a step.
    pub(super) fn is_end_free(&self, step: &PlacedStep) -> bool {
        self.free.is_free(step.end())
    }
}
