//! Which of many segments come near each other: only those whose stretches of one axis overlap are compared, in the order
//! of their left ends.

use super::{Segment, Vec2};

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
