//! Certificates: a text file of lines by which a stranger checks the results of a call. Each line is a JSON object: the head, for
//! each result what was asked, by which rule, and what it claims, then its outcomes in the order of their trials; and at the end
//! the SHA-256 of all lines before. `docs/proofs.md` describes the fields, `tools/verify.py` reads them.
//!
//! Truth values are runs (how often false, then how often true, and so on) or bits in base64, the first trial in the lowest
//! bit of the first byte; whichever is shorter.

use super::json;
use crate::base::digest::Digest;
use crate::base::random;
use crate::compile::Study;
use crate::compile::study::{Ask, Measure, MeasureKind, Query, Role};
use crate::engine::outcome::{CallResult, QueryResult};
use crate::engine::shards::{Column, Kept};
use crate::trials::cell::Reading;
use base64::{Engine, prelude::BASE64_STANDARD};
use serde_json::{Value, json};
use std::fmt::Write as _;

/// The first field of a certificate: what it is, and the version of its format.
const FORMAT: &str = "certificate 1";
/// Fields of a result that are no part of its claim.
const LEFT_OUT: [&str; 6] = ["witnesses", "replay", "elapsed_s", "evidence", "distribution", "steps"];

/// The certificate of a call whose outcomes were kept.
pub fn text(study: &Study, run: &CallResult, kept: &Kept) -> String {
    let inputs: Vec<Value> =
        run.inputs.iter().map(|(file, print)| json!([file, print.to_string()])).collect();
    let mut lines = vec![json!({
        "smc": FORMAT,
        "version": run.version,
        "scenario": run.scenario,
        "seed": run.seed,
        "generator": [random::GENERATOR, random::LAYOUT],
        "inputs": inputs,
        "people": run.people,
    })];
    for result in &run.results {
        let queries = queries(study, result);
        let mut fields = json::result(result);
        if let Value::Object(fields) = &mut fields {
            fields.retain(|name, _| !LEFT_OUT.contains(&name.as_str()));
        }
        let asks: Vec<Value> = queries.iter().map(|query| asked(&query.ask)).collect();
        lines.push(json!({ "result": fields, "claim": result.certificate, "ask": asks }));
        for (number, query) in queries.iter().enumerate() {
            for (option, measure, column, count) in columns(&query.ask, result) {
                let head = json!({ "outcomes": result.asked.index, "ask": number, "option": option, "measure": measure });
                lines.push(json::joined([head, packed(&kept.readings(column, count))]));
            }
            if let Ask::Estimate { measure, level: Some(_), .. } = &query.ask {
                let runs = kept.runs(measure.target.world);
                let runs =
                    runs.iter().map(|(run, found)| json!([run.branch, run.lost_reaches, found.estimate]));
                let runs: Vec<Value> = runs.collect();
                lines.push(json!({ "runs": result.asked.index, "estimates": runs }));
            }
        }
    }
    let mut text = String::new();
    for line in lines {
        let _ = writeln!(text, "{line}");
    }
    let digest = Digest::of(text.as_bytes());
    let _ = writeln!(text, "{}", json!({ "digest": digest.to_string() }));
    text
}

/// The queries that a result answers: one, or all under every value of a parameter.
fn queries<'s>(study: &'s Study, result: &QueryResult) -> Vec<&'s Query> {
    let of_index = study.queries.iter().filter(|query| query.index == result.asked.index);
    let (own, others): (Vec<_>, Vec<_>) = of_index.partition(|query| query.settings == result.asked.settings);
    if own.is_empty() { others } else { own }
}

/// What a query asks, in numbers.
fn asked(ask: &Ask) -> Value {
    match ask {
        Ask::Check { measure: of, at_least, or_equal, threshold, beside, .. } => json!({
            "check": measure(of), "at_least": at_least, "or_equal": or_equal, "theta": threshold, "beside": beside,
        }),
        Ask::Estimate { measure: of, .. } => json!({ "estimate": measure(of) }),
        Ask::Compare { first, within, delta, .. } => {
            json!({ "compare": measure(first), "within": within, "delta": delta })
        }
        Ask::Rank { measure: of, models, beside, .. } => {
            let role = |role: &Role| match role {
                Role::Constraint { at_least, threshold, .. } => {
                    json!({ "at_least": at_least, "theta": threshold })
                }
                Role::Aim { epsilon } => json!({ "epsilon": epsilon }),
            };
            let beside = beside.iter().map(|one| json::joined([kind(&one.kind), role(&one.role)]));
            json!({ "rank": measure(of), "models": models, "beside": beside.collect::<Vec<_>>() })
        }
    }
}

