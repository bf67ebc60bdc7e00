//! One shortest path (A*, Hart, Nilsson, Raphael 1968). The ends are joined to all vertices they see; a line to an end is
//! tested only when the search comes to it (Bohlin and Kavraki 2000).

use super::free::FreeSpace;
use super::graph::Roadmap;
use crate::base::frontier::Frontier;
use crate::base::geometry::Vec2;

/// Before a vertex that is reached from the start.
const START: u32 = u32::MAX;

/// The shortest path between two places, both included; straight where the line is free, `None` if there is none.
pub fn shortest(roadmap: &Roadmap, free: &FreeSpace, from: Vec2, to: Vec2) -> Option<Vec<Vec2>> {
    if free.is_clear(from, to) {
        return Some(vec![from, to]);
    }
    let vertices = roadmap.vertices();
    // Of settled vertices, the vertex before.
    let mut before: Vec<Option<u32>> = vec![None; vertices.len()];
    // Whole lengths; of each its vertex, the one before, and the length up to it in bits, which have the same order.
    let mut queue: Frontier<(u32, u32, u64)> = (0_u32..)
        .zip(vertices)
        .map(|(k, p)| ((p - from).norm(), (to - p).norm(), k))
        .map(|(length, rest, k)| (length + rest, (k, START, length.to_bits())))
        .collect();
    while let Some((_, (at, previous, length))) = queue.pop() {
        let place = vertices[at as usize];
        if before[at as usize].is_some() || (previous == START && !free.is_clear(from, place)) {
            continue;
        }
        before[at as usize] = Some(previous);
        // The estimate of the rest is the straight line: no other path can be shorter.
        if free.is_clear(place, to) {
            let step = |k: &u32| before.get(*k as usize).copied().flatten();
            let back = std::iter::successors(Some(at), step).take_while(|k| *k != START);
            let mut path: Vec<Vec2> = back.map(|k| vertices[k as usize]).collect();
            path.reverse();
            return Some([vec![from], path, vec![to]].concat());
        }
        for &(next, edge) in roadmap.neighbours(at) {
            if before[next as usize].is_none() {
                let length = f64::from_bits(length) + edge;
                let estimate = length + (to - vertices[next as usize]).norm();
                queue.push(estimate, (next, at, length.to_bits()));
            }
        }
    }
    None
}
