//! Inferred traces and groups as data and as pictures: `smc infer`.

mod page;

use crate::base::geometry::{Bounds, Shape, Vec2};
use crate::data::tracks::Velocity;
use crate::perception::{Birth, Death, Group, Inference, InferredTrace, Inferring, Padding};
use crate::report::number::thousandths;
use crate::report::svg::picture::Picture;
use crate::report::svg::{Drawing, Ink};
pub use page::{to_page, to_text, traces};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// What was inferred from a file, and how.
#[derive(Clone, Copy, Debug)]
pub struct InferredFile<'a> {
    /// Name of the file.
    pub file: &'a str,
    /// Which velocities were used.
    pub velocity: Velocity,
    /// Name of the model of motion.
    pub motion: &'a str,
    /// The preset or kind whose parameters people have in it, if it has parameters.
    pub kind: Option<&'a str>,
    /// Name of the scenario whose barriers people avoid in it.
    pub scene: Option<&'a str>,
    /// Options of the inference.
    pub options: &'a Inferring,
    /// Its result.
    pub inference: &'a Inference,
}

// Inferred points as CSV, one row a point; what is unknown is empty.

/// `time,trace,group,x,y,vx,vy,id`, by time and trace, in SI units, with three decimals.
pub fn to_csv(inference: &Inference) -> String {
    let mut text = "time,trace,group,x,y,vx,vy,id\n".to_owned();
    for one in &inference.points {
        let (time, p) = (thousandths(one.point.time), one.point.position.map(thousandths));
        let velocity = one.point.velocity.map(|v| v.map(thousandths));
        let velocity = velocity.map_or_else(|| ",".to_owned(), |v| format!("{},{}", v.x, v.y));
        let id = one.person.map_or_else(String::new, |id| id.to_string());
        let _ = writeln!(text, "{time},{},{},{},{},{velocity},{id}", one.trace, one.group, p.x, p.y);
    }
    text
}

// Inferred traces and groups as one JSON object.

/// Version of the form of this object.
const SCHEMA: u32 = 1;

/// File, parameters, intervals, traces, groups and scores. Times, places and velocities have three decimals.
pub fn to_json(report: &InferredFile) -> String {
    let (options, found) = (report.options, report.inference);
    let (tracking, clustering) = (options.tracking, options.clustering);
    let all = json!({
        "schema": SCHEMA,
        "file": report.file,
        "velocity": report.velocity.name(),
        "parameters": {
            "motion": report.motion,
            "kind": report.kind,
            "scene": report.scene,
            "anonymous": options.is_anonymous,
            "threshold": tracking.threshold,
            "projection": tracking.longest,
            "discount": tracking.discount,
            "padding": match tracking.padding { Padding::Printed => "printed", Padding::Gated => "gated" },
            "waiting": tracking.waiting,
            "sensors_within": tracking.sensors_within,
            "cohesion": clustering.threshold,
            "position_discount": clustering.position_discount,
            "velocity_discount": clustering.velocity_discount,
            "seed": options.key.seed,
        },
        "intervals": found.intervals.iter().map(|(from, to)| [*from, *to].map(thousandths)).collect::<Vec<_>>(),
        "traces": found.traces.iter().map(trace).collect::<Vec<_>>(),
        "groups": found.groups.iter().map(group).collect::<Vec<_>>(),
        "score": { "tracks": found.tracks, "groups": found.score },
    });
    format!("{all}\n")
}

fn trace(one: &InferredTrace) -> Value {
    let points = one.trace.points.iter().map(|point| {
        let (p, v) = (point.position.map(thousandths), point.velocity.map(|v| v.map(thousandths)));
        json!([thousandths(point.time), p.x, p.y, v.map(|v| v.x), v.map(|v| v.y)])
    });
    json!({
        "id": one.trace.number,
        "from": thousandths(one.trace.since),
        "to": thousandths(one.trace.end().time),
        "points": points.collect::<Vec<_>>(),
        "people": one.people,
    })
}

fn group(one: &Group) -> Value {
    let (born, of) = match one.born {
        Birth::Appear => ("appear", None),
        Birth::Split(of) => ("split", Some(of)),
    };
    let (ended, into) = match one.ended {
        Death::Leave => ("leave", None),
        Death::Merge(into) => ("merge", Some(into)),
    };
    let members = one.members.iter().map(|member| {
        let (from, to) = (thousandths(member.from), thousandths(member.to));
        json!({ "trace": member.trace, "from": from, "to": to })
    });
    json!({
        "id": one.number,
        "from": thousandths(one.from),
        "to": thousandths(one.to),
        "born": born,
        "of": of,
        "ended": ended,
        "into": into,
        "members": members.collect::<Vec<_>>(),
    })
}

