//! Square cells with the distance of their centers from the barriers. The distance changes by at most 1 m per metre, so one
//! number bounds it from below around a cell; most tests of collision need no more.

use crate::base::geometry::{Bounds, Vec2};
use crate::route::roadmap::FreeSpace;

/// Distances are measured up to here, m; larger ones are recorded as this.
const FARTHEST: f64 = 2.0;

/// Most cells in a row or column; the cells of a larger scene are larger.
const MOST: f64 = 2000.0;

/// Lines that come nearer to barriers than they should by less than this are clear, m.
const GRAZE: f64 = 0.002;

/// Where the eight cells around a cell are.
const SIDES: [(i64, i64); 8] = [(1, 0), (0, 1), (-1, 0), (0, -1), (1, 1), (-1, 1), (-1, -1), (1, -1)];

/// Cells over a rectangle.
#[derive(Clone, Debug)]
pub struct ClearanceGrid {
    low: Vec2,
    side: f64,
    columns: usize,
    rows: usize,
    /// Distance of the center of each cell from the barriers, m, row by row; 0 inside of solid obstacles.
    clearance: Vec<f64>,
    reach: f64,
}

impl ClearanceGrid {
    /// The side of a cell in Agethen et al. 2018, m.
    pub const SIDE: f64 = 0.08;

    /// Cells of a side, m, that cover a rectangle (at most 2000 in a row; larger cells if necessary).
    pub fn new(free: &FreeSpace, bounds: &Bounds, side: f64) -> Self {
        let size = bounds.high - bounds.low;
        let side = side.max(1e-3).max(size.max() / MOST);
        let count = |length: f64| (length / side + 1e-9).ceil().max(1.0) as usize;
        let (columns, rows) = (count(size.x), count(size.y));
        // The cells lie symmetrically over the rectangle.
        let spare = Vec2::new(columns as f64, rows as f64) * side - size;
        let mut grid = Self {
            low: bounds.low - spare * 0.5,
            side,
            columns,
            rows,
            clearance: Vec::new(),
            reach: free.reach(),
        };
        let clearance = |k| {
            let center = grid.center(k);
            let pieces = free.sight().near(center, FARTHEST);
            let distance = pieces.iter().map(|piece| piece.distance(center)).fold(FARTHEST, f64::min);
            if distance >= free.reach() && !free.is_free(center) { 0.0 } else { distance }
        };
        grid.clearance = (0..columns as u32 * rows as u32).map(clearance).collect();
        grid
    }

    /// The side of a cell, m.
    pub fn side(&self) -> f64 {
        self.side
    }

    /// Cells in a row.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Cells in a column.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// The distance that a body keeps from barriers, m.
    pub fn reach(&self) -> f64 {
        self.reach
    }

    /// The center of a cell, m.
    pub fn center(&self, cell: u32) -> Vec2 {
        let (column, row) = (cell as usize % self.columns, cell as usize / self.columns);
        self.low + Vec2::new(column as f64 + 0.5, row as f64 + 0.5) * self.side
    }

    /// Place in units of cells, (0, 0) at the center of the first one, and the cell to the lower left of it that has
    /// neighbours to the right and above, if the grid has two rows and columns.
    pub(super) fn corner(&self, p: Vec2) -> (Vec2, u32) {
        let at = (p - self.low) / self.side - Vec2::repeat(0.5);
        let index = |v: f64, count: usize| (v.max(0.0) as usize).min(count.saturating_sub(2));
        (at, (index(at.y, self.rows) * self.columns + index(at.x, self.columns)) as u32)
    }

    /// The cell of a place; the nearest one outside of the grid.
    pub fn cell(&self, p: Vec2) -> u32 {
        let at = (p - self.low) / self.side;
        let index = |v: f64, count: usize| (v.max(0.0) as usize).min(count - 1);
        (index(at.y, self.rows) * self.columns + index(at.x, self.columns)) as u32
    }

    /// Whether the center of a body can be at the center of a cell.
    pub fn is_free(&self, cell: u32) -> bool {
        self.keeps(cell, self.reach)
    }

    /// Whether the center of a cell is at least so far from all barriers.
    pub(super) fn keeps(&self, cell: u32, distance: f64) -> bool {
        self.clearance.get(cell as usize).is_some_and(|known| *known >= distance)
    }

    /// No barrier is nearer to the place than this, m; negative where the grid does not say.
    pub fn clearance(&self, p: Vec2) -> f64 {
        let cell = self.cell(p);
        self.clearance[cell as usize] - (p - self.center(cell)).norm()
    }

