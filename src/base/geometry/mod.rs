//! Geometry of the plane, in metres.

mod clearing;
pub mod convex;
mod nearby;
pub mod polygon;
pub mod segment;
pub mod shape;
mod sweep;

pub use clearing::clearing;
pub use nearby::{Nearby, amply_around};
pub use polygon::meeting_edges;
pub use polygon::{HoleFault, Polygon};
pub use segment::Segment;
pub use shape::{Bounds, Shape};
pub use sweep::sweep;

/// A point or vector of the plane.
pub type Vec2 = nalgebra::Vector2<f64>;

/// Largest coordinate of a scene, m. A step of a person is about 0.01 m and its rounding here 1e-10 m; much farther
/// from the origin, rounding would swallow the step.
pub const FARTHEST: f64 = 1e6;

/// The error of the coordinates of a point; `None` if they are valid.
pub fn coordinate_fault(p: Vec2) -> Option<String> {
    let far = [p.x, p.y].into_iter().find(|coordinate| coordinate.abs() > FARTHEST || coordinate.is_nan())?;
    Some(format!("a coordinate must lie between -1e6 m and 1e6 m (got {far:e} m)"))
}

/// The vector turned by `angle` radians to the left.
pub fn rotated(v: Vec2, angle: f64) -> Vec2 {
    let (sin, cos) = super::math::sin_cos(angle);
    Vec2::new(cos * v.x - sin * v.y, sin * v.x + cos * v.y)
}

/// The z component of the cross product.
pub fn cross(a: Vec2, b: Vec2) -> f64 {
    a.x * b.y - a.y * b.x
}
