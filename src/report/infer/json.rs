//! Inferred traces and groups as one JSON object.

use super::InferredFile;
use crate::perception::{Birth, Death, Group, InferredTrace, Padding};
use crate::report::number::thousandths;
use serde_json::{Value, json};

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
