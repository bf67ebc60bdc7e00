//! Planned paths as data and as pictures: `smc path`.

use super::number::plain;
use super::svg::frame::{Frame, picture};
use super::svg::scale::Scale;
use super::svg::{Ink, plan};
use crate::base::geometry::Vec2;
use crate::model::Scenario;
use crate::route::path::Piece;
use crate::route::planner::{Course, Terrain};
use crate::route::profile::Region;
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::sync::Arc;

/// Points of a curve in a picture.
const POINTS: u32 = 400;

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
            "pieces": path.course.path.pieces().iter().map(piece).collect::<Vec<_>>(),
            "knots": knots,
        })
    };
    let all = json!({ "roadmap": roadmap, "paths": paths.iter().map(one).collect::<Vec<_>>() });
    format!("{all:#}\n")
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
    let mut out = "agent,path,t,s,x,y,vx,vy,ax,ay,piece\n".to_owned();
    for path in paths {
        let (course, joints) = (&path.course, path.course.path.joints());
        let name = if path.name.contains(',') { format!("\"{}\"", path.name) } else { path.name.clone() };
        for t in times(course, dt) {
            let motion = course.motion(t);
            let place = course.path.at(motion.distance);
            let (d, v) = (place.direction, motion.speed);
            let across = Vec2::new(-d.y, d.x) * (v * v * place.curvature);
            let (velocity, acceleration) = (d * v, d * motion.acceleration + across);
            // The first joint is the start.
            let piece =
                joints.partition_point(|joint| *joint <= motion.distance).clamp(1, joints.len().max(2) - 1);
            let _ = writeln!(
                out,
                "{},{name},{t},{},{},{},{},{},{},{},{piece}",
                path.agent,
                motion.distance,
                place.position.x,
                place.position.y,
                velocity.x,
                velocity.y,
                acceleration.x,
                acceleration.y
            );
        }
    }
    out
}

/// The map: the scene, the roadmap, and the rounded paths from where the walkers are; and where they are planned to be at some
/// times, s.
pub fn map(scenario: &Scenario, paths: &[PlannedPath], instants: &[f64]) -> String {
    let mut drawing = plan::scene(scenario);
    if let Some(terrain) = paths.iter().find_map(|path| path.terrain.as_ref()) {
        let vertex = |k: u32| terrain.roadmap.vertices()[k as usize];
        for &(a, b) in terrain.roadmap.edges() {
            drawing.line(&[vertex(a), vertex(b)], Ink::ROADMAP);
        }
    }
    for path in paths {
        let line = &path.course.path;
        let steps = (line.length() * 10.0).ceil().max(1.0) as u32;
        let at = |k: u32| line.at(line.length() * f64::from(k) / f64::from(steps)).position;
        drawing.line(&(0..=steps).map(at).collect::<Vec<_>>(), Ink::WAY);
        drawing.dot(at(0), Ink::START);
        for time in instants {
            let place = line.at(path.course.motion(*time).distance).position;
            drawing.dot(place, Ink::BARRIER);
            drawing.text(place + Vec2::new(0.0, 0.3), &format!("{} s", plain(*time)));
        }
        // Only who has several paths needs names for them.
        if paths.iter().filter(|other| other.agent == path.agent).count() > 1 {
            drawing.text(at(steps / 2), &path.name);
        }
    }
    drawing.finish(if scenario.title.is_empty() { "paths" } else { &scenario.title })
}

/// The plane of place and speed: limit curve, feasible region, and profiles.
pub fn phase(region: &Region, courses: &[Course], title: &str) -> String {
    let length = region.optimum().length();
    let at = |k: u32| length * f64::from(k) / f64::from(POINTS);
    let curve =
        |of: &dyn Fn(f64) -> f64| -> Vec<(f64, f64)> { (0..=POINTS).map(|k| (at(k), of(at(k)))).collect() };
    let profile = |(k, course): (usize, &Course)| {
        let time = |k: u32| course.motion(course.duration() * f64::from(k) / f64::from(POINTS));
        let points = (0..=POINTS).map(time).map(|motion| (motion.distance, motion.speed));
        (format!("profile {}", k + 1), points.collect())
    };
    let mut curves: Vec<_> = courses.iter().enumerate().map(profile).collect();
    curves.push(("fastest".to_owned(), curve(&|x| region.highest(x))));
    curves.push(("slowest".to_owned(), curve(&|x| region.lowest(x))));
    curves.push(("limit".to_owned(), curve(&|x| region.limit(x))));
    chart(["s (m)", "ds/dt (m/s)"], curves, title)
}

/// Speed and acceleration over time.
pub fn speed(courses: &[Course], title: &str) -> String {
    let mut curves = Vec::new();
    for (k, course) in courses.iter().enumerate() {
        let time = |k: u32| course.duration() * f64::from(k) / f64::from(POINTS);
        let all = || (0..=POINTS).map(time).map(|t| (t, course.motion(t)));
        let of = |what: &str| if courses.len() == 1 { what.to_owned() } else { format!("{what} {}", k + 1) };
        curves.push((of("speed"), all().map(|(t, motion)| (t, motion.speed)).collect()));
        let whole = |motion: crate::route::profile::Motion| {
            let curvature = course.path.at(motion.distance).curvature;
            let across = motion.speed * motion.speed * curvature;
            (motion.acceleration * motion.acceleration + across * across).sqrt()
        };
        curves.push((of("acceleration"), all().map(|(t, motion)| (t, whole(motion))).collect()));
    }
    chart(["t (s)", "speed (m/s), acceleration (m/s^2)"], curves, title)
}

/// Named curves between axes that contain zero. What is infinite is left out.
fn chart(axes: [&str; 2], curves: Vec<(String, Vec<(f64, f64)>)>, title: &str) -> String {
    let all = || curves.iter().flat_map(|(_, points)| points.iter().copied());
    let x = Scale::linear(all().map(|(x, _)| x).chain([0.0]));
    let y = Scale::linear(all().map(|(_, y)| y).chain([0.0]));
    let mut frame = Frame::new(axes, x, y);
    for (k, (name, points)) in curves.into_iter().enumerate() {
        frame.line(points.into_iter().filter(|(x, y)| x.is_finite() && y.is_finite()), k);
        frame.name(&name, k);
    }
    picture(title, vec![frame])
}
