//! Planned paths as data and as pictures: `smc path`.

use super::number::plain;
use super::svg::frame::Frame;
use super::svg::picture::Picture;
use super::svg::scale::Scale;
use super::svg::{Drawing, Ink, plan};
use crate::base::geometry::{Bounds, Vec2};
use crate::model::Scenario;
use crate::route::path::Piece;
use crate::route::planner::{Course, Terrain};
use crate::route::profile::{Printed, Region};
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::sync::Arc;

/// Points of a curve in a picture.
const POINTS: u32 = 400;
/// Points of a piece of a printed profile.
const PER_PIECE: u32 = 20;

/// A planned path of somebody.
#[derive(Clone, Debug)]
pub struct PlannedPath {
    /// Whose.
    pub agent: String,
    /// Its name among the paths of the agent.
    pub name: String,
    /// Where it was planned; none of a path that was given by its shape.
    pub terrain: Option<Arc<Terrain>>,
    /// Its corners, m.
    pub corners: Vec<Vec2>,
    /// The path and the speeds along it.
    pub course: Course,
}

fn point(p: Vec2) -> Value {
    json!([p.x, p.y])
}

fn piece(piece: &Piece) -> Value {
    match piece {
        Piece::Line { from, to } => json!({ "line": piece.length(), "from": point(*from), "to": point(*to) }),
        Piece::Arc { centre, radius, turn, .. } => json!({
            "arc": piece.length(),
            "centre": point(*centre),
            "radius": radius,
            "from": point(piece.start().position),
            "to": point(piece.end().position),
            "turn": turn,
        }),
        Piece::Turn { at, from, to } => json!({ "stop": point(*at), "from": point(*from), "to": point(*to) }),
    }
}

/// Roadmap, paths and profiles.
pub fn to_json(paths: &[PlannedPath]) -> String {
    let roadmap = paths.iter().find_map(|path| path.terrain.as_ref()).map(|terrain| {
        json!({
            "vertices": terrain.roadmap.vertices().iter().map(|p| point(*p)).collect::<Vec<_>>(),
            "edges": terrain.roadmap.edges(),
        })
    });
    let one = |path: &PlannedPath| {
        let word = path.terrain.as_ref().map(|terrain| terrain.free.rays().word(&path.corners));
        let knots = path.course.varied.as_ref().map(|varied| {
            let (x, u): (Vec<f64>, Vec<f64>) = varied.knots().iter().copied().unzip();
            json!({ "x": x, "u": u })
        });
        json!({
            "agent": path.agent,
            "path": path.name,
            "class": word.as_ref().map(|word| word.letters().to_vec()),
            "length": path.course.path.length(),
            "optimal_s": path.course.optimum.duration(),
            "duration_s": path.course.duration(),
            "segments": path.course.path.pieces().iter().map(piece).collect::<Vec<_>>(),
            "knots": knots,
        })
    };
    format!("{:#}\n", json!({ "roadmap": roadmap, "paths": paths.iter().map(one).collect::<Vec<_>>() }))
}

/// A run of Algorithm 1 as printed: its name, and what came of it.
pub type PrintedRun = (String, Printed);

/// All runs: whether each returned, which limits it breaks, and its pieces.
pub fn printed_to_json(runs: &[PrintedRun]) -> String {
    let one = |(name, run): &PrintedRun| match run {
        Printed::NeverReturns(why) => json!({ "path": name, "returned": false, "why": why.phrase() }),
        Printed::Profile(profile) => json!({
            "path": name,
            "returned": true,
            "breaks": profile.violations().names(),
            "duration_s": profile.duration().is_finite().then(|| profile.duration()),
            "points": profile.points(1),
        }),
    };
    format!("{:#}\n", json!({ "algorithm": "printed", "paths": runs.iter().map(one).collect::<Vec<_>>() }))
}

/// A row for each place of each run that returned, and one without numbers for each other run.
pub fn printed_to_csv(runs: &[PrintedRun]) -> String {
    let mut out = "path,returned,breaks,t,s,v,a\n".to_owned();
    for (name, run) in runs {
        match run {
            Printed::NeverReturns(why) => {
                let _ = writeln!(out, "{name},false,{},,,,", why.phrase());
            }
            Printed::Profile(profile) => {
                let breaks = profile.violations().names().join(" and ");
                for [t, s, v, a] in profile.points(PER_PIECE) {
                    let _ = writeln!(out, "{name},true,{breaks},{t},{s},{v},{a}");
                }
            }
        }
    }
    out
}

