//! The plan of a scenario: barriers, regions, starts, and the shortest ways from the starts through all goals.

use super::picture::Picture;
use super::{Drawing, Ink};
use crate::base::geometry::{Bounds, Shape, Vec2};
use crate::model::{Agent, Goal, Leg, Move, Obstacle, Parameter, Position, Route, Scenario, Scene};
use crate::report::number::plain;
use crate::route::{Atlas, Bend};

/// Points of a drawn arc are at most so far apart, rad.
const STEP: f64 = 0.1;

/// Points on each side of a start among which one beside the barriers is sought.
const TRIED: u32 = 12;

/// The place where a way begins; none of a start near somebody.
fn start(scene: &Scene, agent: &Agent, radius: f64) -> Option<Vec2> {
    match &agent.start.position {
        Position::Point(point) => Some(*point),
        Position::Within(shape) => Some(beside_barriers(scene, shape, radius)),
        Position::Near { .. } => None,
    }
}

/// The middle of a shape, or the place next to it at which a body of this radius, m, touches no barrier.
fn beside_barriers(scene: &Scene, shape: &Shape, radius: f64) -> Vec2 {
    let is_free = |p: &Vec2| {
        scene.walls().all(|wall| wall.distance(*p) >= radius)
            && scene.solids().all(|solid| solid.distance(*p) >= radius)
    };
    let (middle, bounds) = (shape.inner_point(), shape.bounds());
    let place = |k: u32| (f64::from(k) + 0.5) / f64::from(TRIED);
    let tried = (0..TRIED * TRIED).map(|k| {
        let share = Vec2::new(place(k % TRIED), place(k / TRIED));
        bounds.low + (bounds.high - bounds.low).component_mul(&share)
    });
    let free = std::iter::once(middle).chain(tried).filter(|p| shape.contains(*p)).filter(is_free);
    free.min_by(|a, b| (a - middle).norm().total_cmp(&(b - middle).norm())).unwrap_or(middle)
}

/// The way of an agent from the middle of its start through all goals of a route: its points and its length, m.
fn way(atlas: &Atlas, agent: &Agent, route: &Route) -> Option<(Vec<Vec2>, f64)> {
    let Route::Legs { legs, .. } = route else { return None };
    let radius = agent.body[Parameter::Radius].draw(0.5);
    let mut points = vec![start(atlas.scene(), agent, radius)?];
    let mut length = 0.0;
    for leg in legs {
        let Leg::To(goal) = leg else { continue };
        let from = *points.last()?;
        if agent.body.finds_ways || agent.body.planner.is_some() {
            let mut way = atlas.way(from, goal, radius)?;
            length += way.length;
            loop {
                points.extend(way.bends.iter().flat_map(along));
                points.push(way.end);
                let Some((portal, _)) = way.over else { break };
                points.push(landing(atlas.scene(), portal, way.end));
                way = atlas.way(*points.last()?, goal, radius)?;
            }
        } else {
            let to = match goal {
                Goal::Point(point) => *point,
                Goal::Region(id) => atlas.scene().regions[id.0 as usize].shape.nearest(from),
            };
            points.push(to);
            length += (to - from).norm();
        }
    }
    (points.len() > 1).then_some((points, length))
}

/// Where one goes on who crosses the line of a portal at a place.
fn landing(scene: &Scene, portal: usize, at: Vec2) -> Vec2 {
    let portal = &scene.storeys.portals[portal];
    let share = (at - portal.line.a).norm() / portal.line.length();
    portal.landing.a + (portal.landing.b - portal.landing.a) * share + portal.onward * 0.01
}

/// Points along an arc.
fn along(bend: &Bend) -> Vec<Vec2> {
    let count = (bend.turn.abs() / STEP).ceil().max(1.0);
    (0..=count as u32).map(|k| bend.at(f64::from(k) / count)).collect()
}

/// People who start and go alike, one of each.
fn shown(scenario: &Scenario) -> Vec<&Agent> {
    let mut shown: Vec<&Agent> = Vec::new();
    for agent in &scenario.agents {
        if shown.last().is_none_or(|last| last.start != agent.start || last.route != agent.route) {
            shown.push(agent);
        }
    }
    shown
}

