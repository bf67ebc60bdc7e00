//! What a plan is for: the goals of the route up to the next pause, each with the point that a walker has drawn in it.

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
}

impl Errand {
    /// The goals at the beginning of some legs, for a body of a radius, m. The same legs have the same points in all plans of a
    /// person in a trial: the draws are addressed by how many legs are left.
    pub fn new(scene: &Scene, free: &FreeSpace, legs: &[Leg], radius: f64, stream: Stream) -> Self {
        let goals = legs.iter().map_while(|leg| if let Leg::To(goal) = leg { Some(goal) } else { None });
        let left = |k: usize| GOALS | ((legs.len() - k) as u32) << 8;
        let point = |(k, goal): (usize, &Goal)| {
            point_in(scene, |p| free.is_free(p), goal, radius, |n| stream.uniform_pair(left(k) + n))
        };
        Self { points: goals.enumerate().map(point).collect() }
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
