//! Results recomputed from the outcomes of a certificate (`report::certificate`): the ordinary session reads these as if they
//! were the parts of shards, over worlds in which nothing happens. No procedure is described a second time here, so a fault of
//! one would not be seen; `tools/verify.py` shares no code with this.

use super::diagnostics::Diagnostics;
use super::model::Draft;
use super::refusal::refusals;
use crate::base::math;
use crate::base::random::{Purpose, Stream, TrialKey};
use crate::base::visible::visible;
use crate::compile::Study;
use crate::compile::study::{Ask, Query};
use crate::engine::shards::{Column, Part, Stored, again};
use crate::engine::{Budget, Call, CommandLine, Fault, Nobody, Threads, run};
use crate::kernel::driver::{Drivers, MakeDrivers};
use crate::logic::{Root, Term, TermId};
use crate::report::certificate::{self, Entry, Time};
use crate::trials::cell::Reading;
use serde_json::Value;
use std::collections::BTreeSet;

/// Fields of a result that outcomes do not say: where it was asked, marks of trials, why it was not more, warnings, what a move
/// means, and how often such a model was right.
const UNSAID: [&str; 9] =
    ["file", "line", "shrunk", "no_way", "stopped_by", "shortfall", "warnings", "means", "model"];
/// Numbers that another version rounds otherwise are the same.
const SAME: f64 = 1e-9;
/// More worlds, and columns of all worlds together, than a certificate has.
const WORLDS: usize = 1 << 14;
const COLUMNS: usize = 1 << 20;

/// A world in which nothing happens.
const NOTHING: &str = "process p { var x = 1 }";
/// A truth and a time.
const QUERIES: &str = "check P(p.x > 0) >= 0.5\nestimate Q(0.5, time_until(p.x > 0))";

/// Whether a result follows from its outcomes.
///
/// # Errors
/// Why it does not, in words.
pub fn follows(head: &certificate::Head, entry: &Entry, threads: &Threads) -> Result<(), String> {
    let study = study(entry)?;
    let part = Part::given(&entry.outcomes, &entry.runs);
    let heads = [&part.head];
    let reread = |_| Some(part.clone());
    let stored =
        Stored::new(&heads, &reread, threads).map_err(|_| "two of its lines contradict each other")?;
    let mut budget = Budget::new(head.max_trials, None);
    budget.max_total = head.total_trials;
    let place = |_| (String::new(), 0);
    let drivers = |_: &_, _| Drivers::default();
    let call = Call {
        seed: head.seed,
        branch: 0,
        explains: false,
        shows_evidence: false,
        repeats: false,
        line: CommandLine::default(),
        only: Vec::new(),
        place: &place,
        drivers: &drivers,
    };
    let run = run(&study, &call, &stored, &budget, &Nobody);
    let run = run.map_err(|fault| refusals(&fault).first().map_or(String::new(), |one| one.title.clone()))?;
    let [result] = &run.results[..] else { return Err("it is not one result".to_owned()) };
    let queries: Vec<&Query> = entry.queries.iter().collect();
    let wanted = certificate::read_by(&queries, result);
    let is_read = |(_, column, count): &(_, Column, u64), (of, readings): &(Column, Vec<Reading>)| {
        column == of && [u64::MAX, readings.len() as u64].contains(count)
    };
    let is_whole = wanted.len() == entry.outcomes.len();
    if !is_whole || !wanted.iter().zip(&entry.outcomes).all(|(one, line)| is_read(one, line)) {
        let counts = |all: Vec<u64>| all.iter().map(u64::to_string).collect::<Vec<_>>().join(", ");
        let has = counts(entry.outcomes.iter().map(|(_, readings)| readings.len() as u64).collect());
        let reads = counts(wanted.iter().map(|(.., count)| *count).collect());
        return Err(format!("it has {has} outcomes, and the rule reads {reads}"));
    }
    let evidence = match (&entry.queries[..], &entry.outcomes[..]) {
        ([query], [(_, readings)]) => certificate::evidence(query, readings),
        _ => None,
    };
    differ("the evidence", &entry.evidence, &evidence.unwrap_or_default(), &[])?;
    differ("", &entry.result, &certificate::fields(result), &UNSAID)?;
    differ("the claim", &entry.claim, &serde_json::json!(result.certificate), &[])
}

