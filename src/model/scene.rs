//! The scene: what stands still.

use crate::base::geometry::{Segment, Shape, Vec2};

/// Index of a region of the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct RegionId(pub u32);

/// Index of a barrier of the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct BarrierId(pub u32);

/// What stands still.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scene {
    /// Walls and obstacles.
    pub barriers: Vec<Barrier>,
    /// Regions, which hinder nobody.
    pub regions: Vec<Region>,
    /// Named points, m.
    pub points: Vec<(String, Vec2)>,
}

/// A wall or an obstacle.
#[derive(Clone, Debug, PartialEq)]
pub struct Barrier {
    /// Its name, or what an import calls it; may be empty.
    pub name: String,
    /// What it is.
    pub obstacle: Obstacle,
}

/// The form of a barrier.
#[derive(Clone, Debug, PartialEq)]
pub enum Obstacle {
    /// Segments, passable on neither side, without an inside.
    Wall(Vec<Segment>),
    /// A solid disc or polygon; in the holes of a polygon one can stand.
    Solid(Shape),
}

/// A named part of the plane.
#[derive(Clone, Debug, PartialEq)]
pub struct Region {
    /// Its name.
    pub name: String,
    /// Its extent.
    pub shape: Shape,
}

impl Obstacle {
    /// Distance from `p` to the barrier's surface; negative inside a solid.
    pub fn distance(&self, p: Vec2) -> f64 {
        match self {
            Self::Wall(segments) => segments.iter().map(|s| s.distance(p)).fold(f64::INFINITY, f64::min),
            Self::Solid(Shape::Circle { centre, radius }) => (p - centre).norm() - radius,
            Self::Solid(Shape::Polygon(polygon)) => {
                let distance = (p - polygon.nearest_on_outline(p)).norm();
                if polygon.contains(p) { -distance } else { distance }
            }
        }
    }
}
