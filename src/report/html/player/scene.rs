//! What stands still in a scene, in whole millimetres.

use crate::base::geometry::{Segment, Shape, Vec2};
use crate::base::tick::Clock;
use crate::model::{self, Goal, Leg, Move, Moves, Route, Scenario};
use serde::Serialize;

/// A scene and what the names of its agents are grouped by.
#[derive(Debug, Serialize)]
pub(super) struct Scene {
    unit: &'static str,
    /// Pieces of walls, `[x, y, x, y]`.
    walls: Vec<[i64; 4]>,
    solids: Vec<Outline>,
    regions: Vec<Named>,
    points: Vec<Point>,
    groups: Vec<Group>,
    options: Vec<Options>,
    /// Number of agents.
    agents: usize,
}

/// A shape: a circle or rings of points, the first around the others, which are holes.
#[derive(Debug, Serialize)]
#[serde(rename_all = "lowercase")]
enum Outline {
    /// `[x, y, radius]`
    Circle([i64; 3]),
    /// Of each ring x and y in turn.
    Rings(Vec<Vec<i64>>),
}

#[derive(Debug, Serialize)]
struct Named {
    name: String,
    shape: Outline,
}

#[derive(Debug, Serialize)]
struct Point {
    name: String,
    at: [i64; 2],
}

#[derive(Debug, Serialize)]
struct Group {
    name: String,
    members: Vec<u32>,
}

/// The moves of an agent that a ranking compares.
#[derive(Debug, Serialize)]
struct Options {
    agent: u32,
    /// How long a heading holds, s.
    seconds: f64,
    routes: Vec<NamedRoute>,
    headings: Vec<Heading>,
}

#[derive(Debug, Serialize)]
struct NamedRoute {
    label: String,
    /// The goals: x and y in turn.
    points: Vec<i64>,
}

/// A direction: left of that to a goal by an angle, rad.
#[derive(Debug, Serialize)]
struct Heading {
    label: String,
    toward: [i64; 2],
    turn: f64,
}

/// The middles of the goals of a route.
fn goals(scene: &model::Scene, route: &Route) -> Vec<Vec2> {
    let Route::Legs { legs, .. } = route else { return Vec::new() };
    let goal = |leg: &Leg| match leg {
        Leg::To(Goal::Point(point)) => Some(*point),
        Leg::To(Goal::Region(id)) => Some(scene.regions[id.0 as usize].shape.inner_point()),
        _ => None,
    };
    legs.iter().filter_map(goal).collect()
}

fn options(scenario: &Scenario, moves: &Moves) -> Options {
    let route = |(label, option): &(String, Move)| match option {
        Move::Route(number) => {
            let goals = goals(&scenario.scene, moves.routes.get(*number)?);
            Some(NamedRoute { label: label.clone(), points: goals.into_iter().flat_map(place).collect() })
        }
        _ => None,
    };
    let own = scenario.agents.get(moves.agent.0 as usize);
    let toward = own.and_then(|agent| goals(&scenario.scene, &agent.route).first().copied());
    let heading = |(label, option): &(String, Move)| match option {
        Move::Heading(turn) => Some(Heading { label: label.clone(), toward: place(toward?), turn: *turn }),
        _ => None,
    };
    Options {
        agent: moves.agent.0,
        seconds: scenario.clock.seconds(moves.duration),
        routes: moves.options.iter().filter_map(route).collect(),
        headings: moves.options.iter().filter_map(heading).collect(),
    }
}

fn millimetres(length: f64) -> i64 {
    (length * 1000.0).round() as i64
}

fn place(at: Vec2) -> [i64; 2] {
    [millimetres(at.x), millimetres(at.y)]
}

fn outline(shape: &Shape) -> Outline {
    match shape {
        Shape::Circle { centre, radius } => {
            let [x, y] = place(*centre);
            Outline::Circle([x, y, millimetres(*radius)])
        }
        Shape::Polygon(polygon) => {
            let rings = std::iter::once(&polygon.outline).chain(&polygon.holes);
            Outline::Rings(rings.map(|ring| ring.iter().flat_map(|at| place(*at)).collect()).collect())
        }
        Shape::Parts(_) => Outline::Rings(Vec::new()),
    }
}

impl Scene {
    pub(super) fn of(scenario: &Scenario) -> Self {
        let wall = |wall: &Segment| {
            let ([a, b], [c, d]) = (place(wall.a), place(wall.b));
            [a, b, c, d]
        };
        let regions = scenario.scene.regions.iter();
        let points = scenario.scene.points.iter();
        let groups = scenario.groups.iter();
        Self {
            unit: if scenario.clock == Clock::Steps { "steps" } else { "s" },
            walls: scenario.scene.walls().map(wall).collect(),
            solids: scenario.scene.solids().map(outline).collect(),
            regions: regions
                .filter(|one| one.is_declared())
                .flat_map(|one| one.shape.parts().iter().map(|part| (one.name.clone(), outline(part))))
                .map(|(name, shape)| Named { name, shape })
                .collect(),
            points: points.map(|(name, at)| Point { name: name.clone(), at: place(*at) }).collect(),
            groups: groups
                .map(|one| Group {
                    name: one.name.clone(),
                    members: one.members.iter().map(|id| id.0).collect(),
                })
                .collect(),
            options: scenario.moves.iter().map(|moves| options(scenario, moves)).collect(),
            agents: scenario.agents.len(),
        }
    }
}