/// Whether the study of the inputs asks what a certificate answers.
pub fn is_asked(study: &Study, entry: &Entry) -> bool {
    let is_same = |one: &Query, other: &Query| {
        one.ask == other.ask && one.text == other.text && one.settings == other.settings
    };
    let are_times = |(column, _): &(Column, Vec<Reading>)| {
        let told = entry.times.iter().find(|(known, _)| known == column).map(|(_, time)| *time);
        certificate::time(study, *column) == told
    };
    entry.queries.iter().all(|query| study.queries.iter().any(|one| is_same(one, query)))
        && entry.outcomes.iter().all(are_times)
}

/// An outcome that is another one when its trial is run again.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mismatch {
    /// The place of its result among the entries.
    pub entry: usize,
    /// Index of the trial.
    pub trial: u64,
    /// The outcome of the certificate.
    pub told: Reading,
    /// The outcome of the trial.
    pub found: Reading,
}

/// Trials that were run again.
#[derive(Clone, Debug, PartialEq)]
pub struct Audit {
    /// How many were drawn.
    pub draws: u64,
    /// The number of the verifier by which they were drawn.
    pub key: u64,
    /// What differs.
    pub differ: Vec<Mismatch>,
}

impl Audit {
    /// The largest share of forged outcomes that it misses with a probability.
    pub fn escapes(&self, probability: f64) -> f64 {
        1.0 - math::pow(probability, 1.0 / self.draws as f64)
    }
}

/// Runs trials again that are drawn by a key of the verifier, uniformly from all outcomes, and compares their outcomes.
///
/// # Errors
/// If a trial cannot be run.
pub fn audit(
    (study, drivers): (&Study, &MakeDrivers),
    (head, entries): (&certificate::Head, &[Entry]),
    (draws, key): (u64, u64),
    threads: &Threads,
) -> Result<Audit, Fault> {
    let lines: Vec<(usize, &(Column, Vec<Reading>))> = entries
        .iter()
        .enumerate()
        .flat_map(|(k, entry)| entry.outcomes.iter().map(move |line| (k, line)))
        .collect();
    let total: u64 = lines.iter().map(|(_, (_, readings))| readings.len() as u64).sum();
    if total == 0 {
        return Ok(Audit { draws: 0, key, differ: Vec::new() });
    }
    let mut drawn = vec![BTreeSet::new(); lines.len()];
    for draw in 0..draws {
        let [word, _] =
            Stream::of(TrialKey { seed: key, index: draw, branch: 0 }, 0, Purpose::Audit).words(0);
        // The remainder is uniform up to one part in 2^64 / total.
        let mut place = word % total;
        for (of, (_, (_, readings))) in lines.iter().enumerate() {
            if let Some(beyond) = place.checked_sub(readings.len() as u64) {
                place = beyond;
            } else {
                drawn[of].insert(place);
                break;
            }
        }
    }
    let mut differ = Vec::new();
    for ((entry, (column, readings)), drawn) in lines.into_iter().zip(drawn) {
        let drawn: Vec<u64> = drawn.into_iter().collect();
        let now = again((study, drivers), *column, (head.seed, &drawn), threads)?;
        for (trial, now) in drawn.into_iter().zip(now) {
            let told = readings[trial as usize];
            let is_same = told == now || told.value().zip(now.value()).is_some_and(|(a, b)| near(a, b));
            if !is_same {
                differ.push(Mismatch { entry, trial, told, found: now });
            }
        }
    }
    Ok(Audit { draws, key, differ })
}

