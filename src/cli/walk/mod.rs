//! `smc walk`: many walks of agents, leg by leg.

mod arguments;
mod trials;

pub(super) use arguments::WalkCommand;

use super::complaint;
use super::inputs;
use super::output;
use super::terminal::{Colors, print, warn};
use crate::base::random::{MOST_TRIALS, TrialKey};
use crate::base::visible::visible;
use crate::compile::nearest::nearest;
use crate::engine::{Threads, placeable, smaller};
use crate::gait;
use crate::kernel::Program;
use crate::library;
use crate::model::{Agent, Goal, Position, Scenario};
use crate::report::ExitCode as Exit;
use crate::report::number::{counted, plain};
use crate::report::walked::{self, Walked, WalkedLeg};
use crate::route::Ways;
use crate::syntax::diagnostic::Diagnostic;
use arguments::WalkFormat;
use std::path::Path;
use std::sync::Arc;
use trials::Task;

/// Runs the command.
pub(super) fn run(arguments: &WalkCommand, colors: Colors) -> Exit {
    let inputs::Loaded { inputs, paths, .. } = inputs::load(&arguments.model, &[]);
    complaint::diagnose(&inputs, colors);
    let Some(study) = &inputs.study else { return Exit::Wrong };
    let Some(world) = study.worlds.get(study.base) else { return Exit::Wrong };
    let outputs = [arguments.output.as_deref(), arguments.traces.as_deref()];
    let found = checked(arguments)
        .and_then(|()| {
            if study.worlds.len() > 2 {
                return Err(complaint::argument(
                    "walks cannot be written for a sweep",
                    "write `--set name=value`",
                ));
            }
            outputs.into_iter().try_for_each(|path| output::guard(path, &paths))
        })
        .and_then(|()| placeable(world).map_err(|fault| library::refusal(&fault)))
        .and_then(|()| walks(arguments, &world.scenario));
    let (scenario, walked, is_wrong) = match found {
        Ok(found) => found,
        Err(error) => {
            complaint::tell(&error, &inputs.sources, colors);
            return Exit::Wrong;
        }
    };
    match write(arguments, &scenario, &walked) {
        Ok(()) if is_wrong => Exit::Wrong,
        Ok(()) => Exit::Success,
        Err(error) => {
            complaint::tell(&error, &[], colors);
            Exit::Wrong
        }
    }
}

/// Whether the numbers of a call are possible.
fn checked(arguments: &WalkCommand) -> Result<(), Diagnostic> {
    if arguments.trials == 0 {
        return Err(complaint::argument("`--trials` must be positive (got 0)", "write a number from 1"));
    }
    if arguments.trials > MOST_TRIALS {
        let hint = format!("write a number up to {MOST_TRIALS}");
        return Err(complaint::argument("`--trials` is too large", hint));
    }
    if arguments.threads == Some(0) {
        return Err(complaint::argument("`--threads` must be positive (got 0)", "write a number from 1"));
    }
    let fps = arguments.fps;
    if fps > 0.0 && fps <= 1e6 {
        return Ok(());
    }
    let title = format!("`--fps` must be above 0 and at most 1e6 (got {fps})");
    Err(complaint::argument(title, "write a number of rows a second, such as 120"))
}

/// Runs the trials; and whether the model was wrong in one of them.
fn walks(
    arguments: &WalkCommand,
    scenario: &Arc<Scenario>,
) -> Result<(Arc<Scenario>, Walked, bool), Diagnostic> {
    let ways = Ways::default();
    let mut scenario = Arc::clone(scenario);
    library::find_paths(Arc::make_mut(&mut scenario), arguments.seed, &ways);
    let program = Program::driven(scenario.clone(), gait::drivers(&ways, &scenario, arguments.seed));
    let agents = chosen(&program, &arguments.agent)?;
    let threads = Threads::new(arguments.threads).map_err(|error| {
        complaint::argument(format!("no thread can be started: {error}"), "write fewer `--threads`")
    })?;
    let legs = |agent: usize| scenario.agents[agent].route.goals().count();
    let task = Task {
        program: &program,
        seed: arguments.seed,
        trials: arguments.trials,
        agents: agents.iter().map(|agent| (*agent, legs(*agent))).collect(),
        keeps_places: arguments.traces.is_some()
            || matches!(arguments.format, WalkFormat::Traces | WalkFormat::Svg),
    };
    let mut walked = Walked {
        title: scenario.title.clone(),
        trials: arguments.trials,
        seed: arguments.seed,
        dt: scenario.clock.step_seconds(),
        legs: agents.iter().flat_map(|agent| legs_of(&scenario, &scenario.agents[*agent])).collect(),
        ..Walked::default()
    };
    let (mut is_wrong, mut shrunk) = (false, Vec::new());
    for (trial, outcome) in (0..).zip(task.run(&threads)) {
        let mut first = 0;
        for (walks, (_, legs)) in outcome.walks.into_iter().zip(&task.agents) {
            for (leg, walk) in walked.legs[first..].iter_mut().zip(walks) {
                leg.walks.push(walk);
            }
            first += legs;
        }
        walked.no_way += u64::from(outcome.has_no_way);
        if let Some((reason, wrong)) = outcome.broken {
            is_wrong |= wrong;
            walked.broken.push((trial, reason));
        }
        if outcome.has_shrunk {
            shrunk.push(trial);
        }
    }
    if let Some(first) = shrunk.first() {
        let key = TrialKey { seed: arguments.seed, index: *first, branch: 0 };
        warn(&format!("warning: {}\n", smaller(&program, key, shrunk.len() as u64)));
    }
    Ok((scenario, walked, is_wrong))
}

