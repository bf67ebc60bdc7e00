//! Even steps along the shortest path over the cells of a grid: the baseline of Agethen et al. 2018, section 5.2.

use super::last::Chain;
use super::placed::{PlacedStep, end_of};
use super::task::Walk;
use super::walker::Walker;
use crate::base::geometry::Vec2;
use crate::gait::{SPANS, Shape, Stance};
use crate::route::grid::shortest_cells;

/// The place so far along a line of points, m.
fn along(points: &[Vec2], mut left: f64) -> Vec2 {
    for pair in points.windows(2) {
        let length = (pair[1] - pair[0]).norm();
        if left <= length {
            return pair[0] + (pair[1] - pair[0]) * (left / length.max(1e-12));
        }
        left -= length;
    }
    points[points.len() - 1]
}

impl Walk<'_> {
    /// All steps to the goal, the first one first: as long as the gait's usual ones, or a little shorter.
    pub(super) fn along_cells(&self, walker: &Walker) -> Option<Chain> {
        let mut path = shortest_cells(self.ground.grid(), walker.at, self.goal)?;
        // The path leads from the middle of a cell to that of another.
        let last = path.len() - 1;
        (path[0], path[last]) = (walker.at, if last > 0 { self.goal } else { walker.at });
        path.push(self.goal);
        let length: f64 = path.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum();
        let count = (length / self.usual()).ceil().max(1.0);
        let (each, usual) = (length / count, self.usual());
        let (mut foot, mut chain) = (walker.foot, Chain::new());
        for k in 0..count as u32 {
            let at = |part: f64| along(&path, each * (f64::from(k) + part));
            let (start, ahead) = (at(0.0), at(1e-3) - at(0.0));
            let heading = ahead / ahead.norm().max(1e-12);
            let seen = |p: Vec2| {
                let way = p - start;
                Vec2::new(way.dot(&heading), heading.x * way.y - heading.y * way.x)
            };
            let landmarks = std::array::from_fn(|n| seen(at((n + 1) as f64 / SPANS as f64)));
            let shape = Shape { landmarks, duration: self.gait.duration() * each / usual };
            let step = PlacedStep::new(foot, start, heading, shape);
            chain.push((step, Stance { last: Some((foot, shape)), ..walker.stance }));
            foot = foot.other();
            debug_assert!(end_of(&shape).norm() <= each * (1.0 + 1e-9), "a chord is no longer than its path");
        }
        Some(chain)
    }
}
