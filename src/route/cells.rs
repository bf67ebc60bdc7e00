//! Which circles may be in sight from where: a grid of cells, each with the circles that no single barrier hides from all of
//! it. A list is made when it is first needed, and depends on nothing but the scene, so that no result depends on when.

use super::circle::Circle;
use crate::base::geometry::{Bounds, Segment, Vec2, cross};
use crate::model::{Piece, Sight};
use std::sync::OnceLock;

/// Side of a cell, m, in scenes of usual size.
const SIDE: f64 = 1.0;

/// Most cells in a row or column.
const MOST: f64 = 200.0;

/// Sides of a block of cells, whose circles are found first.
const BLOCK: f64 = 4.0;

/// Squares of the plane, and the circles that may be in sight from each.
#[derive(Debug, Default)]
struct Grid {
    low: Vec2,
    side: f64,
    columns: usize,
    lists: Vec<OnceLock<Vec<u32>>>,
}

impl Grid {
    fn new(bounds: &Bounds, side: f64) -> Self {
        let size = bounds.high - bounds.low;
        let (columns, rows) = ((size.x / side) as usize + 1, (size.y / side) as usize + 1);
        let lists = (0..columns * rows).map(|_| OnceLock::new()).collect();
        Self { low: bounds.low, side, columns, lists }
    }

    /// The square of a place.
    fn square(&self, p: Vec2) -> Option<usize> {
        let at = (p - self.low) / self.side;
        let is_inside = at.x >= 0.0 && at.y >= 0.0 && (at.x as usize) < self.columns;
        let square = is_inside.then(|| at.y as usize * self.columns + at.x as usize)?;
        (square < self.lists.len()).then_some(square)
    }

    /// The circles that may be in sight from a square; those among `known`.
    fn seen<'k>(
        &self,
        square: usize,
        (circles, sight): (&[Circle], &Sight),
        known: impl FnOnce() -> &'k [u32],
    ) -> &[u32] {
        self.lists[square].get_or_init(|| {
            let at = Vec2::new((square % self.columns) as f64, (square / self.columns) as f64);
            let low = self.low + at * self.side;
            let cell = Bounds { low, high: low + Vec2::repeat(self.side) };
            let in_sight = |&k: &u32| !is_hidden(&cell, &circles[k as usize], sight);
            known().iter().copied().filter(in_sight).collect()
        })
    }
}

#[derive(Debug, Default)]
pub(super) struct Cells {
    fine: Grid,
    blocks: Grid,
    /// For places outside of the grids.
    all: Vec<u32>,
}

impl Cells {
    pub(super) fn new(circles: &[Circle]) -> Self {
        let all = (0..circles.len() as u32).collect();
        let Some(bounds) = Bounds::around(circles.iter().map(|circle| circle.centre)) else {
            return Self { all, ..Self::default() };
        };
        let size = bounds.high - bounds.low;
        let side = SIDE.max(size.x / MOST).max(size.y / MOST);
        Self { fine: Grid::new(&bounds, side), blocks: Grid::new(&bounds, BLOCK * side), all }
    }

    /// How many cells there are.
    pub(super) fn count(&self) -> usize {
        self.fine.lists.len()
    }

    /// The cell of a place, and the circles that may be in sight from it, and perhaps others; ascending.
    pub(super) fn seen(&self, p: Vec2, circles: &[Circle], sight: &Sight) -> (Option<usize>, &[u32]) {
        let Some(cell) = self.fine.square(p) else { return (None, &self.all) };
        let middle = Vec2::new((cell % self.fine.columns) as f64, (cell / self.fine.columns) as f64);
        let middle = self.fine.low + (middle + Vec2::repeat(0.5)) * self.fine.side;
        let scene = (circles, sight);
        let block = || self.blocks.square(middle);
        let known = || block().map_or(&self.all[..], |block| self.blocks.seen(block, scene, || &self.all));
        (Some(cell), self.fine.seen(cell, scene, known))
    }
}

fn corners(b: &Bounds) -> [Vec2; 4] {
    [b.low, Vec2::new(b.high.x, b.low.y), b.high, Vec2::new(b.low.x, b.high.y)]
}

/// Whether one edge lies between all of a cell and all of a circle.
fn is_hidden(cell: &Bounds, circle: &Circle, sight: &Sight) -> bool {
    let reach = Vec2::repeat(circle.radius);
    let (here, there) =
        (corners(cell), corners(&Bounds { low: circle.centre - reach, high: circle.centre + reach }));
    let line = Segment::new(0.5 * (cell.low + cell.high), circle.centre);
    let between = |edge: &Segment| {
        let side = |p: Vec2| cross(edge.b - edge.a, p - edge.a);
        let sign = side(here[0]).signum();
        here.iter().all(|p| sign * side(*p) > 0.0)
            && there.iter().all(|p| sign * side(*p) < 0.0)
            && here.iter().all(|p| {
                there.iter().all(|q| {
                    let end = |e: Vec2| sign * cross(q - p, e - p);
                    end(edge.a) * end(edge.b) < 0.0
                })
            })
    };
    sight.any_along(&line, 0.0, |piece| matches!(piece, Piece::Edge(edge) if between(edge)))
}
