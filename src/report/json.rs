//! One JSON object for programs; `docs/schema/verdict.schema.json` describes it.
//!
//! Fields are only ever added within a major version. What is infinite or unknown is `null`; a result that
//! lies beyond the horizon, in whole or by an end of its interval, says so by `"censored": true`. Everything
//! but `elapsed_s` is a function of input, seed and version.

use super::phrase::front;
use super::setting;
use crate::base::random;
use crate::engine::outcome::{
    Also, CallResult, Comparison, Counts, CurvePoint, Distribution, Every, Evidence, Finding, Interval, Kind,
    Method, QueryResult, Ranking, Shows, Side, Snapshot, Standing, UnderOne, Verdict, Witness,
};
use serde::{Serialize, Serializer};
use serde_json::{Map, Value, json};

/// Below this doubles tell all whole numbers apart.
const LARGEST_WHOLE: f64 = 9_007_199_254_740_992.0;

/// The report of a run, indented, ending with a line end.
pub fn render(run: &CallResult) -> String {
    format!("{:#}\n", object(run))
}

/// The report of a run as a JSON value.
pub fn object(run: &CallResult) -> Value {
    let inputs: Vec<Value> =
        run.inputs.iter().map(|(file, print)| json!({ "file": file, "hash": print.to_string() })).collect();
    let velocities = |(name, velocity): &(String, &str)| json!({ "name": name, "velocity": velocity });
    let mut object = json!({
        "schema": 3,
        "scenario": run.scenario,
        "seed": run.seed,
        "version": run.version,
        "results": run.results.iter().map(result).collect::<Vec<_>>(),
        "diagnostics": run.diagnostics.iter().map(finding).collect::<Vec<_>>(),
        "warnings": run.warnings,
        "generator": { "name": random::GENERATOR, "layout": random::LAYOUT },
        "inputs": inputs,
        "people": run.people,
        "tracks": run.tracks.iter().map(velocities).collect::<Vec<_>>(),
        "interrupted": run.interrupted,
        "error": Value::Null,
        "replay": run.replay,
        "elapsed_s": run.elapsed_s,
    });
    if let Some(failure) = &run.failure {
        object["error"] = json!({ "bug": failure.is_bug(), "message": failure.message() });
    }
    object
}

impl Serialize for QueryResult {
    /// As in the JSON report.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        result(self).serialize(serializer)
    }
}

impl Serialize for CallResult {
    /// As the JSON report.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        object(self).serialize(serializer)
    }
}

/// A number; one without a fraction is written without one, so that counts are whole.
pub(super) fn number(x: f64) -> Value {
    if x.fract() == 0.0 && x.abs() < LARGEST_WHOLE { json!(x as i64) } else { json!(x) }
}

fn maybe(x: Option<f64>) -> Value {
    x.map_or(Value::Null, number)
}

fn finding(finding: &Finding) -> Value {
    let spot = finding.spot.as_ref();
    json!({
        "code": finding.code,
        "severity": if finding.error { "error" } else { "warning" },
        "file": spot.map(|spot| &spot.file),
        "line": spot.map(|spot| spot.start.0),
        "column": spot.map(|spot| spot.start.1),
        "end": spot.map(|spot| json!({ "line": spot.end.0, "column": spot.end.1 })),
        "message": finding.message,
        "label": finding.label,
        "hint": finding.hint,
    })
}

