//! What a plan is for: the goals of the route up to the next pause, each with the point that a walker has drawn in it. In a scene
//! with levels, it is the goals on one island, or the line of the stairs that lead to the first one.

use crate::base::geometry::Vec2;
use crate::base::random::Stream;
use crate::model::{Goal, Leg, Scene};
use crate::route::roadmap::FreeSpace;

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
    /// How many of the legs lie there.
    pub legs: usize,
    /// The line of stairs that the way leads across, as a place on it and one behind it, m.
    pub over: Option<[Vec2; 2]>,
}

impl Errand {
    /// The goals at the beginning of some legs, for a body of a radius, m. The same legs have the same points in all plans of a
    /// person in a trial: the draws are addressed by how many legs are left.
    pub fn new(floor: &Floor<'_>, free: &FreeSpace, legs: &[Leg], radius: f64, stream: Stream) -> Self {
        if let Some([line, beyond]) = floor.over {
            return Self { points: vec![line], beyond: Some(beyond) };
        }
        let goals = legs.iter().take(floor.legs);
        let goals = goals.map_while(|leg| if let Leg::To(goal) = leg { Some(goal) } else { None });
        let left = |k: usize| GOALS | ((legs.len() - k) as u32) << 8;
        let point = |(k, goal): (usize, &Goal)| {
            point_in(floor.scene, |p| free.is_free(p), goal, radius, |n| stream.uniform_pair(left(k) + n))
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

/// A free point of a goal, a radius inside if there is room; of a region without one its middle.
pub fn point_in(
    scene: &Scene,
    is_free: impl Fn(Vec2) -> bool,
    goal: &Goal,
    radius: f64,
    draw: impl Fn(u32) -> [f64; 2],
) -> Vec2 {
    let shape = match goal {
        Goal::Point(point) => return *point,
        Goal::Region(id) => match scene.regions.get(id.0 as usize) {
            Some(region) => &region.shape,
            None => return Vec2::zeros(),
        },
    };
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
