//! `smc walk`: many walks of agents, leg by leg.

mod trials;

use super::page::Trials;
use super::terminal::{Colors, warn};
use super::values::{Cores, Limit, Model, Print, parse_rate, parse_trials, threads};
use super::{complaint, inputs, output, page};
use crate::base::geometry::Vec2;
use crate::base::random::TrialKey;
use crate::base::visible::visible;
use crate::engine::traces::FIRST;
use crate::engine::{placeable, smaller};
use crate::kernel::Program;
use crate::model::{Agent, Goal, Position, Scenario};
use crate::report::number::{counted, plain};
use crate::report::walked::{Walked, WalkedLeg};
use crate::report::{ExitCode as Exit, walked};
use crate::route::Ways;
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::source::Source;
use crate::{gait, library};
use clap::{Args, ValueEnum};
use std::num::NonZeroU64;
use std::path::PathBuf;
use std::sync::Arc;
use trials::Task;

/// Runs the command.
pub(super) fn run(arguments: &WalkCommand, colors: Colors) -> Exit {
    let Some((study, inputs::Loaded { inputs, paths })) = inputs::load_or_tell(&arguments.model, &[], colors)
    else {
        return Exit::Wrong;
    };
    let Some(world) = study.worlds.get(study.base) else { return Exit::Wrong };
    let sweep = || complaint::argument("walks cannot be written for a sweep", "write `--set name=value`");
    let is_one = if study.worlds.len() > 2 { Err(sweep()) } else { Ok(()) };
    let done = is_one
        .and_then(|()| output::guard(arguments.output.as_deref(), &paths))
        .and_then(|()| output::guard(arguments.report.as_deref(), &paths))
        .and_then(|()| placeable(world).map_err(|fault| library::refusal(&fault)))
        .and_then(|()| walk(arguments, Arc::clone(&world.scenario), (&inputs.sources, colors)));
    complaint::end(done, &inputs.sources, colors)
}

/// Runs the trials and writes what they gave.
fn walk(
    arguments: &WalkCommand,
    mut scenario: Arc<Scenario>,
    (sources, colors): (&[Source], Colors),
) -> Result<Exit, Diagnostic> {
    let ways = Ways::default();
    library::find_paths(Arc::make_mut(&mut scenario), arguments.seed, &ways);
    let program = Program::driven(scenario.clone(), gait::drivers(&ways, &scenario, arguments.seed));
    let agents = chosen(&program, &arguments.agent)?;
    let threads = threads(arguments.cores.threads)?;
    let task = Task {
        program: &program,
        seed: arguments.seed,
        trials: arguments.trials.get(),
        agents: agents.iter().map(|k| (*k, scenario.agents[*k].route.goals().count())).collect(),
        keeps_places: matches!(arguments.format, WalkFormat::Traces | WalkFormat::Svg),
    };
    let mut walked = Walked {
        title: scenario.title.clone(),
        trials: arguments.trials.get(),
        seed: arguments.seed,
        dt: scenario.clock.step_seconds(),
        legs: agents.iter().flat_map(|agent| legs_of(&scenario, &scenario.agents[*agent])).collect(),
        ..Walked::default()
    };
    let (mut exit, mut shrunk) = (Exit::Success, Vec::new());
    for (trial, outcome) in (0..).zip(task.run(&threads)) {
        let mut first = 0;
        for (walks, (_, legs)) in outcome.walks.into_iter().zip(&task.agents) {
            walked.legs[first..].iter_mut().zip(walks).for_each(|(leg, walk)| leg.walks.push(walk));
            first += legs;
        }
        walked.no_way += u64::from(outcome.has_no_way);
        walked.broken.extend(outcome.broken.map(|reason| (trial, reason)));
        // As a check of the same trials would.
        exit = if outcome.is_wrong { Exit::Wrong } else { exit };
        shrunk.extend(outcome.has_shrunk.then_some(trial));
    }
    write(arguments, &scenario, &walked)?;
    if let Some(path) = &arguments.report {
        let trials = arguments.trials.get().min(FIRST);
        let line = page::line(&arguments.model).simulate(&[], arguments.seed, 0);
        let trials = Trials {
            program: &program,
            scenario: &arguments.model.scenario,
            sources,
            seed: arguments.seed,
            list: &mut (0..trials).map(|index| (index, None)),
            last: scenario.horizon,
            replay: format!("{line} -n {trials}"),
        };
        exit = exit.worse(trials.write(path, colors));
    }
    if let Some(first) = shrunk.first() {
        let key = TrialKey { seed: arguments.seed, index: *first, branch: 0 };
        warn(&format!("warning: {}\n", smaller(&program, key, shrunk.len() as u64)));
    }
    if walked.no_way > 0 {
        warn(&format!("warning: an agent has no way to a goal in {}\n", counted(walked.no_way, "trial")));
    }
    if let Some((trial, reason)) = walked.broken.first() {
        let trials = counted(walked.broken.len() as u64, "trial");
        warn(&format!("warning: {trials} broken off: trial {trial} {reason}\n"));
    }
    Ok(exit)
}