/// Whether two numbers are the same but for rounding.
fn near(a: f64, b: f64) -> bool {
    a == b || (a - b).abs() <= SAME * a.abs().max(b.abs()).max(1.0)
}

/// The queries of a result over worlds in which nothing happens.
fn study(entry: &Entry) -> Result<Study, String> {
    let horizon = entry.queries.iter().find_map(|query| query.horizon.as_deref()).unwrap_or("1 step");
    // One step long, whatever its length.
    let step = if horizon.contains("step") { String::new() } else { format!("step = {horizon}\n") };
    let made = Draft::new("nothing.scn", format!("horizon = {horizon}\n{step}{NOTHING}"))
        .compiled(&[("nothing.bltl", QUERIES)]);
    let (mut study, _) = made.map_err(|found: Diagnostics| found.to_string())?;
    let targets = entry.queries.iter().flat_map(|query| certificate::columns(&query.ask));
    let split = entry.queries.iter().filter_map(|query| certificate::split(&query.ask));
    let runs = split.flat_map(|(world, both)| both.map(|column| (None, (world, None, column))));
    let (mut worlds, mut columns) = (0_usize, 0_usize);
    for query in &entry.queries {
        if let Ask::Rank { options, measure, models, .. } = &query.ask {
            if options.is_empty() || options.len().checked_rem(*models) != Some(0) {
                return Err(format!("it has {} options under {models} values", options.len()));
            }
            columns = columns.max(measure.target.column);
        }
    }
    for (_, (world, _, column)) in targets.chain(runs) {
        (worlds, columns) = (worlds.max(world), columns.max(column));
    }
    if worlds > WORLDS || (worlds + 1).saturating_mul(columns.saturating_add(1)) > COLUMNS {
        return Err(format!("it names column {columns} of world {worlds}"));
    }
    let mut world = study.worlds.swap_remove(0);
    let [truth, time] = &world.columns[..] else { return Err("it has no two columns".to_owned()) };
    let (until, mut length) = (time.clone(), time.clone());
    length.root = Root::Metric(TermId(world.tree.terms.len() as u32));
    world.tree.terms.push(Term::Constant(0.0));
    world.columns = vec![truth.clone(); columns + 1];
    study.worlds = vec![world; worlds + 1];
    for ((world, _, column), time) in &entry.times {
        if let Some(one) = study.worlds.get_mut(*world).and_then(|world| world.columns.get_mut(*column)) {
            *one = if *time == Time::Until { until.clone() } else { length.clone() };
        }
    }
    study.queries.clone_from(&entry.queries);
    study.title = String::new();
    Ok(study)
}

/// Where two values differ, in words; fields of the names `but` are not compared.
fn differ(place: &str, told: &Value, found: &Value, but: &[&str]) -> Result<(), String> {
    match (told, found) {
        (Value::Object(told), Value::Object(found)) => {
            let names = told.keys().chain(found.keys().filter(|name| !told.contains_key(*name)));
            for name in names.filter(|name| !but.contains(&name.as_str())) {
                let at =
                    |fields: &serde_json::Map<String, Value>| fields.get(name).cloned().unwrap_or_default();
                let inner =
                    if place.is_empty() { format!("`{name}`") } else { format!("`{name}` of {place}") };
                differ(&inner, &at(told), &at(found), but)?;
            }
            Ok(())
        }
        (Value::Array(told), Value::Array(found)) if told.len() == found.len() => {
            told.iter().zip(found).try_for_each(|(told, found)| differ(place, told, found, but))
        }
        (Value::Number(told), Value::Number(found))
            if told.as_f64().zip(found.as_f64()).is_some_and(|(a, b)| near(a, b)) =>
        {
            Ok(())
        }
        _ if told == found => Ok(()),
        _ => {
            let (told, found) = (told.to_string(), found.to_string());
            Err(format!("{place} is {}, and the outcomes say {found}", visible(&told)))
        }
    }
}