/// A result as a JSON value.
pub(super) fn result(result: &QueryResult) -> Value {
    let mut object = Map::new();
    let mut put = |key: &str, value: Value| object.insert(key.to_owned(), value);
    put("index", json!(result.asked.index));
    put("name", json!(result.asked.name));
    put("query", json!(result.asked.text));
    put("file", json!(result.asked.file));
    put("line", json!(result.asked.line));
    put("settings", setting::object(&result.asked.settings));
    put("kind", json!(result.asked.kind.name()));
    put("verdict", json!(result.verdict.map(Verdict::name)));
    put("certifies", json!(result.certifies));
    put("horizon", json!(result.asked.horizon));
    if let Some(given) = &result.asked.given {
        put("given", json!(given));
    }
    put("estimate", maybe(result.estimate));
    put("low", number(result.low));
    put("high", number(result.high));
    put("censored", json!(result.censored.is_some()));
    put("of", json!(result.of));
    put("unit", json!(result.unit));
    put("interval", json!(result.interval));
    put("method", method(&result.method));
    for (key, value) in counts(&result.consumed.counts) {
        put(&key, value);
    }
    put("clipped", json!(result.consumed.clipped));
    put("shrunk", json!(result.consumed.shrunk));
    if result.consumed.no_way > 0 {
        put("no_way", json!(result.consumed.no_way));
    }
    put("steps", json!(result.consumed.steps));
    put("stopped_by", json!(result.stopped_by.name()));
    if let Some(shortfall) = result.shortfall() {
        put("shortfall", json!(shortfall.name()));
    }
    if let Some(Comparison { first, second, difference }) = &result.compare {
        put("first", side(first));
        put("second", side(second));
        put("difference", side(difference));
    }
    if let Some(ranking @ Ranking { choice, means, gap, tied, aim, options, is_empty }) = &result.rank {
        put("choice", json!(choice));
        if result.asked.kind == Kind::Pareto {
            put("aim", json!(aim));
            put("front", front(ranking).collect());
        }
        if *is_empty {
            put("none", json!(true));
        }
        if let Some(means) = means {
            put("means", json!(means));
        }
        put("gap", number(*gap));
        put("tied", json!(tied));
        let options = options.iter().map(|option| {
            let mut object = numbered("option", &option.label, &option.value, &option.counts);
            object.insert("status".into(), json!(option.status.name()));
            if !option.under.is_empty() {
                object.insert("under".into(), option.under.iter().map(side).collect());
            }
            if !option.also.is_empty() {
                object.insert("also".into(), option.also.iter().map(also).collect());
            }
            if !option.settings.is_empty() {
                object.insert("settings".into(), setting::object(&option.settings));
            }
            Value::Object(object)
        });
        put("options", options.collect());
    }
    if let Some(found) = &result.every {
        put("every", every(found));
    }
    if let Some(error) = &result.model {
        put("model", json!(error));
    }
    if let Some(found) = &result.distribution {
        put("distribution", distribution(found));
    }
    if let Some(found) = &result.rare {
        put("splitting", json!(found));
    }
    if let Some(found) = &result.evidence {
        put("evidence", evidence(found));
    }
    put("warnings", json!(result.warnings));
    put("witnesses", result.witnesses.iter().map(|one| witness(one, result.asked.against)).collect());
    put("replay", json!(result.replay));
    put("elapsed_s", json!(result.elapsed_s));
    Value::Object(object)
}

fn method(method: &Method) -> Value {
    let mut object = Map::new();
    object.insert("name".into(), json!(method.name));
    object.extend(method.numbers.iter().map(|(name, value)| (name.clone(), number(*value))));
    Value::Object(object)
}

fn counts(counts: &Counts) -> Map<String, Value> {
    let fields = [
        ("trials", counts.trials),
        ("successes", counts.successes),
        ("failures", counts.failures),
        ("unresolved", counts.unresolved),
    ];
    fields.into_iter().map(|(name, value)| (name.to_owned(), json!(value))).collect()
}

fn interval(value: &Interval) -> Map<String, Value> {
    let fields = [("estimate", value.estimate), ("low", value.low), ("high", value.high)];
    fields.into_iter().map(|(name, value)| (name.to_owned(), number(value))).collect()
}

fn numbered(key: &str, label: &str, value: &Interval, trials: &Counts) -> Map<String, Value> {
    let mut object = Map::new();
    object.insert(key.to_owned(), json!(label));
    object.extend(interval(value));
    object.extend(counts(trials));
    object
}

fn also(also: &Also) -> Value {
    let mut object = Map::new();
    object.insert("what".into(), json!(also.what));
    object.extend(interval(&also.value));
    object.insert("unit".into(), json!(also.unit));
    object.insert("holds".into(), json!(also.holds));
    Value::Object(object)
}

