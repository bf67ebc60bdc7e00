//! Rapidly-exploring random trees (`LaValle` 1998), with a bias towards a target.

use super::free::FreeSpace;
use super::nearest::VertexGrid;
use crate::base::geometry::Vec2;
use crate::base::random::Stream;

/// Tries per sample, on average.
const TRIES: u64 = 100;

/// A rapidly-exploring random tree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rrt {
    /// Where the tree starts.
    pub root: Vec2,
    /// How many vertices are wanted, the root included.
    pub samples: usize,
    /// Greatest length of an edge, m.
    pub step: f64,
    /// Probability that the tree grows towards the target.
    pub bias: f64,
    /// The target, which need not be reachable.
    pub target: Option<Vec2>,
}

impl Rrt {
    /// The vertices, and pairs of them between which a line is free, the smaller number first, sorted.
    pub(super) fn draw(&self, free: &FreeSpace, stream: Stream) -> (Vec<Vec2>, Vec<(u32, u32)>) {
        let mut grid = VertexGrid::new(free.bounds(), self.samples);
        grid.insert(self.root);
        let (mut edges, mut found) = (Vec::new(), Vec::new());
        let tries = (self.samples as u64 * TRIES).min(u64::from(u32::MAX / 2)) as u32;
        for number in 0..tries {
            if grid.places().len() >= self.samples {
                break;
            }
            let target = self.target.filter(|_| stream.uniform(2 * number + 1) < self.bias);
            let sample = free.place(stream.uniform_pair(2 * number));
            let towards = target.unwrap_or(sample);
            let Some(&(square, nearest)) = grid.nearest(towards, 1, &mut found).first() else { break };
            let Some(&from) = grid.places().get(nearest as usize) else { break };
            let distance = square.sqrt();
            let share = if distance > self.step { self.step / distance } else { 1.0 };
            let to = from + (towards - from) * share;
            // A tree that has reached its target stays there.
            if distance > 0.0 && free.is_vertex(to) && free.is_clear(from, to) {
                edges.push((nearest, grid.places().len() as u32));
                grid.insert(to);
            }
        }
        edges.sort_unstable();
        (grid.into_places(), edges)
    }
}
