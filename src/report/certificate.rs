//! Certificates: a text file of lines by which a stranger checks the results of a call. Each line is a JSON object: the head, for
//! each result what was asked, by which rule, and what it claims, then its outcomes in the order of their trials; and at the end
//! the SHA-256 of all lines before. `docs/proofs.md` describes the fields; `smc verify` and `tools/verify.py` read them.
//!
//! Truth values are runs (how often false, then how often true, and so on) or bits in base64, the first trial in the lowest
//! bit of the first byte; whichever is shorter.

use super::json;
use crate::base::digest::Digest;
use crate::base::random;
use crate::compile::Study;
use crate::compile::study::{Ask, Measure, Query, RankOption};
use crate::engine::outcome::{CallResult, QueryResult};
use crate::engine::shards::{Column, Kept, RunRecord, SplitRun};
use crate::engine::{Budget, Call, last_evidence};
use crate::logic::Root;
use crate::trials::cell::Reading;
use crate::trials::setup::is_never_early;
use base64::{Engine, prelude::BASE64_STANDARD};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::fmt::Write as _;
use thiserror::Error;

/// The first field of a certificate: what it is, and the version of its format.
const FORMAT: &str = "certificate 1";
/// Fields of a result that are no part of its claim.
const LEFT_OUT: [&str; 6] = ["witnesses", "replay", "elapsed_s", "evidence", "distribution", "steps"];
/// Most outcomes of a line that are read.
const MOST: u64 = 1 << 28;

/// What the results of a certificate are of.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Head {
    /// The format, and its version.
    smc: String,
    /// Version of the program.
    pub version: String,
    /// The commit from which it was built, if whoever built it said so in the variable `SMC_COMMIT`.
    pub commit: Option<String>,
    /// The scenario.
    pub scenario: String,
    /// Seed of all random numbers.
    pub seed: u64,
    /// The generator of random numbers, and how it is addressed.
    pub generator: (String, u32),
    /// Input files with their digests.
    pub inputs: Vec<(String, String)>,
    /// The presets of people.
    pub people: Vec<String>,
    /// Values of `--set`.
    pub settings: Vec<String>,
    /// Value of `--velocity`.
    pub velocity: Option<String>,
    /// Values of `--models`.
    pub models: Vec<String>,
    /// Largest number of trials of a query.
    pub max_trials: u64,
    /// Largest number of trials of a ranking.
    pub total_trials: Option<u64>,
}

/// A result with what it was found from.
#[derive(Clone, Debug)]
pub struct Entry {
    /// Its fields, as in the JSON report.
    pub result: Value,
    /// What it certifies, in numbers.
    pub claim: Value,
    /// What was asked: one query, or one for each value of a parameter.
    pub queries: Vec<Query>,
    /// The outcomes of each column.
    pub outcomes: Vec<(Column, Vec<Reading>)>,
    /// The columns that are times.
    pub times: Vec<(Column, Time)>,
    /// The evidence of a test at its end.
    pub evidence: Value,
    /// The runs of splitting.
    pub runs: Vec<(SplitRun, RunRecord)>,
}

/// A number that is never below 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Time {
    /// A time until something, which may lie beyond the horizon.
    Until,
    /// The time of a leg, a magnitude.
    Length,
}

/// Why a text is no certificate.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{0}")]
pub struct Unreadable(String);

fn unreadable(reason: impl Into<String>) -> Unreadable {
    Unreadable(reason.into())
}

