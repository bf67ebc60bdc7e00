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

#[derive(Debug, Default)]
pub(super) struct Cells {
    low: Vec2,
    side: f64,
    columns: usize,
    lists: Vec<OnceLock<Vec<u32>>>,
    /// For places outside of the grid.
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
        let (columns, rows) = ((size.x / side) as usize + 1, (size.y / side) as usize + 1);
        let lists = (0..columns * rows).map(|_| OnceLock::new()).collect();
        Self { low: bounds.low, side, columns, lists, all }
    }

    /// The circles that may be in sight from a place, and perhaps others; ascending.
    pub(super) fn seen(&self, p: Vec2, circles: &[Circle], sight: &Sight) -> &[u32] {
        let at = (p - self.low) / self.side;
        if !(at.x >= 0.0 && at.y >= 0.0 && (at.x as usize) < self.columns) {
            return &self.all;
        }
        let (column, row) = (at.x as usize, at.y as usize);
        let Some(list) = self.lists.get(row * self.columns + column) else { return &self.all };
        list.get_or_init(|| {
            let low = self.low + Vec2::new(column as f64, row as f64) * self.side;
            let cell = Bounds { low, high: low + Vec2::repeat(self.side) };
            let in_sight = |&k: &u32| !is_hidden(&cell, &circles[k as usize], sight);
            self.all.iter().copied().filter(in_sight).collect()
        })
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
