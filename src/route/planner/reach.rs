//! Whether a roadmap leads where a walker goes, before the first trial. An exact way may exist that no roadmap has: vertices are
//! drawn, and lie in a box.

use super::terrain::{Terrain, Terrains};
use crate::base::geometry::Vec2;
use crate::model::{AgentId, RoadmapRule, Scenario};
use crate::route::roadmap::DistanceField;
use crate::route::survey::{Doubt, DoubtKind, Place, Stretch, stretches};

/// A start is looked at in so many rows of so many places, and a goal.
const ROWS: u32 = 8;
const GOAL_ROWS: u32 = 3;

/// The first thing that is doubtful about the roadmap of an agent, called `who`; `None` for agents that do not plan, and among
/// levels, where each has a roadmap of its own.
pub fn doubt(terrains: &Terrains, scenario: &Scenario, seed: u64, id: AgentId, who: &str) -> Option<Doubt> {
    let scene = &scenario.scene;
    let agent = &scenario.agents[id.0 as usize];
    let planner = agent.body.planner.as_ref().filter(|_| scene.storeys.are_none())?;
    for Stretch { origin, goal, end, name } in stretches(scene, agent) {
        let terrain = terrains.of(scene, agent, goal, seed)?;
        let free = |place: Place<'_>, rows: u32| {
            let all = place.places(scene, rows);
            let free: Vec<Vec2> = all.iter().copied().filter(|p| terrain.free.is_free(*p)).collect();
            if free.is_empty() { all } else { free }
        };
        let ends = free(end, GOAL_ROWS);
        let fields: Vec<DistanceField> =
            ends.iter().map(|p| DistanceField::new(&terrain.roadmap, &terrain.free, *p)).collect();
        let leads = |from| fields.iter().any(|to| to.path(&terrain.roadmap, &terrain.free, from).is_some());
        let number = terrain.roadmap.vertices().len();
        if number < 2 {
            let vertices = if number == 1 { "only one vertex" } else { "no vertices" };
            let said = format!("the roadmap of `{}` has {vertices}", planner.kind);
            return Some(Doubt {
                agent: id,
                kind: DoubtKind::Sometimes,
                said,
                between: None,
                hint: hint(&terrain),
            });
        }
        let Some((from, from_name)) = origin else { continue };
        let places = free(from, ROWS);
        let count = places.iter().filter(|p| leads(**p)).count();
        if count == places.len() {
            continue;
        }
        let path = format!("no path on the roadmap of `{}`, seed {seed}, leads {who}", planner.kind);
        let (all, without) = (places.len(), places.len() - count);
        let said = match count {
            0 => format!("{path} from {from_name} to {name}"),
            _ => format!("{path} to {name} from {without} of {all} places of {from_name}"),
        };
        let kind = if count == 0 { DoubtKind::Never } else { DoubtKind::Sometimes };
        return Some(Doubt { agent: id, kind, said, between: None, hint: hint(&terrain) });
    }
    None
}

/// What would make a roadmap lead farther.
fn hint(terrain: &Terrain) -> String {
    let round = |v: f64| (v * 100.0).round() / 100.0;
    let (low, high) = (terrain.free.bounds().low, terrain.free.bounds().high);
    let size = match terrain.planner().roadmap {
        RoadmapRule::Prm { .. } => "make `clearance` or `separation` smaller",
        RoadmapRule::Rrt { .. } => "make `clearance` smaller",
    };
    format!(
        "vertices lie in the box ({}, {}) .. ({}, {}) m around all barriers, regions and points: a `point` outside of it makes it larger; or {size}, or draw more samples",
        round(low.x),
        round(low.y),
        round(high.x),
        round(high.y),
    )
}
