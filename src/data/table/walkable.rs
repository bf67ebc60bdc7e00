//! The walkable area of a scene as a polygon with holes: the rectangle around all that is there, less what blocks agents.
//!
//! Walls have no thickness, so a wall becomes a strip of 1 mm. Of the parts that remain, those count in which an agent was.

use crate::base::geometry::{Bounds, Segment, Shape, Vec2};
use crate::base::math;
use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::float::single::SingleFloatOverlay;

/// Room around everything, m.
const MARGIN: f64 = 1.0;
/// Half the thickness of a wall, m.
const HALF: f64 = 5e-4;
/// Corners of a disc.
const CORNERS: u32 = 64;
/// Coordinates are written in steps of so many to a metre.
const STEPS: f64 = 1e6;

type Ring = Vec<[f64; 2]>;

/// What is known of the walkable area.
pub(super) struct Walkable<'t> {
    walls: &'t [Segment],
    solids: &'t [Shape],
    bounds: Option<Bounds>,
    /// Where agents were first.
    first: Vec<Vec2>,
}

impl<'t> Walkable<'t> {
    /// Of a scene with these barriers.
    pub(super) fn new(walls: &'t [Segment], solids: &'t [Shape]) -> Self {
        let solid = solids.iter().map(Shape::bounds).flat_map(|bounds| [bounds.low, bounds.high]);
        let ends = walls.iter().flat_map(|wall| [wall.a, wall.b]);
        Self { walls, solids, bounds: Bounds::around(solid.chain(ends)), first: Vec::new() }
    }

    /// An agent is somewhere; agents have ids from 1 in the order in which they come.
    pub(super) fn see(&mut self, id: i64, at: Vec2) {
        let known = self.bounds.iter().flat_map(|bounds| [bounds.low, bounds.high]);
        self.bounds = Bounds::around(known.chain([at]));
        if id > self.first.len() as i64 {
            self.first.push(at);
        }
    }

    /// The rectangle around everything.
    pub(super) fn bounds(&self) -> Bounds {
        let margin = Vec2::new(MARGIN, MARGIN);
        let known = self.bounds.unwrap_or(Bounds { low: Vec2::zeros(), high: Vec2::zeros() });
        Bounds { low: known.low - margin, high: known.high + margin }
    }

    /// The area as well-known text.
    pub(super) fn text(&self) -> String {
        let Bounds { low, high } = self.bounds();
        let all = vec![vec![[low.x, low.y], [high.x, low.y], [high.x, high.y], [low.x, high.y]]];
        let mut blocked: Vec<Ring> = self.walls.iter().map(strip).collect();
        blocked.extend(self.solids.iter().flat_map(rings));
        let parts = if blocked.is_empty() {
            vec![all]
        } else {
            all.overlay_as::<i64>(&blocked, OverlayRule::Difference, FillRule::NonZero)
        };
        let is_used = |part: &&Vec<Ring>| {
            self.first.iter().any(|at| part.iter().filter(|ring| is_inside(ring, *at)).count() % 2 == 1)
        };
        let used: Vec<&Vec<Ring>> = parts.iter().filter(is_used).collect();
        let shown = if used.is_empty() { parts.iter().collect() } else { used };
        let polygons: Vec<String> = shown.into_iter().map(|part| polygon(part)).collect();
        match polygons.as_slice() {
            [one] => format!("POLYGON {one}"),
            many => format!("MULTIPOLYGON ({})", many.join(", ")),
        }
    }
}

fn polygon(rings: &[Ring]) -> String {
    let point = |[x, y]: &[f64; 2]| {
        let [x, y] = [x, y].map(|number| (number * STEPS).round() / STEPS);
        format!("{x} {y}")
    };
    let ring = |ring: &Ring| {
        let points: Vec<String> = ring.iter().chain(ring.first()).map(point).collect();
        format!("({})", points.join(", "))
    };
    format!("({})", rings.iter().map(ring).collect::<Vec<_>>().join(", "))
}