/// The legs of an agent, without walks.
fn legs_of(scenario: &Scenario, agent: &Agent) -> Vec<WalkedLeg> {
    let scene = &scenario.scene;
    let point = |at: &crate::base::geometry::Vec2| {
        let named = scene.points.iter().find(|(_, known)| known == at);
        named.map_or_else(|| format!("({}, {})", plain(at.x), plain(at.y)), |(name, _)| name.clone())
    };
    let start = match &agent.start.position {
        Position::Point(at) => point(at),
        Position::Within(shape) => {
            let named = scene.regions.iter().find(|region| region.shape == *shape);
            named.map_or_else(|| "start".to_owned(), |region| region.name.clone())
        }
        Position::Near { agent, .. } => format!("near {}", scenario.agents[agent.0 as usize].name),
    };
    let goal = |goal: &Goal| match goal {
        Goal::Point(at) => point(at),
        Goal::Region(id) => scene.regions[id.0 as usize].name.clone(),
    };
    let ends: Vec<String> = std::iter::once(start).chain(agent.route.goals().map(goal)).collect();
    let leg = |(number, ends): (usize, &[String])| WalkedLeg {
        agent: agent.name.clone(),
        steps: agent.body.stepper.is_some(),
        number,
        ends: [ends[0].clone(), ends[1].clone()],
        walks: Vec::new(),
    };
    (1..).zip(ends.windows(2)).map(leg).collect()
}

/// The agents of these names, or all that have a route and are there from the start.
fn chosen(program: &Program, names: &[String]) -> Result<Vec<usize>, Diagnostic> {
    let agents = &program.scenario.agents;
    let walks = |agent: &usize| agents[*agent].route.goals().next().is_some();
    let comes = |agent: &usize| program.arrivals.comes(*agent);
    let all: Vec<usize> = (0..agents.len()).filter(|agent| walks(agent) && !comes(agent)).collect();
    if all.is_empty() {
        let hint = "write a route: `agent worker: operator { at = rack  route = station }`";
        return Err(complaint::argument("no agent has a route from the start", hint));
    }
    if names.is_empty() {
        if (0..agents.len()).any(|agent| comes(&agent)) {
            warn("warning: agents from sources are left out; `smc simulate` writes their traces\n");
        }
        return Ok(all);
    }
    let known = || all.iter().map(|agent| agents[*agent].name.as_str());
    let find = |name: &String| {
        let name = name.trim();
        if let Some(at) = known().position(|known| known == name) {
            return Ok(all[at]);
        }
        let hint = nearest(name, known()).map_or_else(
            || format!("agents with a route are {}", known().take(12).collect::<Vec<_>>().join(", ")),
            |near| format!("did you mean `{near}`?"),
        );
        let title = match agents.iter().position(|agent| agent.name == name) {
            Some(agent) if comes(&agent) => format!("agent `{name}` comes from a source"),
            Some(_) => format!("agent `{name}` has no route"),
            None => format!("unknown agent `{name}`"),
        };
        Err(complaint::argument(title, hint))
    };
    let mut found = names.iter().map(find).collect::<Result<Vec<usize>, _>>()?;
    found.sort_unstable();
    found.dedup();
    Ok(found)
}

fn write(arguments: &WalkCommand, scenario: &Scenario, walked: &Walked) -> Result<(), Diagnostic> {
    let mut bytes = Vec::new();
    let mut left_out = 0;
    let unwritten = |path: &Path, error: &std::io::Error| {
        complaint::output(format!("`{}` cannot be written: {error}", path.display()))
    };
    let internal = |error: std::io::Error| complaint::output(error.to_string());
    match arguments.format {
        WalkFormat::Text => bytes.extend(visible(&walked::to_text(walked)).bytes()),
        WalkFormat::Json => bytes.extend(walked::to_json(walked).bytes()),
        WalkFormat::Csv => walked::write_csv(&mut bytes, walked).map_err(internal)?,
        WalkFormat::Traces => {
            left_out = walked::write_traces(&mut bytes, walked, arguments.fps).map_err(internal)?;
        }
        WalkFormat::Svg => bytes.extend(walked::draw(scenario, walked).bytes()),
    }
    if let Some(path) = &arguments.traces {
        left_out = output::write(path, |out| walked::write_traces(out, walked, arguments.fps))
            .map_err(|error| unwritten(path, &error))?;
    }
    match &arguments.output {
        Some(path) => {
            output::write(path, |out| out.write_all(&bytes)).map_err(|error| unwritten(path, &error))?;
        }
        None => print(&String::from_utf8_lossy(&bytes)).map_err(complaint::output)?,
    }
    if left_out > 0 {
        let walks = counted(left_out, "walk");
        warn(&format!("warning: {walks} without a length in time left out of the traces\n"));
    }
    if !matches!(arguments.format, WalkFormat::Text | WalkFormat::Json) {
        if walked.no_way > 0 {
            warn(&format!("warning: no way to a goal in {}\n", counted(walked.no_way, "trial")));
        }
        if let Some((trial, reason)) = walked.broken.first() {
            let trials = counted(walked.broken.len() as u64, "trial");
            warn(&format!("warning: {trials} broken off, first trial {trial}: {reason}\n"));
        }
    }
    Ok(())
}
