//! Which surfaces may be near: a grid over the rectangles around them.
//!
//! For scenes with thousands of barriers, as buildings imported from files have them. A question gives all
//! surfaces whose rectangles meet a given one, and perhaps some more, in ascending order; whoever asks looks
//! closely at each. So it changes no bit whether a surface was found here or in a look at all of them.

use super::{Bounds, Segment, Vec2};
use std::borrow::Cow;

/// Up to so many surfaces, a look at each is as fast.
const FEW: usize = 16;

/// At most so many entries a surface, on average: large surfaces are in many squares.
const MOST_ENTRIES: usize = 64;

/// Squares of the plane and the surfaces that reach into each.
#[derive(Clone, Debug, Default)]
pub struct Nearby {
    all: Vec<u32>,
    /// `None` where all are looked at.
    squares: Option<Squares>,
}

#[derive(Clone, Debug)]
struct Squares {
    low: Vec2,
    high: Vec2,
    per_side: f64,
    columns: usize,
    rows: usize,
    /// Where the list of each square starts; one more at the end.
    first: Vec<u32>,
    surfaces: Vec<u32>,
}

impl Nearby {
    /// For surfaces inside these rectangles.
    pub fn new(bounds: &[Bounds]) -> Self {
        let squares = if bounds.len() > FEW { Squares::new(bounds) } else { None };
        Self { all: (0..bounds.len() as u32).collect(), squares }
    }

    /// Side of a square, m; `None` where all surfaces are always near.
    pub fn side(&self) -> Option<f64> {
        self.squares.as_ref().map(|squares| 1.0 / squares.per_side)
    }

    /// Whether a rectangle holds all surfaces.
    pub fn is_within(&self, around: &Bounds) -> bool {
        self.squares.as_ref().is_none_or(|squares| {
            let (low, high) = (squares.low, squares.high);
            around.low.x <= low.x
                && around.low.y <= low.y
                && around.high.x >= high.x
                && around.high.y >= high.y
        })
    }

    /// The surfaces that may be nearer than `reach` to a place, ascending; amply, whatever rounding does.
    pub fn within(&self, p: Vec2, reach: f64) -> Cow<'_, [u32]> {
        let mut room = Vec::new();
        if self.squares.is_some() {
            self.find(&amply_around(p, reach), &mut room);
            return Cow::Owned(room);
        }
        Cow::Borrowed(&self.all)
    }

    /// The surfaces that may meet a rectangle, ascending. `room` is overwritten.
    pub fn find<'a>(&'a self, around: &Bounds, room: &'a mut Vec<u32>) -> &'a [u32] {
        let Some(squares) = &self.squares else { return &self.all };
        room.clear();
        let columns = squares.columns(around.low.x, around.high.x);
        let rows = squares.rows(around.low.y, around.high.y);
        // Large surfaces are in many squares: a look at all of them is faster than sorting as many entries.
        let entries = |row| squares.entries(row, &columns);
        if rows.clone().map(entries).sum::<usize>() > self.all.len() {
            return &self.all;
        }
        for row in rows.clone() {
            for column in columns.clone() {
                room.extend_from_slice(squares.at(row, column));
            }
        }
        if rows.len() * columns.len() > 1 {
            room.sort_unstable();
            room.dedup();
        }
        room
    }
}

/// A square of twice `reach` around a place, and more than rounding can do.
pub fn amply_around(p: Vec2, reach: f64) -> Bounds {
    let reach = Vec2::repeat(reach + 1e-9 * (reach + p.x.abs() + p.y.abs()));
    Bounds { low: p - reach, high: p + reach }
}