/// A wall as a strip, anticlockwise.
fn strip(wall: &Segment) -> Ring {
    let along = (wall.b - wall.a).try_normalize(0.0).unwrap_or(Vec2::new(1.0, 0.0)) * HALF;
    let left = Vec2::new(-along.y, along.x);
    let (a, b) = (wall.a - along, wall.b + along);
    [a - left, b - left, b + left, a + left].map(|p| [p.x, p.y]).to_vec()
}

/// The outline of a solid anticlockwise, its holes clockwise.
fn rings(solid: &Shape) -> Vec<Ring> {
    let turned = |ring: &[Vec2], is_hole: bool| {
        let mut ring: Ring = ring.iter().map(|p| [p.x, p.y]).collect();
        let next = ring.iter().cycle().skip(1);
        let area: f64 = ring.iter().zip(next).map(|([ax, ay], [bx, by])| ax * by - bx * ay).sum();
        if (area < 0.0) != is_hole {
            ring.reverse();
        }
        ring
    };
    match solid {
        Shape::Circle { centre, radius } => {
            let corner = |k: u32| {
                let (sin, cos) = math::sin_cos(std::f64::consts::TAU * f64::from(k) / f64::from(CORNERS));
                centre + Vec2::new(cos, sin) * *radius
            };
            vec![turned(&(0..CORNERS).map(corner).collect::<Vec<_>>(), false)]
        }
        Shape::Polygon(polygon) => {
            let holes = polygon.holes.iter().map(|hole| turned(hole, true));
            std::iter::once(turned(&polygon.outline, false)).chain(holes).collect()
        }
        Shape::Parts(parts) => parts.iter().flat_map(rings).collect(),
    }
}

/// Whether a point lies in a ring: a ray from it meets an odd number of edges.
fn is_inside(ring: &Ring, at: Vec2) -> bool {
    let edges = ring.iter().zip(ring.iter().cycle().skip(1));
    let meets = |([ax, ay], [bx, by]): (&[f64; 2], &[f64; 2])| {
        (*ay > at.y) != (*by > at.y) && at.x < ax + (bx - ax) * (at.y - ay) / (by - ay)
    };
    edges.filter(|edge| meets(*edge)).count() % 2 == 1
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wall(a: [f64; 2], b: [f64; 2]) -> Segment {
        Segment::new(Vec2::new(a[0], a[1]), Vec2::new(b[0], b[1]))
    }

    #[test]
    fn without_barriers_it_is_the_rectangle_around_the_agents() {
        let mut area = Walkable::new(&[], &[]);
        area.see(1, Vec2::new(0.0, 0.0));
        area.see(2, Vec2::new(4.0, 2.0));
        assert_eq!(area.text(), "POLYGON ((-1 -1, 5 -1, 5 3, -1 3, -1 -1))");
    }

    #[test]
    fn a_closed_room_is_its_inside_and_an_obstacle_is_a_hole() {
        let corners = [[0.0, 0.0], [6.0, 0.0], [6.0, 4.0], [0.0, 4.0], [0.0, 0.0]];
        let walls: Vec<Segment> = corners.windows(2).map(|pair| wall(pair[0], pair[1])).collect();
        let desk = [Shape::rectangle(Vec2::new(2.0, 1.0), Vec2::new(3.0, 2.0))];
        let mut area = Walkable::new(&walls, &desk);
        area.see(1, Vec2::new(1.0, 1.0));
        let text = area.text();
        assert!(text.starts_with("POLYGON ((") && text.matches('(').count() == 3, "{text}");
        for corner in ["0.0005 0.0005", "5.9995 3.9995", "2 1", "3 2"] {
            assert!(text.contains(corner), "{corner} in {text}");
        }
        assert!(!text.contains("-1"), "the outside is no part of it: {text}");
        // An agent on each side of the walls.
        area.see(2, Vec2::new(9.0, 1.0));
        assert!(area.text().starts_with("MULTIPOLYGON "), "{}", area.text());
    }
}
