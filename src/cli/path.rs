//! `smc path`: the paths and speed profiles of walkers that plan, as tables and pictures; or of a path given by its shape.

use super::arguments::{Figure, Model, PathCommand, PathFormat, SpeedLaw};
use super::complaint;
use super::inputs;
use super::output;
use super::terminal::{Colors, print, warn};
use crate::base::geometry::Vec2;
use crate::base::random::{Purpose, Stream, TrialKey};
use crate::compile::nearest::nearest;
use crate::kernel::{Program, Run, State};
use crate::library;
use crate::model::{AgentId, Move, Parameter, Route, Scenario, Sight, SpeedRule};
use crate::report::ExitCode as Exit;
use crate::report::paths::{self, PlannedPath};
use crate::route::Ways;
use crate::route::path::{Path, PathShape, round};
use crate::route::planner::{Course, Speeds, Wish};
use crate::route::profile::{
    Law, Limits, Printed, Region, Stretch, Variety, optimal, printed, region, varied,
};
use std::fmt::Write as _;
use std::sync::Arc;

/// Least share of the largest speed squared that profiles draw.
const FLOOR: f64 = 0.1;
/// Draws of one profile.
const DRAWS: u32 = 1 << 10;

/// Why the call is wrong, and what to write.
type Refusal = (String, String);

/// Runs the command.
pub(super) fn run(arguments: &PathCommand, colors: Colors) -> Exit {
    let given = [&arguments.scenario, &arguments.shape].into_iter().flatten().count()
        + usize::from(arguments.waypoints.is_some());
    if given != 1 {
        let error = complaint::argument(
            "`smc path` takes a scenario, `--shape` or `--waypoints`",
            "write for example `smc path models/plaza.scn` or `smc path --shape 'L10 A45/7 L10'`",
        );
        complaint::tell(&error, &[], colors);
        return Exit::Wrong;
    }
    let text = match &arguments.scenario {
        Some(scenario) => match of_model(arguments, scenario, colors) {
            Ok(text) => text,
            Err(exit) => return exit,
        },
        None => match of_shape(arguments) {
            Ok(text) => text,
            Err((reason, hint)) => {
                complaint::tell(&complaint::argument(reason, hint), &[], colors);
                return Exit::Wrong;
            }
        },
    };
    let written = match &arguments.output {
        Some(path) => output::write(path, |out| out.write_all(text.as_bytes()))
            .map_err(|error| format!("`{}` cannot be written: {error}", path.display())),
        None => print(&text),
    };
    match written {
        Ok(()) => Exit::Success,
        Err(reason) => {
            complaint::tell(&complaint::output(reason), &[], colors);
            Exit::Wrong
        }
    }
}

/// The paths of the walkers of a scenario, from where they start in a trial.
fn of_model(arguments: &PathCommand, scenario: &str, colors: Colors) -> Result<String, Exit> {
    let model =
        Model { scenario: scenario.to_owned(), set: arguments.set.clone(), data: arguments.data.clone() };
    let inputs = inputs::load(&model, &[]).inputs;
    complaint::diagnose(&inputs, colors);
    let Some(study) = &inputs.study else { return Err(Exit::Wrong) };
    let Some(world) = study.worlds.get(study.base) else { return Err(Exit::Wrong) };
    let refuse = |(reason, hint): Refusal| {
        complaint::tell(&complaint::argument(reason, hint), &[], colors);
        Exit::Wrong
    };
    let ways = Ways::default();
    let mut scenario = Arc::clone(&world.scenario);
    library::find_paths(Arc::make_mut(&mut scenario), arguments.seed, &ways);
    let chosen = chosen(&scenario, arguments.agent.as_deref()).map_err(refuse)?;
    let program = Program::driven(scenario.clone(), ways.drivers(&scenario, arguments.seed));
    let key = TrialKey { seed: arguments.seed, index: arguments.trial, branch: 0 };
    let (run, _) = Run::of(&program, key.into()).map_err(|fault| {
        let why = crate::engine::no_start(&scenario, fault);
        refuse((format!("trial {} cannot start: {why}", key.index), "choose another `--trial`".to_owned()))
    })?;
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
        (PathFormat::Csv, _) => Ok(paths::to_csv(&found, arguments.dt)),
        (PathFormat::Text, _) => Ok(told(&found)),
        (PathFormat::Svg, Figure::Map) => Ok(paths::map(&scenario, &found)),
        (PathFormat::Svg, figure) => {
            let Some(first) = found.first() else { return Err(Exit::Wrong) };
            let course = &first.course;
            if figure == Figure::Speed {
                return Ok(paths::speed(std::slice::from_ref(course), title));
            }
            let limits = run_limits(run.state(), &scenario, &first.agent);
            let region = limits
                .and_then(|limits| region(&course.stretches(), limits, course.motion(0.0).speed, 0.0).ok());
            region.map(|region| paths::phase(&region, std::slice::from_ref(course), title)).ok_or(Exit::Wrong)
        }
    }
}

