//! Circles that ways turn around: a corner of a barrier inflated by the body, or an inflated disc; and the arcs of them on
//! which the middle of a body can be.

use crate::base::geometry::{Segment, Vec2, cross};
use crate::base::math::{atan2, sin_cos};
use crate::model::sight::ROUNDING;
use crate::model::{Piece, Sight};
use std::f64::consts::TAU;

/// Angles that differ by less are one, rad.
const SAME_ANGLE: f64 = 1e-9;

/// A free part of a circle, counterclockwise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Arc {
    /// Angle at which it begins, rad.
    pub(super) from: f64,
    /// How far it goes, rad; a full turn at most.
    pub(super) extent: f64,
    /// Unit vectors to its ends.
    ends: (Vec2, Vec2),
}

impl Arc {
    fn new(from: f64, extent: f64) -> Self {
        Self { from, extent, ends: (direction(from), direction(from + extent)) }
    }

    /// Whether it is a whole circle.
    pub(super) fn is_full(&self) -> bool {
        self.extent >= TAU
    }

    /// Whether it may hold the end of a unit vector; a quick test before [`Arc::place`].
    fn may_hold(&self, u: Vec2) -> bool {
        let (start, end) = self.ends;
        let slack = 2.0 * SAME_ANGLE;
        if self.is_full() {
            true
        } else if self.extent <= 0.5 * TAU {
            cross(start, u) >= -slack && cross(u, end) >= -slack
        } else {
            cross(start, u) >= -slack || cross(u, end) >= -slack
        }
    }

    /// How far from its beginning a unit vector points, rad, if it points to the arc.
    fn place(&self, u: Vec2) -> Option<f64> {
        let angle = atan2(u.y, u.x);
        let turn = if angle < 0.0 { angle + TAU } else { angle } - self.from;
        let turn = if turn < 0.0 { turn + TAU } else { turn };
        let turn = if turn >= TAU { turn - TAU } else { turn };
        if turn <= self.extent {
            Some(turn)
        } else if turn <= self.extent + SAME_ANGLE {
            Some(self.extent)
        } else {
            (turn >= TAU - SAME_ANGLE).then_some(0.0)
        }
    }
}

/// A circle with its free arcs.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Circle {
    pub(super) centre: Vec2,
    pub(super) radius: f64,
    pub(super) arcs: Vec<Arc>,
}

impl Circle {
    /// The arc to which a unit vector from the centre points, and how far from its beginning, rad.
    pub(super) fn place(&self, u: Vec2) -> Option<(usize, f64)> {
        let arcs = self.arcs.iter().enumerate();
        arcs.filter(|(_, arc)| arc.may_hold(u)).find_map(|(k, arc)| Some((k, arc.place(u)?)))
    }
}

pub(super) fn direction(angle: f64) -> Vec2 {
    let (sin, cos) = sin_cos(angle);
    Vec2::new(cos, sin)
}

/// The circles of a scene for bodies of a radius, m; those without a free arc are left out.
pub(super) fn circles(sight: &Sight, reach: f64) -> Vec<Circle> {
    let mut centres: Vec<(Vec2, f64)> = Vec::new();
    for piece in sight.pieces() {
        match piece {
            Piece::Edge(edge) => centres.extend([(edge.a, reach), (edge.b, reach)]),
            Piece::Disc { centre, radius } => centres.push((*centre, radius + reach)),
        }
    }
    let key = |(p, radius): &(Vec2, f64)| [p.x, p.y, *radius];
    centres.sort_by(|a, b| {
        let orders = key(a).into_iter().zip(key(b)).map(|(a, b)| a.total_cmp(&b));
        orders.fold(std::cmp::Ordering::Equal, std::cmp::Ordering::then)
    });
    centres.dedup_by(|a, b| key(a) == key(b));
    let circle = |(centre, radius)| Circle { centre, radius, arcs: arcs(sight, centre, radius, reach) };
    centres.into_iter().map(circle).filter(|circle| !circle.arcs.is_empty()).collect()
}

/// The arcs of a circle that keep a distance of `reach` from all barriers.
fn arcs(sight: &Sight, centre: Vec2, radius: f64, reach: f64) -> Vec<Arc> {
    let pieces = sight.near(centre, radius + reach);
    let is_free = |angle: f64| {
        let p = centre + direction(angle) * radius;
        pieces.iter().all(|piece| piece.distance(p) >= reach - ROUNDING)
    };
    let mut angles = Vec::new();
    for piece in &pieces {
        crossings(piece, (centre, radius), reach, &mut angles);
    }
    for angle in &mut angles {
        *angle = if *angle < 0.0 { *angle + TAU } else { *angle };
    }
    angles.sort_by(f64::total_cmp);
    angles.dedup_by(|a, b| *a - *b < 1e-12);
    let count = angles.len();
    if count == 0 {
        return if is_free(0.0) { vec![Arc::new(0.0, TAU)] } else { Vec::new() };
    }
    let extent =
        |k: usize| if k + 1 < count { angles[k + 1] - angles[k] } else { angles[0] + TAU - angles[k] };
    let free: Vec<bool> = (0..count).map(|k| is_free(angles[k] + 0.5 * extent(k))).collect();
    let Some(blocked) = free.iter().position(|free| !free) else { return vec![Arc::new(0.0, TAU)] };
    let mut out = Vec::new();
    let mut open: Option<(f64, f64)> = None;
    for k in (blocked + 1..=blocked + count).map(|k| k % count) {
        if free[k] {
            let (from, so_far) = open.unwrap_or((angles[k], 0.0));
            open = Some((from, so_far + extent(k)));
        } else if let Some((from, extent)) = open.take().filter(|(_, extent)| *extent > SAME_ANGLE) {
            out.push(Arc::new(from, extent));
        }
    }
    out
}