/// The certificate of a call whose outcomes were kept.
pub fn text(study: &Study, call: &Call<'_>, budget: &Budget, run: &CallResult, kept: &Kept) -> String {
    let line = &call.line;
    let head = Head {
        smc: FORMAT.to_owned(),
        version: run.version.clone(),
        commit: option_env!("SMC_COMMIT").map(str::to_owned),
        scenario: run.scenario.clone(),
        seed: run.seed,
        generator: (random::GENERATOR.to_owned(), random::LAYOUT),
        inputs: run.inputs.iter().map(|(file, print)| (file.clone(), print.to_string())).collect(),
        people: run.people.iter().map(ToString::to_string).collect(),
        settings: line.settings.clone(),
        velocity: line.velocity.clone(),
        models: line.models.clone(),
        max_trials: budget.max_trials,
        total_trials: budget.max_total,
    };
    let mut lines = vec![json!(head)];
    for result in &run.results {
        let queries = queries(study, result);
        lines.push(json!({ "result": fields(result), "claim": result.certificate, "queries": queries }));
        for (option, column, count) in read_by(&queries, result) {
            let mut head = json!({ "option": option, "column": column });
            if let Some(time) = time(study, column) {
                head["time"] = json!(time);
            }
            let readings = kept.readings(column, count);
            if let [query] = queries[..]
                && let Some(evidence) = evidence(query, &readings)
            {
                head["evidence"] = evidence;
            }
            lines.push(json::joined([head, packed(&readings)]));
        }
        if let Some((world, _)) = queries.iter().find_map(|query| split(&query.ask)) {
            lines.push(json!({ "runs_of_splitting": kept.runs(world) }));
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

/// The evidence of a test after the last trial but one, and after the last one: its logarithms for above and for below.
pub fn evidence(query: &Query, readings: &[Reading]) -> Option<Value> {
    let weights = last_evidence(&query.ask, readings)?;
    Some(json!(weights.map(|both| both.map(|weight| weight.log))))
}

/// Reads a certificate.
///
/// # Errors
/// If the text is none, or was changed.
pub fn read(text: &str) -> Result<(Head, Vec<Entry>), Unreadable> {
    let body = text.trim_end().rfind('\n').map_or(0, |at| at + 1);
    let digest =
        || Some(serde_json::from_str::<Value>(&text[body..]).ok()?.get("digest")?.as_str()?.to_owned());
    let digest = digest()
        .ok_or_else(|| unreadable("its last line has no digest: it is cut short, or is no certificate"))?;
    if digest != Digest::of(&text.as_bytes()[..body]).to_string() {
        return Err(unreadable("its digest does not match: it was changed"));
    }
    let mut lines = text[..body].lines().map(|line| {
        serde_json::from_str::<Value>(line)
            .map_err(|error| unreadable(format!("a line is not JSON: {error}")))
    });
    let first = lines.next().ok_or_else(|| unreadable("it is empty"))??;
    match first["smc"].as_str() {
        Some(FORMAT) => {}
        other => {
            return Err(unreadable(format!("it is `{}`, not `{FORMAT}`", other.unwrap_or("nothing known"))));
        }
    }
    let mut entries: Vec<Entry> = Vec::new();
    for line in lines {
        let mut line = line?;
        if line.get("result").is_some() {
            let [result, claim, queries] = ["result", "claim", "queries"].map(|name| line[name].take());
            let (outcomes, times, runs) = (Vec::new(), Vec::new(), Vec::new());
            let (queries, evidence) = (known(queries)?, Value::Null);
            entries.push(Entry { result, claim, queries, outcomes, times, evidence, runs });
            continue;
        }
        let entry = entries.last_mut().ok_or_else(|| unreadable("outcomes stand before the first result"))?;
        match line.get_mut("runs_of_splitting") {
            Some(runs) => entry.runs.extend(known::<Vec<_>>(runs.take())?),
            None => {
                let column = known(line["column"].take())?;
                if let Some(time) = line.get_mut("time") {
                    entry.times.push((column, known(time.take())?));
                }
                if let Some(evidence) = line.get_mut("evidence") {
                    entry.evidence = evidence.take();
                }
                entry.outcomes.push((column, unpacked(line)?));
            }
        }
    }
    Ok((known(first)?, entries))
}

fn known<T: serde::de::DeserializeOwned>(value: Value) -> Result<T, Unreadable> {
    serde_json::from_value(value).map_err(|error| unreadable(format!("a line does not fit: {error}")))
}

/// What is known of a column without its outcomes: that it is a time until something, or else another number that is never below 0.
pub fn time(study: &Study, (world, _, column): Column) -> Option<Time> {
    let world = study.worlds.get(world)?;
    match world.columns.get(column)?.root {
        Root::Metric(term) if !is_never_early((&world.tree, &world.signals), term) => None,
        Root::Metric(term) if world.tree.is_time_until(term) => Some(Time::Until),
        Root::Metric(_) => Some(Time::Length),
        Root::Formula(_) | Root::Robustness(..) => None,
    }
}

/// The fields of a result that a certificate has.
pub fn fields(result: &QueryResult) -> Value {
    let mut fields = json::result(result);
    if let Value::Object(fields) = &mut fields {
        fields.retain(|name, _| !LEFT_OUT.contains(&name.as_str()));
    }
    fields
}

/// The queries that a result answers: one, or all under every value of a parameter.
pub fn queries<'s>(study: &'s Study, result: &QueryResult) -> Vec<&'s Query> {
    let of_index = study.queries.iter().filter(|query| query.index == result.asked.index);
    let (own, others): (Vec<_>, Vec<_>) = of_index.partition(|query| query.settings == result.asked.settings);
    if own.is_empty() { others } else { own }
}

/// The columns whose trials a result has read, how many of each (all there are: `u64::MAX`), and the option or the side that each
/// is of.
pub fn read_by(queries: &[&Query], result: &QueryResult) -> Vec<(Option<String>, Column, u64)> {
    let mut all = Vec::new();
    for (place, query) in queries.iter().enumerate() {
        let columns = columns(&query.ask);
        let width = match &query.ask {
            Ask::Rank { options, .. } => columns.len() / options.len().max(1),
            _ => 1,
        };
        for (k, (option, column)) in columns.into_iter().enumerate() {
            let count = match &query.ask {
                // Splitting has some trials besides its runs.
                Ask::Estimate { level: Some(_), .. } => u64::MAX,
                Ask::Rank { models, .. } => count(result, k / width % (*models).max(1), option.as_deref()),
                _ => count(result, place, None),
            };
            all.push((option, column, count));
        }
    }
    all
}

/// The world and the columns of a question for splitting.
pub fn split(ask: &Ask) -> Option<(usize, [usize; 2])> {
    match ask {
        Ask::Estimate { measure, level: Some(level), .. } => {
            Some((measure.target.world, [measure.target.column, *level]))
        }
        _ => None,
    }
}

/// The columns of the trials that a query reads, with the option or the side that each is of.
pub fn columns(ask: &Ask) -> Vec<(Option<String>, Column)> {
    match ask {
        Ask::Check { measure, .. } | Ask::Estimate { measure, .. } => {
            vec![(None, (measure.target.world, None, measure.target.column))]
        }
        Ask::Compare { first, second, .. } => {
            let side = |(name, of): (&str, &Measure)| {
                (Some(name.to_owned()), (of.target.world, None, of.target.column))
            };
            [("first", first), ("second", second)].map(side).into()
        }
        Ask::Rank { options, .. } => {
            let of = |option: &RankOption| {
                let own = std::iter::once(option.target.column).chain(option.beside.iter().copied());
                let place = |column| (option.target.world, option.advice, column);
                own.map(|column| (Some(option.label.clone()), place(column))).collect::<Vec<_>>()
            };
            options.iter().flat_map(of).collect()
        }
    }
}

/// How many trials of a column a result has read, where the value of a parameter is the one of this place.
fn count(result: &QueryResult, place: usize, option: Option<&str>) -> u64 {
    let trials = result.consumed.counts.trials;
    match (&result.compare, &result.rank, &result.every) {
        (Some(found), ..) => found.difference.counts.trials,
        (_, Some(found), _) => {
            let of = found.options.iter().find(|known| Some(known.label.as_str()) == option);
            of.map_or(trials, |of| of.under.get(place).map_or(of.counts, |side| side.counts).trials)
        }
        // Each value of a parameter has trials of its own.
        (.., Some(every)) => every.parts.get(place).map_or(0, |part| part.counts.trials),
        _ => trials,
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

/// The readings of a line.
fn unpacked(line: Value) -> Result<Vec<Reading>, Unreadable> {
    #[derive(Deserialize)]
    struct Line {
        count: u64,
        unresolved: Vec<usize>,
        values: Option<Vec<Value>>,
        runs: Option<Vec<u64>>,
        bits: Option<String>,
    }
    let Line { count, unresolved, values, runs, bits } = known(line)?;
    if count > MOST {
        return Err(unreadable(format!("{count} outcomes are more than are read")));
    }
    let count = count as usize;
    let mut readings: Vec<Reading> = match (values, runs, bits) {
        (Some(values), None, None) => {
            let value = |value: &Value| match value {
                Value::Null => Some(Reading::Unresolved),
                Value::String(text) => text.parse().ok().map(Reading::Value),
                value => value.as_f64().map(Reading::Value),
            };
            values
                .iter()
                .map(value)
                .collect::<Option<_>>()
                .ok_or_else(|| unreadable("a value is no number"))?
        }
        (None, Some(runs), None) => {
            let sum = runs.iter().try_fold(0_u64, |sum, run| sum.checked_add(*run));
            if sum != Some(count as u64) {
                return Err(unreadable(format!("its runs are not of {count} trials")));
            }
            let one =
                |(k, run): (usize, &u64)| std::iter::repeat_n(Reading::Truth(k % 2 == 1), *run as usize);
            runs.iter().enumerate().flat_map(one).collect()
        }
        (None, None, Some(bits)) => {
            let bytes = BASE64_STANDARD.decode(bits).map_err(|_| unreadable("its bits are not base64"))?;
            if bytes.len() != count.div_ceil(8) {
                return Err(unreadable(format!("its bits are not of {count} trials")));
            }
            let truth = |k: usize| Reading::Truth(bytes[k / 8] >> (k % 8) & 1 == 1);
            (0..count).map(truth).collect()
        }
        _ => return Err(unreadable("a line has no outcomes")),
    };
    if readings.len() != count || unresolved.iter().any(|place| *place >= count) {
        return Err(unreadable(format!("a line has not the outcomes of {count} trials")));
    }
    for place in unresolved {
        readings[place] = Reading::Unresolved;
    }
    Ok(readings)
}
