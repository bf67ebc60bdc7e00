//! Pushes bodies that found no free place apart, inside the shapes they belong to.

use super::crowd::Crowd;
use super::placement::Ground;
use crate::base::geometry::{Segment, Shape, Vec2};
use crate::base::math;
use crate::model::Obstacle;

/// How often everyone may be pushed.
const SWEEPS: u32 = 300;

/// How far apart pushed bodies come to rest, m: far above rounding, far below what anyone sees.
const CLEARANCE: f64 = 1e-6;

/// Share of an overlap that one body gives way, if the other can move too.
const SHARE: f64 = 0.6;

/// Where a body may be.
#[derive(Clone, Copy)]
pub(super) enum Room<'a> {
    /// Only where it is.
    Fixed,
    /// In a shape.
    Within(&'a Shape),
    /// Near another body.
    Near { anchor: usize, within: f64 },
}

impl Room<'_> {
    /// Whether a place is farther from another body than it may be, by more than anyone sees.
    pub(super) fn is_left(self, crowd: &Crowd, p: Vec2) -> bool {
        match self {
            Self::Near { anchor, within } => crowd.way_from(anchor, p).norm() > within + CLEARANCE,
            Self::Fixed | Self::Within(_) => false,
        }
    }

    fn nearest(self, crowd: &Crowd, p: Vec2) -> Vec2 {
        match self {
            Self::Fixed => p,
            Self::Within(shape) => shape.nearest(p),
            Self::Near { anchor, within } => {
                let from = crowd.way_from(anchor, p);
                let distance = from.norm();
                if distance > within { crowd.positions[anchor] + from * (within / distance) } else { p }
            }
        }
    }
}

/// Moves bodies until none overlap and each is where it may be, or for a fixed number of sweeps. Others stay.
pub(super) fn relax(crowd: &mut Crowd, rooms: &[Room<'_>], ground: Ground<'_>) {
    for sweep in 0..SWEEPS {
        let mut moved = false;
        for (body, room) in rooms.iter().enumerate() {
            if matches!(room, Room::Fixed) {
                continue;
            }
            let (at, radius) = (crowd.positions[body], crowd.radii[body]);
            let push = push(crowd, rooms, ground, body, sweep);
            let length = push.norm();
            if length == 0.0 {
                // Whom it is to be near may have been pushed away.
                moved |= room.is_left(crowd, at) && draw_in(crowd, *room, ground, body);
                continue;
            }
            moved = true;
            // No further than half a radius at a time, so that nobody is pushed through anything.
            let step = push * math::at_most(0.5 * radius / length, 1.0);
            let to = room.nearest(crowd, at + step);
            if !crosses_wall(ground, at, to) {
                crowd.shift(body, to);
            }
        }
        if !moved {
            return;
        }
    }
    for (body, room) in rooms.iter().enumerate() {
        if room.is_left(crowd, crowd.positions[body]) {
            draw_in(crowd, *room, ground, body);
        }
    }
}

/// Brings a body back to where it may be; whether it could.
fn draw_in(crowd: &mut Crowd, room: Room<'_>, ground: Ground<'_>, body: usize) -> bool {
    let at = crowd.positions[body];
    let to = room.nearest(crowd, at);
    let free = !crosses_wall(ground, at, to);
    if free {
        crowd.shift(body, to);
    }
    free
}

/// The way out of all overlaps of a body; zero without any.
fn push(crowd: &Crowd, rooms: &[Room<'_>], ground: Ground<'_>, body: usize, sweep: u32) -> Vec2 {
    let (at, radius) = (crowd.positions[body], crowd.radii[body]);
    let mut push = Vec2::zeros();
    crowd.around(body, at, |other| {
        let apart = crowd.way_from(other, at);
        let distance = apart.norm();
        let overlap = radius + crowd.radii[other] - distance;
        if overlap <= 0.0 {
            return;
        }
        let direction = if distance > 0.0 {
            apart / distance
        } else {
            // Two at one point: any direction will do, if it is another for each and in each sweep.
            let (sin, cos) = math::sin_cos_turn(f64::from(body as u32 * 7 + sweep) * 0.381_966_011_25);
            Vec2::new(cos, sin)
        };
        let share = if matches!(rooms[other], Room::Fixed) { 1.0 } else { SHARE };
        push += direction * (share * overlap + CLEARANCE);
    });
    for obstacle in ground.near(at, radius) {
        let distance = obstacle.distance(at);
        if distance < radius {
            let surface = obstacle.nearest_on_surface(at);
            let outward = if distance < 0.0 { surface - at } else { at - surface };
            let length = outward.norm();
            if length > 0.0 {
                push += outward * ((radius - distance + CLEARANCE) / length);
            }
        }
    }
    push
}

fn crosses_wall(ground: Ground<'_>, from: Vec2, to: Vec2) -> bool {
    let path = Segment::new(from, to);
    ground.near(from, path.length()).any(|obstacle| match obstacle {
        Obstacle::Wall(segments) => segments.iter().any(|s| s.meets(&path)),
        Obstacle::Solid(_) => false,
    })
}
