//! Inferred traces and groups as one JSON object.

use super::InferredFile;
use crate::perception::{Birth, Death, Group, InferredTrace, Padding};
use serde_json::{Value, json};

/// Version of the form of this object.
const SCHEMA: u32 = 1;

/// File, parameters, intervals, traces, groups and scores.
pub fn to_json(report: &InferredFile) -> String {
    let (options, found) = (report.options, report.inference);
    let (tracking, clustering) = (options.tracking, options.clustering);
    let tracks = found.tracks.map(|score| {
        json!({
            "tracks": score.tracks,
            "unsplit": score.unsplit,
            "switches": score.switches,
            "idf1": score.idf1,
            "joins": score.joins,
            "wrong_joins": score.wrong_joins,
        })
    });
    let groups = found.score.map(|score| {
        json!({
            "annotated": score.annotated,
            "together": score.together,
            "always": score.always,
            "share": score.share,
            "precision": score.precision,
            "recall": score.recall,
        })
    });
    let all = json!({
        "schema": SCHEMA,
        "file": report.file,
        "velocity": report.velocity.name(),
        "parameters": {
            "motion": report.motion,
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
        "intervals": found.intervals.iter().map(|(from, to)| json!([from, to])).collect::<Vec<_>>(),
        "traces": found.traces.iter().map(trace).collect::<Vec<_>>(),
        "groups": found.groups.iter().map(group).collect::<Vec<_>>(),
        "score": { "tracks": tracks, "groups": groups },
    });
    format!("{all}\n")
}

fn trace(one: &InferredTrace) -> Value {
    let points = one.trace.points.iter().map(|point| {
        let (p, v) = (point.position, point.velocity);
        json!([point.time, p.x, p.y, v.map(|v| v.x), v.map(|v| v.y)])
    });
    json!({
        "id": one.trace.number,
        "from": one.trace.since,
        "to": one.trace.end().time,
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
    let members = one
        .members
        .iter()
        .map(|member| json!({ "trace": member.trace, "from": member.from, "to": member.to }));
    json!({
        "id": one.number,
        "from": one.from,
        "to": one.to,
        "born": born,
        "of": of,
        "ended": ended,
        "into": into,
        "members": members.collect::<Vec<_>>(),
    })
}
