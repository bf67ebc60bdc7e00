//! Where the center of a body can be: places and straight lines that keep a distance from all barriers.

use super::rays::Rays;
use crate::base::geometry::{Bounds, Nearby, Segment, Shape, Vec2};
use crate::model::sight::ROUNDING;
use crate::model::{Obstacle, Scene, Sight};

/// The least distance from barriers, m. A line that only touches a wall is not free, even for a point.
const LEAST: f64 = 1e-6;

/// The free space of a scene for bodies of one radius.
#[derive(Clone, Debug)]
pub struct FreeSpace {
    sight: Sight,
    solids: Vec<Shape>,
    /// Over the bounds of the solids.
    nearby: Nearby,
    rays: Rays,
    bounds: Bounds,
    reach: f64,
}

impl FreeSpace {
    /// The places at least `clearance_total` (radius of the body and clearance, m) from all barriers and outside of solid
    /// obstacles. Its bounds are those of all barriers, regions and points.
    pub fn new(scene: &Scene, clearance_total: f64) -> Self {
        let mut corners: Vec<Vec2> = scene.points.iter().map(|(_, p)| *p).collect();
        let mut solids = Vec::new();
        for barrier in &scene.barriers {
            match &barrier.obstacle {
                Obstacle::Wall(segments) => corners.extend(segments.iter().flat_map(|s| [s.a, s.b])),
                Obstacle::Solid(shape) => solids.push(shape.clone()),
            }
        }
        let boxes: Vec<Bounds> = solids.iter().map(Shape::bounds).collect();
        let regions = scene.regions.iter().map(|region| region.shape.bounds());
        corners.extend(regions.chain(boxes.iter().copied()).flat_map(|b| [b.low, b.high]));
        let origin = Bounds { low: Vec2::zeros(), high: Vec2::zeros() };
        let sight = Sight::new(scene);
        Self {
            rays: Rays::new(sight.pieces(), &solids, Rays::DIRECTION),
            bounds: Bounds::around(corners).unwrap_or(origin),
            nearby: Nearby::new(&boxes),
            reach: clearance_total.max(LEAST),
            solids,
            sight,
        }
    }

    /// The rectangle in which vertices are drawn.
    pub fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// The rays that tell on which side a path passes each obstacle.
    pub fn rays(&self) -> &Rays {
        &self.rays
    }

    /// The surfaces of the barriers.
    pub fn sight(&self) -> &Sight {
        &self.sight
    }

    /// Distance that is kept from barriers, m.
    pub fn reach(&self) -> f64 {
        self.reach
    }

    /// Whether the center of a body can be at a place.
    pub fn is_free(&self, p: Vec2) -> bool {
        let place = Segment::new(p, p);
        let is_near =
            self.sight.any_along(&place, self.reach, |piece| piece.distance(p) < self.reach - ROUNDING);
        !is_near && !self.nearby.within(p, 0.0).iter().any(|&k| self.solids[k as usize].contains(p))
    }

    /// Whether a place is free and inside the bounds.
    pub(super) fn is_vertex(&self, p: Vec2) -> bool {
        let Bounds { low, high } = self.bounds;
        let is_inside = low.x <= p.x && p.x <= high.x && low.y <= p.y && p.y <= high.y;
        is_inside && self.is_free(p)
    }

    /// Whether a body can go straight from one place to another. Between free places this is exact: no point of the line is
    /// nearer to a barrier than the distance to keep. An end that is nearer itself sets the distance that the line keeps.
    pub fn is_clear(&self, from: Vec2, to: Vec2) -> bool {
        self.sight.is_clear(from, to, self.reach)
    }

    /// The place in the bounds at two shares of its sides.
    pub(super) fn place(&self, [x, y]: [f64; 2]) -> Vec2 {
        let Bounds { low, high } = self.bounds;
        low + (high - low).component_mul(&Vec2::new(x, y))
    }
}
