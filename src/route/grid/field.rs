//! Lengths of the shortest ways from everywhere to a goal: Dijkstra on cells whose parents are the farthest cells in sight, as
//! in lazy Theta* (Nash, Koenig, Tovey 2010), or the corners in between. Steps between neighbours alone would make ways up to 8 % too
//! long, and centers of cells lie up to half a cell beside the corners.

use super::clearance::ClearanceGrid;
use crate::base::frontier::Frontier;
use crate::base::geometry::Vec2;

/// Ways keep this distance from barriers in addition to the radius, m, where there is room for it: about the sway of a walk.
const COMFORT: f64 = 0.05;

/// A metre nearer to barriers than that counts as so many.
const TIGHT: f64 = 3.0;

/// The direction of a way is that to the place so far ahead, m, if a corner is nearer.
const AHEAD: f64 = 0.2;

/// How a way begins: straight to an anchor, with `rest` metres from there.
#[derive(Clone, Copy, Debug)]
struct Onward {
    anchor: Vec2,
    /// The anchor after it.
    next: Vec2,
    rest: f64,
    /// The last anchor before the goal; `None` if the anchor is the goal.
    root: Option<Vec2>,
}

/// The ways to one goal.
#[derive(Clone, Debug)]
pub struct GoalField {
    goal: Vec2,
    cells: Vec<Option<Onward>>,
}

impl GoalField {
    /// The field of a goal point.
    pub fn new(grid: &ClearanceGrid, goal: Vec2) -> Self {
        let mut field = Self { goal, cells: vec![None; grid.columns() * grid.rows()] };
        field.spread(grid);
        // Places between free and other cells need the ways of both.
        field.widen(grid);
        field.widen(grid);
        field
    }

    /// The field of a point to which straight lines lead from everywhere.
    pub fn straight(goal: Vec2) -> Self {
        Self { goal, cells: Vec::new() }
    }

    /// Whether it is one to which straight lines lead.
    pub fn is_straight(&self) -> bool {
        self.cells.is_empty()
    }

    fn spread(&mut self, grid: &ClearanceGrid) {
        let comfort = grid.reach() + COMFORT;
        let (near, start) = (1.5 * grid.side(), 1.5 * grid.side() + COMFORT);
        let mut lengths = vec![f64::INFINITY; self.cells.len()];
        let mut states = vec![State::Open; self.cells.len()];
        let mut queue = Frontier::new();
        let source = grid.cell(self.goal);
        for cell in grid.around(source).chain([source]).filter(|k| grid.is_free(*k)) {
            let length = (grid.center(cell) - self.goal).norm();
            lengths[cell as usize] = length;
            self.cells[cell as usize] =
                Some(Onward { anchor: self.goal, next: self.goal, rest: 0.0, root: None });
            queue.push(length, cell);
        }
        while let Some((length, at)) = queue.pop() {
            let (k, center) = (at as usize, grid.center(at));
            if states[k] == State::Closed || length > lengths[k] {
                continue;
            }
            let Some(onward) = self.cells[k] else { continue };
            let sees = |anchor: Vec2| {
                (anchor - center).norm() <= near || grid.is_clear(center, anchor, comfort, start)
            };
            if states[k] == State::Open {
                states[k] = State::Checked;
                if !sees(onward.anchor) {
                    // The cells around it whose ways are known: their anchors, or the cells themselves.
                    let mut best = (f64::INFINITY, onward);
                    // Many cells share an anchor; it is looked at once.
                    let mut hidden = onward.anchor;
                    for other in grid.around(at).filter(|other| states[*other as usize] == State::Closed) {
                        let Some(known) = self.cells[other as usize] else { continue };
                        let through = (center - known.anchor).norm() + known.rest;
                        if through < best.0 && known.anchor != hidden {
                            if sees(known.anchor) {
                                best = (through, known);
                                continue;
                            }
                            hidden = known.anchor;
                        }
                        if known.anchor == best.1.anchor && best.0.is_finite() {
                            continue;
                        }
                        // Around the corner that is in between, or at least through the neighbour.
                        let corner = grid.corner_between(center, known.anchor, comfort).filter(|corner| {
                            sees(*corner) && grid.is_clear(*corner, known.anchor, comfort, start)
                        });
                        let (place, rest) = match corner {
                            Some(corner) => (corner, (corner - known.anchor).norm() + known.rest),
                            None => {
                                let place = grid.center(other);
                                let more = if grid.keeps(at, comfort) { 0.0 } else { TIGHT - 1.0 };
                                (place, more * (center - place).norm() + lengths[other as usize])
                            }
                        };
                        let step = (center - place).norm();
                        if step + rest < best.0 {
                            let root = Some(known.root.unwrap_or(place));
                            best = (step + rest, Onward { anchor: place, next: known.anchor, rest, root });
                        }
                    }
                    lengths[k] = best.0;
                    self.cells[k] = Some(best.1).filter(|_| best.0.is_finite());
                    if best.0.is_finite() {
                        queue.push(best.0, at);
                    }
                    continue;
                }
            }
            states[k] = State::Closed;
            for other in grid.around(at) {
                let j = other as usize;
                let length = (grid.center(other) - onward.anchor).norm() + onward.rest;
                if states[j] == State::Open && length < lengths[j] && grid.is_free(other) {
                    lengths[j] = length;
                    self.cells[j] = Some(onward);
                    queue.push(length, other);
                }
            }
        }
    }