/// The profiles of the runs that returned; those that break a limit say so.
pub fn printed_curves(runs: &[PrintedRun]) -> Vec<Curve> {
    let curve = |(name, run): &PrintedRun| {
        let Printed::Profile(profile) = run else { return None };
        let breaks = profile.violations().names();
        let name = if breaks.is_empty() { name.clone() } else { format!("{name}: {}", breaks.join(", ")) };
        Some((name, profile.points(PER_PIECE)))
    };
    runs.iter().filter_map(curve).collect()
}

/// Times from 0 to the end of a course, `dt` seconds apart, the end included.
fn times(course: &Course, dt: f64) -> impl Iterator<Item = f64> + '_ {
    let duration = course.duration();
    let count = (duration / dt).floor() as u64;
    let rest = (duration - count as f64 * dt > 1e-9).then_some(duration);
    (0..=count).map(move |k| k as f64 * dt).chain(rest)
}

/// One row for each time step of each path.
pub fn to_csv(paths: &[PlannedPath], dt: f64) -> String {
    let mut out = "agent,path,t,s,x,y,vx,vy,ax,ay,segment\n".to_owned();
    for path in paths {
        let (course, joints) = (&path.course, path.course.path.joints());
        let name = if path.name.contains(',') { format!("\"{}\"", path.name) } else { path.name.clone() };
        for t in times(course, dt) {
            let motion = course.motion(t);
            let place = course.path.at(motion.distance);
            let (d, v, at) = (place.direction, motion.speed, place.position);
            let across = Vec2::new(-d.y, d.x) * (v * v * place.curvature);
            let (velocity, acceleration) = (d * v, d * motion.acceleration + across);
            // The first joint is the start.
            let piece =
                joints.partition_point(|joint| *joint <= motion.distance).clamp(1, joints.len().max(2) - 1);
            let places = [t, motion.distance, at.x, at.y];
            let motions = [velocity.x, velocity.y, acceleration.x, acceleration.y];
            let numbers = [places, motions].concat().iter().map(f64::to_string).collect::<Vec<_>>().join(",");
            let _ = writeln!(out, "{},{name},{numbers},{piece}", path.agent);
        }
    }
    out
}

/// Colours of up to four times on a map.
const MOMENTS: [Ink; 4] = [Ink::BARRIER, Ink::TRACE_START, Ink::TRACE_END, Ink::REGION];

/// The rounded paths, with the places at some times, s.
fn draw_paths(drawing: &mut Drawing, paths: &[PlannedPath], instants: &[f64]) {
    for path in paths {
        let line = &path.course.path;
        let steps = (line.length() * 10.0).ceil().max(1.0) as u32;
        let at = |k: u32| line.at(line.length() * f64::from(k) / f64::from(steps)).position;
        drawing.line(&(0..=steps).map(at).collect::<Vec<_>>(), Ink::WAY);
        drawing.dot(at(0), Ink::START);
        for (k, time) in instants.iter().enumerate() {
            let place = line.at(path.course.motion(*time).distance).position;
            drawing.dot(place, MOMENTS[k % MOMENTS.len()]);
        }
        // Only who has several paths needs names for them.
        if paths.iter().filter(|other| other.agent == path.agent).count() > 1 {
            drawing.text(at(steps / 2), &path.name);
        }
    }
    drawing.name(Ink::WAY, "paths");
    drawing.name(Ink::START, "where they begin");
    for (k, time) in instants.iter().enumerate().take(MOMENTS.len()) {
        drawing.name(MOMENTS[k], &format!("at {} s", plain(*time)));
    }
}

/// The map: the scene, the roadmap, and the rounded paths from where the walkers are; and where they are planned to be at some
/// times, s.
pub fn map(scenario: &Scenario, paths: &[PlannedPath], instants: &[f64]) -> Picture {
    let mut drawing = plan::scene(scenario);
    if let Some(terrain) = paths.iter().find_map(|path| path.terrain.as_ref()) {
        let vertex = |k: u32| terrain.roadmap.vertices()[k as usize];
        for &(a, b) in terrain.roadmap.edges() {
            drawing.line(&[vertex(a), vertex(b)], Ink::ROADMAP);
        }
        drawing.name(Ink::ROADMAP, "roadmap");
    }
    draw_paths(&mut drawing, paths, instants);
    Picture::plan(if scenario.title.is_empty() { "paths" } else { &scenario.title }, drawing)
}