impl Nearby {
    /// Whether something is true of a surface that may be nearer than `reach` to a line; some are asked about repeatedly.
    pub fn any_along(&self, line: &Segment, reach: f64, mut is_true: impl FnMut(u32) -> bool) -> bool {
        let Some(squares) = &self.squares else { return self.all.iter().any(|&k| is_true(k)) };
        let slack = |v: f64| reach + 1e-9 * (reach + v.abs());
        let (low, high) = if line.a.y <= line.b.y { (line.a, line.b) } else { (line.b, line.a) };
        let (bottom, top) = (low.y - slack(low.y), high.y + slack(high.y));
        let rise = high.y - low.y;
        for row in squares.rows(bottom, top) {
            // The part of the line that is near this row.
            let (from, to) = squares.span(row);
            let share = |y: f64| if rise > 0.0 { ((y - low.y) / rise).clamp(0.0, 1.0) } else { 0.0 };
            let reached =
                if rise > 0.0 { (share(from - slack(from)), share(to + slack(to))) } else { (0.0, 1.0) };
            let x = |share: f64| low.x + (high.x - low.x) * share;
            let (left, right) = (x(reached.0).min(x(reached.1)), x(reached.0).max(x(reached.1)));
            for column in squares.columns(left - slack(left), right + slack(right)) {
                if squares.at(row, column).iter().any(|&k| is_true(k)) {
                    return true;
                }
            }
        }
        false
    }
}

impl Squares {
    /// `None` where coordinates are infinite or no numbers.
    fn new(bounds: &[Bounds]) -> Option<Self> {
        let all = Bounds::around(bounds.iter().flat_map(|b| [b.low, b.high]))?;
        let size = all.high - all.low;
        if !(size.x.is_finite() && size.y.is_finite() && size.x + size.y > 0.0) {
            return None;
        }
        // As many squares as surfaces, about; fewer while large surfaces are in too many of them.
        let count = bounds.len() as f64;
        let mut side = (size.x * size.y / count).sqrt();
        let least = (size.x + size.y) / (2.0 * count);
        side = if side > least { side } else { least };
        loop {
            let mut squares = Self {
                low: all.low,
                high: all.high,
                per_side: 1.0 / side,
                columns: (size.x / side) as usize + 1,
                rows: (size.y / side) as usize + 1,
                first: Vec::new(),
                surfaces: Vec::new(),
            };
            let entries: usize =
                bounds.iter().map(|b| squares.rows_of(b).len() * squares.columns_of(b).len()).sum();
            if entries <= MOST_ENTRIES * bounds.len() {
                squares.fill(bounds);
                return Some(squares);
            }
            side *= 2.0;
        }
    }

    fn fill(&mut self, bounds: &[Bounds]) {
        let mut lists = vec![Vec::new(); self.rows * self.columns];
        for (k, b) in bounds.iter().enumerate() {
            for row in self.rows_of(b) {
                for column in self.columns_of(b) {
                    lists[row * self.columns + column].push(k as u32);
                }
            }
        }
        for list in lists {
            self.first.push(self.surfaces.len() as u32);
            self.surfaces.extend(list);
        }
        self.first.push(self.surfaces.len() as u32);
    }

    /// Which of `count` intervals: never falls as `v` rises. The cast saturates, and takes NaN to 0.
    fn place(&self, v: f64, count: usize) -> usize {
        ((v * self.per_side) as usize).min(count - 1)
    }

    fn columns(&self, low: f64, high: f64) -> std::ops::Range<usize> {
        self.place(low - self.low.x, self.columns)..self.place(high - self.low.x, self.columns) + 1
    }

    fn rows(&self, low: f64, high: f64) -> std::ops::Range<usize> {
        self.place(low - self.low.y, self.rows)..self.place(high - self.low.y, self.rows) + 1
    }

    fn columns_of(&self, b: &Bounds) -> std::ops::Range<usize> {
        self.columns(b.low.x, b.high.x)
    }

    fn rows_of(&self, b: &Bounds) -> std::ops::Range<usize> {
        self.rows(b.low.y, b.high.y)
    }