    /// Gives cells without a way the best one of the cells around them.
    fn widen(&mut self, grid: &ClearanceGrid) {
        let known = self.cells.clone();
        for cell in (0..known.len() as u32).filter(|k| known[*k as usize].is_none()) {
            let center = grid.center(cell);
            let length = |way: &Onward| (center - way.anchor).norm() + way.rest;
            let ways = grid.around(cell).filter_map(|other| known[other as usize]);
            self.cells[cell as usize] = ways.min_by(|a, b| length(a).total_cmp(&length(b)));
        }
    }

    /// Length of the way from a place to `goal`, m, and its direction (length 1; zero at the goal); `None` where no way leads
    /// there. `goal` is a point near that of the field and in sight of it. Continuous in the place.
    pub fn way(&self, grid: &ClearanceGrid, from: Vec2, goal: Vec2) -> Option<Way> {
        if self.is_straight() {
            let ahead = goal - from;
            let length = ahead.norm();
            return Some(Way { length, direction: ahead / length.max(1e-12), is_straight: false });
        }
        let (at, corner) = grid.corner(from);
        let columns = grid.columns() as u32;
        let (column, row) = (f64::from(corner % columns), f64::from(corner / columns));
        let share = Vec2::new((at.x - column).clamp(0.0, 1.0), (at.y - row).clamp(0.0, 1.0));
        let right = [1.0 - share.x, share.x];
        let (mut length, mut direction, mut total, mut sees) = (0.0, Vec2::zeros(), 0.0, true);
        for (k, weight) in [(0, 1.0 - share.y), (columns, share.y)]
            .into_iter()
            .flat_map(|(row, up)| [(corner + row, up * right[0]), (corner + row + 1, up * right[1])])
        {
            let Some(Some(way)) = self.cells.get(k as usize).filter(|_| weight > 0.0) else { continue };
            let (anchor, rest) = match way.root {
                None => (goal, 0.0),
                Some(root) => (way.anchor, way.rest + (root - goal).norm() - (root - self.goal).norm()),
            };
            let distance = (anchor - from).norm();
            sees &= way.root.is_none();
            length += weight * (distance + rest);
            // Close to a corner it is where the way leads from there that counts.
            let onward = way.next - anchor;
            let beyond = (AHEAD - distance).clamp(0.0, onward.norm());
            let ahead = anchor - from + onward * (beyond / onward.norm().max(1e-12));
            direction += ahead * (weight / ahead.norm().max(1e-12));
            total += weight;
        }
        let norm = direction.norm();
        let direction = if norm > 1e-9 { direction / norm } else { Vec2::zeros() };
        (total > 0.0).then(|| Way { length: length / total, direction, is_straight: sees })
    }
}

/// A way to the goal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Way {
    /// Its length, m.
    pub length: f64,
    /// In which direction it begins.
    pub direction: Vec2,
    /// Whether it leads straight to the goal.
    pub is_straight: bool,
}

