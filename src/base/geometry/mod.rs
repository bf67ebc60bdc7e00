//! Geometry of the plane, in metres.

mod clearing;
pub mod convex;
mod nearby;
pub mod polygon;
pub mod segment;
pub mod shape;

pub use clearing::clearing;
pub use nearby::{Nearby, amply_around};
pub use polygon::{HoleFault, Polygon, meeting_edges};
pub use segment::Segment;
pub use shape::{Bounds, Shape};

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

// Which of many segments come near each other: only those whose stretches of one axis overlap are compared, in the order
// of their left ends.

/// A coordinate of a point.
type Coordinate = fn(&Vec2) -> f64;

/// Two of some segments, by their numbers, that are a pair, if any are. `is_pair` is asked of segments whose bounding
/// boxes have a point in common.
pub fn sweep(segments: &[Segment], mut is_pair: impl FnMut(usize, usize) -> bool) -> Option<(usize, usize)> {
    let corners = || segments.iter().flat_map(|s| [s.a, s.b]);
    // Along the axis on which the segments, all in all, reach less far.
    let reach = |of: Coordinate| {
        let (low, high) =
            corners().map(|p| of(&p)).fold((f64::MAX, f64::MIN), |(l, h), x| (l.min(x), h.max(x)));
        segments.iter().map(|s| (of(&s.a) - of(&s.b)).abs()).sum::<f64>() / (high - low)
    };
    let (along, beside): (Coordinate, Coordinate) =
        if reach(|p| p.x) <= reach(|p| p.y) { (|p| p.x, |p| p.y) } else { (|p| p.y, |p| p.x) };
    let ends = |s: &Segment, of: Coordinate| (of(&s.a).min(of(&s.b)), of(&s.a).max(of(&s.b)));
    let mut order: Vec<usize> = (0..segments.len()).collect();
    order.sort_by(|&i, &j| ends(&segments[i], along).0.total_cmp(&ends(&segments[j], along).0));
    for (k, &i) in order.iter().enumerate() {
        let ((_, right), (low, high)) = (ends(&segments[i], along), ends(&segments[i], beside));
        for &j in &order[k + 1..] {
            if ends(&segments[j], along).0 > right {
                break;
            }
            let (other_low, other_high) = ends(&segments[j], beside);
            if low <= other_high && other_low <= high && is_pair(i, j) {
                return Some((i, j));
            }
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn whoever_meets_is_found(ends in prop::collection::vec((0_i8..9, 0_i8..9, 0_i8..9, 0_i8..9), 0..12)) {
            let at = |x: i8, y: i8| Vec2::new(f64::from(x), f64::from(y));
            let segments: Vec<Segment> =
                ends.iter().map(|&(a, b, c, d)| Segment::new(at(a, b), at(c, d))).collect();
            let found = sweep(&segments, |i, j| segments[i].meets(&segments[j]));
            let any = (0..segments.len()).any(|i| (0..i).any(|j| segments[i].meets(&segments[j])));
            prop_assert_eq!(found.is_some(), any);
            if let Some((i, j)) = found {
                prop_assert!(i != j && segments[i].meets(&segments[j]));
            }
        }
    }
}
