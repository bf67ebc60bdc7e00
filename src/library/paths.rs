//! The options of `paths` declarations: which paths there are is known when the roadmap of the run is drawn.

use crate::base::fingerprint::Fingerprint;
use crate::compile::Study;
use crate::compile::study::{Ask, RankOption};
use crate::model::{Agent, AgentId, Body, GaitRule, Move, Scenario};
use crate::route::Ways;
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::Diagnostic;
use std::collections::BTreeSet;
use std::sync::Arc;

/// Finds the paths of a scenario and names the options after them; those that there are not are left out. The agents without
/// any path.
pub fn find_paths(scenario: &mut Scenario, seed: u64, ways: &Ways) -> Vec<AgentId> {
    let mut moves = scenario.moves.clone();
    let mut without = Vec::new();
    for declared in moves.iter_mut().filter(|moves| moves.paths.is_some()) {
        let found = ways.paths(scenario, seed, declared.agent, declared.options.len());
        let Some(shortest) = found.first().map(|path| path.length) else {
            without.push(declared.agent);
            continue;
        };
        declared.options = (0..).zip(&found).map(|(k, path)| (path.name(k), Move::Path(k))).collect();
        declared.paths = Some(found.iter().map(|path| path.length - shortest).collect());
    }
    scenario.moves = moves;
    without
}

/// What verdicts about some bodies are conditional on: roadmaps, and files of gaits.
fn given<'s>(bodies: impl Iterator<Item = &'s Arc<Body>>, seed: u64) -> Option<String> {
    let (mut kinds, mut gaits) = (BTreeSet::new(), BTreeSet::new());
    for body in bodies {
        kinds.extend(body.planner.as_ref().map(|planner| planner.kind.as_str()));
        if let Some(GaitRule::Learned { file, text }) = body.stepper.as_ref().map(|stepper| &stepper.gait) {
            gaits.insert((file, text));
        }
    }
    let kinds: Vec<&str> = kinds.into_iter().collect();
    let roadmaps = match kinds.as_slice() {
        [] => None,
        [one] => Some(format!("the roadmap of {one}, seed {seed}")),
        all => Some(format!("the roadmaps of {}, seed {seed}", all.join(", "))),
    };
    let gaits = gaits
        .into_iter()
        .map(|(file, text)| format!("the gait {file} ({})", Fingerprint::of(text.as_bytes())));
    let all: Vec<String> = roadmaps.into_iter().chain(gaits).collect();
    (!all.is_empty()).then(|| all.join("; "))
}

/// The condition of results about a program elsewhere.
const PROGRAM: &str = "the given program, if its trials are independent and its seed decides them";

/// The same for all worlds that queries ask about, and for their rankings. An error for each agent without any path. Queries
/// learn what they are given.
pub(super) fn settle(study: &mut Study, seed: u64, ways: &Ways) -> Vec<Diagnostic> {
    let asked: BTreeSet<usize> = study.queries.iter().flat_map(|query| query.ask.worlds()).collect();
    let mut errors = Vec::new();
    for query in &mut study.queries {
        let worlds = query.ask.worlds();
        let bodies = worlds
            .iter()
            .filter_map(|world| study.worlds.get(*world))
            .flat_map(|world| world.scenario.agents.iter().map(|agent| &agent.body));
        query.given = given(bodies, seed);
        let is_played = |world: &usize| {
            study.worlds.get(*world).is_some_and(|world| world.scenario.processes.outside.is_some())
        };
        if worlds.iter().any(is_played) {
            query.given = Some(PROGRAM.to_owned());
            if let Ask::Estimate { level: Some(_), .. } = query.ask {
                let error = error!(E0603, query.span, "trials of a program cannot be split";
                    hint: "estimate it without `by splitting`, which starts trials again from their states");
                errors.push(error);
            }
        }
    }
    for number in asked {
        let Some(world) = study.worlds.get_mut(number) else { continue };
        if world.scenario.moves.iter().all(|moves| moves.paths.is_none()) {
            continue;
        }
        let scenario = Arc::make_mut(&mut world.scenario);
        for agent in find_paths(scenario, seed, ways) {
            let Agent { name, route, .. } = &world.scenario.agents[agent.0 as usize];
            let (said, hint) = if route.goals().next().is_none() {
                (
                    format!("`{name}` has no goal to which paths could lead"),
                    "write `route = GOAL` with the agent",
                )
            } else {
                (
                    format!("no path on the roadmap of seed {seed} leads `{name}` to its goal"),
                    "draw more samples: `roadmap = prm(samples = 1000)`",
                )
            };
            let error = match world.place_of(agent) {
                Some(span) => error!(E0803, span, "{said}"),
                None => Diagnostic::placeless(Code::E0803, said),
            };
            errors.push(error.hint(hint));
        }
        let scenario = &world.scenario;
        for query in &mut study.queries {
            let Ask::Rank { options, .. } = &mut query.ask else { continue };
            let here = |option: &RankOption| option.advice.filter(|_| option.target.world == number);
            // Under every value of a parameter a path stands in several worlds; one of them without it has none to rank.
            let is_missing = |advice: &(usize, usize)| scenario.singles(*advice).is_none();
            let missing: Vec<_> = options.iter().filter_map(here).filter(is_missing).collect();
            options.retain(|option| option.advice.is_none_or(|advice| !missing.contains(&advice)));
            for option in options {
                let Some(advice) = here(option) else { continue };
                let singles = scenario.singles(advice).into_iter().flatten().flatten();
                let mut of_paths = singles.filter(|(of, _)| scenario.moves[*of].paths.is_some());
                let Some((of, k)) = of_paths.next() else { continue };
                let moves = &scenario.moves[of];
                let is_alone = (of, k) == advice;
                let label =
                    if is_alone { Some(moves.options[k].0.clone()) } else { scenario.move_name(advice) };
                let values = option.settings.iter().map(|(name, value)| format!(", {name} = {value}"));
                option.label = label.unwrap_or_default() + &values.collect::<String>();
                if option.settings.is_empty() && is_alone {
                    option.deviation = moves.deviations()[k];
                }
            }
        }
    }
    errors
}
