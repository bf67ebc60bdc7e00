//! Probabilistic roadmaps (Kavraki, Svestka, Latombe, Overmars 1996), with the bridge test for narrow passages (Hsu, Jiang,
//! Reif, Sun 2003).

use super::free::FreeSpace;
use super::nearest::VertexGrid;
use crate::base::geometry::Vec2;
use crate::base::math::sin_cos_turn;
use crate::base::random::Stream;

/// Tries per sample, on average. In the second half of the tries all samples are uniform: a scene may have no bridges.
const TRIES: u64 = 100;

/// Mean and standard deviation of the length of bridges, m.
const BRIDGE: (f64, f64) = (5.0, 1.0);

/// The first end of a bridge lies at most so far out of the bounds, m. With 1 m the coverage is that of the measurements
/// that the tests repeat; without a limit, more bridges lie in the corners of the bounds.
const BEYOND: f64 = 1.0;

/// How samples are spread.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SamplingRule {
    /// Uniformly over the free space.
    Uniform,
    /// Every second one is the free middle of a line between two places that are not free.
    Bridge,
}

/// A probabilistic roadmap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prm {
    /// How many vertices are wanted.
    pub samples: usize,
    /// How they are spread.
    pub sampling: SamplingRule,
    /// Least distance between vertices, m. It limits how many there can be.
    pub separation: f64,
    /// Each vertex is joined to so many of its nearest, where the edge is free.
    pub neighbours: usize,
}

impl Prm {
    /// The vertices, and pairs of them between which a line is free, the smaller number first; each pair once, sorted.
    pub(super) fn draw(&self, free: &FreeSpace, stream: Stream) -> (Vec<Vec2>, Vec<(u32, u32)>) {
        let mut grid = VertexGrid::new(free.bounds(), self.samples);
        let tries = (self.samples as u64 * TRIES).min(u64::from(u32::MAX / 3)) as u32;
        let least = self.separation * self.separation;
        let mut found = Vec::new();
        for number in 0..tries {
            let count = grid.places().len();
            if count >= self.samples {
                break;
            }
            let is_bridge =
                self.sampling == SamplingRule::Bridge && count.is_multiple_of(2) && number < tries / 2;
            let place = free.place(stream.uniform_pair(3 * number));
            if free.is_free(place)
                && (!is_bridge || is_middle(free, place, stream, 3 * number))
                && (least == 0.0 || grid.nearest(place, 1, &mut found).iter().all(|(far, _)| *far >= least))
            {
                grid.insert(place);
            }
        }
        let edges = self.edges(free, &grid);
        (grid.into_places(), edges)
    }

    fn edges(&self, free: &FreeSpace, grid: &VertexGrid) -> Vec<(u32, u32)> {
        let (mut edges, mut found) = (Vec::new(), Vec::new());
        for (a, p) in (0_u32..).zip(grid.places()) {
            let others = grid.nearest(*p, self.neighbours + 1, &mut found).iter().map(|(_, b)| *b);
            // A vertex at the same place may come before it.
            let others = others.filter(|b| *b != a).take(self.neighbours);
            edges.extend(others.map(|b| (a.min(b), a.max(b))));
        }
        edges.sort_unstable();
        edges.dedup();
        let place = |k: u32| grid.places().get(k as usize).copied().unwrap_or_default();
        edges.retain(|(a, b)| free.is_clear(place(*a), place(*b)));
        edges
    }
}

/// Whether neither end of a line of random length and direction with this middle is free and in the bounds.
fn is_middle(free: &FreeSpace, middle: Vec2, stream: Stream, draw: u32) -> bool {
    let [normal, _] = stream.normal_pair(draw + 1);
    let (sin, cos) = sin_cos_turn(stream.uniform(draw + 2));
    let half = Vec2::new(cos, sin) * (0.5 * (BRIDGE.0 + BRIDGE.1 * normal).abs());
    let (first, second) = (middle - half, middle + half);
    let out = free.bounds().low - first;
    let out = out.sup(&(first - free.bounds().high));
    out.max() <= BEYOND && !free.is_vertex(first) && !free.is_vertex(second)
}