/// One line for each path.
fn told(paths: &[PlannedPath]) -> String {
    let mut out = String::new();
    for PlannedPath { agent, name, course, .. } in paths {
        let (length, fastest, walked) = (course.path.length(), course.optimum.duration(), course.duration());
        let _ = writeln!(
            out,
            "{agent:<14} {name:<16} {length:.2} m, {walked:.2} s (at least {fastest:.2} s), {} pieces",
            course.path.pieces().len()
        );
    }
    out
}

/// The limits of an agent of this name.
fn run_limits(state: &State, scenario: &Scenario, name: &str) -> Option<Limits> {
    let id = scenario.agents.iter().position(|agent| agent.name == name)?;
    let slot = state.slot(id, 0);
    let of = |parameter| state.bodies[parameter][slot.block].0[slot.lane];
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
    let at = |field: &[crate::base::lanes::Lanes]| field[slot.block].0[slot.lane];
    let of = |parameter: Parameter| at(&state.bodies[parameter]);
    Some(Wish {
        scenario,
        agent: id,
        address: (key, agent.entity, 0),
        motion: (
            Vec2::new(at(&state.motion.x), at(&state.motion.y)),
            Vec2::new(at(&state.motion.vx), at(&state.motion.vy)),
        ),
        legs,
        speeds: Speeds::new(of, of(Parameter::Speed), agent.body.planner.as_ref()?.profile),
        path,
    })
}

/// The agent of a name, or all that plan.
fn chosen(scenario: &Scenario, name: Option<&str>) -> Result<Vec<AgentId>, Refusal> {
    let plans = |id: &AgentId| scenario.agents[id.0 as usize].body.planner.is_some();
    let all: Vec<AgentId> = (0..scenario.agents.len() as u32).map(AgentId).filter(plans).collect();
    let Some(name) = name else {
        let hint = "declare a kind that plans: `kind planner: planned { limit speed = 1.5 m/s }`";
        return if all.is_empty() {
            Err(("nobody plans in this scenario".to_owned(), hint.to_owned()))
        } else {
            Ok(all)
        };
    };
    let names: Vec<&str> = all.iter().map(|id| scenario.agents[id.0 as usize].name.as_str()).collect();
    if let Some(at) = names.iter().position(|known| *known == name.trim()) {
        return Ok(vec![all[at]]);
    }
    let hint = nearest(name, names.iter().copied()).map_or_else(
        || format!("those who plan are {}", names.join(", ")),
        |near| format!("did you mean `{near}`?"),
    );
    Err((format!("`{name}` does not plan, or is not there"), hint))
}

/// A path by its shape or its way points.
fn of_shape(arguments: &PathCommand) -> Result<String, Refusal> {
    let (stretches, path) = match (&arguments.shape, &arguments.waypoints) {
        (Some(text), _) => {
            let shape: PathShape = text.parse().map_err(|error: crate::route::path::ShapeError| {
                (
                    format!("`--shape` cannot be read: {error}"),
                    "write for example `--shape 'L10 A45/7 L10'`".to_owned(),
                )
            })?;
            (shape.stretches(), shape.path())
        }
        (None, Some(file)) => {
            let corners = way_points(file)?;
            let path = round(&corners, arguments.corner, 0.0, &Sight::default());
            (crate::route::planner::stretches(&path), path)
        }
        (None, None) => (Vec::new(), Path::empty(Vec2::zeros())),
    };
    let limits = Limits {
        speed: arguments.speed,
        along: arguments.acceleration,
        across: arguments.across.unwrap_or(arguments.acceleration),
    };
    let ends = (arguments.start_speed, arguments.end_speed);
    let wrong = |error: crate::route::profile::Infeasible| {
        (format!("this path has no profile: {error}"), "change a limit or an end speed".to_owned())
    };
    let optimum = optimal(&stretches, limits, ends.0, ends.1).map_err(wrong)?;
    let mut profiles = Vec::new();
    for number in 0..arguments.profiles {
        profiles.push(profile(arguments, &stretches, limits, number).map_err(wrong)?);
    }
    let courses: Vec<Course> = profiles
        .iter()
        .filter_map(Clone::clone)
        .map(|varied| Course { path: path.clone(), optimum: optimum.clone(), varied: Some(varied) })
        .collect();
    let title = arguments.shape.clone().unwrap_or_default();
    match (arguments.format, arguments.figure) {
        (PathFormat::Text, _) => tell_shape(arguments, &stretches, limits, &courses),
        (PathFormat::Svg, Figure::Phase) => {
            let region: Region = region(&stretches, limits, ends.0, ends.1).map_err(wrong)?;
            Ok(paths::phase(&region, &courses, &title))
        }
        (PathFormat::Svg, Figure::Speed) => Ok(paths::speed(&courses, &title)),
        (PathFormat::Svg, Figure::Map) => {
            Err(("a shape has no map".to_owned(), "write `--figure phase` or `--figure speed`".to_owned()))
        }
        (format, _) => {
            let alone = Course { path, optimum, varied: None };
            let all = if courses.is_empty() { vec![alone] } else { courses };
            let named = |(k, course)| PlannedPath {
                agent: "shape".to_owned(),
                name: format!("profile {}", k + 1),
                terrain: None,
                corners: Vec::new(),
                course,
            };
            let found: Vec<PlannedPath> = all.into_iter().enumerate().map(named).collect();
            Ok(if format == PathFormat::Json {
                paths::to_json(&found)
            } else {
                paths::to_csv(&found, arguments.dt)
            })
        }
    }
}

