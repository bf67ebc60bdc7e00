//! What a plan is for: the goals of the route up to the next pause, each with the point that a walker has drawn in it. In a scene
//! with levels, it is the goals on one island, or the line of the stairs that lead to the first one.

use super::terrain::{Terrain, exits, middle};
use crate::base::geometry::{Shape, Vec2};
use crate::base::random::Stream;
use crate::model::{Goal, Leg, Scene, Storeys};
use crate::route::roadmap::shortest;

/// Most points that are drawn in a region until one is free.
const TRIES: u32 = 200;
/// Numbers of the draws of goals; those of plans lie below.
const GOALS: u32 = 1 << 31;

/// The goals of a plan.
#[derive(Clone, Debug, PartialEq)]
pub struct Errand {
    /// A point of each, m; a plan ends at rest at the last one.
    pub points: Vec<Vec2>,
    /// A place behind a line of stairs at which the plan would end, m.
    pub beyond: Option<Vec2>,
}

/// Where an errand is done: the whole scene, or one island of a scene with levels.
#[derive(Clone, Copy, Debug)]
pub struct Floor<'a> {
    /// Its scene.
    pub scene: &'a Scene,
    /// Its number; 0 without levels.
    pub island: usize,
    /// The levels of the whole scene.
    pub storeys: &'a Storeys,
    /// How many of the legs lie there.
    pub legs: usize,
    /// The line of stairs that the way leads across, as a place on it and one behind it, m.
    pub over: Option<[Vec2; 2]>,
}

impl Errand {
    /// The goals at the beginning of some legs, for a body of a radius, m, on its way from a place, m. The same legs have the same
    /// points in all plans of a person in a trial: the draws are addressed by how many legs are left. Of several exits it is the one
    /// to which the shortest path leads, of equal ones the first.
    pub fn new(
        floor: &Floor<'_>,
        terrain: &Terrain,
        legs: &[Leg],
        (from, radius): (Vec2, f64),
        stream: Stream,
    ) -> Self {
        if let Some([line, beyond]) = floor.over {
            return Self { points: vec![line], beyond: Some(beyond) };
        }
        let goals = legs.iter().take(floor.legs);
        let goals = goals.map_while(|leg| if let Leg::To(goal) = leg { Some(goal) } else { None });
        let left = |k: usize| GOALS | ((legs.len() - k) as u32) << 8;
        let is_here = |part: &&Shape| floor.storeys.island_at(part.inner_point()) == floor.island;
        let length = |from: Vec2, to: Vec2| {
            let path = shortest(&terrain.roadmap, &terrain.free, from, to)?;
            Some(path.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum::<f64>())
        };
        let mut before = from;
        let point = |(k, goal): (usize, &Goal)| {
            let draw = |n| stream.uniform_pair(left(k) + n);
            let inside = |part: &Shape| point_in(part, |p| terrain.free.is_free(p), radius, draw);
            before = match exits(floor.scene, goal) {
                [] => middle(floor.scene, goal),
                [one] => inside(one),
                all => {
                    let ends: Vec<Vec2> = all.iter().filter(is_here).map(inside).collect();
                    let ways = ends.iter().map(|end| length(before, *end));
                    ends.get(shortest_of(ways)).copied().unwrap_or_else(|| middle(floor.scene, goal))
                }
            };
            before
        };
        Self { points: goals.enumerate().map(point).collect(), beyond: None }
    }

    /// Where a plan ends, m.
    pub fn end(&self) -> Option<Vec2> {
        self.beyond.or(self.points.last().copied())
    }

    /// The points that a plan passes on its way.
    pub fn through(&self) -> &[Vec2] {
        let count = self.points.len() - usize::from(self.beyond.is_none() && !self.points.is_empty());
        &self.points[..count]
    }
}

/// Which of some ways is the shortest, m; of equal ones the first.
pub fn shortest_of(ways: impl Iterator<Item = Option<f64>>) -> usize {
    let ways = ways.map(|way| way.unwrap_or(f64::INFINITY)).enumerate();
    ways.min_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(k, _)| k)
}

/// A free point of a shape, a radius inside if there is room; of one without such a point its middle.
pub fn point_in(
    shape: &Shape,
    is_free: impl Fn(Vec2) -> bool,
    radius: f64,
    draw: impl Fn(u32) -> [f64; 2],
) -> Vec2 {
    let bounds = shape.bounds();
    let size = bounds.high - bounds.low;
    let is_inside = |p: Vec2| shape.depth(p) >= radius;
    let mut other = None;
    for n in 0..TRIES {
        let [x, y] = draw(n);
        let p = bounds.low + Vec2::new(size.x * x, size.y * y);
        if is_inside(p) && is_free(p) {
            return p;
        }
        other = other.or(Some(p).filter(|p| shape.contains(*p) && is_free(*p)));
    }
    other.unwrap_or_else(|| shape.inner_point())
}
