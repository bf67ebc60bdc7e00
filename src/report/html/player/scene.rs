//! What stands still in a scene, in whole millimetres.

use crate::base::geometry::{Segment, Shape, Vec2};
use crate::base::tick::Clock;
use crate::model::Scenario;
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
                .map(|one| Named { name: one.name.clone(), shape: outline(&one.shape) })
                .collect(),
            points: points.map(|(name, at)| Point { name: name.clone(), at: place(*at) }).collect(),
            groups: groups
                .map(|one| Group {
                    name: one.name.clone(),
                    members: one.members.iter().map(|id| id.0).collect(),
                })
                .collect(),
            agents: scenario.agents.len(),
        }
    }
}
