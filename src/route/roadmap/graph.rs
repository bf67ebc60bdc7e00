//! A roadmap as a graph: vertices, undirected edges and their lengths.

use super::free::FreeSpace;
use super::prm::Prm;
use super::rrt::Rrt;
use crate::base::geometry::Vec2;
use crate::base::random::Stream;

/// How a roadmap is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sampler {
    /// A probabilistic roadmap.
    Prm(Prm),
    /// A rapidly-exploring random tree.
    Rrt(Rrt),
}

/// Vertices and the free straight edges between some of them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Roadmap {
    vertices: Vec<Vec2>,
    edges: Vec<(u32, u32)>,
    /// Where the neighbours of each vertex begin, and one more at the end.
    first: Vec<u32>,
    neighbours: Vec<(u32, f64)>,
}

impl Roadmap {
    /// Draws a roadmap. The same stream gives the same roadmap. It has fewer vertices than wanted where a number of tries did
    /// not find as many; fewer than two are of no use.
    pub fn draw(free: &FreeSpace, sampler: &Sampler, stream: Stream) -> Self {
        let (vertices, edges) = match sampler {
            Sampler::Prm(prm) => prm.draw(free, stream),
            Sampler::Rrt(rrt) => rrt.draw(free, stream),
        };
        Self::new(vertices, edges)
    }

    /// With given edges, each a pair of different vertices; edges to vertices that do not exist are left out.
    pub(super) fn new(vertices: Vec<Vec2>, mut edges: Vec<(u32, u32)>) -> Self {
        edges.retain(|(a, b)| a.max(b) < &(vertices.len() as u32));
        let place = |k: u32| vertices[k as usize];
        let mut ends: Vec<(u32, u32)> = edges.iter().flat_map(|&(a, b)| [(a, b), (b, a)]).collect();
        ends.sort_unstable();
        let start = |vertex: usize| ends.partition_point(|(a, _)| (*a as usize) < vertex) as u32;
        let first = (0..=vertices.len()).map(start).collect();
        let neighbours = ends.iter().map(|&(a, b)| (b, (place(a) - place(b)).norm())).collect();
        Self { vertices, edges, first, neighbours }
    }

    /// The places of the vertices, m.
    pub fn vertices(&self) -> &[Vec2] {
        &self.vertices
    }

    /// The edges as pairs of vertices, each once, the smaller number first.
    pub fn edges(&self) -> &[(u32, u32)] {
        &self.edges
    }

    /// The neighbours of a vertex by number, ascending, and the lengths of the edges, m; none of a vertex that does not exist.
    pub fn neighbours(&self, vertex: u32) -> &[(u32, f64)] {
        let at = |k: usize| self.first.get(k).copied().map(|first| first as usize);
        let range = at(vertex as usize).zip(at(vertex as usize + 1)).map(|(from, to)| from..to);
        range.and_then(|range| self.neighbours.get(range)).unwrap_or_default()
    }
}