    /// The distance of a place from barriers, m, between those of the four centers around it, and its gradient.
    fn between(&self, p: Vec2) -> (f64, Vec2) {
        let (at, corner) = self.corner(p);
        let (columns, corner) = (self.columns as u32, corner as usize);
        let (column, row) = (corner as u32 % columns, corner as u32 / columns);
        let x = (at.x - f64::from(column)).clamp(0.0, 1.0);
        let y = (at.y - f64::from(row)).clamp(0.0, 1.0);
        let known = |k: usize| self.clearance.get(corner + k).copied().unwrap_or(0.0);
        let (a, b, c, d) = (known(0), known(1), known(self.columns), known(self.columns + 1));
        let (below, above) = (a + x * (b - a), c + x * (d - c));
        let gradient = Vec2::new(b - a + y * (d - c - b + a), above - below) / self.side;
        (below + y * (above - below), gradient)
    }

    /// The place on a line that is nearest to barriers, moved across to this distance from them, m: the corner that a way from one end
    /// to the other bends around.
    pub(super) fn corner_between(&self, from: Vec2, to: Vec2, distance: f64) -> Option<Vec2> {
        let length = (to - from).norm();
        let along = (to - from) / length.max(1e-12);
        let (mut at, mut tightest) = (0.0, (f64::INFINITY, from));
        while at < length {
            let place = from + along * at;
            let (known, _) = self.between(place);
            if known < tightest.0 {
                tightest = (known, place);
            }
            at += (known - distance - self.side).max(0.25 * self.side);
        }
        let mut at = tightest.1;
        for _ in 0..3 {
            let (known, gradient) = self.between(at);
            let norm = gradient.norm();
            if norm < 0.5 || (known - distance).abs() > 2.0 * self.side {
                return None;
            }
            at -= gradient * ((known - distance) / (norm * norm));
        }
        Some(at)
    }

    /// The up to eight cells around a cell.
    pub(super) fn around(&self, cell: u32) -> impl Iterator<Item = u32> + use<> {
        let (columns, rows) = (self.columns as i64, self.rows as i64);
        let (column, row) = (i64::from(cell) % columns, i64::from(cell) / columns);
        SIDES.into_iter().filter_map(move |(dx, dy)| {
            let (x, y) = (column + dx, row + dy);
            (x >= 0 && y >= 0 && x < columns && y < rows).then_some((y * columns + x) as u32)
        })
    }

    /// Whether the cells along a line keep a distance, m, from barriers; those within `start` of its begin need only be free.
    pub(super) fn is_clear(&self, from: Vec2, to: Vec2, distance: f64, start: f64) -> bool {
        let length = (to - from).norm();
        let along = (to - from) / length.max(1e-12);
        let mut at = 0.0;
        while at < length {
            let cell = self.cell(from + along * at);
            let known = self.clearance[cell as usize];
            let least = if at < start { self.reach } else { distance };
            // The distance of a center is that of its cell within the diagonal.
            if known < least + 0.71 * self.side
                && (known < self.reach || self.between(from + along * at).0 < least - GRAZE)
            {
                return false;
            }
            // A cell that is far from barriers answers for all cells within that distance.
            at += (known - distance - self.side).max(0.5 * self.side);
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::geometry::Shape;
    use crate::model::{Barrier, Obstacle, Scene};

    #[test]
    fn clearance_is_a_lower_bound_and_cells_are_free_where_the_body_fits() {
        let shapes = [
            Shape::rectangle(Vec2::new(1.0, 1.0), Vec2::new(4.0, 2.0)),
            Shape::Circle { centre: Vec2::new(5.0, 4.0), radius: 0.7 },
        ];
        let barrier =
            |shape: &Shape| Barrier { name: String::new(), obstacle: Obstacle::Solid(shape.clone()) };
        let scene = Scene { barriers: shapes.iter().map(barrier).collect(), ..Scene::default() };
        let free = FreeSpace::new(&scene, 0.25);
        let bounds = Bounds { low: Vec2::zeros(), high: Vec2::new(6.5, 6.5) };
        let grid = ClearanceGrid::new(&free, &bounds, ClearanceGrid::SIDE);
        assert_eq!((grid.columns(), grid.rows()), (82, 82));
        for k in 0..10_000_u32 {
            let p = Vec2::new(f64::from(k % 100), f64::from(k / 100)) * 0.066 - Vec2::repeat(0.05);
            let distance = shapes.iter().map(|s| s.distance(p));
            let is_inside = shapes.iter().any(|s| s.contains(p));
            assert!(is_inside || grid.clearance(p) <= distance.fold(f64::INFINITY, f64::min) + 1e-12, "{p}");
            let cell = grid.cell(p);
            assert_eq!(grid.is_free(cell), free.is_free(grid.center(cell)), "{p}");
        }
    }
}
