//! Numbers of a recording: a summary for people, a table of all frames, JSON, and a page.

use super::html::{Page, Table};
use super::json;
use super::number::{brief, count};
use crate::data::table;
use crate::data::tracks::Recording;
use crate::engine::outcome::CallResult;
use crate::engine::traces::{Traces, Walk, recorded};
use crate::replay::measure::Measured;
use crate::replay::measure::encounters::Passing;
use crate::syntax::source::Source;
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::fmt::Write as _;

/// Quantiles of the summary.
const LEVELS: [f64; 3] = [0.05, 0.5, 0.95];
/// The post-encroachment times that are shown.
const SHOWN: usize = 5;
/// Units of numbers as columns of tables have them.
const UNITS: [&str; 8] = ["", "m", "s", "m/s", "/m^2", "/s", "steps", "m^2"];

/// The mean, the ends and some quantiles of a number over the frames that have it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Summary {
    frames: usize,
    mean: f64,
    ends: (f64, f64),
    quantiles: [f64; LEVELS.len()],
}

/// `None` where no frame has the number.
fn summary(measured: &Measured, number: usize) -> Option<Summary> {
    let values = measured.rows.iter().map(|(_, row)| row[number]).filter(|x| !x.is_nan());
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    let (first, last) = (*values.first()?, *values.last()?);
    let n = values.len();
    // The least value that is not below this share of all.
    let quantile = |level: f64| values[((level * n as f64).ceil() as usize).clamp(1, n) - 1];
    let mean = values.iter().sum::<f64>() / n as f64;
    Some(Summary { frames: n, mean, ends: (first, last), quantiles: LEVELS.map(quantile) })
}

/// What is said of the whole.
fn head(measured: &Measured) -> String {
    let frames = measured.rows.len() as u64;
    let seconds = measured.rows.last().map_or(0.0, |(time, _)| *time);
    format!("{} persons, {} frames, {} s", count(measured.persons as u64), count(frames), brief(seconds))
}

/// The table of the summary.
fn numbers(measured: &Measured) -> Table {
    let row = |(k, number): (usize, &crate::replay::measure::Number)| {
        let unit = if number.unit.is_empty() { String::new() } else { format!(" {}", number.unit) };
        let Some(Summary { frames, mean, ends, quantiles }) = summary(measured, k) else {
            return vec![number.name.clone(), "none".to_owned()];
        };
        let mut cells = vec![number.name.clone(), format!("{}{unit}", brief(mean)), brief(ends.0)];
        cells.extend(quantiles.iter().map(|x| brief(*x)));
        cells.extend([brief(ends.1), count(frames as u64)]);
        cells
    };
    Table {
        title: "Numbers of the recording".to_owned(),
        note: "Over the frames that have the number.".to_owned(),
        columns: vec!["number", "mean", "least", "5 %", "median", "95 %", "largest", "frames"],
        rows: measured.numbers.iter().enumerate().map(row).collect(),
    }
}

/// The table of those who passed a place soon after somebody else.
fn passings(measured: &Measured) -> Table {
    let within = |seconds: f64| measured.passings.iter().filter(|one| one.time <= seconds).count() as u64;
    let mut rows: Vec<Vec<String>> =
        [1.0, 2.0, 3.0].map(|s| vec![format!("pairs within {s} s"), count(within(s))]).to_vec();
    rows.extend(measured.passings.iter().take(SHOWN).map(|Passing { first, second, time, at }| {
        vec![format!("{second} after {first}, at {} s", brief(*at)), format!("{} s", brief(*time))]
    }));
    Table {
        title: "Post-encroachment times".to_owned(),
        note: "From when one body has left a place until another one covers it, up to 5 s.".to_owned(),
        columns: vec!["who", "time"],
        rows,
    }
}

