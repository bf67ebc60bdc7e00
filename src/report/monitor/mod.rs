//! Properties of recorded people: `smc monitor`.

mod number;
#[cfg(test)]
mod tests;

pub use number::MonitoredNumber;

use crate::data::tracks::Velocity;
use crate::replay::Beyond;
use crate::report::number::{count, counted, maybe_estimated, plain, thousandths};
use crate::report::text::columns::table;
use crate::stats::bootstrap::{Bootstrap, DRAWS, Estimate, ratio};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::io;

/// Properties on a recording, and how they were read.
#[derive(Clone, Debug, PartialEq)]
pub struct Monitored {
    /// Name of the scenario's file.
    pub model: String,
    /// Names of the files of properties.
    pub properties: Vec<String>,
    /// Name of the recording.
    pub recording: String,
    /// Which velocities were used.
    pub velocity: Velocity,
    /// The person who is the user; `None` if each one is in turn.
    pub user: Option<u32>,
    /// Time between instants, s.
    pub every: f64,
    /// What is assumed of people after their tracks.
    pub beyond: Beyond,
    /// Confidence of intervals.
    pub confidence: f64,
    /// The properties, in order.
    pub results: Vec<MonitoredProperty>,
    /// The numbers that queries estimate, in order.
    pub numbers: Vec<MonitoredNumber>,
    /// All instants, in the order of the rows.
    pub instants: Vec<MonitoredInstant>,
}

/// All properties from one instant on, with one person as the user.
#[derive(Clone, Debug, PartialEq)]
pub struct MonitoredInstant {
    /// Time in the recording, s.
    pub time: f64,
    /// Id of the person.
    pub person: u32,
    /// One for each property, in order.
    pub verdicts: Vec<InstantVerdict>,
}

/// A property at one instant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InstantVerdict {
    /// It is satisfied.
    True,
    /// It is violated.
    False,
    /// It cannot be decided, for this reason: `the track ends`.
    Unresolved(&'static str),
}

impl InstantVerdict {
    /// `true`, `false`, `unresolved`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::True => "true",
            Self::False => "false",
            Self::Unresolved(_) => "unresolved",
        }
    }
}

// Monitored properties as CSV, one row an instant of a person.

/// `time,person` and a column for each property: `true`, `false` or `unresolved`. Times are to 1 ms.
///
/// # Errors
/// Errors of the writer.
pub fn write_csv(out: impl io::Write, report: &Monitored) -> io::Result<()> {
    let mut table = csv::Writer::from_writer(out);
    let names = report.results.iter().map(|one| one.name.as_str());
    table.write_record(["time", "person"].into_iter().chain(names))?;
    for one in &report.instants {
        let cells = [thousandths(one.time).to_string(), one.person.to_string()];
        let verdicts = one.verdicts.iter().map(|verdict| verdict.name());
        table.write_record(cells.iter().map(String::as_str).chain(verdicts))?;
    }
    table.flush()
}

// One property over all instants of a recording.

/// How often a property was satisfied.
#[derive(Clone, Debug, PartialEq)]
pub struct MonitoredProperty {
    /// Its name.
    pub name: String,
    /// Number of instants at which it is satisfied.
    pub satisfied: u64,
    /// Number of instants at which it is violated.
    pub violated: u64,
    /// Number of instants at which it is unresolved.
    pub unresolved: u64,
    /// The reasons of unresolved instants, with their numbers.
    pub reasons: BTreeMap<&'static str, u64>,
    /// Number of persons with an instant.
    pub persons: u64,
    /// Share of satisfied among resolved instants, with an interval over persons; `None` if no instant is resolved.
    pub share: Option<Estimate>,
}

