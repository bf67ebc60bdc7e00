//! Convex polygons: cut by lines, and what they share with a shape.

use super::{Polygon, Segment, Shape, Vec2, cross};
use crate::base::math;

/// The name of an edge that no numbered line has made.
pub const UNNAMED: u32 = u32::MAX;

/// A convex polygon, counterclockwise. Without corners it is empty.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Convex {
    /// Each corner, and the name of the edge that begins there.
    corners: Vec<(Vec2, u32)>,
    /// Room for a cut.
    room: Vec<(Vec2, u32)>,
}

impl Convex {
    /// A regular polygon around the origin, its first corner on the first axis.
    pub fn regular(sides: u32, radius: f64) -> Self {
        let turn = 2.0 * std::f64::consts::PI / f64::from(sides);
        let corner = |k: u32| {
            let (sin, cos) = math::sin_cos(turn * f64::from(k));
            (Vec2::new(radius * cos, radius * sin), UNNAMED)
        };
        Self { corners: (0..sides).map(corner).collect(), room: Vec::new() }
    }

    /// Becomes the same as another one.
    pub fn copy(&mut self, other: &Self) {
        self.corners.clone_from(&other.corners);
    }

    /// Keeps what lies where `normal * p <= limit`. The new edge gets this name. Whether anything was cut off.
    pub fn cut(&mut self, normal: Vec2, limit: f64, name: u32) -> bool {
        if self.corners.iter().all(|(p, _)| normal.dot(p) <= limit) {
            return false;
        }
        self.room.clear();
        for (k, &(a, edge)) in self.corners.iter().enumerate() {
            let b = self.corners[(k + 1) % self.corners.len()].0;
            let (beyond_a, beyond_b) = (normal.dot(&a) - limit, normal.dot(&b) - limit);
            if beyond_a <= 0.0 {
                self.room.push((a, edge));
            }
            if (beyond_a <= 0.0) != (beyond_b <= 0.0) {
                let at = a + (b - a) * (beyond_a / (beyond_a - beyond_b));
                self.room.push((at, if beyond_a <= 0.0 { name } else { edge }));
            }
        }
        std::mem::swap(&mut self.corners, &mut self.room);
        true
    }

    /// Its corners.
    pub fn corners(&self) -> impl ExactSizeIterator<Item = Vec2> + '_ {
        self.corners.iter().map(|(p, _)| *p)
    }

    /// Its edges with their names, counterclockwise.
    pub fn edges(&self) -> impl Iterator<Item = (Segment, u32)> + '_ {
        let next = self.corners.iter().cycle().skip(1);
        self.corners.iter().zip(next).map(|(&(a, name), &(b, _))| (Segment::new(a, b), name))
    }

    /// Its area.
    pub fn area(&self) -> f64 {
        0.5 * self.edges().map(|(edge, _)| cross(edge.a, edge.b)).sum::<f64>()
    }

    /// How far a point lies from the nearest edge, m; negative outside.
    pub fn depth(&self, p: Vec2) -> f64 {
        let depth = |edge: Segment| cross(edge.b - edge.a, p - edge.a) / edge.length();
        self.edges()
            .filter(|(edge, _)| edge.a != edge.b)
            .map(|(edge, _)| depth(edge))
            .fold(f64::INFINITY, f64::min)
    }

    /// The area that it shares with a shape whose coordinates count from `origin`.
    pub fn shared_area(&self, shape: &Shape, origin: Vec2) -> f64 {
        match shape {
            Shape::Circle { centre, radius } => {
                let from = origin - centre;
                self.edges().map(|(edge, _)| with_disc(edge.a + from, edge.b + from, *radius)).sum()
            }
            Shape::Polygon(Polygon { outline, holes }) => {
                let holes = holes.iter().map(|hole| self.with_ring(hole, origin)).sum::<f64>();
                self.with_ring(outline, origin) - holes
            }
            Shape::Parts(parts) => parts.iter().map(|part| self.shared_area(part, origin)).sum(),
        }
    }

    /// The area shared with the inside of a ring: the ring is cut by the lines of the edges (Sutherland and Hodgman 1974).
    /// Where that leaves several parts, edges between them lie twice on one line and cancel out.
    fn with_ring(&self, ring: &[Vec2], origin: Vec2) -> f64 {
        let mut rest =
            Self { corners: ring.iter().map(|p| (p - origin, UNNAMED)).collect(), room: Vec::new() };
        for (edge, _) in self.edges() {
            let along = edge.b - edge.a;
            let outward = Vec2::new(along.y, -along.x);
            rest.cut(outward, outward.dot(&edge.a), UNNAMED);
        }
        rest.area().abs()
    }
}

