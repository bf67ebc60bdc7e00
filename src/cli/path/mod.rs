//! `smc path`: the paths and speed profiles of walkers that plan, as tables and pictures; or of a path given by its shape.

mod arguments;
mod shape;

pub(super) use arguments::PathCommand;

use super::complaint;
use super::inputs;
use super::output;
use super::page::{self, Trials};
use super::terminal::{Colors, warn};
use super::values::Model;
use crate::base::random::TrialKey;
use crate::gait;
use crate::kernel::{Program, Run, State};
use crate::library;
use crate::model::{AgentId, Move, Parameter, Route, Scenario, SpeedRule};
use crate::report::ExitCode as Exit;
use crate::report::number::counted;
use crate::report::paths::{self, PlannedPath};
use crate::route::Ways;
use crate::route::path::Piece;
use crate::route::planner::{Speeds, Wish};
use crate::route::profile::{Limits, region};
use crate::syntax::diagnostic::Diagnostic;
use arguments::{Figure, PathFormat};
use std::fmt::Write as _;
use std::sync::Arc;

/// Most rows of a table.
const MOST_ROWS: f64 = 1e6;

/// Runs the command.
pub(super) fn run(arguments: &PathCommand, colors: Colors) -> Exit {
    complaint::end(write(arguments, colors), &[], colors)
}

fn write(arguments: &PathCommand, colors: Colors) -> Result<Exit, Vec<Diagnostic>> {
    let given = [&arguments.scenario, &arguments.shape].into_iter().flatten().count()
        + usize::from(arguments.waypoints.is_some());
    if given != 1 {
        let title = "`smc path` takes a scenario, `--shape` or `--waypoints`";
        let hint = "write for example `smc path models/plaza.scn` or `smc path --shape 'L10 A45/7 L10'`";
        return Err(complaint::argument(title, hint).into());
    }
    let text = match &arguments.scenario {
        Some(scenario) => of_model(arguments, scenario, colors)?,
        None => shape::of_shape(arguments)?,
    };
    output::put(arguments.output.as_deref(), &text)?;
    Ok(Exit::Success)
}

/// The paths of the walkers of a scenario, from where they start in a trial. What was told already is no error to write.
fn of_model(arguments: &PathCommand, scenario: &str, colors: Colors) -> Result<String, Vec<Diagnostic>> {
    let model = Model {
        scenario: scenario.to_owned(),
        set: arguments.set.clone(),
        data: arguments.data.clone(),
        ..Model::default()
    };
    let nothing = Vec::new;
    let (study, inputs::Loaded { inputs, paths }) =
        inputs::load_or_tell(&model, &[], colors).ok_or_else(nothing)?;
    output::guard(arguments.report.as_deref(), &paths)?;
    let world = study.worlds.get(study.base).ok_or_else(nothing)?;
    let ways = Ways::default();
    let mut scenario = Arc::clone(&world.scenario);
    library::find_paths(Arc::make_mut(&mut scenario), arguments.seed, &ways);
    let chosen = chosen(&scenario, arguments.agent.as_deref())?;
    let program = Program::driven(scenario.clone(), gait::drivers(&ways, &scenario, arguments.seed));
    let key = TrialKey { seed: arguments.seed, index: arguments.trial, branch: 0 };
    let (run, _) = Run::of(&program, key.into()).map_err(|fault| {
        let why = crate::engine::no_start(&scenario, fault);
        complaint::argument(format!("trial {} cannot start: {why}", key.index), "choose another `--trial`")
    })?;
    if let Some(path) = &arguments.report {
        let mut list = followed(&scenario, &chosen).into_iter().map(|option| (key.index, option));
        let trials = Trials {
            program: &program,
            scenario: &model.scenario,
            sources: &inputs.sources,
            seed: key.seed,
            list: &mut list,
            last: scenario.horizon,
            replay: page::line(&model).simulate(&[], key.seed, key.index),
        };
        if trials.write(path, colors) != Exit::Success {
            return Err(nothing());
        }
    }
    let walkers = ways.walkers(&scenario, arguments.seed);
    let mut found = Vec::new();
    for id in chosen {
        let declared = scenario.moves.iter().find(|moves| moves.agent == id && moves.paths.is_some());
        let options: Vec<(String, Option<u32>)> = match declared {
            Some(moves) => {
                let class = |option| if let Move::Path(k) = option { Some(k) } else { None };
                moves.options.iter().map(|(name, option)| (name.clone(), class(*option))).collect()
            }
            None => vec![("path 1".to_owned(), None)],
        };
        for (name, path) in options {
            let wish = wish(&scenario, run.state(), id, key, path);
            let agent = scenario.agents[id.0 as usize].name.clone();
            match wish
                .and_then(|wish| walkers.outline(&wish))
                .and_then(|one| Some((one.course?, one.corners, one.terrain)))
            {
                Some((course, corners, terrain)) => {
                    found.push(PlannedPath { agent, name, terrain: Some(terrain), corners, course });
                }
                None => warn(&format!("`{agent}` has no way in trial {}", key.index)),
            }
        }
    }
    let title = &scenario.title;
    match (arguments.format, arguments.figure) {
        (PathFormat::Json, _) => Ok(paths::to_json(&found)),
        (PathFormat::Csv, _) => Ok(table(&found, arguments.dt)?),
        (PathFormat::Text, _) => Ok(told(&found)),
        (PathFormat::Svg, figure) => {
            let picture = match (figure, found.first()) {
                (Figure::Map, _) => paths::map(&scenario, &found, &arguments.at),
                (_, None) => return Err(nothing()),
                (Figure::Speed, Some(first)) => {
                    paths::speed(&[paths::curve(first.agent.clone(), &first.course)], title)
                }
                (Figure::Phase, Some(first)) => {
                    let course = &first.course;
                    let limits = run_limits(run.state(), &scenario, &first.agent).ok_or_else(nothing)?;
                    let region = region(&course.stretches(), limits, course.motion(0.0).speed, 0.0);
                    let curve = paths::curve(first.agent.clone(), course);
                    paths::phase(&region.map_err(|_| nothing())?, &[curve], title)
                }
            };
            Ok(arguments.print.svg(&picture))
        }
    }
}

