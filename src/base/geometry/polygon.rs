//! A polygon with holes.

use super::{Segment, Vec2, cross};

/// A simple outline and the holes in it. Rings are closed implicitly; their sense does not matter.
#[derive(Clone, Debug, PartialEq)]
pub struct Polygon {
    /// Corners of the outline.
    pub outline: Vec<Vec2>,
    /// Corners of each hole.
    pub holes: Vec<Vec<Vec2>>,
}

fn ring_area(ring: &[Vec2]) -> f64 {
    let mut twice = 0.0;
    for (k, &a) in ring.iter().enumerate() {
        twice += cross(a, ring[(k + 1) % ring.len()]);
    }
    (0.5 * twice).abs()
}

fn ring_segments(ring: &[Vec2]) -> impl Iterator<Item = Segment> + '_ {
    (0..ring.len()).map(|k| Segment::new(ring[k], ring[(k + 1) % ring.len()]))
}

/// Even-odd rule; a point on the outline may fall on either side.
fn ring_contains(ring: &[Vec2], p: Vec2) -> bool {
    let mut inside = false;
    for s in ring_segments(ring) {
        if (s.a.y > p.y) != (s.b.y > p.y) {
            let x = s.a.x + (p.y - s.a.y) / (s.b.y - s.a.y) * (s.b.x - s.a.x);
            if p.x < x {
                inside = !inside;
            }
        }
    }
    inside
}

impl Polygon {
    /// A polygon without holes.
    pub const fn new(outline: Vec<Vec2>) -> Self {
        Self { outline, holes: Vec::new() }
    }

    /// The rectangle between two opposite corners.
    pub fn rectangle(a: Vec2, b: Vec2) -> Self {
        Self::new(vec![a, Vec2::new(b.x, a.y), b, Vec2::new(a.x, b.y)])
    }

    /// Area of the outline less that of the holes.
    pub fn area(&self) -> f64 {
        ring_area(&self.outline) - self.holes.iter().map(|hole| ring_area(hole)).sum::<f64>()
    }

    /// All edges: those of the outline, then those of the holes.
    pub fn segments(&self) -> impl Iterator<Item = Segment> + '_ {
        ring_segments(&self.outline).chain(self.holes.iter().flat_map(|hole| ring_segments(hole)))
    }

    /// Whether `p` lies inside or on the outline, and not strictly inside a hole.
    pub fn contains(&self, p: Vec2) -> bool {
        if self.segments().any(|s| s.distance(p) == 0.0) {
            return true;
        }
        ring_contains(&self.outline, p) && !self.holes.iter().any(|hole| ring_contains(hole, p))
    }

    /// The point of the outline (holes included) nearest to `p`.
    pub fn nearest_on_outline(&self, p: Vec2) -> Vec2 {
        let mut best = (f64::INFINITY, p);
        for s in self.segments() {
            let q = s.nearest(p);
            let distance = (p - q).norm();
            if distance < best.0 {
                best = (distance, q);
            }
        }
        best.1
    }

    /// Whether no two edges of one ring cross. Neighbours share a corner and do not count.
    pub fn is_simple(&self) -> bool {
        std::iter::once(&self.outline).chain(&self.holes).all(|ring| {
            let edges: Vec<_> = ring_segments(ring).collect();
            let n = edges.len();
            (0..n).all(|i| (i + 2..n).all(|j| (i == 0 && j == n - 1) || !edges[i].meets(&edges[j])))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ring() -> Polygon {
        let mut p = Polygon::rectangle(Vec2::new(0.0, 0.0), Vec2::new(4.0, 4.0));
        p.holes.push(Polygon::rectangle(Vec2::new(1.0, 1.0), Vec2::new(3.0, 3.0)).outline);
        p
    }

    #[test]
    fn holes_are_outside() {
        assert_eq!(ring().area(), 12.0);
        assert!(ring().contains(Vec2::new(0.5, 2.0)));
        assert!(!ring().contains(Vec2::new(2.0, 2.0)));
        assert!(ring().contains(Vec2::new(1.0, 2.0)), "the rim of a hole belongs to the polygon");
        assert!(ring().contains(Vec2::new(4.0, 4.0)));
        assert!(!ring().contains(Vec2::new(4.1, 4.0)));
    }

    #[test]
    fn a_bow_tie_is_not_simple() {
        let p = |x: f64, y: f64| Vec2::new(x, y);
        assert!(!Polygon::new(vec![p(0., 0.), p(2., 2.), p(2., 0.), p(0., 2.)]).is_simple());
        assert!(ring().is_simple());
    }
}
