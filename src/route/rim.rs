//! Scenes in which nothing can stand in the way: all barriers lie on the rim of a convex part of the plane in which everybody
//! starts and has all goals. There everybody goes straight, and no ways are looked for.

use crate::base::geometry::{Segment, Shape, Vec2, cross};
use crate::model::{Goal, Leg, Obstacle, Position, Route, Scenario};

/// The convex hull of points, counterclockwise (Andrew 1979).
fn hull(mut points: Vec<Vec2>) -> Vec<Vec2> {
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    points.dedup();
    let half = |points: &mut dyn Iterator<Item = &Vec2>| {
        let mut chain: Vec<Vec2> = Vec::new();
        for &p in points {
            while let [.., a, b] = *chain.as_slice()
                && cross(b - a, p - a) <= 0.0
            {
                chain.pop();
            }
            chain.push(p);
        }
        chain.pop();
        chain
    };
    let mut out = half(&mut points.iter());
    out.extend(half(&mut points.iter().rev()));
    out
}

fn corners(shape: &Shape) -> Vec<Vec2> {
    match shape {
        Shape::Polygon(polygon) => polygon.outline.clone(),
        Shape::Circle { .. } => {
            let b = shape.bounds();
            vec![b.low, Vec2::new(b.high.x, b.low.y), b.high, Vec2::new(b.low.x, b.high.y)]
        }
    }
}

/// Whether no barrier of a scenario can stand in anybody's way.
pub(super) fn is_open(scenario: &Scenario) -> bool {
    let mut edges: Vec<Segment> = Vec::new();
    for barrier in &scenario.scene.barriers {
        match &barrier.obstacle {
            Obstacle::Wall(segments) => edges.extend(segments),
            Obstacle::Solid(_) => return false,
        }
    }
    let mut points: Vec<Vec2> = edges.iter().flat_map(|edge| [edge.a, edge.b]).collect();
    for agent in &scenario.agents {
        match &agent.start.position {
            Position::Point(point) => points.push(*point),
            Position::Within(shape) => points.extend(corners(shape)),
            Position::Near { .. } if edges.is_empty() => {}
            Position::Near { .. } => return false,
        }
    }
    points.extend(scenario.routes().flat_map(|route| goals(scenario, route)));
    let rim = hull(points);
    let is_on_rim = |edge: &Segment| {
        (0..rim.len()).any(|k| {
            let side = Segment::new(rim[k], rim[(k + 1) % rim.len()]);
            side.distance(edge.a) <= 1e-9 && side.distance(edge.b) <= 1e-9
        })
    };
    edges.iter().all(is_on_rim)
}

fn goals<'a>(scenario: &'a Scenario, route: &'a Route) -> impl Iterator<Item = Vec2> + 'a {
    route.legs().iter().flat_map(|leg| match leg {
        Leg::To(Goal::Point(point)) => vec![*point],
        Leg::To(Goal::Region(id)) => {
            scenario.scene.regions.get(id.0 as usize).map_or(Vec::new(), |region| corners(&region.shape))
        }
        Leg::Wait(_) => Vec::new(),
    })
}
