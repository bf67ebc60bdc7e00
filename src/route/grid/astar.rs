//! A* on the cells of a grid with the octile distance (Hart, Nilsson, Raphael 1968): the planner that walks of steps are
//! compared with.

use super::clearance::ClearanceGrid;
use crate::base::geometry::Vec2;
use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::f64::consts::SQRT_2;

/// The centers of the cells of a shortest path between the cells of two places, by steps to the eight cells around; `None` if
/// there is none.
pub fn shortest_cells(grid: &ClearanceGrid, from: Vec2, to: Vec2) -> Option<Vec<Vec2>> {
    let (first, last, columns) = (grid.cell(from), grid.cell(to), grid.columns() as u32);
    if !grid.is_free(first) || !grid.is_free(last) {
        return None;
    }
    // Lengths in units of 1e-4 of a side: whole numbers, so that the queue compares one.
    const STRAIGHT: u32 = 10_000;
    const DIAGONAL: u32 = (1e4 * SQRT_2) as u32;
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
