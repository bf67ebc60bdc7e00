//! The paths of different classes between which a walker can choose: found once a run, from the middle of its start.

use super::terrain::{Terrain, Terrains, middle};
use crate::base::geometry::Vec2;
use crate::model::{AgentId, Leg, Position, Route, Scenario};
use crate::route::roadmap::{DistanceField, alternatives};

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

    /// The corners from a place on: from the farthest one that a body sees from there; the last one is left out.
    pub(super) fn from(&self, terrain: &Terrain, place: Vec2) -> Vec<Vec2> {
        let inner = self.corners.get(1..self.corners.len().saturating_sub(1)).unwrap_or_default();
        let seen = (0..inner.len()).rev().find(|k| terrain.free.is_clear(place, inner[*k]));
        inner[seen.unwrap_or(0).min(inner.len())..].to_vec()
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
    let Route::Legs { legs, .. } = &agent.route else { return Vec::new() };
    let Some(goal) = legs.iter().find_map(|leg| if let Leg::To(goal) = leg { Some(goal) } else { None })
    else {
        return Vec::new();
    };
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