impl MonitoredProperty {
    /// The summary of property number `index`.
    pub fn of(name: &str, index: usize, instants: &[MonitoredInstant], confidence: f64) -> Self {
        let mut parts = BTreeMap::<u32, [f64; 2]>::new();
        let mut reasons = BTreeMap::new();
        let (mut satisfied, mut violated, mut unresolved) = (0, 0, 0);
        for instant in instants {
            let [yes, resolved] = parts.entry(instant.person).or_default();
            match instant.verdicts.get(index) {
                Some(InstantVerdict::True) => {
                    satisfied += 1;
                    *yes += 1.0;
                    *resolved += 1.0;
                }
                Some(InstantVerdict::False) => {
                    violated += 1;
                    *resolved += 1.0;
                }
                Some(InstantVerdict::Unresolved(reason)) => {
                    unresolved += 1;
                    *reasons.entry(*reason).or_default() += 1;
                }
                None => {}
            }
        }
        let parts: Vec<[f64; 2]> = parts.into_values().collect();
        let bootstrap = Bootstrap { persons: parts.len(), draws: DRAWS, seed: 0, confidence };
        let share = bootstrap.estimate(ratio(&parts));
        let (name, persons) = (name.to_owned(), parts.len() as u64);
        Self { name, satisfied, violated, unresolved, reasons, persons, share }
    }

    /// Number of instants.
    pub const fn instants(&self) -> u64 {
        self.satisfied + self.violated + self.unresolved
    }
}

// Monitored properties for people.

/// A table with a row for each property, and why instants are unresolved.
pub fn to_text(report: &Monitored) -> String {
    let mut out = String::new();
    let Monitored { model, recording, every, .. } = report;
    let (level, velocity) = (plain(100.0 * report.confidence), report.velocity.name());
    let user = match report.user {
        Some(id) => format!("user: person {id}"),
        None => "each person is the user in turn".to_owned(),
    };
    let beyond = match report.beyond {
        Beyond::Unresolved => "nothing is assumed",
        Beyond::Onward => "people go straight on",
    };
    let files = report.properties.join(", ");
    let _ = writeln!(out, "{recording} ({velocity} velocities), {model}, {files}");
    let _ = writeln!(out, "{user}, every {} s; after the end of a track: {beyond}\n", plain(*every));
    let rows = report.results.iter().map(|one| {
        let [satisfied, violated, unresolved, persons] =
            [one.satisfied, one.violated, one.unresolved, one.persons].map(count);
        vec![one.name.clone(), satisfied, violated, unresolved, persons, maybe_estimated(one.share, "")]
    });
    let heads = ["property", "satisfied", "violated", "unresolved", "persons", "share satisfied"];
    if !report.results.is_empty() {
        table(&mut out, "", &heads, rows);
    }
    if !report.numbers.is_empty() {
        let parts = if report.user.is_some() { "blocks" } else { "persons" };
        let rows = report.numbers.iter().map(|one| {
            let unit = if one.unit.is_empty() { String::new() } else { format!(" {}", one.unit) };
            let [instants, unresolved, clipped, parts] =
                [one.instants, one.unresolved, one.clipped, one.parts].map(count);
            let value = maybe_estimated(one.estimate, &unit);
            vec![one.name.clone(), instants, unresolved, clipped, parts, value]
        });
        out.push_str(if report.results.is_empty() { "" } else { "\n" });
        table(&mut out, "", &["number", "instants", "unresolved", "clipped", parts, "value"], rows);
        let drawn = match report.user {
            Some(_) => format!("blocks of {} s", plain(number::BLOCK)),
            None => "persons".to_owned(),
        };
        let _ = writeln!(out, "\nvalue: of all instants, with a {level} % interval (bootstrap over {drawn})");
    }
    if report.results.is_empty() {
        return out;
    }
    let _ = writeln!(
        out,
        "\nshare satisfied: of the resolved instants, with a {level} % interval (bootstrap over persons)"
    );
    for one in &report.results {
        for (reason, number) in one.reasons.iter().filter(|(reason, _)| !reason.is_empty()) {
            let _ = writeln!(out, "{}: {} unresolved: {reason}", one.name, counted(*number, "instant"));
        }
    }
    out
}

// Monitored properties as one JSON object, without their instants; `docs/schema/monitor.schema.json` describes it.

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
        "numbers": report.numbers,
        "resampled": if report.user.is_some() { "blocks" } else { "persons" },
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