fn stream(arguments: &PathCommand) -> Stream {
    Stream::of(TrialKey { seed: arguments.seed, index: arguments.trial, branch: 0 }, 0, Purpose::Plan)
}

/// A varied profile; none with the printed algorithm, which has no such form.
fn profile(
    arguments: &PathCommand,
    stretches: &[Stretch],
    limits: Limits,
    number: u32,
) -> Result<Option<crate::route::profile::Varied>, crate::route::profile::Infeasible> {
    let law = match arguments.by {
        SpeedLaw::Printed => return Ok(None),
        SpeedLaw::Uniform => Law::Uniform,
        SpeedLaw::Varied => Law::Preferred { speed: 0.85 * limits.speed, spread: 0.15 },
    };
    let variety = Variety { pieces: arguments.pieces, floor: FLOOR, law };
    let stream = stream(arguments);
    let draw = |knot: u32| stream.uniform_pair(number * DRAWS + knot % DRAWS);
    let found = varied(stretches, limits, arguments.start_speed, arguments.end_speed, &variety, draw)?;
    Ok(Some(arguments.duration.and_then(|duration| found.scaled_to(duration)).unwrap_or(found)))
}

/// The fastest time with all its digits, the speeds at the joints, and how many profiles came about and are legal.
fn tell_shape(
    arguments: &PathCommand,
    stretches: &[Stretch],
    limits: Limits,
    courses: &[Course],
) -> Result<String, Refusal> {
    let wrong = |error: crate::route::profile::Infeasible| {
        (format!("this path has no profile: {error}"), "change a limit or an end speed".to_owned())
    };
    let optimum = optimal(stretches, limits, arguments.start_speed, arguments.end_speed).map_err(wrong)?;
    let speeds: Vec<String> = optimum.node_speeds().map(|speed| format!("{speed:.6}")).collect();
    let mut out = format!("optimal_s {:.17}\n", optimum.duration());
    let _ = writeln!(out, "length {:.6} m\nspeeds at the joints {} m/s", optimum.length(), speeds.join(", "));
    if arguments.by == SpeedLaw::Printed {
        let stream = stream(arguments);
        let (mut returned, mut legal) = (0, 0);
        for number in 0..arguments.profiles {
            let draw = |k: u32| stream.uniform(number * DRAWS + k % DRAWS);
            let found = printed(stretches, limits, arguments.start_speed, arguments.end_speed, draw);
            if let Printed::Profile(profile) = found.map_err(wrong)? {
                returned += 1;
                legal += u32::from(!profile.violations().any());
            }
        }
        let _ = writeln!(
            out,
            "{returned} of {} profiles returned, {legal} of them keep every limit",
            arguments.profiles
        );
    } else if !courses.is_empty() {
        let legal = courses.iter().filter(|course| course.is_legal(limits)).count();
        let times: Vec<String> =
            courses.iter().take(10).map(|course| format!("{:.6}", course.duration())).collect();
        let _ = writeln!(
            out,
            "{} of {} profiles returned, {legal} of them keep every limit\ndurations {} s{}",
            courses.len(),
            arguments.profiles,
            times.join(", "),
            if courses.len() > 10 { ", …" } else { "" }
        );
    }
    Ok(out)
}

/// The way points of a CSV file with the columns `x` and `y`, m.
fn way_points(file: &std::path::Path) -> Result<Vec<Vec2>, Refusal> {
    let hint = || "write a CSV file with the columns `x` and `y` in metres".to_owned();
    let name = file.display().to_string();
    let bytes = inputs::read(&name).map_err(|reason| (reason, hint()))?;
    let mut reader = csv::Reader::from_reader(bytes.as_slice());
    let header = reader.headers().cloned().unwrap_or_default();
    let column = |of: &str| header.iter().position(|known| known.trim() == of);
    let (Some(x), Some(y)) = (column("x"), column("y")) else {
        return Err((format!("`{name}` has no columns `x` and `y`"), hint()));
    };
    let mut points = Vec::new();
    for (k, record) in reader.records().enumerate() {
        let number = |record: &csv::StringRecord, at: usize| -> Option<f64> {
            record.get(at)?.trim().parse().ok().filter(|v: &f64| v.is_finite())
        };
        let point = record.ok().and_then(|record| Some(Vec2::new(number(&record, x)?, number(&record, y)?)));
        let Some(point) = point else {
            return Err((format!("`{name}`: line {} has no numbers in `x` and `y`", k + 2), hint()));
        };
        points.push(point);
    }
    Ok(points)
}
