//! People who were recorded and go on exactly as they were seen: after a second nobody does.
//!
//! After 1 to 4.8 s, 0 to 7 % of the recorded persons of hotel, eth, zara and students are in the region that holds 90 % of such
//! trials; with laws of heading and speed it is 81 to 92 % (`docs/replay.md`).

use crate::base::tick::Tick;
use crate::compile::Study;
use crate::compile::study::World;
use crate::logic::{Part, reach};
use crate::model::{Agent, AgentId, Kind, Parameter, Route};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::Diagnostic;

/// How far ahead people may be taken to go on as they were seen, s.
const AHEAD: f64 = 1.0;

/// A law that a hint proposes.
const HINT: &str = "write `heading = recorded + normal(0 deg, 14 deg)` and `speed = wanted * normal(1, 0.15) in 0 m/s .. 3 m/s`; \
                    `smc fit` finds the numbers of a site";

/// A warning where a query looks farther ahead than people go on as they were seen.
pub(super) fn missing(study: &Study, only: &[usize]) -> Option<Diagnostic> {
    let asked = study.queries.iter().filter(|query| only.is_empty() || only.contains(&query.index));
    asked.flat_map(|query| query.ask.worlds()).find_map(|at| {
        let world = study.worlds.get(at)?;
        let scenario = &world.scenario;
        let is_moved =
            |id: AgentId| scenario.moves.iter().any(|moves| moves.agents().any(|agent| agent == id));
        let mut ids = (0..scenario.agents.len() as u32).map(AgentId);
        let agent = ids.find(|&id| goes_on_as_seen(&scenario.agents[id.0 as usize]) && !is_moved(id))?;
        let ahead = world.columns.iter().filter_map(|column| seconds(world, column.root.part()));
        let ahead = ahead.fold(0.0, f64::max);
        if ahead <= AHEAD {
            return None;
        }
        let place = world.place_of(agent)?;
        let said = format!("people go on exactly as they were seen, and a formula looks {ahead} s ahead");
        Some(Diagnostic::warning(Code::W0706, place, said).hint(HINT))
    })
}

/// How far ahead a formula or metric looks, s.
fn seconds(world: &World, part: Part) -> Option<f64> {
    let scenario = &world.scenario;
    let found = reach(&world.tree, part, scenario.horizon, scenario.clock).ok()?;
    let ticks = if found.unbounded { scenario.horizon } else { Tick(found.ticks) };
    Some(scenario.clock.seconds(ticks))
}

/// Whether somebody was seen to walk, and nothing is drawn of how this person goes on.
fn goes_on_as_seen(agent: &Agent) -> bool {
    let start = &agent.start;
    let has_law = start.turn.constant() != Some(0.0)
        || start.own_speed && agent.body[Parameter::Speed].constant().is_none();
    let walks = matches!(agent.body.kind, Kind::Sfm | Kind::Cfs) && start.driving().norm() > 0.0;
    !start.seen.is_empty() && agent.route == Route::Onward && walks && !has_law
}
