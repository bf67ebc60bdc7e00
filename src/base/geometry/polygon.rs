//! A polygon with holes.

use super::shape::Bounds;
use super::{Segment, Shape, Vec2, cross, sweep};

/// A simple outline and the holes in it. Rings are closed implicitly; their sense does not matter.
#[derive(Clone, Debug, PartialEq)]
pub struct Polygon {
    /// Corners of the outline.
    pub outline: Vec<Vec2>,
    /// Corners of each hole.
    pub holes: Vec<Vec<Vec2>>,
}

/// An error of the holes of a polygon; holes are numbered from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum HoleFault {
    /// It has no part inside the outline.
    #[error("hole {0} is outside the outline")]
    Outside(usize),
    /// It lies inside the outline in part only.
    #[error("hole {0} crosses the outline")]
    Crosses(usize),
    /// They share more than their rims.
    #[error("holes {0} and {1} overlap")]
    Overlap(usize, usize),
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

/// Whether two edges cross at a point inside both.
fn crosses(a: &Segment, b: &Segment) -> bool {
    let side = |s: &Segment, p: Vec2| cross(s.b - s.a, p - s.a);
    let apart = |p: f64, q: f64| (p > 0.0 && q < 0.0) || (p < 0.0 && q > 0.0);
    apart(side(a, b.a), side(a, b.b)) && apart(side(b, a.a), side(b, a.b))
}

fn rings_cross(first: &[Vec2], second: &[Vec2]) -> bool {
    let edges: Vec<Segment> = ring_segments(first).chain(ring_segments(second)).collect();
    let of_first = |k: usize| k < first.len();
    sweep(&edges, |i, j| of_first(i) != of_first(j) && crosses(&edges[i], &edges[j])).is_some()
}

/// Two edges of a ring that meet and are no neighbours, which share a corner, by their numbers.
pub fn meeting_edges(ring: &[Vec2]) -> Option<(usize, usize)> {
    let edges: Vec<Segment> = ring_segments(ring).collect();
    let n = edges.len();
    let neighbours = |i: usize, j: usize| (i + 1) % n == j || (j + 1) % n == i;
    sweep(&edges, |i, j| !neighbours(i, j) && edges[i].meets(&edges[j]))
}

/// Corners, middles of the edges and a point inside: where they lie tells how two rings that do not cross lie.
fn marks(ring: &[Vec2]) -> impl Iterator<Item = Vec2> + '_ {
    let inner = Shape::Polygon(Polygon::new(ring.to_vec())).inner_point();
    ring_segments(ring).flat_map(|s| [s.a, 0.5 * (s.a + s.b)]).chain([inner])
}

/// Whether a point lies in a ring and not on its rim.
fn strictly_inside(ring: &[Vec2], p: Vec2) -> bool {
    ring_contains(ring, p) && ring_segments(ring).all(|s| s.distance(p) > 0.0)
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

    /// What is wrong with the holes, where each ring by itself is simple: they lie inside the outline and apart from
    /// each other; rims may touch.
    pub fn hole_fault(&self) -> Option<HoleFault> {
        let outline = Self::new(self.outline.clone());
        let bounds: Vec<Option<Bounds>> =
            self.holes.iter().map(|hole| Bounds::around(hole.iter().copied())).collect();
        let apart = |j: usize, k: usize| match (&bounds[j], &bounds[k]) {
            (Some(a), Some(b)) => {
                a.high.x < b.low.x || b.high.x < a.low.x || a.high.y < b.low.y || b.high.y < a.low.y
            }
            _ => true,
        };
        for (k, hole) in self.holes.iter().enumerate() {
            let outside = marks(hole).filter(|p| !outline.contains(*p)).count();
            if outside > 0 || rings_cross(hole, &self.outline) {
                let apart = !rings_cross(hole, &self.outline)
                    && !marks(hole).any(|p| strictly_inside(&self.outline, p))
                    && !marks(&self.outline).any(|p| strictly_inside(hole, p));
                return Some(if apart { HoleFault::Outside(k + 1) } else { HoleFault::Crosses(k + 1) });
            }
            for (j, other) in self.holes[..k].iter().enumerate() {
                if apart(j, k) {
                    continue;
                }
                let overlap = rings_cross(hole, other)
                    || marks(hole).any(|p| strictly_inside(other, p))
                    || marks(other).any(|p| strictly_inside(hole, p));
                if overlap {
                    return Some(HoleFault::Overlap(j + 1, k + 1));
                }
            }
        }
        None
    }

    /// Whether no two edges of one ring cross. Neighbours share a corner and do not count.
    pub fn is_simple(&self) -> bool {
        std::iter::once(&self.outline).chain(&self.holes).all(|ring| meeting_edges(ring).is_none())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

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
    fn holes_lie_inside_and_apart() {
        let p = |x: f64, y: f64| Vec2::new(x, y);
        let with = |holes: &[(f64, f64, f64, f64)]| {
            let mut polygon = Polygon::rectangle(p(0., 0.), p(4., 4.));
            let ring = |&(a, b, c, d)| Polygon::rectangle(p(a, b), p(c, d)).outline;
            polygon.holes = holes.iter().map(ring).collect();
            polygon.hole_fault()
        };
        assert_eq!(with(&[(1., 1., 3., 3.)]), None);
        assert_eq!(with(&[(0., 1., 2., 2.), (2., 1., 3., 2.)]), None, "rims may touch");
        assert_eq!(with(&[(5., 1., 6., 2.)]), Some(HoleFault::Outside(1)));
        assert_eq!(with(&[(4., 1., 6., 2.)]), Some(HoleFault::Outside(1)), "touching from outside");
        assert_eq!(with(&[(3., 1., 6., 2.)]), Some(HoleFault::Crosses(1)));
        assert_eq!(with(&[(-1., -1., 6., 6.)]), Some(HoleFault::Crosses(1)));
        assert_eq!(with(&[(1., 1., 2., 2.), (1., 1., 2., 2.)]), Some(HoleFault::Overlap(1, 2)));
        assert_eq!(with(&[(1., 1., 3., 3.), (1.5, 1.5, 2., 2.)]), Some(HoleFault::Overlap(1, 2)));
        assert_eq!(with(&[(1., 1., 3., 3.), (2., 2., 3.5, 3.5)]), Some(HoleFault::Overlap(1, 2)));
    }

    #[test]
    fn a_bow_tie_is_not_simple() {
        let p = |x: f64, y: f64| Vec2::new(x, y);
        assert!(!Polygon::new(vec![p(0., 0.), p(2., 2.), p(2., 0.), p(0., 2.)]).is_simple());
        assert!(ring().is_simple());
    }

    proptest! {
        #[test]
        fn edges_that_meet_are_those_of_a_look_at_all_pairs(
            corners in prop::collection::vec((0_i8..6, 0_i8..6), 3..9),
        ) {
            let points: Vec<Vec2> =
                corners.iter().map(|&(x, y)| Vec2::new(f64::from(x), f64::from(y))).collect();
            let edges: Vec<Segment> = ring_segments(&points).collect();
            let n = edges.len();
            let plain = (0..n)
                .all(|i| (i + 2..n).all(|j| (i == 0 && j == n - 1) || !edges[i].meets(&edges[j])));
            prop_assert_eq!(Polygon::new(points).is_simple(), plain);
        }
    }
}