#[derive(Clone, Copy, PartialEq)]
enum State {
    Open,
    Checked,
    Closed,
}

#[cfg(test)]
#[allow(clippy::disallowed_methods, reason = "the platform's functions are the reference")]
mod tests {
    use super::*;
    use crate::base::geometry::{Bounds, Shape};
    use crate::model::{Barrier, Obstacle, Scene};
    use crate::route::roadmap::FreeSpace;

    fn grid(shape: Option<Shape>) -> ClearanceGrid {
        let barrier = |shape| Barrier { name: String::new(), obstacle: Obstacle::Solid(shape) };
        let scene = Scene { barriers: shape.map(barrier).into_iter().collect(), ..Scene::default() };
        let bounds = Bounds { low: Vec2::zeros(), high: Vec2::new(8.0, 8.0) };
        ClearanceGrid::new(&FreeSpace::new(&scene, 0.25), &bounds, ClearanceGrid::SIDE)
    }

    #[test]
    fn open_floor_has_straight_ways_also_to_a_goal_nearby_and_from_outside() {
        let grid = grid(None);
        let field = GoalField::new(&grid, Vec2::new(3.0, 4.0));
        for k in 0..400_u32 {
            let from = Vec2::new(f64::from(k % 20), f64::from(k / 20)) * 0.45 - Vec2::repeat(0.3);
            let goal = Vec2::new(3.1, 3.8);
            let way = field.way(&grid, from, goal).unwrap();
            assert!((way.length - (goal - from).norm()).abs() < 1e-9);
            assert!(way.is_straight && (from + way.direction * way.length - goal).norm() < 1e-9);
        }
    }

    /// The shortest way around a disc: two tangents and an arc.
    fn around(from: Vec2, to: Vec2, center: Vec2, radius: f64) -> f64 {
        let (a, b) = (from - center, to - center);
        let tangent = |v: Vec2| (v.norm_squared() - radius * radius).sqrt();
        let angle = (a.dot(&b) / (a.norm() * b.norm())).clamp(-1.0, 1.0).acos();
        let arc = angle - (radius / a.norm()).acos() - (radius / b.norm()).acos();
        if arc <= 0.0 { (to - from).norm() } else { tangent(a) + tangent(b) + radius * arc }
    }

    #[test]
    fn ways_around_a_disc_are_long_enough_and_rarely_too_long_and_continuous() {
        let (center, radius, goal) = (Vec2::new(4.0, 4.0), 1.0, Vec2::new(7.0, 4.3));
        let grid = grid(Some(Shape::Circle { centre: center, radius }));
        let field = GoalField::new(&grid, goal);
        // From behind, the way leads along the tangent of what it keeps.
        let from = Vec2::new(1.0, 4.1);
        let ahead = field.way(&grid, from, goal).unwrap().direction;
        let kept = (center - from).perp(&ahead).abs();
        assert!((kept - radius - 0.25 - COMFORT).abs() < 0.01, "{kept}");
        let (mut worst, mut sum, mut count): (f64, f64, f64) = (0.0, 0.0, 0.0);
        for k in 0..40_000_u32 {
            let from = Vec2::new(f64::from(k % 200), f64::from(k / 200)) * 0.04;
            if (from - center).norm() < radius + 0.32 || (from - goal).norm() < 0.5 {
                continue;
            }
            let exact = around(from, goal, center, radius + 0.25);
            let way = field.way(&grid, from, goal).unwrap();
            assert!(way.length > 0.995 * exact - 1e-9, "{from}: {} {exact}", way.length);
            // The way keeps some centimetres more from the disc than the body.
            worst = worst.max((way.length - exact - 0.05) / exact);
            (sum, count) = (sum + way.length / exact - 1.0, count + 1.0);
            let near = field.way(&grid, from + Vec2::new(1e-4, 1e-4), goal).unwrap();
            assert!((near.length - way.length).abs() < 1e-3, "{from}");
        }
        assert!(worst < 0.045 && sum / count < 0.005, "{worst} {}", sum / count);
    }
}