// Inferred traces and groups as a picture, as Figures 3 to 6 of Given-Wilson, Legay, Sedwards, Zendra 2017: traces
// black, their starts blue, their ends red, and at each instant a circle for each group, sized by its members.

/// Radius of the circle of one person, m; it grows with the root of the number.
const RADIUS: f64 = 0.2;

/// The picture.
pub fn to_svg(report: &InferredFile) -> Picture {
    let found = report.inference;
    let bounds = Bounds::around(found.points.iter().map(|one| one.point.position));
    let room = Vec2::repeat(0.5);
    let bounds = bounds.map(|Bounds { low, high }| Bounds { low: low - room, high: high + room });
    let mut drawing = Drawing::new(bounds.unwrap_or(Bounds { low: Vec2::zeros(), high: Vec2::repeat(1.0) }));
    for instant in found.points.chunk_by(|a, b| a.point.time == b.point.time) {
        let mut groups = BTreeMap::<u64, (Vec2, f64)>::new();
        for one in instant {
            let (sum, count) = groups.entry(one.group).or_insert((Vec2::zeros(), 0.0));
            *sum += one.point.position;
            *count += 1.0;
        }
        for (sum, count) in groups.into_values() {
            drawing.shape(&Shape::Circle { centre: sum / count, radius: RADIUS * count.sqrt() }, Ink::GROUP);
        }
    }
    for one in &found.traces {
        let points: Vec<Vec2> = one.trace.points.iter().map(|point| point.position).collect();
        drawing.line(&points, Ink::TRACE);
        if let (Some(first), Some(last)) = (points.first(), points.last()) {
            drawing.dot(*first, Ink::TRACE_START);
            drawing.dot(*last, Ink::TRACE_END);
        }
    }
    drawing.name(Ink::TRACE, "traces");
    drawing.name(Ink::TRACE_START, "where they begin");
    drawing.name(Ink::TRACE_END, "where they end");
    drawing.name(Ink::GROUP, "groups, at each instant");
    Picture::plan(&format!("Traces and groups of people ({} velocities)", report.velocity.name()), drawing)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::tracks::{Batch, read_observations};
    use crate::perception::{ConstantVelocity, infer};
    use crate::report::svg::picture::Paper;

    #[test]
    fn all_formats_hold_the_same_points() {
        let text = "{\"t\":0,\"seen\":[{\"x\":0,\"y\":0,\"id\":4},{\"x\":0.5,\"y\":0}]}\n{\"t\":0.4,\"seen\":[{\"x\":0.10049,\"y\":0,\"id\":4}]}\n";
        let batches: Vec<Batch> = read_observations(text).unwrap();
        let options = Inferring::default();
        let inference = infer(&batches, &options, &mut ConstantVelocity).unwrap();
        let report = InferredFile {
            file: "a.jsonl",
            velocity: Velocity::Seen,
            motion: "social-force",
            kind: Some("helbing2000"),
            scene: None,
            options: &options,
            inference: &inference,
        };
        let json: serde_json::Value = serde_json::from_str(&to_json(&report)).unwrap();
        assert_eq!(json["velocity"], "seen");
        let parameters = &json["parameters"];
        assert_eq!((&parameters["kind"], &parameters["scene"]), (&"helbing2000".into(), &().into()));
        assert_eq!(json["intervals"], serde_json::json!([[0.0, 0.4]]));
        assert_eq!(json["traces"][0]["people"], serde_json::json!([4]));
        assert_eq!(json["traces"][0]["points"][0], serde_json::json!([0.0, 0.0, 0.0, null, null]));
        assert_eq!(json["traces"][0]["points"][1], serde_json::json!([0.4, 0.1, 0.0, 0.251, 0.0]));
        assert_eq!(json["groups"][0]["born"], "appear");
        assert_eq!(json["score"]["tracks"]["unsplit"], 1);
        let csv = to_csv(&inference);
        assert_eq!(csv.lines().count(), 4);
        assert_eq!(csv.lines().nth(1), Some("0,1,1,0,0,,,4"));
        assert_eq!(csv.lines().nth(3), Some("0.4,1,1,0.1,0,0.251,0,4"));
        let svg = to_svg(&report).svg(Paper::default());
        assert_eq!(svg.matches("<polyline").count(), 2);
        assert!(svg.starts_with("<svg") && svg.ends_with("</svg>\n"));
    }
}
