//! A straight segment: the piece every wall and every outline is made of.

use super::{Vec2, cross};

/// The points between two ends, ends included. The ends may coincide.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// First end.
    pub a: Vec2,
    /// Second end.
    pub b: Vec2,
}

impl Segment {
    /// The segment from `a` to `b`.
    pub const fn new(a: Vec2, b: Vec2) -> Self {
        Self { a, b }
    }

    /// Its length.
    pub fn length(&self) -> f64 {
        (self.b - self.a).norm()
    }

    /// The point of the segment nearest to `p`.
    pub fn nearest(&self, p: Vec2) -> Vec2 {
        let along = self.b - self.a;
        let square = along.dot(&along);
        if square == 0.0 {
            return self.a;
        }
        let share = (p - self.a).dot(&along) / square;
        self.a + along * share.clamp(0.0, 1.0)
    }

    /// Distance from `p` to the segment.
    pub fn distance(&self, p: Vec2) -> f64 {
        (p - self.nearest(p)).norm()
    }

    /// Distance between the two segments, 0 where they meet.
    pub fn distance_to(&self, other: &Self) -> f64 {
        if self.meets(other) {
            return 0.0;
        }
        let ends = self.distance(other.a).min(self.distance(other.b));
        ends.min(other.distance(self.a)).min(other.distance(self.b))
    }

    /// Whether the two segments cross between their ends.
    pub fn crosses(&self, other: &Self) -> bool {
        let turn = |a, b, c| cross(b - a, c - a);
        let (d1, d2) = (turn(other.a, other.b, self.a), turn(other.a, other.b, self.b));
        let (d3, d4) = (turn(self.a, self.b, other.a), turn(self.a, self.b, other.b));
        d1 * d2 < 0.0 && d3 * d4 < 0.0
    }

    /// Whether the two segments have a point in common.
    pub fn meets(&self, other: &Self) -> bool {
        if self.crosses(other) {
            return true;
        }
        let touches = |s: &Self, p: Vec2| s.distance(p) == 0.0;
        touches(self, other.a) || touches(self, other.b) || touches(other, self.a) || touches(other, self.b)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_point_is_inside_or_an_end() {
        let s = Segment::new(Vec2::new(0.0, 0.0), Vec2::new(4.0, 0.0));
        assert_eq!(s.nearest(Vec2::new(1.0, 3.0)), Vec2::new(1.0, 0.0));
        assert_eq!(s.nearest(Vec2::new(-1.0, 3.0)), s.a);
        assert_eq!(s.distance(Vec2::new(7.0, 4.0)), 5.0);
        let point = Segment::new(s.a, s.a);
        assert_eq!(point.nearest(Vec2::new(1.0, 1.0)), s.a);
    }

    #[test]
    fn crossing_and_touching_segments_meet() {
        let seg = |x0, y0, x1, y1| Segment::new(Vec2::new(x0, y0), Vec2::new(x1, y1));
        let s = seg(0.0, 0.0, 4.0, 0.0);
        assert!(s.meets(&seg(2.0, -1.0, 2.0, 1.0)));
        assert!(s.meets(&seg(4.0, 0.0, 5.0, 1.0)));
        assert!(!s.meets(&seg(2.0, 0.5, 2.0, 1.0)));
        assert!(s.meets(&seg(1.0, 0.0, 9.0, 0.0)));
    }
}
