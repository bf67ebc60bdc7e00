//! A* on the cells of a grid with the octile distance (Hart, Nilsson, Raphael 1968): the planner that walks of steps are
//! compared with.

use super::clearance::ClearanceGrid;
use crate::base::geometry::Vec2;
use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::f64::consts::SQRT_2;

/// Lengths of steps in units of 1e-4 of a side: whole numbers, so that the queue compares one.
const STRAIGHT: u32 = 10_000;
const DIAGONAL: u32 = (1e4 * SQRT_2) as u32;

/// The centers of the cells of a shortest path between the cells of two places, by steps to the eight cells around; `None` if
/// there is none.
pub fn shortest_cells(grid: &ClearanceGrid, from: Vec2, to: Vec2) -> Option<Vec<Vec2>> {
    let (first, last, columns) = (grid.cell(from), grid.cell(to), grid.columns() as u32);
    if !grid.is_free(first) || !grid.is_free(last) {
        return None;
    }
    let heuristic = |k: u32| {
        let (dx, dy) = ((k % columns).abs_diff(last % columns), (k / columns).abs_diff(last / columns));
        STRAIGHT * (dx.max(dy) - dx.min(dy)) + DIAGONAL * dx.min(dy)
    };
    let mut lengths = vec![u32::MAX; columns as usize * grid.rows()];
    let mut before = vec![first; lengths.len()];
    // Of equally good cells the one with the smaller remainder comes first.
    let entry = |length: u32, k: u32| {
        let left = heuristic(k);
        Reverse((u64::from(length + left) << 32 | u64::from(left), k, length))
    };
    lengths[first as usize] = 0;
    let mut queue = BinaryHeap::from([entry(0, first)]);
    while let Some(Reverse((_, at, length))) = queue.pop() {
        if at == last {
            let onward = |k: &u32| (*k != first).then(|| before[*k as usize]);
            let mut path: Vec<Vec2> =
                std::iter::successors(Some(at), onward).map(|k| grid.center(k)).collect();
            path.reverse();
            return Some(path);
        }
        if length > lengths[at as usize] {
            continue;
        }
        for other in grid.around(at).filter(|k| grid.is_free(*k)) {
            let is_straight = other % columns == at % columns || other / columns == at / columns;
            let length = length + if is_straight { STRAIGHT } else { DIAGONAL };
            if length < lengths[other as usize] {
                lengths[other as usize] = length;
                before[other as usize] = at;
                queue.push(entry(length, other));
            }
        }
    }
    None
}

#[cfg(test)]
mod tests {
    #![allow(
        clippy::disallowed_methods,
        clippy::print_stdout,
        reason = "tests may use the platform's functions"
    )]

    use super::*;
    use crate::base::geometry::{Bounds, Shape};
    use crate::base::math;
    use crate::base::random::{Purpose, Stream, TrialKey};
    use crate::model::{Barrier, Obstacle, Scene};
    use crate::route::roadmap::FreeSpace;

    #[test]
    fn a_path_is_as_short_as_sweeps_over_all_cells_find() {
        let area = Shape::rectangle(Vec2::new(1.0, 0.0), Vec2::new(1.6, 2.4));
        let barriers = vec![Barrier { name: String::new(), obstacle: Obstacle::Solid(area) }];
        let free = FreeSpace::new(&Scene { barriers, ..Scene::default() }, 0.25);
        let bounds = Bounds { low: Vec2::zeros(), high: Vec2::new(3.2, 3.2) };
        let grid = ClearanceGrid::new(&free, &bounds, 0.08);
        let (from, to) = (Vec2::new(0.3, 0.4), Vec2::new(2.9, 0.3));
        let path = shortest_cells(&grid, from, to).unwrap();
        let length: f64 = path.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum();
        assert!(path.iter().all(|p| grid.is_free(grid.cell(*p))));
        assert!(path.windows(2).all(|pair| (pair[1] - pair[0]).norm() < 1.5 * grid.side()));
        // Bellman and Ford.
        let count = (grid.columns() * grid.rows()) as u32;
        let mut lengths = vec![f64::INFINITY; count as usize];
        lengths[grid.cell(to) as usize] = 0.0;
        for _ in 0..count {
            let before = lengths.clone();
            for k in (0..count).filter(|k| grid.is_free(*k)) {
                for other in grid.around(k).filter(|k| grid.is_free(*k)) {
                    let step = (grid.center(k) - grid.center(other)).norm();
                    lengths[k as usize] = lengths[k as usize].min(lengths[other as usize] + step);
                }
            }
            if before == lengths {
                break;
            }
        }
        assert!((length - lengths[grid.cell(from) as usize]).abs() < 1e-3);
        assert!(shortest_cells(&grid, from, Vec2::new(1.3, 1.0)).is_none());
    }

    /// The column of plain grid paths in the table of docs/gait.md, with the distances and radii of models/table1.scn.
    #[test]
    fn grid_paths_between_discs_vary_as_their_ends_do() {
        let free = FreeSpace::new(&Scene::default(), 0.25);
        let bounds = Bounds { low: Vec2::repeat(-2.0), high: Vec2::new(6.0, 2.0) };
        let grid = ClearanceGrid::new(&free, &bounds, 0.08);
        for (distance, radius) in [(2.3, 0.205), (2.2, 0.355), (3.0, 0.37), (2.35, 0.33), (1.0, 0.21)] {
            let length = |trial: u64| {
                let key = TrialKey { seed: 0, index: trial, branch: 0 };
                let stream = Stream::of(key, 0, Purpose::Placement);
                let in_disc = |k: u32| {
                    let [u, v] = stream.uniform_pair(k);
                    let (sin, cos) = math::sin_cos(v * std::f64::consts::TAU);
                    Vec2::new(cos, sin) * (radius * u.sqrt())
                };
                let path = shortest_cells(&grid, in_disc(0), in_disc(1) + Vec2::new(distance, 0.0)).unwrap();
                path.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum::<f64>()
            };
            let mut lengths: Vec<f64> = (0..400).map(length).collect();
            lengths.sort_by(f64::total_cmp);
            let quantile = |q| crate::stats::twosample::quantile(&lengths, q);
            let (median, iqr) = (quantile(0.5), quantile(0.75) - quantile(0.25));
            println!("{distance} m, radius {radius} m: {median:.2}/{iqr:.2}");
            assert!(median > distance - 0.03 && median < distance + 0.15, "{distance}: {median}");
            assert!(iqr > 0.6 * radius && iqr < 1.2 * radius, "{distance}: {iqr}");
        }
    }
}