/// The angles at which a circle meets the line at distance `reach` from a piece.
fn crossings(piece: &Piece, circle: (Vec2, f64), reach: f64, angles: &mut Vec<f64>) {
    match piece {
        Piece::Edge(edge) => {
            around(edge.a, reach, circle, angles);
            around(edge.b, reach, circle, angles);
            beside(edge, reach, circle, angles);
        }
        Piece::Disc { centre, radius } => around(*centre, radius + reach, circle, angles),
    }
}

/// Where a circle meets another one.
fn around(other: Vec2, reach: f64, (centre, radius): (Vec2, f64), angles: &mut Vec<f64>) {
    let between = other - centre;
    let distance = between.norm();
    if distance > 0.0 && distance <= radius + reach && distance >= (radius - reach).abs() {
        let cos = (distance * distance + radius * radius - reach * reach) / (2.0 * distance * radius);
        pair(atan2(between.y, between.x), cos, angles);
    }
}

/// Where a circle meets the two lines beside an edge.
fn beside(edge: &Segment, reach: f64, (centre, radius): (Vec2, f64), angles: &mut Vec<f64>) {
    let along = edge.b - edge.a;
    let length = along.norm();
    if length > 0.0 {
        let normal = Vec2::new(-along.y, along.x) / length;
        for normal in [normal, -normal] {
            let far = (edge.a - centre).dot(&normal) + reach;
            if far.abs() <= radius * (1.0 + 1e-12) {
                pair(atan2(normal.y, normal.x), far / radius, angles);
            }
        }
    }
}

/// The two angles whose difference from one has this cosine.
fn pair(angle: f64, cos: f64, angles: &mut Vec<f64>) {
    let cos = cos.clamp(-1.0, 1.0);
    let turn = atan2((1.0 - cos * cos).max(0.0).sqrt(), cos);
    for angle in [angle - turn, angle + turn] {
        let angle = if angle < 0.0 { angle + TAU } else { angle };
        angles.push(if angle >= TAU { angle - TAU } else { angle });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Barrier, Obstacle, Scene};
    use std::f64::consts::PI;

    fn scene(walls: &[[f64; 4]]) -> Sight {
        let wall = |w: &[f64; 4]| Barrier {
            name: String::new(),
            obstacle: Obstacle::Wall(vec![Segment::new(Vec2::new(w[0], w[1]), Vec2::new(w[2], w[3]))]),
        };
        Sight::new(&Scene { barriers: walls.iter().map(wall).collect(), ..Scene::default() })
    }

    #[test]
    fn the_end_of_a_wall_has_half_a_circle_and_a_corner_a_quarter() {
        let found = circles(&scene(&[[0.0, 0.0, 4.0, 0.0], [0.0, 0.0, 0.0, 4.0]]), 0.25);
        let of = |x: f64, y: f64| {
            let circle = found.iter().find(|c| c.centre == Vec2::new(x, y)).unwrap();
            assert_eq!(circle.arcs.len(), 1);
            circle.arcs[0]
        };
        let corner = of(0.0, 0.0);
        assert!((corner.from - PI).abs() < 1e-6 && (corner.extent - 0.5 * PI).abs() < 1e-6, "{corner:?}");
        let end = of(4.0, 0.0);
        assert!((end.from - 1.5 * PI).abs() < 1e-6 && (end.extent - PI).abs() < 1e-6, "{end:?}");
    }

    #[test]
    fn a_joint_of_a_straight_wall_and_an_end_at_another_wall_have_no_arc() {
        let found = circles(&scene(&[[0.0, 0.0, 4.0, 0.0], [4.0, 0.0, 9.0, 0.0], [6.0, 0.0, 6.0, 5.0]]), 0.3);
        let mut centres: Vec<(f64, f64)> = found.iter().map(|c| (c.centre.x, c.centre.y)).collect();
        centres.sort_by(|a, b| a.0.total_cmp(&b.0));
        assert_eq!(centres, [(0.0, 0.0), (6.0, 5.0), (9.0, 0.0)]);
    }
}
