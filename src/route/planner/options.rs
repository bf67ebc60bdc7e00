//! The paths of different classes between which a walker can choose: found once a run, from the middle of its start.

use super::terrain::{Terrain, Terrains, middle};
use crate::base::geometry::Vec2;
use crate::model::{AgentId, Position, Scenario};
use crate::route::roadmap::{DistanceField, alternatives, shortest};

/// Places of a path are at most so far apart, m.
const APART: f64 = 1.0;

/// One path of a class.
#[derive(Clone, Debug, PartialEq)]
pub struct PathOption {
    /// Its corners on the roadmap, from the middle of the start to the middle of the first goal, m.
    pub corners: Vec<Vec2>,
    /// Its length, m.
    pub length: f64,
}

impl PathOption {
    /// Its name among the options, from its number.
    pub fn name(&self, number: u32) -> String {
        format!("path {} ({:.1} m)", number + 1, self.length)
    }

    /// A way of the class from a place to a point of the goal: to the beginning of the path, along it, and on to the point. It is
    /// for shortening, as long as it passes all obstacles on the same sides.
    pub(super) fn way(&self, terrain: &Terrain, place: Vec2, goal: Vec2) -> Option<Vec<Vec2>> {
        let free = &terrain.free;
        let join = |from: Vec2, to: Vec2| {
            if free.is_clear(from, to) {
                Some(vec![from, to])
            } else {
                shortest(&terrain.roadmap, free, from, to)
            }
        };
        let (first, last) = (*self.corners.first()?, *self.corners.last()?);
        let mut way = join(place, first)?;
        way.extend(self.points().into_iter().skip(1));
        way.extend(join(last, goal)?.into_iter().skip(1));
        Some(way)
    }

    /// The corners, and places between them at most a metre apart.
    fn points(&self) -> Vec<Vec2> {
        let mut out: Vec<Vec2> = self.corners.first().copied().into_iter().collect();
        for pair in self.corners.windows(2) {
            let count = ((pair[1] - pair[0]).norm() / APART).ceil().max(1.0);
            out.extend((1..=count as u32).map(|k| pair[0] + (pair[1] - pair[0]) * (f64::from(k) / count)));
        }
        out
    }
}

/// At most so many paths of different classes for an agent, the shortest first; none for agents that do not plan or have no goal.
pub fn path_options(
    terrains: &Terrains,
    scenario: &Scenario,
    seed: u64,
    id: AgentId,
    most: usize,
) -> Vec<PathOption> {
    let agent = &scenario.agents[id.0 as usize];
    let Some(goal) = agent.route.goals().next() else { return Vec::new() };
    let Some(terrain) = terrains.of(&scenario.scene, agent, goal, seed) else { return Vec::new() };
    let start = match &agent.start.position {
        Position::Point(point) => *point,
        Position::Within(shape) => shape.inner_point(),
        Position::Near { agent, .. } => match &scenario.agents[agent.0 as usize].start.position {
            Position::Point(point) => *point,
            Position::Within(shape) => shape.inner_point(),
            Position::Near { .. } => return Vec::new(),
        },
    };
    let field = DistanceField::new(&terrain.roadmap, &terrain.free, middle(&scenario.scene, goal));
    let found = alternatives(&terrain.roadmap, &terrain.free, &field, start, most);
    found.into_iter().map(|one| PathOption { length: one.length, corners: one.path }).collect()
}