fn measure(measure: &Measure) -> Value {
    kind(&measure.kind)
}

fn kind(kind: &MeasureKind) -> Value {
    match kind {
        MeasureKind::Probability => json!({ "kind": "probability" }),
        MeasureKind::Expectation { range, level: None, .. } => json!({ "kind": "mean", "range": range }),
        MeasureKind::Expectation { range, level, .. } => {
            json!({ "kind": "tail", "range": range, "level": level })
        }
        MeasureKind::Quantile { level, .. } => json!({ "kind": "quantile", "level": level }),
        MeasureKind::Curve { times, falls, .. } => json!({ "kind": "curve", "times": times, "falls": falls }),
    }
}

/// The columns that a result has read: option, measure, where they are, and of how many trials.
fn columns(ask: &Ask, result: &QueryResult) -> Vec<(Option<String>, usize, Column, u64)> {
    let trials = result.consumed.counts.trials;
    match ask {
        Ask::Check { measure, .. } | Ask::Estimate { measure, .. } => {
            vec![(None, 0, (measure.target.world, None, measure.target.column), trials)]
        }
        Ask::Compare { first, second, .. } => {
            let pairs = result.compare.as_ref().map_or(0, |found| found.difference.counts.trials);
            let side = |(name, of): (&str, &Measure)| {
                (Some(name.to_owned()), 0, (of.target.world, None, of.target.column), pairs)
            };
            [("first", first), ("second", second)].map(side).into()
        }
        Ask::Rank { options, .. } => {
            let ranked = result.rank.iter().flat_map(|rank| &rank.options);
            let count = |label: &str| {
                let found = ranked.clone().find(|option| option.label == label);
                found.map_or(trials, |option| option.counts.trials)
            };
            let all = options.iter().flat_map(|option| {
                let columns = std::iter::once(option.target.column).chain(option.beside.iter().copied());
                columns.enumerate().map(move |(measure, column)| {
                    let place = (option.target.world, option.advice, column);
                    (Some(option.label.clone()), measure, place, option.label.as_str())
                })
            });
            all.map(|(option, measure, place, label)| (option, measure, place, count(label))).collect()
        }
    }
}

/// Readings as fields of a line.
fn packed(readings: &[Reading]) -> Value {
    let is_lost = |reading: &Reading| matches!(reading, Reading::Unresolved | Reading::Faulty);
    let lost: Vec<usize> = (0..readings.len()).filter(|k| is_lost(&readings[*k])).collect();
    let head = json!({ "count": readings.len(), "unresolved": lost });
    let body = if readings.iter().any(|reading| matches!(reading, Reading::Value(_))) {
        let value = |reading: &Reading| match reading {
            Reading::Value(value) if value.is_finite() => json!(value),
            Reading::Value(value) => json!(value.to_string()),
            _ => Value::Null,
        };
        json!({ "values": readings.iter().map(value).collect::<Vec<_>>() })
    } else {
        truths(&readings.iter().map(|reading| *reading == Reading::Truth(true)).collect::<Vec<_>>())
    };
    json::joined([head, body])
}

/// Truth values as runs or as bits.
fn truths(truths: &[bool]) -> Value {
    let mut runs = Vec::new();
    let mut last = false;
    let mut length = 0_u64;
    for truth in truths {
        if *truth != last {
            runs.push(length);
            (last, length) = (*truth, 0);
        }
        length += 1;
    }
    runs.push(length);
    let mut bytes = vec![0_u8; truths.len().div_ceil(8)];
    for (k, _) in truths.iter().enumerate().filter(|(_, truth)| **truth) {
        bytes[k / 8] |= 1 << (k % 8);
    }
    let (runs, bits) = (json!({ "runs": runs }), json!({ "bits": BASE64_STANDARD.encode(bytes) }));
    if runs.to_string().len() <= bits.to_string().len() { runs } else { bits }
}
