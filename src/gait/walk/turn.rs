//! Turned and scaled steps, and turns on the spot.

use super::placed::{angle, end_of};
use crate::base::geometry::Vec2;
use crate::base::math;
use crate::gait::{SPANS, Shape};
use std::f64::consts::{FRAC_PI_2, PI};

/// Most by which a step turns, rad: 50 degrees (Hase and Stein 1999 report more in turns on one foot).
pub(super) const WIDEST: f64 = 50.0 * PI / 180.0;

/// Who goes straight to a place does not turn by more than this, rad.
const ASIDE: f64 = 20.0 * PI / 180.0;

/// Slower steps may turn by up to 90 degrees, m/s.
const SLOW: f64 = 0.7;

/// Most by which a step of this length and duration turns, rad.
pub(super) fn limit(shape: &Shape) -> f64 {
    if end_of(shape).norm() < SLOW * shape.duration { FRAC_PI_2 } else { WIDEST }
}

/// Whether the path of a step turns by no more than the limit.
pub(super) fn is_legal(shape: &Shape) -> bool {
    angle(Vec2::x(), shape.curve().tangent(1.0)).abs() <= limit(shape)
}

/// The step bent by an angle, rad, positive to the left, along an arc, and scaled. Its direction at the begin stays.
pub(super) fn bent(shape: &Shape, turn: f64, scale: f64) -> Shape {
    let arc = end_of(shape).norm() * scale;
    // The place x on the way of the step goes to x on an arc of this curvature, and y stays across it.
    let curvature = if arc > 1e-6 { turn / arc } else { 0.0 };
    let bend = |p: Vec2| {
        let (x, y) = (p.x * scale, p.y * scale);
        let half = 0.5 * x * curvature;
        let (sin, cos) = math::sin_cos(half);
        let chord = if half.abs() > 1e-4 { x * sin / half } else { x * (1.0 - half * half / 6.0) };
        let (across, along) = (2.0 * sin * cos, 1.0 - 2.0 * sin * sin);
        Vec2::new(chord * cos - y * across, chord * sin + y * along)
    };
    Shape { landmarks: shape.landmarks.map(bend), duration: shape.duration }
}

/// The step scaled and bent so that it ends at a place in its frame, with the factor and the angle, rad; `None` where that
/// takes more than half or twice its length or a turn beyond the limit.
pub(super) fn fitted(shape: &Shape, target: Vec2) -> Option<(Shape, f64, f64)> {
    let (mut scale, mut turn) = (target.norm() / end_of(shape).norm().max(1e-9), 0.0);
    for _ in 0..4 {
        let made = bent(shape, turn, scale);
        let end = end_of(&made);
        scale *= target.norm() / end.norm().max(1e-9);
        turn += 2.0 * angle(end, target);
        if !(0.2..=2.0).contains(&scale) || turn.abs() > limit(&made) {
            return None;
        }
    }
    let mut made = bent(shape, turn, scale);
    let miss = target - end_of(&made);
    for (k, p) in made.landmarks.iter_mut().enumerate() {
        let share = (k + 1) as f64 / SPANS as f64;
        *p += miss * (share * share);
    }
    made.landmarks[SPANS - 1] = target;
    (miss.norm() < 0.02 && is_legal(&made)).then_some((made, scale, turn))
}

/// The step along a straight line to a place in its frame, with the factor and the angle, rad; `None` where that takes too
/// long a step or one to the side.
pub(super) fn straightened(shape: &Shape, target: Vec2) -> Option<(Shape, f64, f64)> {
    let length = end_of(shape).norm();
    let (scale, turn) = (target.norm() / length.max(1e-9), angle(Vec2::x(), target));
    let landmarks = shape.landmarks.map(|p| target * (p.norm() / length));
    let is_possible = scale <= 2.0 && turn.abs() < ASIDE;
    is_possible.then_some((Shape { landmarks, ..*shape }, scale, turn))
}

/// A turn on the spot by an angle, rad: a short arc of this radius, m.
pub(super) fn on_the_spot(turn: f64, radius: f64, duration: f64) -> Shape {
    let at = |k: usize| {
        let (sin, cos) = math::sin_cos(turn * (k + 1) as f64 / SPANS as f64);
        Vec2::new(radius * sin * turn.signum(), radius * (1.0 - cos) * turn.signum())
    };
    Shape { landmarks: std::array::from_fn(at), duration }
}