/// A path without a scene, with the joints of its lines and arcs.
pub fn map_of_shape(path: &PlannedPath, instants: &[f64], title: &str) -> Picture {
    let line = &path.course.path;
    let joints: Vec<Vec2> = line.joints().iter().map(|joint| line.at(*joint).position).collect();
    let corners = line.pieces().iter().flat_map(|piece| [piece.start().position, piece.end().position]);
    let around = Bounds::around(corners.chain(path.corners.iter().copied()));
    let mut drawing = Drawing::new(around.unwrap_or_default());
    drawing.line(&path.corners, Ink::ROADMAP);
    draw_paths(&mut drawing, std::slice::from_ref(path), instants);
    for joint in joints {
        drawing.dot(joint, Ink::JOINT);
    }
    drawing.name(Ink::JOINT, "joints of lines and arcs");
    Picture::plan(title, drawing)
}

/// A profile as a figure shows it: its name, and rows of time, s, place, m, speed, m/s, and acceleration, m/s^2.
pub type Curve = (String, Vec<[f64; 4]>);

/// The profile of a course, with the acceleration along and across its path together.
pub fn curve(name: String, course: &Course) -> Curve {
    let time = |k: u32| course.duration() * f64::from(k) / f64::from(POINTS);
    let row = |t: f64| {
        let motion = course.motion(t);
        let across = motion.speed * motion.speed * course.path.at(motion.distance).curvature;
        let whole = (motion.acceleration * motion.acceleration + across * across).sqrt();
        [t, motion.distance, motion.speed, whole]
    };
    (name, (0..=POINTS).map(time).map(row).collect())
}

/// The plane of place and speed: limit curve, feasible region, and profiles (Li, Li, Ge 2019, Figures 3 and 5).
pub fn phase(region: &Region, curves: &[Curve], title: &str) -> Picture {
    const STYLES: [usize; 2] = [3, 4];
    let length = region.optimum().length();
    let places: Vec<f64> = (0..=POINTS).map(|k| length * f64::from(k) / f64::from(POINTS)).collect();
    let bounded = |x: f64| if region.limit(x).is_finite() { region.limit(x) } else { region.highest(x) };
    let drawn = curves.iter().flat_map(|(_, rows)| rows.iter().map(|row| row[2]));
    let speeds = places.iter().map(|x| bounded(*x)).chain(drawn).chain([0.0]).collect::<Vec<_>>();
    let mut frame =
        Frame::new(["place (m)", "speed (m/s)"], Scale::between(0.0, length), Scale::linear(speeds));
    let [fastest, limit] = STYLES;
    let band: Vec<_> = places.iter().map(|x| (*x, region.lowest(*x), region.highest(*x))).collect();
    frame.band(&band, fastest);
    frame.line(places.iter().map(|x| (*x, region.highest(*x))), fastest);
    frame.line(places.iter().map(|x| (*x, region.lowest(*x))), fastest);
    frame.line(places.iter().map(|x| (*x, bounded(*x))), limit);
    for (k, (name, rows)) in curves.iter().enumerate() {
        frame.line(rows.iter().map(|row| (row[1], row[2])), profile_style(k));
        frame.name(name, profile_style(k));
    }
    frame.name("feasible region", fastest);
    frame.name("limit of speed and turning", limit);
    Picture::charts(title, vec![frame])
}

/// Speed and acceleration over time, one above the other (Figure 6).
pub fn speed(curves: &[Curve], title: &str) -> Picture {
    let chart = |axis: &str, column: usize| {
        let all = || curves.iter().flat_map(|(_, rows)| rows);
        let x = Scale::linear(all().map(|row| row[0]).chain([0.0]));
        let y = Scale::linear(all().map(|row| row[column]).chain([0.0]));
        let mut frame = Frame::new(["time (s)", axis], x, y);
        for (k, (_, rows)) in curves.iter().enumerate() {
            frame.line(rows.iter().map(|row| (row[0], row[column])), profile_style(k));
        }
        frame.low()
    };
    let mut below = chart("acceleration (m/s^2)", 3);
    for (k, (name, _)) in curves.iter().enumerate() {
        below.name(name, profile_style(k));
    }
    Picture::charts(title, vec![chart("speed (m/s)", 2), below])
}

/// Profiles have other styles than the limits.
fn profile_style(k: usize) -> usize {
    [0, 1, 2, 5][k % 4]
}