/// The legs of an agent, without walks.
fn legs_of(scenario: &Scenario, agent: &Agent) -> Vec<WalkedLeg> {
    let scene = &scenario.scene;
    let point = |at: &Vec2| {
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
    let walks = |k: &usize| agents[*k].route.goals().next().is_some() && !program.arrivals.comes(*k);
    let all: Vec<usize> = (0..agents.len()).filter(walks).collect();
    if all.is_empty() {
        let hint = "write a route: `agent worker: operator { at = rack; route = station }`";
        return Err(complaint::argument("no agent has a route from the start of a trial on", hint));
    }
    if names.is_empty() {
        if (0..agents.len()).any(|k| program.arrivals.comes(k)) {
            warn("warning: agents from sources are left out; `smc simulate` writes their traces\n");
        }
        return Ok(all);
    }
    let known: Vec<&str> = all.iter().map(|k| agents[*k].name.as_str()).collect();
    let find = |name: &String| {
        let hint = || complaint::meant(name, &known, "agents with a route are");
        let title = if agents.iter().any(|agent| agent.name == *name) {
            format!("agent `{name}` has no route from the start of a trial on")
        } else {
            format!("unknown agent `{name}`")
        };
        let found = known.iter().position(|known| known == name).map(|at| all[at]);
        found.ok_or_else(|| complaint::argument(title, hint()))
    };
    let mut found = names.iter().map(find).collect::<Result<Vec<usize>, _>>()?;
    found.sort_unstable();
    found.dedup();
    Ok(found)
}

fn write(arguments: &WalkCommand, scenario: &Scenario, walked: &Walked) -> Result<(), Diagnostic> {
    let text = match arguments.format {
        WalkFormat::Text => visible(&walked::to_text(walked)).into_owned(),
        WalkFormat::Json => walked::to_json(walked),
        WalkFormat::Csv => output::table(|out| walked::write_csv(out, walked))?,
        WalkFormat::Svg => arguments.print.svg(&walked::draw(scenario, walked)),
        WalkFormat::Traces => output::table(|out| {
            let left_out = walked::write_traces(out, walked, arguments.fps)?;
            if left_out > 0 {
                warn(&format!("warning: {} that took no time left out\n", counted(left_out, "walk")));
            }
            Ok(())
        })?,
    };
    output::put(arguments.output.as_deref(), &text)
}

// The options of `smc walk`.

/// `smc walk`
#[derive(Args, Debug)]
pub(in crate::cli) struct WalkCommand {
    /// The model.
    #[command(flatten)]
    pub(in crate::cli) model: Model,
    /// The time that the call may take.
    #[command(flatten)]
    pub(in crate::cli) limit: Limit,
    /// Only this agent: `worker`, `people[1]`; all agents with a route by default. May be given several times.
    #[arg(long, value_name = "NAME")]
    pub(in crate::cli) agent: Vec<String>,
    /// Number of trials.
    #[arg(short = 'n', long, default_value = "100", value_name = "N", value_parser = parse_trials)]
    pub(in crate::cli) trials: NonZeroU64,
    /// Seed of all random numbers.
    #[arg(long, default_value_t = 0)]
    pub(in crate::cli) seed: u64,
    /// Threads.
    #[command(flatten)]
    pub(in crate::cli) cores: Cores,
    /// Format of the output.
    #[arg(long, value_enum, default_value_t = WalkFormat::Text)]
    pub(in crate::cli) format: WalkFormat,
    /// How wide a picture is.
    #[command(flatten)]
    pub(in crate::cli) print: Print,
    /// Rows of a trace for each second.
    #[arg(long, default_value = "120", value_name = "RATE", value_parser = parse_rate)]
    pub(in crate::cli) fps: f64,
    /// File to write instead of standard output.
    #[arg(short, long, value_name = "FILE")]
    pub(in crate::cli) output: Option<PathBuf>,
    /// Also write a self-contained HTML page that plays the first eight trials.
    #[arg(long, value_name = "FILE.html")]
    pub(in crate::cli) report: Option<PathBuf>,
}

/// Formats of `smc walk`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(in crate::cli) enum WalkFormat {
    /// For people.
    Text,
    /// One object; see docs/schema/legs.schema.json.
    Json,
    /// One row for each leg.
    Csv,
    /// One row for each place of each walk: `walk,leg,t,x,y,heading,foot,step`.
    Traces,
    /// A picture of all walks.
    Svg,
}
