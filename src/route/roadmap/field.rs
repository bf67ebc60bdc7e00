//! Lengths of the shortest paths from all vertices of a roadmap to one goal (Dijkstra 1959), and the path from any place.

use super::free::FreeSpace;
use super::graph::Roadmap;
use crate::base::frontier::Frontier;
use crate::base::geometry::Vec2;

/// The way to a goal from the vertices of a roadmap.
#[derive(Clone, Debug, PartialEq)]
pub struct DistanceField {
    goal: Vec2,
    /// Length of the shortest path from each vertex, m; infinite where there is none.
    lengths: Vec<f64>,
    /// The next vertex on it; `None` where it goes straight for the goal.
    next: Vec<Option<u32>>,
    sees_goal: Vec<bool>,
}

impl DistanceField {
    /// The field of a goal. The goal is joined to all vertices that it sees.
    pub fn new(roadmap: &Roadmap, free: &FreeSpace, goal: Vec2) -> Self {
        let vertices = roadmap.vertices();
        let sees_goal: Vec<bool> = vertices.iter().map(|p| free.is_clear(*p, goal)).collect();
        let straight = |(p, sees): (&Vec2, &bool)| if *sees { (goal - p).norm() } else { f64::INFINITY };
        let mut lengths: Vec<f64> = vertices.iter().zip(&sees_goal).map(straight).collect();
        let mut next = vec![None; vertices.len()];
        let finite = (0_u32..).zip(&lengths).filter(|(_, length)| length.is_finite());
        let mut queue: Frontier<u32> = finite.map(|(k, length)| (*length, k)).collect();
        while let Some((length, at)) = queue.pop() {
            if length > lengths[at as usize] {
                continue;
            }
            for &(other, edge) in roadmap.neighbours(at) {
                if length + edge < lengths[other as usize] {
                    lengths[other as usize] = length + edge;
                    next[other as usize] = Some(at);
                    queue.push(length + edge, other);
                }
            }
        }
        Self { goal, lengths, next, sees_goal }
    }

    /// The goal, m.
    pub fn goal(&self) -> Vec2 {
        self.goal
    }

    /// Length of the shortest path from a vertex, m; infinite where there is none.
    pub fn length(&self, vertex: u32) -> f64 {
        self.lengths.get(vertex as usize).copied().unwrap_or(f64::INFINITY)
    }

    /// Whether a vertex is joined to the goal.
    pub(super) fn sees_goal(&self, vertex: u32) -> bool {
        self.sees_goal.get(vertex as usize).copied().unwrap_or_default()
    }

    /// The shortest path from a place, which is joined to all vertices that it sees: straight where the line is free, both
    /// ends included; `None` if there is none. `roadmap` and `free` are those of the field.
    pub fn path(&self, roadmap: &Roadmap, free: &FreeSpace, from: Vec2) -> Option<Vec<Vec2>> {
        if free.is_clear(from, self.goal) {
            return Some(vec![from, self.goal]);
        }
        // In the order of length over each vertex, the first that can be seen.
        let candidates = (0_u32..).zip(roadmap.vertices().iter().zip(&self.lengths));
        let mut queue: Frontier<u32> = candidates
            .filter(|(_, (_, length))| length.is_finite())
            .map(|(k, (p, length))| ((p - from).norm() + length, k))
            .collect();
        let place = |k: u32| roadmap.vertices().get(k as usize).copied();
        let mut nearest = std::iter::from_fn(|| queue.pop());
        let (_, first) = nearest.find(|(_, k)| place(*k).is_some_and(|p| free.is_clear(from, p)))?;
        let onward = |k: &u32| self.next.get(*k as usize).copied().flatten();
        let middle = std::iter::successors(Some(first), onward).filter_map(place);
        Some(std::iter::once(from).chain(middle).chain([self.goal]).collect())
    }
}
