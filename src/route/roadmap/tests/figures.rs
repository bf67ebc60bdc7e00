//! Figures of merit of roadmaps and paths: coverage, short edges and sharp corners (Li, Li, Ge 2019, Figures 9 and 10).

use super::super::Roadmap;
use super::super::rays::unite;
use crate::base::geometry::{Vec2, cross};

/// Area of the convex hull of places, m² (Andrew's monotone chain, 1979).
pub(super) fn hull_area(places: &[Vec2]) -> f64 {
    let mut sorted = places.to_vec();
    sorted.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    let chain = |places: &mut dyn Iterator<Item = Vec2>| {
        let mut hull: Vec<Vec2> = Vec::new();
        for p in places {
            while let [.., a, b] = hull[..]
                && cross(b - a, p - b) <= 0.0
            {
                hull.pop();
            }
            hull.push(p);
        }
        hull
    };
    let lower = chain(&mut sorted.iter().copied());
    let upper = chain(&mut sorted.iter().rev().copied());
    let area = |hull: &[Vec2]| hull.windows(2).map(|w| cross(w[0], w[1])).sum::<f64>();
    0.5 * (area(&lower) + area(&upper))
}

/// Edges of a roadmap by length.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct ShortEdges {
    /// Edges shorter than the limit.
    pub(super) shorter: usize,
    /// Edges not longer than the limit, up to rounding.
    pub(super) at_most: usize,
    /// Edges of the shortest spanning forest (Kruskal 1956) that are shorter than the limit.
    pub(super) forest: usize,
}

/// Counts the edges of a roadmap that are shorter than `limit`, m.
pub(super) fn short_edges(roadmap: &Roadmap, limit: f64) -> ShortEdges {
    let place = |k: u32| roadmap.vertices().get(k as usize).copied().unwrap_or_default();
    let edges = roadmap.edges().iter();
    let mut lengths: Vec<(f64, u32, u32)> =
        edges.map(|&(a, b)| ((place(a) - place(b)).norm(), a, b)).collect();
    lengths.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut sets: Vec<usize> = (0..roadmap.vertices().len()).collect();
    // A tree that steps by the limit has edges of that length, but for rounding.
    let slack = 1e-9 * limit;
    let mut count = ShortEdges { shorter: 0, at_most: 0, forest: 0 };
    for (length, a, b) in lengths {
        let is_shorter = length < limit - slack;
        count.shorter += usize::from(is_shorter);
        count.at_most += usize::from(length <= limit + slack);
        count.forest += usize::from(is_shorter && unite(&mut sets, a as usize, b as usize));
    }
    count
}

/// The largest radius, m, of an arc that rounds a corner and uses at most half of each edge:
/// min(La, Lb) / (2 tan(delta / 2)) with the turning angle delta. Infinite where the path goes straight on.
pub(super) fn largest_radius(before: Vec2, corner: Vec2, after: Vec2) -> f64 {
    let (first, second) = (corner - before, after - corner);
    let (a, b) = (first.norm(), second.norm());
    let turn = cross(first, second).abs();
    if turn == 0.0 && first.dot(&second) > 0.0 {
        return f64::INFINITY;
    }
    // tan(delta / 2) = sin(delta) / (1 + cos(delta)).
    0.5 * a.min(b) * ((a * b + first.dot(&second)) / turn).max(0.0)
}