/// A drawing of barriers, regions and starts with room for some points.
pub fn drawn(scenario: &Scenario, points: impl Iterator<Item = Vec2>) -> Drawing {
    let (scene, shown) = (&scenario.scene, shown(scenario));
    let shapes = scene.regions.iter().map(|region| region.shape.bounds());
    let starts = shown.iter().filter_map(|agent| match &agent.start.position {
        Position::Within(shape) => Some(shape.bounds()),
        _ => None,
    });
    let barriers = scene.barriers.iter().filter_map(|barrier| barrier.obstacle.bounds());
    let corners = shapes.chain(starts).chain(barriers).flat_map(|b| [b.low, b.high]);
    let ends = scene.lines.iter().flat_map(|line| [line.segment.a, line.segment.b]);
    let all = corners.chain(ends).chain(scene.points.iter().map(|(_, point)| *point)).chain(points);
    let bounds = Bounds::around(all).unwrap_or(Bounds { low: Vec2::zeros(), high: Vec2::new(1.0, 1.0) });
    let mut drawing = Drawing::new(bounds);
    for region in scene.shown_regions() {
        drawing.shape(&region.shape, Ink::REGION);
    }
    for line in &scene.lines {
        drawing.line(&[line.segment.a, line.segment.b], Ink::REGION);
    }
    for agent in &shown {
        match &agent.start.position {
            Position::Within(shape) => drawing.shape(shape, Ink::START),
            Position::Point(point) => drawing.dot(*point, Ink::START),
            Position::Near { .. } => {}
        }
    }
    // Doors that may change are drawn open.
    for barrier in &scene.with_closed(0).barriers {
        match &barrier.obstacle {
            Obstacle::Wall(segments) => segments.iter().for_each(|s| drawing.line(&[s.a, s.b], Ink::BARRIER)),
            Obstacle::Solid(shape) => drawing.shape(shape, Ink::BARRIER),
        }
    }
    drawing
}

/// A drawing of the scene and of the starts.
pub fn scene(scenario: &Scenario) -> Drawing {
    drawn(scenario, std::iter::empty())
}

/// The plan of a scenario.
pub fn draw(scenario: &Scenario) -> Picture {
    let atlas = Atlas::new(scenario.scene.with_closed(0).into_owned());
    let shown = shown(scenario);
    let ways = shown.iter().filter_map(|agent| way(&atlas, agent, &agent.route));
    let ways: Vec<(Vec<Vec2>, f64)> = ways.collect();
    let named = routes(&atlas, scenario);
    let all = ways.iter().map(|(points, _)| points).chain(named.iter().map(|(_, points)| points));
    let mut drawing = drawn(scenario, all.flatten().copied());
    for (name, points) in &named {
        drawing.line(points, Ink::ROUTE);
        drawing.text(middle(points), name);
    }
    for (points, length) in &ways {
        drawing.line(points, Ink::WAY);
        drawing.text(middle(points), &format!("{} m", plain((length * 10.0).round() / 10.0)));
    }
    name_places(&mut drawing, scenario);
    if !ways.is_empty() {
        drawing.name(Ink::WAY, "shortest ways");
    }
    if !named.is_empty() {
        drawing.name(Ink::ROUTE, "named routes");
    }
    Picture::plan(if scenario.title.is_empty() { "plan" } else { &scenario.title }, drawing)
}

/// The named routes among the moves of agents, with their ways.
fn routes(atlas: &Atlas, scenario: &Scenario) -> Vec<(String, Vec<Vec2>)> {
    let mut named = Vec::new();
    for moves in &scenario.moves {
        let Some(agent) = scenario.agents.get(moves.agent.0 as usize) else { continue };
        for (label, option) in &moves.options {
            if let Move::Route(number) = option
                && let Some((points, _)) =
                    moves.routes.get(*number).and_then(|route| way(atlas, agent, route))
            {
                named.push((label.trim_start_matches("route ").to_owned(), points));
            }
        }
    }
    named
}

/// Names of regions, lines and points.
pub fn name_places(drawing: &mut Drawing, scenario: &Scenario) {
    for region in scenario.scene.shown_regions() {
        for part in region.shape.parts() {
            drawing.text(part.inner_point(), region.label());
        }
    }
    for line in &scenario.scene.lines {
        drawing.text(0.5 * (line.segment.a + line.segment.b), &line.name);
    }
    for (name, at) in &scenario.scene.points {
        drawing.dot(*at, Ink::REGION);
        drawing.text(*at, name);
    }
}

/// The place half-way along a line.
fn middle(points: &[Vec2]) -> Vec2 {
    let total: f64 = points.windows(2).map(|w| (w[1] - w[0]).norm()).sum();
    let mut left = 0.5 * total;
    for w in points.windows(2) {
        let length = (w[1] - w[0]).norm();
        if left <= length && length > 0.0 {
            return w[0] + (w[1] - w[0]) * (left / length);
        }
        left -= length;
    }
    points[0]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::geometry::Segment;
    use crate::model::Barrier;

    #[test]
    fn a_way_begins_beside_the_wall_that_a_start_spans() {
        let wall = Segment::new(Vec2::new(5.0, 0.0), Vec2::new(5.0, 4.0));
        let barrier = Barrier { name: String::new(), obstacle: Obstacle::Wall(vec![wall]) };
        let scene = Scene { barriers: vec![barrier], ..Scene::default() };
        let shape = Shape::rectangle(Vec2::new(0.0, 0.0), Vec2::new(10.0, 4.0));
        let begin = beside_barriers(&scene, &shape, 0.25);
        let aside = (begin.x - 5.0).abs();
        assert!((0.25..1.0).contains(&aside) && (begin.y - 2.0).abs() < 0.5, "{begin}");
        assert_eq!(beside_barriers(&Scene::default(), &shape, 0.25), Vec2::new(5.0, 2.0));
    }
}