/// For people.
pub fn to_text(file: &str, measured: &Measured) -> String {
    let mut out = format!("{file}: {}\n", head(measured));
    let all = numbers(measured);
    let name = all.rows.iter().map(|row| row[0].chars().count()).max().unwrap_or(0).max(6);
    let cell = |row: &[String], k: usize| row.get(k).cloned().unwrap_or_default();
    let columns: Vec<String> = all.columns.iter().map(|column| (*column).to_owned()).collect();
    for row in std::iter::once(&columns).chain(&all.rows) {
        let _ = write!(out, "\n  {:<name$}  {:>12}", row[0], cell(row, 1));
        (2..8).for_each(|k| _ = write!(out, "  {:>8}", cell(row, k)));
    }
    let _ = writeln!(out, "\n");
    let passed = passings(measured);
    let _ = writeln!(out, "{}", passed.title);
    for row in &passed.rows {
        let _ = writeln!(out, "  {:<36}  {}", row[0], row[1]);
    }
    for region in &measured.empty {
        let _ = writeln!(out, "\nwarning: nobody was ever in `{region}`");
    }
    out
}

/// One object: the summary of each number, and the post-encroachment times; `docs/schema/measure.schema.json` describes it.
pub fn to_json(file: &str, measured: &Measured) -> String {
    let number = |(k, number): (usize, &crate::replay::measure::Number)| {
        let found = summary(measured, k);
        let of = |value: &dyn Fn(&Summary) -> f64| {
            found.as_ref().map_or(Value::Null, |one| json::number(value(one)))
        };
        json!({
            "name": number.name, "unit": number.unit, "frames": found.map_or(0, |one| one.frames),
            "mean": of(&|one| one.mean), "least": of(&|one| one.ends.0), "largest": of(&|one| one.ends.1),
            "quantiles": LEVELS.iter().enumerate()
                .map(|(at, level)| json!({ "level": level, "value": of(&|one| one.quantiles[at]) })).collect::<Vec<_>>(),
        })
    };
    let passing =
        |one: &Passing| json!({ "first": one.first, "second": one.second, "time": one.time, "at": one.at });
    let object = json!({
        "schema": 1, "recording": file, "persons": measured.persons, "frames": measured.rows.len(),
        "seconds": measured.rows.last().map_or(0.0, |(time, _)| *time),
        "numbers": measured.numbers.iter().enumerate().map(number).collect::<Vec<_>>(),
        "post_encroachment": measured.passings.iter().map(passing).collect::<Vec<_>>(),
        "empty_regions": measured.empty,
    });
    format!("{object:#}\n")
}

/// The columns of the table of all frames, as the formats of traces need them.
pub fn table(title: &str, measured: &Measured) -> table::Table {
    let unit = |unit: &str| UNITS.into_iter().find(|known| *known == unit).unwrap_or("");
    let columns = measured
        .numbers
        .iter()
        .map(|one| table::Column::new(&one.name, table::Kind::Number(unit(&one.unit))));
    table::Table {
        columns: std::iter::once(table::Column::new("time", table::Kind::Number("s")))
            .chain(columns)
            .collect(),
        scenario: title.to_owned(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        ..table::Table::default()
    }
}

/// The rows of that table.
pub fn rows(measured: &Measured) -> impl Iterator<Item = Vec<table::Value<'static>>> {
    measured.rows.iter().map(|(time, row)| {
        std::iter::once(*time).chain(row.iter().copied()).map(table::Value::Number).collect()
    })
}

/// A page with the summary, the player, heat maps, N(t) of each line and speed against density.
pub fn to_page<'a>(
    file: &str,
    recording: &Recording,
    measured: &Measured,
    sources: &'a [Source],
) -> Page<'a> {
    let walk = |person: &crate::data::tracks::Person| Walk {
        name: person.id.to_string(),
        points: person.samples.iter().map(|one| (recording.time_of(one.frame), one.position)).collect(),
        groups: Vec::new(),
    };
    let walks: Vec<Walk> = recording.people().iter().map(walk).collect();
    let trace = recorded(file, measured.scene.clone(), &walks);
    let warnings: BTreeSet<String> =
        measured.empty.iter().map(|region| format!("nobody was ever in `{region}`")).collect();
    Page {
        run: CallResult {
            warnings: warnings.into_iter().collect(),
            ..CallResult::of(format!("Numbers of {file}: {}", head(measured)), 0)
        },
        sources,
        tables: vec![numbers(measured), passings(measured)],
        traces: Traces { list: trace.into_iter().collect(), left_out: 0 },
        without_crowd: false,
    }
}