/// The table of paths, whose length is bounded because it is kept in memory.
fn table(found: &[PlannedPath], dt: f64) -> Result<String, Diagnostic> {
    let rows = found.iter().map(|path| path.course.duration() / dt).sum::<f64>().ceil();
    if rows > MOST_ROWS {
        let title = format!("the table would have {rows} rows, more than {MOST_ROWS}");
        return Err(complaint::argument(title, "write a longer `--dt`, or fewer `--profiles`"));
    }
    Ok(paths::to_csv(found, dt))
}

/// The paths that walkers can be advised to take; none is followed where they have one alone.
fn followed(scenario: &Scenario, walkers: &[AgentId]) -> Vec<Option<(usize, usize)>> {
    let declared = scenario.moves.iter().enumerate();
    let declared = declared.filter(|(_, moves)| moves.paths.is_some() && walkers.contains(&moves.agent));
    let all = declared.flat_map(|(number, moves)| (0..moves.options.len()).map(move |k| Some((number, k))));
    let all: Vec<Option<(usize, usize)>> = all.collect();
    if all.is_empty() { vec![None] } else { all }
}

/// One line for each path.
fn told(paths: &[PlannedPath]) -> String {
    let mut out = String::new();
    for PlannedPath { agent, name, course, .. } in paths {
        let (length, fastest, walked) = (course.path.length(), course.optimum.duration(), course.duration());
        let of = |word, is: fn(&Piece) -> bool| {
            counted(course.path.pieces().iter().filter(|piece| is(piece)).count() as u64, word)
        };
        let lines = of("line", |piece| matches!(piece, Piece::Line { .. }));
        let arcs = of("arc", |piece| matches!(piece, Piece::Arc { .. }));
        let _ = writeln!(
            out,
            "{agent:<14} {name:<16} {length:.2} m, {walked:.2} s (at least {fastest:.2} s), {lines}, {arcs}"
        );
    }
    out
}

/// The limits of an agent of this name.
fn run_limits(state: &State, scenario: &Scenario, name: &str) -> Option<Limits> {
    let id = scenario.agents.iter().position(|agent| agent.name == name)?;
    let slot = state.slot(id, 0);
    let of = |parameter| slot.of(&state.bodies[parameter]);
    Some(Speeds::new(of, 1.0, SpeedRule::Optimal).limits)
}

/// What an agent wants at the start of a trial; none for those who have no route of legs.
fn wish<'a>(
    scenario: &'a Scenario,
    state: &State,
    id: AgentId,
    key: TrialKey,
    path: Option<u32>,
) -> Option<Wish<'a>> {
    let agent = &scenario.agents[id.0 as usize];
    let Route::Legs { legs, .. } = &agent.route else { return None };
    let slot = state.slot(id.0 as usize, 0);
    let of = |parameter: Parameter| slot.of(&state.bodies[parameter]);
    let planner = agent.body.planner.as_ref()?;
    Some(Wish {
        scenario,
        agent: id,
        address: (key, agent.entity, 0),
        motion: (state.position(slot), state.velocity(slot)),
        legs,
        speeds: Speeds {
            rounding: planner.rounding,
            ..Speeds::new(of, of(Parameter::Speed), planner.profile)
        },
        path,
    })
}

/// The agent of a name, or all that plan.
fn chosen(scenario: &Scenario, name: Option<&str>) -> Result<Vec<AgentId>, Diagnostic> {
    let plans = |id: &AgentId| scenario.agents[id.0 as usize].body.planner.is_some();
    let all: Vec<AgentId> = (0..scenario.agents.len() as u32).map(AgentId).filter(plans).collect();
    let Some(name) = name else {
        let hint = "declare a kind that plans: `kind planner: planned { limit speed = 1.5 m/s }`";
        let error = || complaint::argument("nobody plans in this scenario", hint);
        return if all.is_empty() { Err(error()) } else { Ok(all) };
    };
    let names: Vec<&str> = all.iter().map(|id| scenario.agents[id.0 as usize].name.as_str()).collect();
    if let Some(at) = names.iter().position(|known| *known == name.trim()) {
        return Ok(vec![all[at]]);
    }
    let hint = complaint::meant(name, &names, "those who plan are");
    Err(complaint::argument(format!("`{name}` does not plan, or is not there"), hint))
}
