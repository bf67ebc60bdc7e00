//! Advice as JSON lines: `smc advise`. `docs/schema/advice.schema.json` describes them.

use crate::advise::{Advice, Walked};
use crate::base::geometry::Vec2;
use crate::data::tracks::Velocity;
use crate::report::number::thousandths as millis;
use serde_json::{Value, json};

/// Version of the form.
const SCHEMA: u32 = 1;

/// The line of a cycle that took so many milliseconds.
pub fn line(advice: &Advice, velocity: Velocity, used_ms: f64) -> String {
    let options: Vec<Value> = advice
        .options
        .iter()
        .map(|option| {
            let [probability, low, high] = option.probability;
            json!({ "move": option.label, "probability": number(probability), "low": number(low),
                    "high": number(high), "status": option.status })
        })
        .collect();
    let groups: Vec<Value> = advice
        .groups
        .iter()
        .map(|group| {
            json!({ "id": group.id, "traces": group.traces, "x": millis(group.position.x), "y": millis(group.position.y),
                    "vx": millis(group.velocity.x), "vy": millis(group.velocity.y) })
        })
        .collect();
    let user = advice.user.as_ref().map(|user| {
        json!({ "id": user.id, "trace": user.trace, "group": user.group, "members": user.members,
                "x": millis(user.position.x), "y": millis(user.position.y),
                "place": user.place.name(), "rejoin": vector(user.rejoin) })
    });
    let of = |k: usize| advice.probability.map_or(Value::Null, |all| number(all[k]));
    let object = json!({
        "schema": SCHEMA,
        "cycle": advice.cycle,
        "t": (advice.time * 1e6).round() / 1e6,
        "velocity": velocity.name(),
        "status": advice.status.name(),
        "move": advice.chosen,
        "direction": vector(advice.direction),
        "speed": advice.speed.map(millis),
        "probability": of(0),
        "low": of(1),
        "high": of(2),
        "gap": advice.gap.map_or(Value::Null, number),
        "certified": advice.certified,
        "trials": advice.trials,
        "options": options,
        "user": user,
        "groups": groups,
        "people": advice.people,
        "followed": advice.followed,
        "used_ms": millis(used_ms),
        "notes": advice.notes,
    });
    format!("{object}\n")
}

/// The last line of a replay in which the user walked as advised.
pub fn end(advised: &Walked, recorded: &Walked) -> String {
    let way = |walked: &Walked| {
        json!({ "least_distance": walked.least_distance.map(millis), "time": millis(walked.time),
                "length": millis(walked.length) })
    };
    format!(
        "{}\n",
        json!({ "schema": SCHEMA, "status": "end", "advised": way(advised), "recorded": way(recorded) })
    )
}

fn number(value: f64) -> Value {
    if value.is_finite() { json!(value) } else { Value::Null }
}

fn vector(direction: Option<Vec2>) -> Value {
    direction.map_or(Value::Null, |d| json!([millis(d.x), millis(d.y)]))
}
