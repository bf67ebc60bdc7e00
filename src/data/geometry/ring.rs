//! Rings of polygons: what makes one usable.

use crate::base::geometry::{Polygon, Segment, Vec2, cross, meeting_edges};

/// The corners of a ring, the closing one not repeated, or what is wrong with it.
pub(super) fn checked(mut points: Vec<Vec2>) -> Result<Vec<Vec2>, String> {
    points.dedup();
    while points.len() > 1 && points.first() == points.last() {
        points.pop();
    }
    if points.len() < 3 {
        return Err("has fewer than three corners".into());
    }
    if let Some(at) = crossing(&points) {
        return Err(format!("meets itself near ({}, {})", at.x, at.y));
    }
    let ring = Polygon::new(points);
    if ring.area() > 0.0 { Ok(ring.outline) } else { Err("has no area".into()) }
}

/// A point where two edges meet that are not neighbours, about.
fn crossing(ring: &[Vec2]) -> Option<Vec2> {
    let edge = |k: usize| Segment::new(ring[k], ring[(k + 1) % ring.len()]);
    meeting_edges(ring).map(|(i, j)| meeting(&edge(i), &edge(j)))
}

/// Where two segments that meet do so: at an end that lies on the other, or where they cross. Rounded to millionths, as
/// far as that can be seen, for people to read.
fn meeting(first: &Segment, second: &Segment) -> Vec2 {
    let ends = [(second, first.a), (second, first.b), (first, second.a), (first, second.b)];
    if let Some((_, end)) = ends.iter().find(|(other, end)| other.distance(*end) == 0.0) {
        return *end;
    }
    let (along, beside) = (first.b - first.a, second.b - second.a);
    let share = cross(second.a - first.a, beside) / cross(along, beside);
    let at = first.a + along * share;
    if !(at.x.is_finite() && at.y.is_finite()) {
        return second.a;
    }
    at.map(|v| if v.abs() < 1e9 { (v * 1e6).round() / 1e6 } else { v })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ring(corners: &[(f64, f64)]) -> Vec<Vec2> {
        corners.iter().map(|&(x, y)| Vec2::new(x, y)).collect()
    }

    #[test]
    fn degenerate_rings_are_refused() {
        assert_eq!(
            checked(ring(&[(0., 0.), (1., 0.), (1., 0.), (0., 0.)])).unwrap_err(),
            "has fewer than three corners"
        );
        assert_eq!(checked(ring(&[(0., 0.), (1., 0.), (2., 0.)])).unwrap_err(), "has no area");
        let bow_tie = checked(ring(&[(0., 0.), (2., 2.), (2., 0.), (0., 2.)])).unwrap_err();
        assert_eq!(bow_tie, "meets itself near (1, 1)");
        let third = checked(ring(&[(0., 0.), (1., 1.), (1., 0.), (0., 0.5)])).unwrap_err();
        assert_eq!(third, "meets itself near (0.333333, 0.333333)");
        let touching = checked(ring(&[(0., 0.), (4., 0.), (4., 4.), (3., 0.), (0., 4.)])).unwrap_err();
        assert_eq!(touching, "meets itself near (3, 0)");
        assert_eq!(checked(ring(&[(0., 0.), (1., 0.), (0., 1.), (0., 0.)])).unwrap().len(), 3);
    }
}
