//! Monitored properties as one JSON object, without their instants; `docs/schema/monitor.schema.json` describes it.

use super::{Monitored, MonitoredProperty};
use serde_json::{Value, json};

/// Version of the form of this object.
const SCHEMA: u32 = 1;

/// Files, options, and a result for each property.
pub fn to_json(report: &Monitored) -> String {
    let all = json!({
        "schema": SCHEMA,
        "model": report.model,
        "properties": report.properties,
        "recording": report.recording,
        "velocity": report.velocity.name(),
        "user": report.user,
        "every": report.every,
        "beyond": report.beyond.name(),
        "confidence": report.confidence,
        "results": report.results.iter().map(result).collect::<Vec<_>>(),
    });
    format!("{all:#}\n")
}

fn result(one: &MonitoredProperty) -> Value {
    let reasons = one.reasons.iter().map(|(reason, count)| json!({ "reason": reason, "count": count }));
    json!({
        "name": one.name,
        "satisfied": one.satisfied,
        "violated": one.violated,
        "unresolved": one.unresolved,
        "unresolved_because": reasons.collect::<Vec<_>>(),
        "instants": one.instants(),
        "persons": one.persons,
        "share": one.share,
    })
}
