//! Bodies placed so far, found by neighbourhood.

use crate::base::geometry::Vec2;
use crate::model::Periods;
use std::collections::BTreeMap;

/// Up to so many bodies, all are in one cell.
const FEW: usize = 64;

/// Discs in a grid of square cells of twice the largest radius, so that all that overlap a disc are in
/// its cell and the eight around it.
#[derive(Clone, Debug)]
pub(super) struct Crowd {
    pub(super) positions: Vec<Vec2>,
    pub(super) radii: Vec<f64>,
    cell: f64,
    /// How far images are, and the periods.
    ways: Vec<Vec2>,
    periods: Periods,
    cells: BTreeMap<(i64, i64), Vec<u32>>,
}

impl Crowd {
    /// So many bodies, none placed.
    pub(super) fn new(radii: Vec<f64>, periods: Periods) -> Self {
        let largest = radii.iter().fold(0.0, |a: f64, &b| if b > a { b } else { a });
        let cell = if radii.len() <= FEW || largest == 0.0 { f64::INFINITY } else { 2.0 * largest };
        let positions = vec![Vec2::zeros(); radii.len()];
        Self { positions, radii, cell, ways: periods.images(), periods, cells: BTreeMap::new() }
    }

    fn cell_of(&self, p: Vec2) -> (i64, i64) {
        ((p.x / self.cell).floor() as i64, (p.y / self.cell).floor() as i64)
    }

    /// Places a body.
    pub(super) fn put(&mut self, body: usize, p: Vec2) {
        let p = self.periods.wrap(p);
        self.positions[body] = p;
        let cell = if self.cell.is_finite() { self.cell_of(p) } else { (0, 0) };
        self.cells.entry(cell).or_default().push(body as u32);
    }

    /// Moves a body that has a place.
    pub(super) fn shift(&mut self, body: usize, p: Vec2) {
        if self.cell.is_finite() {
            let old = self.cell_of(self.positions[body]);
            if let Some(cell) = self.cells.get_mut(&old) {
                cell.retain(|&b| b as usize != body);
            }
            self.put(body, p);
        } else {
            self.positions[body] = self.periods.wrap(p);
        }
    }

    /// The way to a place from a body.
    pub(super) fn way_from(&self, body: usize, p: Vec2) -> Vec2 {
        self.periods.way(p - self.positions[body])
    }

    /// Calls `f` with every placed body that may overlap a disc of `body`'s radius at `p`, except itself.
    /// The order is the same whenever the history is.
    pub(super) fn around(&self, body: usize, p: Vec2, mut f: impl FnMut(usize)) {
        let mut visit = |cell: (i64, i64)| {
            for &other in self.cells.get(&cell).map_or(&[][..], Vec::as_slice) {
                if other as usize != body {
                    f(other as usize);
                }
            }
        };
        if !self.cell.is_finite() {
            visit((0, 0));
            return;
        }
        for way in &self.ways {
            let (x, y) = self.cell_of(p + way);
            for dx in -1..=1 {
                for dy in -1..=1 {
                    visit((x.saturating_add(dx), y.saturating_add(dy)));
                }
            }
        }
    }

    /// Smallest gap between `body`, were it at `p`, and all that are placed; infinite if nobody is near.
    pub(super) fn gap(&self, body: usize, p: Vec2) -> f64 {
        let mut least = f64::INFINITY;
        self.around(body, p, |other| {
            let gap = self.way_from(other, p).norm() - self.radii[body] - self.radii[other];
            if gap < least {
                least = gap;
            }
        });
        least
    }
}