fn every(every: &Every) -> Value {
    let part = |part: &UnderOne| {
        let mut object = interval(&part.figure);
        object.insert("value".into(), json!(part.setting.1));
        object.extend(counts(&part.counts));
        object.insert("verdict".into(), json!(part.verdict.map(Verdict::name)));
        if let Some((option, worth)) = &part.best {
            object.insert("best".into(), json!({ "option": option, "estimate": number(*worth) }));
        }
        Value::Object(object)
    };
    let parts: Vec<Value> = every.parts.iter().map(part).collect();
    json!({ "name": every.name, "least": every.least_value(), "values": parts })
}

fn side(side: &Side) -> Value {
    Value::Object(numbered("settings", &side.label, &side.value, &side.counts))
}

fn witness(witness: &Witness, against: bool) -> Value {
    let mut shown = json!({
        "shows": witness.shows.name(),
        "passing": match witness.shows {
            Shows::Fails => Some(against),
            Shows::Holds => Some(!against),
            Shows::Lowest | Shows::Highest => None,
        },
        "trial": witness.trial,
        "value": maybe(witness.value),
        "time": number(witness.time),
        "what": witness.what,
        "command": witness.command,
    });
    if let (Some(decider), Some(fields)) = (&witness.decider, shown.as_object_mut()) {
        let mut by = json!({ "agent": decider.agent, "place": decider.place });
        if let (Some(value), Some(fields)) =
            (decider.value.filter(|value| value.is_finite()), by.as_object_mut())
        {
            fields.insert("value".to_owned(), json!(value));
            fields.insert("unit".to_owned(), json!(decider.unit));
        }
        if let (Some(other), Some(fields)) = (&decider.other, by.as_object_mut()) {
            fields.insert("other".to_owned(), json!(other));
        }
        fields.insert("decided_by".to_owned(), by);
    }
    shown
}

fn evidence(found: &Evidence) -> Value {
    match found {
        Evidence::Values(snapshots) => {
            let weights = snapshots.iter().find_map(|one| one.weights);
            let shown = |one: &Snapshot| {
                let mut object = Map::from_iter([("trials".to_owned(), json!(one.trials))]);
                object.extend(interval(&one.value));
                if let Some([above, below]) = one.weights {
                    object.insert("above".into(), number(above.log));
                    object.insert("below".into(), number(below.log));
                }
                Value::Object(object)
            };
            let thresholds = weights
                .map(|[above, below]| json!({ "above": number(above.threshold), "below": number(below.threshold) }));
            json!({ "thresholds": thresholds, "snapshots": snapshots.iter().map(shown).collect::<Vec<_>>() })
        }
        Evidence::Options { labels, snapshots } => {
            let option = |(trials, open): &(u64, bool)| json!({ "trials": trials, "open": open });
            let shown = |one: &Standing| json!({ "trials": one.trials, "options": one.options.iter().map(option).collect::<Vec<_>>() });
            json!({ "options": labels, "snapshots": snapshots.iter().map(shown).collect::<Vec<_>>() })
        }
    }
}

fn distribution(found: &Distribution) -> Value {
    let histogram = found.histogram.as_ref().map(|histogram| {
        json!({
            "low": number(histogram.low),
            "high": number(histogram.high),
            "counts": histogram.counts,
            "below": histogram.below,
            "beyond": histogram.beyond,
        })
    });
    let quantiles: Vec<Value> = found
        .quantiles
        .iter()
        .map(|quantile| {
            let mut object = Map::new();
            object.insert("level".into(), json!(quantile.level));
            object.extend(interval(&quantile.value));
            Value::Object(object)
        })
        .collect();
    let empirical: Vec<Value> = found
        .empirical
        .iter()
        .map(|step| json!({ "value": number(step.value), "share": number(step.share) }))
        .collect();
    let mut object =
        json!({ "histogram": histogram, "quantiles": quantiles, "empirical": empirical, "band": found.band });
    if let (Some(curve), Some(fields)) = (&found.curve, object.as_object_mut()) {
        let point = |point: &CurvePoint| {
            let mut object = Map::from_iter([("at".to_owned(), number(point.at))]);
            object.extend(interval(&point.value));
            Value::Object(object)
        };
        let points: Vec<Value> = curve.points.iter().map(point).collect();
        fields.insert("curve".into(), json!({ "name": curve.name, "unit": curve.unit, "points": points }));
    }
    object
}
