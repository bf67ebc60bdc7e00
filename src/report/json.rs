//! One JSON object for programs; `docs/schema/verdict.schema.json` describes it.
//!
//! Fields are only ever added within a major version. What is infinite or unknown is `null`; a result that
//! lies beyond the horizon, in whole or by an end of its interval, says so by `"censored": true`. Everything
//! but `elapsed_s` is a function of input, seed and version.

use super::phrase::front;
use super::setting;
use crate::base::random;
use crate::engine::outcome::{
    Also, CallResult, Comparison, Curve, CurvePoint, Decider, Distribution, Every, Evidence, Finding,
    Histogram, Interval, Kind, Method, Quantile, QueryResult, RankedOption, Ranking, Shortfall, Shows, Side,
    Snapshot, Standing, Step, UnderOne, Verdict, Witness,
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

/// The fields of several objects in one; `null` has none.
pub(super) fn joined<const N: usize>(parts: [Value; N]) -> Value {
    let fields = |part: Value| if let Value::Object(fields) = part { fields } else { Map::new() };
    Value::Object(parts.into_iter().flat_map(fields).collect())
}

/// A field that is there only with a value.
fn optional(key: &str, value: Option<impl Serialize>) -> Value {
    value.map_or(Value::Null, |value| json!({ key: value }))
}

/// A result as a JSON value.
pub(super) fn result(result: &QueryResult) -> Value {
    let QueryResult { asked, consumed, .. } = result;
    joined([
        json!({
            "index": asked.index,
            "name": asked.name,
            "query": asked.text,
            "file": asked.file,
            "line": asked.line,
            "settings": setting::object(&asked.settings),
            "kind": asked.kind.name(),
            "verdict": result.verdict.map(Verdict::name),
            "certifies": result.certifies,
            "horizon": asked.horizon,
        }),
        optional("given", asked.given.as_ref()),
        json!({
            "estimate": maybe(result.estimate),
            "low": number(result.low),
            "high": number(result.high),
            "censored": result.censored.is_some(),
            "of": result.of,
            "unit": result.unit,
            "interval": result.interval,
            "method": method(&result.method),
        }),
        json!(consumed.counts),
        json!({ "clipped": consumed.clipped, "shrunk": consumed.shrunk }),
        optional("no_way", Some(consumed.no_way).filter(|count| *count > 0)),
        json!({ "steps": consumed.steps, "stopped_by": result.stopped_by.name() }),
        optional("shortfall", result.shortfall().map(Shortfall::name)),
        result.compare.as_ref().map_or(Value::Null, |Comparison { first, second, difference }| {
            json!({ "first": side(first), "second": side(second), "difference": side(difference) })
        }),
        result.rank.as_ref().map_or(Value::Null, |found| ranking(found, asked.kind == Kind::Pareto)),
        optional("every", result.every.as_ref().map(every)),
        optional("model", result.model.as_ref()),
        optional("distribution", result.distribution.as_ref().map(distribution)),
        optional("splitting", result.rare),
        optional("evidence", result.evidence.as_ref().map(evidence)),
        json!({
            "warnings": result.warnings,
            "witnesses": result.witnesses.iter().map(|one| witness(one, asked.against)).collect::<Vec<_>>(),
            "replay": result.replay,
            "elapsed_s": result.elapsed_s,
        }),
    ])
}

fn method(method: &Method) -> Value {
    let numbers = method.numbers.iter().map(|(name, value)| (name.clone(), number(*value)));
    joined([json!({ "name": method.name }), Value::Object(numbers.collect())])
}

fn interval(value: &Interval) -> Value {
    json!({ "estimate": number(value.estimate), "low": number(value.low), "high": number(value.high) })
}

fn ranking(found: &Ranking, is_pareto: bool) -> Value {
    let option = |option: &RankedOption| {
        let RankedOption { label, value, counts, under, also: beside, settings, .. } = option;
        let under: Vec<Value> = under.iter().map(side).collect();
        let beside: Vec<Value> = beside.iter().map(also).collect();
        joined([
            json!({ "option": label }),
            interval(value),
            json!(counts),
            json!({ "status": option.status.name() }),
            optional("under", Some(under).filter(|all| !all.is_empty())),
            optional("also", Some(beside).filter(|all| !all.is_empty())),
            optional("settings", (!settings.is_empty()).then(|| setting::object(settings))),
        ])
    };
    joined([
        json!({ "choice": found.choice }),
        optional("aim", is_pareto.then_some(&found.aim)),
        optional("front", is_pareto.then(|| front(found).collect::<Vec<_>>())),
        optional("none", found.is_empty.then_some(true)),
        optional("means", found.means.as_ref()),
        json!({
            "gap": number(found.gap),
            "tied": found.tied,
            "options": found.options.iter().map(option).collect::<Vec<_>>(),
        }),
    ])
}

fn also(also: &Also) -> Value {
    let rest = json!({ "unit": also.unit, "holds": also.holds });
    joined([json!({ "what": also.what }), interval(&also.value), rest])
}

fn every(every: &Every) -> Value {
    let best = |(option, worth): &(String, f64)| json!({ "option": option, "estimate": number(*worth) });
    let part = |part: &UnderOne| {
        joined([
            interval(&part.figure),
            json!({ "value": part.setting.1 }),
            json!(part.counts),
            json!({ "verdict": part.verdict.map(Verdict::name) }),
            optional("best", part.best.as_ref().map(best)),
        ])
    };
    let parts: Vec<Value> = every.parts.iter().map(part).collect();
    json!({ "name": every.name, "least": every.least_value(), "values": parts })
}

fn side(side: &Side) -> Value {
    joined([json!({ "settings": side.label }), interval(&side.value), json!(side.counts)])
}

fn witness(witness: &Witness, against: bool) -> Value {
    let decider = |decider: &Decider| {
        let value = decider.value.filter(|value| value.is_finite());
        joined([
            json!({ "agent": decider.agent, "place": decider.place }),
            optional("level", decider.level.as_ref()),
            value.map_or(Value::Null, |value| json!({ "value": value, "unit": decider.unit })),
            optional("other", decider.other.as_ref()),
        ])
    };
    let shown = json!({
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
    joined([shown, optional("decided_by", witness.decider.as_ref().map(decider))])
}

fn evidence(found: &Evidence) -> Value {
    match found {
        Evidence::Values(snapshots) => {
            let pair = |above: f64, below: f64| json!({ "above": number(above), "below": number(below) });
            let shown = |one: &Snapshot| {
                let weights = one.weights.map_or(Value::Null, |[above, below]| pair(above.log, below.log));
                joined([json!({ "trials": one.trials }), interval(&one.value), weights])
            };
            let weights = snapshots.iter().find_map(|one| one.weights);
            let thresholds = weights.map(|[above, below]| pair(above.threshold, below.threshold));
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
    let histogram = |histogram: &Histogram| {
        json!({
            "low": number(histogram.low),
            "high": number(histogram.high),
            "counts": histogram.counts,
            "below": histogram.below,
            "beyond": histogram.beyond,
        })
    };
    let quantile = |one: &Quantile| joined([json!({ "level": one.level }), interval(&one.value)]);
    let step = |step: &Step| json!({ "value": number(step.value), "share": number(step.share) });
    let point = |point: &CurvePoint| joined([json!({ "at": number(point.at) }), interval(&point.value)]);
    let curve = |curve: &Curve| {
        let points: Vec<Value> = curve.points.iter().map(point).collect();
        json!({ "name": curve.name, "unit": curve.unit, "points": points })
    };
    let shown = json!({
        "histogram": found.histogram.as_ref().map(histogram),
        "quantiles": found.quantiles.iter().map(quantile).collect::<Vec<_>>(),
        "empirical": found.empirical.iter().map(step).collect::<Vec<_>>(),
        "band": found.band,
    });
    joined([shown, optional("curve", found.curve.as_ref().map(curve))])
}
