//! Lines that touch circles: of a way that turns around one after the other.

use super::circle::Circle;
use crate::base::geometry::Vec2;

/// In which sense a way turns around a circle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd)]
pub(super) enum Turn {
    /// Counterclockwise.
    Left,
    /// Clockwise.
    Right,
}

impl Turn {
    /// Both.
    pub(super) const BOTH: [Self; 2] = [Self::Left, Self::Right];

    /// 1 to the left, -1 to the right.
    pub(super) const fn sign(self) -> f64 {
        match self {
            Self::Left => 1.0,
            Self::Right => -1.0,
        }
    }
}

/// A line from one circle to another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Tangent {
    /// Unit vectors from the centres to where it touches.
    pub(super) touches: [Vec2; 2],
    /// Its ends, m.
    pub(super) ends: [Vec2; 2],
    /// Its length, m.
    pub(super) length: f64,
}

fn left(v: Vec2) -> Vec2 {
    Vec2::new(-v.y, v.x)
}

/// The line that a way takes from one circle to another; none where one circle holds the other.
pub(super) fn between((a, turn_a): (&Circle, Turn), (b, turn_b): (&Circle, Turn)) -> Option<Tangent> {
    tangent((a.centre, turn_a.sign() * a.radius), (b.centre, turn_b.sign() * b.radius)).map(
        |(along, length, ends)| Tangent {
            touches: [left(along) * -turn_a.sign(), left(along) * -turn_b.sign()],
            ends,
            length,
        },
    )
}

/// The line from a point to a circle: where it touches as a unit vector from the centre, its end, and its length, m. From within the
/// circle, straight away from the centre to the rim.
pub(super) fn from_point(p: Vec2, circle: &Circle, turn: Turn) -> Option<(Vec2, Vec2, f64)> {
    let away = p - circle.centre;
    let distance = away.norm();
    if distance <= circle.radius {
        let touch = (distance > 0.0).then(|| away / distance)?;
        return Some((touch, circle.centre + touch * circle.radius, circle.radius - distance));
    }
    let (along, length, ends) = tangent((p, 0.0), (circle.centre, turn.sign() * circle.radius))?;
    Some((left(along) * -turn.sign(), ends[1], length))
}

/// Direction, length and ends of the line that touches two circles with signed radii: positive where they lie to the left.
fn tangent((a, of_a): (Vec2, f64), (b, of_b): (Vec2, f64)) -> Option<(Vec2, f64, [Vec2; 2])> {
    // b - a = length along + (of_b - of_a) left(along)
    let between = b - a;
    let (square, aside) = (between.norm_squared(), of_b - of_a);
    let rest = square - aside * aside;
    if square <= 0.0 || rest < 0.0 {
        return None;
    }
    let length = rest.sqrt();
    let along = (between * length - left(between) * aside) / square;
    Some((along, length, [a - left(along) * of_a, b - left(along) * of_b]))
}

/// The place on a circle from which a way leaves in a direction, as a unit vector from the centre.
pub(super) fn leaving(along: Vec2, turn: Turn) -> Vec2 {
    left(along) * -turn.sign()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_touch_both_circles_and_go_on_in_their_sense() {
        let circle =
            |x: f64, y: f64, radius: f64| Circle { centre: Vec2::new(x, y), radius, arcs: Vec::new() };
        let (a, b) = (circle(0.0, 0.0, 1.0), circle(5.0, 2.0, 0.5));
        for (turn_a, turn_b) in Turn::BOTH.into_iter().flat_map(|t| Turn::BOTH.map(|u| (t, u))) {
            let found = between((&a, turn_a), (&b, turn_b)).unwrap();
            let along = (found.ends[1] - found.ends[0]) / found.length;
            for (k, (circle, turn)) in [(&a, turn_a), (&b, turn_b)].into_iter().enumerate() {
                let touch = found.ends[k] - circle.centre;
                assert!((touch.norm() - circle.radius).abs() < 1e-12);
                assert!((touch / circle.radius - found.touches[k]).norm() < 1e-12);
                // Going on around the circle keeps the direction.
                assert!((left(found.touches[k]) * turn.sign() - along).norm() < 1e-12);
            }
        }
        let (touch, end, length) = from_point(Vec2::new(-3.0, 0.0), &a, Turn::Left).unwrap();
        assert!((length - 8.0_f64.sqrt()).abs() < 1e-12 && end.y < 0.0 && (touch - end).norm() < 1e-12);
    }
}
