//! Nearest vertices: a grid to which vertices are added one by one.

use crate::base::geometry::{Bounds, Vec2};

/// No vertex follows in a square.
const NONE: u32 = u32::MAX;

/// Squares of the plane and the vertices in each. What lies beyond the rim is counted in the squares at the rim.
#[derive(Debug)]
pub(super) struct VertexGrid {
    low: Vec2,
    side: f64,
    columns: usize,
    rows: usize,
    /// The latest vertex of each square.
    first: Vec<u32>,
    /// The vertex before each in its square.
    next: Vec<u32>,
    places: Vec<Vec2>,
}

impl VertexGrid {
    /// For about `count` vertices in a rectangle.
    pub(super) fn new(bounds: Bounds, count: usize) -> Self {
        let size = bounds.high - bounds.low;
        let count = count.max(1) as f64;
        // About two vertices a square.
        let side = (2.0 * size.x * size.y / count).sqrt().max((size.x + size.y) / count);
        let side = if side > 0.0 { side } else { 1.0 };
        let (columns, rows) = ((size.x / side) as usize + 1, (size.y / side) as usize + 1);
        let first = vec![NONE; columns * rows];
        Self { low: bounds.low, side, columns, rows, first, next: Vec::new(), places: Vec::new() }
    }

    pub(super) fn places(&self) -> &[Vec2] {
        &self.places
    }

    pub(super) fn into_places(self) -> Vec<Vec2> {
        self.places
    }

    fn square(&self, p: Vec2) -> (usize, usize) {
        let at = (p - self.low) / self.side;
        ((at.x as usize).min(self.columns - 1), (at.y as usize).min(self.rows - 1))
    }

    pub(super) fn insert(&mut self, p: Vec2) {
        let (column, row) = self.square(p);
        let first = &mut self.first[row * self.columns + column];
        self.next.push(*first);
        *first = self.places.len() as u32;
        self.places.push(p);
    }

    /// The `count` vertices nearest to a place, nearest first, ties by number: squares of distances, m², and numbers.
    pub(super) fn nearest<'f>(
        &self,
        p: Vec2,
        count: usize,
        found: &'f mut Vec<(f64, u32)>,
    ) -> &'f [(f64, u32)] {
        found.clear();
        let (column, row) = self.square(p);
        for ring in 0..self.columns.max(self.rows) {
            // All in this ring and beyond are at least so far.
            let least = (ring as f64 - 1.0).max(0.0) * self.side;
            if found.len() >= count && found.last().is_none_or(|(far, _)| *far < least * least) {
                break;
            }
            let columns = column.saturating_sub(ring)..=(column + ring).min(self.columns - 1);
            for y in row.saturating_sub(ring)..=(row + ring).min(self.rows - 1) {
                if y.abs_diff(row) == ring {
                    columns.clone().for_each(|x| self.visit((x, y), p, count, found));
                    continue;
                }
                if column >= ring {
                    self.visit((column - ring, y), p, count, found);
                }
                if ring > 0 && column + ring < self.columns {
                    self.visit((column + ring, y), p, count, found);
                }
            }
        }
        found
    }

    fn visit(&self, (x, y): (usize, usize), p: Vec2, count: usize, found: &mut Vec<(f64, u32)>) {
        let mut vertex = self.first[y * self.columns + x];
        while let Some(place) = self.places.get(vertex as usize) {
            let square = (place - p).norm_squared();
            let at = found.partition_point(|known| *known < (square, vertex));
            if at < count {
                found.truncate(count - 1);
                found.insert(at, (square, vertex));
            }
            vertex = self.next[vertex as usize];
        }
    }
}
