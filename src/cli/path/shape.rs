//! Paths that are given by their shape or by way points: the fastest profile, and drawn ones.

use super::arguments::{Figure, PathCommand, PathFormat, SpeedLaw};
use crate::base::geometry::{Vec2, coordinate_fault};
use crate::base::random::{Purpose, Stream, TrialKey};
use crate::cli::complaint::argument;
use crate::cli::inputs;
use crate::model::Sight;
use crate::model::planner::{PIECES_PER_METRE, RoundingRule};
use crate::report::paths::{self, PlannedPath, PrintedRun};
use crate::route::path::{Path, PathShape, ShapeError, round_by};
use crate::route::planner::{Course, pieces_of, stretches};
use crate::route::profile::{
    Infeasible, Law, Limits, Optimum, Printed, Region, Stretch, Varied, Variety, optimal, printed, region,
    varied,
};
use crate::syntax::diagnostic::Diagnostic;
use std::fmt::Write as _;

/// Least share of the largest speed squared that profiles draw.
const FLOOR: f64 = 0.1;
/// Draws of one profile.
const DRAWS: u32 = 1 << 10;
/// Most runs of the printed algorithm that are told one by one.
const SHOWN: usize = 10;

/// No profile keeps the limits.
fn wrong(error: Infeasible) -> Diagnostic {
    argument(format!("this path has no profile: {error}"), "change a limit or an end speed")
}

/// A path by its shape or its way points.
pub(super) fn of_shape(arguments: &PathCommand) -> Result<String, Diagnostic> {
    let (stretches, path, corners) = match (&arguments.shape, &arguments.waypoints) {
        (Some(text), _) => {
            let shape: PathShape = text.parse().map_err(|error: ShapeError| {
                let title = format!("`--shape` cannot be read: {error}");
                argument(title, "write for example `--shape 'L10 A45/7 L10'`")
            })?;
            (shape.stretches(), shape.path(), Vec::new())
        }
        (None, Some(file)) => {
            let corners = way_points(file)?;
            let rule = if arguments.half_edges { RoundingRule::HalfEdges } else { RoundingRule::Shared };
            let path = round_by(&corners, (arguments.corner, rule), 0.0, &Sight::default());
            (stretches(&path), path, corners)
        }
        (None, None) => (Vec::new(), Path::empty(Vec2::zeros()), Vec::new()),
    };
    let limits = Limits {
        speed: arguments.speed,
        along: arguments.acceleration,
        across: arguments.across.unwrap_or(arguments.acceleration),
    };
    let ends = (arguments.start_speed, arguments.end_speed);
    let optimum = optimal(&stretches, limits, ends.0, ends.1).map_err(wrong)?;
    let mut courses: Vec<Course> = Vec::new();
    for number in 0..arguments.profiles {
        let varied = profile(arguments, &stretches, limits, number).map_err(wrong)?;
        let course = || Course { path: path.clone(), optimum: optimum.clone(), varied: varied.clone() };
        courses.extend(varied.is_some().then(course));
    }
    let runs = runs(arguments, &stretches, limits).map_err(wrong)?;
    let title = match (&arguments.shape, &arguments.waypoints) {
        (Some(shape), _) => shape.clone(),
        _ => "path through way points".to_owned(),
    };
    let alone = || Course { path: path.clone(), optimum: optimum.clone(), varied: None };
    let curves = || {
        let drawn = courses.iter().zip(1..).map(|(course, k)| paths::curve(format!("profile {k}"), course));
        let drawn: Vec<_> = drawn.chain(paths::printed_curves(&runs)).collect();
        let is_alone = drawn.is_empty() && arguments.by != SpeedLaw::Printed;
        if is_alone { vec![paths::curve("fastest".to_owned(), &alone())] } else { drawn }
    };
    let named = |(k, course): (usize, &Course)| PlannedPath {
        agent: "shape".to_owned(),
        name: format!("profile {}", k + 1),
        terrain: None,
        corners: corners.clone(),
        course: course.clone(),
    };
    match (arguments.format, arguments.figure) {
        (PathFormat::Text, _) => Ok(tell_shape(arguments, &optimum, limits, &courses, &runs)),
        (PathFormat::Svg, figure) => {
            let picture = match figure {
                Figure::Phase => {
                    let region: Region = region(&stretches, limits, ends.0, ends.1).map_err(wrong)?;
                    paths::phase(&region, &curves(), &title)
                }
                Figure::Speed => paths::speed(&curves(), &title),
                Figure::Map => {
                    let first = courses.first().cloned().unwrap_or_else(alone);
                    paths::map_of_shape(&named((0, &first)), &arguments.at, &title)
                }
            };
            Ok(arguments.print.svg(&picture))
        }
        (PathFormat::Json, _) if arguments.by == SpeedLaw::Printed => Ok(paths::printed_to_json(&runs)),
        (PathFormat::Csv, _) if arguments.by == SpeedLaw::Printed => Ok(paths::printed_to_csv(&runs)),
        (format, _) => {
            let all = if courses.is_empty() { vec![alone()] } else { courses };
            let found: Vec<PlannedPath> = all.iter().enumerate().map(named).collect();
            Ok(if format == PathFormat::Json {
                paths::to_json(&found)
            } else {
                super::table(&found, arguments.dt)?
            })
        }
    }
}