/// The signed area that the triangle of the origin, `a` and `b` shares with a disc around the origin.
fn with_disc(a: Vec2, b: Vec2, radius: f64) -> f64 {
    let sector = |p: Vec2, q: Vec2| 0.5 * radius * radius * math::atan2(cross(p, q), p.dot(&q));
    let along = b - a;
    let (square, half) = (along.dot(&along), a.dot(&along));
    let root = half * half - square * (a.dot(&a) - radius * radius);
    if root <= 0.0 {
        return sector(a, b);
    }
    // Where the line of the edge enters and leaves the disc.
    let (enters, leaves) = ((-half - root.sqrt()) / square, (-half + root.sqrt()) / square);
    if enters >= 1.0 || leaves <= 0.0 {
        return sector(a, b);
    }
    let (p, q) = (a + along * enters.max(0.0), a + along * leaves.min(1.0));
    let before = if enters > 0.0 { sector(a, p) } else { 0.0 };
    let after = if leaves < 1.0 { sector(q, b) } else { 0.0 };
    before + 0.5 * cross(p, q) + after
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    fn square(side: f64) -> Convex {
        let mut out = Convex::regular(4, 100.0);
        for (x, y) in [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)] {
            out.cut(Vec2::new(x, y), 0.5 * side, UNNAMED);
        }
        out
    }

    #[test]
    fn areas_of_cut_polygons() {
        assert!((Convex::regular(12, 1.0).area() - 3.0).abs() < 1e-14);
        let mut half = square(2.0);
        assert!((half.area() - 4.0).abs() < 1e-12);
        assert!(half.cut(Vec2::new(1.0, 1.0), 0.0, 7));
        assert!((half.area() - 2.0).abs() < 1e-12);
        assert_eq!(half.edges().filter(|(_, name)| *name == 7).count(), 1);
        assert!(half.cut(Vec2::new(1.0, 1.0), -9.0, 8));
        assert_eq!((half.area(), half.corners().len()), (0.0, 0));
    }

    #[test]
    fn areas_shared_with_shapes() {
        let origin = Vec2::new(10.0, -3.0);
        let disc = |radius| Shape::Circle { centre: origin, radius };
        assert!((square(2.0).shared_area(&disc(0.5), origin) - 0.25 * PI).abs() < 1e-12);
        assert!((square(2.0).shared_area(&disc(9.0), origin) - 4.0).abs() < 1e-12);
        // A disc through the middles of the edges of a square, less its quarter beyond one corner.
        let moved = Shape::Circle { centre: origin + Vec2::new(1.0, 1.0), radius: 1.0 };
        assert!((square(2.0).shared_area(&moved, origin) - 0.25 * PI).abs() < 1e-12);
        // A frame: an outline with a hole, the square in the middle of both; and a horseshoe of which it sees two ends.
        let ring = |half: f64| {
            let corners = [(-half, -half), (half, -half), (half, half), (-half, half)];
            corners.map(|(x, y)| origin + Vec2::new(x, y)).to_vec()
        };
        let frame = Shape::Polygon(Polygon { outline: ring(5.0), holes: vec![ring(0.5)] });
        assert!((square(2.0).shared_area(&frame, origin) - 3.0).abs() < 1e-12);
        let corners =
            [(-3., -3.), (3., -3.), (3., 1.), (0.5, 1.), (0.5, -2.), (-0.5, -2.), (-0.5, 1.), (-3., 1.)];
        let outline = corners.map(|(x, y)| origin + Vec2::new(x, y)).to_vec();
        let horseshoe = Shape::Polygon(Polygon { outline, holes: Vec::new() });
        assert!((square(2.0).shared_area(&horseshoe, origin) - 2.0).abs() < 1e-12);
    }
}