    /// The coordinates between which a row lies; without end at the rim, where all that lies beyond is counted.
    fn span(&self, row: usize) -> (f64, f64) {
        let at = |row: usize| self.low.y + row as f64 / self.per_side;
        let low = if row == 0 { f64::NEG_INFINITY } else { at(row) };
        (low, if row + 1 == self.rows { f64::INFINITY } else { at(row + 1) })
    }

    /// How long the lists of some squares of a row are together.
    fn entries(&self, row: usize, columns: &std::ops::Range<usize>) -> usize {
        let square = |column: usize| self.first[row * self.columns + column] as usize;
        square(columns.end) - square(columns.start)
    }

    fn at(&self, row: usize, column: usize) -> &[u32] {
        let square = row * self.columns + column;
        &self.surfaces[self.first[square] as usize..self.first[square + 1] as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_that_meets_a_rectangle_is_missed_and_the_order_is_ascending() {
        // Pieces of many sizes, one as large as the scene, some outside of where anybody asks.
        let piece = |k: u32| {
            let (x, y) = (f64::from(k * 7919 % 997) * 0.11 - 20.0, f64::from(k * 104_729 % 1009) * 0.07);
            let size = 0.3 + f64::from(k % 13);
            Bounds { low: Vec2::new(x, y), high: Vec2::new(x + size, y + size * f64::from(k % 3)) }
        };
        for count in [1, FEW, FEW + 1, 300, 3_000] {
            let mut bounds: Vec<Bounds> = (0..count as u32).map(piece).collect();
            bounds[0] = Bounds { low: Vec2::new(-30.0, -5.0), high: Vec2::new(100.0, 90.0) };
            let nearby = Nearby::new(&bounds);
            assert_eq!(nearby.side().is_none(), count <= FEW);
            let mut room = Vec::new();
            let mut looked_at = 0;
            for ask in 0..200 {
                let low = Vec2::new(f64::from(ask % 20) * 6.0 - 40.0, f64::from(ask / 20) * 9.0 - 10.0);
                let around = Bounds { low, high: low + Vec2::new(0.1 * f64::from(ask), 2.0) };
                let found = nearby.find(&around, &mut room);
                looked_at += found.len();
                assert!(found.is_sorted_by(|a, b| a < b));
                for (k, b) in bounds.iter().enumerate() {
                    let meets = b.low.x <= around.high.x
                        && around.low.x <= b.high.x
                        && b.low.y <= around.high.y
                        && around.low.y <= b.high.y;
                    assert!(!meets || found.binary_search(&(k as u32)).is_ok(), "{k} is missing");
                }
            }
            assert!(count < 1_000 || looked_at < 200 * count / 4, "{looked_at}");
        }
    }

    #[test]
    fn a_question_about_large_surfaces_sorts_no_more_entries_than_there_are_surfaces() {
        let large = |k: u32| {
            let low = Vec2::new(f64::from(k * 7919 % 997) * 0.01, f64::from(k * 104_729 % 1009) * 0.01);
            Bounds { low, high: low + Vec2::new(10.0, 10.0) }
        };
        let bounds: Vec<Bounds> = (0..1_000).map(large).collect();
        let (nearby, mut room) = (Nearby::new(&bounds), Vec::new());
        assert!(nearby.side().is_some());
        assert_eq!(nearby.find(&bounds[0], &mut room).len(), 1_000);
        assert!(room.is_empty());
    }

    #[test]
    fn surfaces_on_one_point_or_without_end_are_all_near() {
        let point = Bounds { low: Vec2::zeros(), high: Vec2::zeros() };
        let endless = Bounds { low: Vec2::zeros(), high: Vec2::new(f64::INFINITY, 0.0) };
        for odd in [point, endless] {
            let nearby = Nearby::new(&[odd; 2 * FEW]);
            let mut room = Vec::new();
            assert!(nearby.side().is_none());
            assert_eq!(nearby.find(&point, &mut room).len(), 2 * FEW);
        }
    }
}