/// The runs of Algorithm 1 as printed, if they are asked for.
fn runs(
    arguments: &PathCommand,
    stretches: &[Stretch],
    limits: Limits,
) -> Result<Vec<PrintedRun>, Infeasible> {
    let count = if arguments.by == SpeedLaw::Printed { arguments.profiles } else { 0 };
    let stream = stream(arguments);
    let run = |number: u32| {
        let draw = |k: u32| stream.uniform(number * DRAWS + k % DRAWS);
        let pieces = arguments.pieces.map(|pieces| pieces as usize);
        let run = printed(stretches, limits, arguments.start_speed, arguments.end_speed, pieces, draw)?;
        Ok((format!("profile {}", number + 1), run))
    };
    (0..count).map(run).collect()
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
) -> Result<Option<Varied>, Infeasible> {
    let law = match arguments.by {
        SpeedLaw::Printed => return Ok(None),
        SpeedLaw::Uniform => Law::Uniform,
        SpeedLaw::Varied => Law::Preferred { speed: 0.85 * limits.speed, spread: 0.15 },
    };
    let length: f64 = stretches.iter().map(|stretch| stretch.length).sum();
    let by_length = || pieces_of(PIECES_PER_METRE, length);
    let pieces = arguments.pieces.map_or_else(by_length, |pieces| pieces as usize);
    let variety = Variety { pieces, floor: FLOOR, law };
    let stream = stream(arguments);
    let draw = |knot: u32| stream.uniform_pair(number * DRAWS + knot % DRAWS);
    let found = varied(stretches, limits, arguments.start_speed, arguments.end_speed, &variety, draw)?;
    Ok(Some(arguments.duration.and_then(|duration| found.scaled_to(duration)).unwrap_or(found)))
}

/// The fastest time with all its digits, the speeds at the joints, and how many profiles came about and are legal.
fn tell_shape(
    arguments: &PathCommand,
    optimum: &Optimum,
    limits: Limits,
    courses: &[Course],
    runs: &[PrintedRun],
) -> String {
    let speeds: Vec<String> = optimum.node_speeds().map(|speed| format!("{speed:.6}")).collect();
    let mut out = format!("optimal_s {:.17}\n", optimum.duration());
    let _ = writeln!(out, "length {:.6} m\nspeeds at the joints {} m/s", optimum.length(), speeds.join(", "));
    if arguments.by == SpeedLaw::Printed {
        let profiles = runs.iter().filter_map(|(_, run)| match run {
            Printed::Profile(profile) => Some(profile.violations().any()),
            Printed::NeverReturns(_) => None,
        });
        let (legal, broken): (Vec<bool>, Vec<bool>) = profiles.partition(|breaks| !breaks);
        let (legal, returned) = (legal.len(), legal.len() + broken.len());
        let _ =
            writeln!(out, "{returned} of {} profiles returned, {legal} of them keep every limit", runs.len());
        for (name, run) in runs.iter().take(SHOWN) {
            let _ = match run {
                Printed::NeverReturns(why) => writeln!(out, "  {name:<12} never returns: {}", why.phrase()),
                Printed::Profile(profile) if profile.violations().any() => {
                    writeln!(out, "  {name:<12} {}", profile.violations().names().join(", "))
                }
                Printed::Profile(profile) => writeln!(out, "  {name:<12} legal, {:.2} s", profile.duration()),
            };
        }
        if runs.len() > SHOWN {
            let _ = writeln!(out, "  and {} more: see `--format csv`", runs.len() - SHOWN);
        }
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
    out
}

/// The way points of a CSV file with the columns `x` and `y`, m.
fn way_points(file: &std::path::Path) -> Result<Vec<Vec2>, Diagnostic> {
    let wrong = |title| argument(title, "write a CSV file with the columns `x` and `y` in metres");
    let name = file.display().to_string();
    let bytes = inputs::read(&name).map_err(wrong)?;
    let mut reader = csv::Reader::from_reader(bytes.as_slice());
    let header = reader.headers().cloned().unwrap_or_default();
    let column = |of: &str| header.iter().position(|known| known.trim() == of);
    let (Some(x), Some(y)) = (column("x"), column("y")) else {
        return Err(wrong(format!("`{name}` has no columns `x` and `y`")));
    };
    let mut points = Vec::new();
    for (k, record) in reader.records().enumerate() {
        let number = |record: &csv::StringRecord, at: usize| -> Option<f64> {
            record.get(at)?.trim().parse().ok().filter(|v: &f64| v.is_finite())
        };
        let point = record.ok().and_then(|record| Some(Vec2::new(number(&record, x)?, number(&record, y)?)));
        let Some(point) = point else {
            return Err(wrong(format!("`{name}`: line {} has no numbers in `x` and `y`", k + 2)));
        };
        if let Some(fault) = coordinate_fault(point) {
            return Err(wrong(format!("`{name}`: line {}: {fault}", k + 2)));
        }
        points.push(point);
    }
    if points.iter().all(|point| *point == points[0]) {
        return Err(wrong(format!("`{name}` needs two different points")));
    }
    Ok(points)
}
