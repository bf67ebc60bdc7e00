//! Where the center of a body can be: places and straight lines that keep a distance from all barriers.

use super::rays::Rays;
use crate::base::geometry::{Bounds, Nearby, Segment, Shape, Vec2, cross};
use crate::model::sight::ROUNDING;
use crate::model::{Obstacle, Piece, Scene, Sight};

/// The least distance from barriers, m. A line that only touches a wall is not free, even for a point.
const LEAST: f64 = 1e-6;

/// The free space of a scene for bodies of one radius.
#[derive(Clone, Debug)]
pub struct FreeSpace {
    sight: Sight,
    /// Solid obstacles and their bounds.
    solids: Vec<(Bounds, Shape)>,
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
        // An island of a scene with levels has regions without parts.
        let regions = scene.regions.iter().flat_map(|region| region.shape.parts()).map(Shape::bounds);
        corners.extend(regions.chain(boxes.iter().copied()).flat_map(|b| [b.low, b.high]));
        let origin = Bounds { low: Vec2::zeros(), high: Vec2::zeros() };
        let sight = Sight::new(scene);
        Self {
            rays: Rays::new(sight.pieces(), &solids, Rays::DIRECTION),
            bounds: Bounds::around(corners).unwrap_or(origin),
            nearby: Nearby::new(&boxes),
            reach: clearance_total.max(LEAST),
            solids: boxes.into_iter().zip(solids).collect(),
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
        let is_inside = |k: &u32| {
            let (bounds, solid) = &self.solids[*k as usize];
            contains(bounds, p) && solid.contains(p)
        };
        !is_near && !self.nearby.within(p, 0.0).iter().any(is_inside)
    }

    /// Whether a place is free and inside the bounds.
    pub(super) fn is_vertex(&self, p: Vec2) -> bool {
        contains(&self.bounds, p) && self.is_free(p)
    }

    /// Whether a body can go straight from one place to another. Between free places this is exact: no point of the line is
    /// nearer to a barrier than the distance to keep. An end that is nearer itself sets the distance that the line keeps.
    pub fn is_clear(&self, from: Vec2, to: Vec2) -> bool {
        let line = Segment::new(from, to);
        // The exact test is slow; most lines are far from all surfaces.
        !self.sight.any_along(&line, self.reach, |piece| may_be_near(piece, &line, self.reach))
            || self.sight.is_clear(from, to, self.reach)
    }

    /// The place in the bounds at two shares of its sides.
    pub(super) fn place(&self, [x, y]: [f64; 2]) -> Vec2 {
        let Bounds { low, high } = self.bounds;
        low + (high - low).component_mul(&Vec2::new(x, y))
    }
}

fn contains(bounds: &Bounds, p: Vec2) -> bool {
    let Bounds { low, high } = bounds;
    low.x <= p.x && p.x <= high.x && low.y <= p.y && p.y <= high.y
}

/// False only if the piece is farther than `reach` from the line.
fn may_be_near(piece: &Piece, line: &Segment, reach: f64) -> bool {
    let Piece::Edge(edge) = piece else { return piece.distance_to(line) <= reach };
    let gap = (line.a.inf(&line.b) - edge.a.sup(&edge.b)).sup(&(edge.a.inf(&edge.b) - line.a.sup(&line.b)));
    let along = edge.b - edge.a;
    let (a, b) = (cross(along, line.a - edge.a), cross(along, line.b - edge.a));
    let is_beside = (a > 0.0) == (b > 0.0) && a.abs().min(b.abs()) > along.norm() * reach;
    gap.max() <= reach && !is_beside
}
