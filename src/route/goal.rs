//! Where a goal is entered: the nearest place of it, a body radius inside where it is a region.

use super::network::Network;
use super::tangent::{Turn, leaving};
use crate::base::geometry::{Polygon, Segment, Shape, Vec2};
use crate::kernel::code::ground::upright;
use crate::model::{Goal, Scene};

/// Something whose nearest place a way can end at.
#[derive(Clone, Copy, Debug)]
enum Mark {
    Point(Vec2),
    Side(Segment),
    Disc { centre: Vec2, radius: f64 },
}

/// A goal for bodies of one radius.
#[derive(Clone, Debug)]
pub(super) struct Entry {
    marks: Vec<Mark>,
    /// The region itself; none of a point.
    region: Option<Shape>,
}

/// Where a way leaves a track towards the goal.
#[derive(Clone, Copy, Debug)]
pub(super) struct Departure {
    /// The track.
    pub(super) track: u32,
    /// How far along it, rad.
    pub(super) at: f64,
    /// Length from there, m.
    pub(super) length: f64,
    /// Where it ends.
    pub(super) end: Vec2,
}

fn sides(outline: &[Vec2]) -> impl Iterator<Item = Mark> + '_ {
    let side = |k: usize| Segment::new(outline[k], outline[(k + 1) % outline.len()]);
    (0..outline.len()).flat_map(move |k| [Mark::Point(outline[k]), Mark::Side(side(k))])
}

impl Entry {
    /// Of a goal; `None` if the scene has no such region.
    pub(super) fn new(scene: &Scene, goal: &Goal, radius: f64) -> Option<Self> {
        let region = match goal {
            Goal::Point(point) => return Some(Self { marks: vec![Mark::Point(*point)], region: None }),
            Goal::Region(id) => scene.regions.get(id.0 as usize)?.shape.clone(),
        };
        let marks = |part: &Shape| match part {
            Shape::Circle { centre, radius: of_region } => {
                vec![Mark::Disc { centre: *centre, radius: (of_region - radius).max(0.0) }]
            }
            Shape::Polygon(polygon) => match upright(polygon) {
                Some(bounds) => {
                    let half = 0.5 * (bounds.high - bounds.low);
                    let inset = Vec2::new(half.x.min(radius), half.y.min(radius));
                    let inner = Polygon::rectangle(bounds.low + inset, bounds.high - inset);
                    sides(&inner.outline).collect()
                }
                None => sides(&polygon.outline).collect(),
            },
            // Parts have no parts.
            Shape::Parts(_) => Vec::new(),
        };
        let marks = region.parts().iter().flat_map(marks).collect();
        Some(Self { marks, region: Some(region) })
    }

    /// Whether a place lies in it.
    pub(super) fn holds(&self, p: Vec2) -> bool {
        self.region.as_ref().is_some_and(|region| region.contains(p))
    }

    /// The nearest places of its parts to a place, and how far each is, m.
    pub(super) fn nearest(&self, p: Vec2) -> impl Iterator<Item = (Vec2, f64)> + '_ {
        self.marks.iter().map(move |mark| {
            let q = match mark {
                Mark::Point(point) => *point,
                Mark::Side(side) => side.nearest(p),
                Mark::Disc { centre, radius } => {
                    let away = p - centre;
                    let distance = away.norm();
                    if distance > *radius { centre + away * (radius / distance) } else { p }
                }
            };
            (q, (q - p).norm())
        })
    }

    /// All places at which ways leave the circles of a network straight for the goal.
    pub(super) fn departures(&self, network: &Network) -> Vec<Departure> {
        let mut out = Vec::new();
        for (k, circle) in network.circles.iter().enumerate() {
            for turn in Turn::BOTH {
                for mark in &self.marks {
                    for along in mark.directions(circle.centre, turn.sign() * circle.radius) {
                        let touch = leaving(along, turn);
                        let place = || network.place(k, turn, touch);
                        let from = circle.centre + touch * circle.radius;
                        if let Some((end, length)) = mark.end(from, along)
                            && let Some((track, at)) = place()
                            && network.sight.is_clear(from, end, network.reach)
                        {
                            out.push(Departure { track, at, length, end });
                        }
                    }
                }
            }
        }
        out
    }
}

impl Mark {
    /// The directions in which a way can leave a circle with a signed radius, positive to the left, straight for the mark.
    fn directions(&self, centre: Vec2, radius: f64) -> Vec<Vec2> {
        match self {
            Self::Point(point) | Self::Disc { centre: point, .. } => {
                let between = point - centre;
                let square = between.norm_squared();
                let rest = square - radius * radius;
                if square <= 0.0 || rest < 0.0 {
                    return Vec::new();
                }
                let left = Vec2::new(-between.y, between.x);
                vec![(between * rest.sqrt() + left * radius) / square]
            }
            Self::Side(side) => {
                let along = side.b - side.a;
                let length = along.norm();
                let normal = Vec2::new(-along.y, along.x) / length;
                if length > 0.0 { vec![normal, -normal] } else { Vec::new() }
            }
        }
    }

    /// Where a way from a place in such a direction ends, and its length, m.
    fn end(&self, from: Vec2, along: Vec2) -> Option<(Vec2, f64)> {
        match self {
            Self::Point(point) => Some((*point, (point - from).norm())),
            Self::Disc { centre, radius } => {
                let length = ((centre - from).norm() - radius).max(0.0);
                Some((from + along * length, length))
            }
            Self::Side(side) => {
                let foot = side.nearest(from);
                let way = foot - from;
                let length = way.dot(&along);
                // Only where the foot of the perpendicular lies on the side: its ends are marks of their own.
                (length >= 0.0 && (way - along * length).norm() <= 1e-9).then_some((foot, length))
            }
        }
    }
}
