//! Rings of polygons: what makes one usable.
//!
//! Crossings are looked for with the edges sorted by their left ends, so that only edges that share a
//! stretch of the x axis are compared.

use crate::base::geometry::{Polygon, Segment, Vec2, cross};

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

/// A coordinate of a point.
type Coordinate = fn(&Vec2) -> f64;

/// A point where two edges meet that are not neighbours, about.
fn crossing(ring: &[Vec2]) -> Option<Vec2> {
    let n = ring.len();
    let edge = |k: usize| Segment::new(ring[k], ring[(k + 1) % n]);
    // Along the axis on which the edges, all in all, reach less far.
    let reach = |of: Coordinate| {
        let (low, high) = ring.iter().map(of).fold((f64::MAX, f64::MIN), |(l, h), x| (l.min(x), h.max(x)));
        (0..n).map(|k| (of(&ring[k]) - of(&ring[(k + 1) % n])).abs()).sum::<f64>() / (high - low)
    };
    let (along, beside): (Coordinate, Coordinate) =
        if reach(|p| p.x) <= reach(|p| p.y) { (|p| p.x, |p| p.y) } else { (|p| p.y, |p| p.x) };
    let left = |s: &Segment| along(&s.a).min(along(&s.b));
    let right = |s: &Segment| along(&s.a).max(along(&s.b));
    let apart = |s: &Segment, t: &Segment| {
        let ends = |s: &Segment| (beside(&s.a).min(beside(&s.b)), beside(&s.a).max(beside(&s.b)));
        let ((a, b), (c, d)) = (ends(s), ends(t));
        b < c || d < a
    };
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&i, &j| left(&edge(i)).total_cmp(&left(&edge(j))));
    for (k, &i) in order.iter().enumerate() {
        let first = edge(i);
        for &j in &order[k + 1..] {
            let second = edge(j);
            if left(&second) > right(&first) {
                break;
            }
            let neighbours = (i + 1) % n == j || (j + 1) % n == i;
            if !neighbours && !apart(&first, &second) && first.meets(&second) {
                return Some(meeting(&first, &second));
            }
        }
    }
    None
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
    use proptest::prelude::*;

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

    proptest! {
        #[test]
        fn the_sweep_agrees_with_all_pairs(corners in prop::collection::vec((0_i8..6, 0_i8..6), 3..9)) {
            let points: Vec<Vec2> =
                corners.iter().map(|&(x, y)| Vec2::new(f64::from(x), f64::from(y))).collect();
            prop_assert_eq!(crossing(&points).is_none(), Polygon::new(points).is_simple());
        }
    }
}
