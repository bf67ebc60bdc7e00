//! A table for programs that plot: one row a result, a side of a comparison and an option of a ranking, each number in a
//! column of its own.
//!
//! Columns of settings hold their unit in the header, `width (m)`; a setting written in two units has two columns. Numbers of
//! the procedures have a column each. Where a name is taken, it stands behind `method` or `set`: `method trials`. What is infinite is `inf`, what is unknown is empty. Everything but `elapsed (s)` is a
//! function of input, seed and version.

use super::phrase::one_line;
use super::setting;
use crate::engine::outcome::{
    CallResult, Comparison, Counts, Interval, QueryResult, RankedOption, Side, Verdict,
};

/// A column: its name, and what is in it.
type Column = (&'static str, fn(&Row<'_>) -> String);

/// Columns that every table has, before those of procedures and settings.
const COLUMNS: [Column; 27] = [
    ("query", |row| row.result.asked.index.to_string()),
    ("name", |row| row.result.asked.name.clone().unwrap_or_default()),
    ("text", |row| one_line(&row.result.asked.text)),
    ("file", |row| row.result.asked.file.clone()),
    ("line", |row| row.result.asked.line.to_string()),
    ("kind", |row| row.result.asked.kind.name().to_owned()),
    ("row", |row| row.kind.to_owned()),
    ("option", |row| row.label.to_owned()),
    ("verdict", |row| row.of_whole(|result| result.verdict.map_or("", Verdict::name).to_owned())),
    ("status", |row| row.status.to_owned()),
    ("estimate", |row| number(row.value.estimate)),
    ("low", |row| number(row.value.low)),
    ("high", |row| number(row.value.high)),
    ("unit", |row| row.unit.unwrap_or(&row.result.unit).to_owned()),
    ("of", |row| row.of.unwrap_or_else(|| row.result.of.as_deref().unwrap_or_default()).to_owned()),
    ("interval", |row| row.result.interval.clone()),
    ("gap", |row| row.of_whole(|result| result.rank.as_ref().map_or(String::new(), |rank| number(rank.gap)))),
    ("trials", |row| row.counts.trials.to_string()),
    ("successes", |row| row.counts.successes.to_string()),
    ("failures", |row| row.counts.failures.to_string()),
    ("unresolved", |row| row.counts.unresolved.to_string()),
    ("clipped", |row| row.of_whole(|result| result.consumed.clipped.to_string())),
    ("steps", |row| row.of_whole(|result| result.consumed.steps.to_string())),
    ("stopped by", |row| row.of_whole(|result| result.stopped_by.name().to_owned())),
    ("method", |row| row.result.method.name.clone()),
    ("seed", |row| row.seed.to_string()),
    ("elapsed (s)", |row| row.of_whole(|result| result.elapsed_s.to_string())),
];

/// The table of a run, ending with a line end.
pub fn render(run: &CallResult) -> String {
    let results = super::text::by_query(&run.results);
    let rows: Vec<Row> = results.iter().flat_map(|result| rows(result, run.seed)).collect();
    let (mut methods, mut settings) = (Vec::new(), Vec::new());
    for row in &rows {
        add(&mut methods, row.result.method.numbers.iter().map(|(name, _)| name.clone()));
        add(&mut settings, row.settings().map(|(header, _)| header));
    }
    let mut table = csv::Writer::from_writer(Vec::new());
    // Writing into memory does not fail.
    let mut names: Vec<String> = COLUMNS.iter().map(|(name, _)| (*name).to_owned()).collect();
    for (prefix, more) in [("method", &methods), ("set", &settings)] {
        for name in more {
            let is_taken = names.contains(name);
            names.push(if is_taken { format!("{prefix} {name}") } else { name.clone() });
        }
    }
    let _ = table.write_record(names);
    for row in &rows {
        let of_method = |name: &String| {
            let found = row.result.method.numbers.iter().find(|(known, _)| known == name);
            found.map_or(String::new(), |(_, value)| value.to_string())
        };
        let of_setting = |header: &String| {
            row.settings().find(|(known, _)| known == header).map_or(String::new(), |(_, value)| value)
        };
        let cells = COLUMNS.iter().map(|(_, cell)| cell(row));
        let _ = table
            .write_record(cells.chain(methods.iter().map(of_method)).chain(settings.iter().map(of_setting)));
    }
    String::from_utf8(table.into_inner().unwrap_or_default()).unwrap_or_default()
}

/// Adds the names that are new.
fn add(all: &mut Vec<String>, names: impl Iterator<Item = String>) {
    for name in names {
        if !all.contains(&name) {
            all.push(name);
        }
    }
}

/// One row: a result, or a part of it.
#[derive(Clone, Copy)]
struct Row<'a> {
    result: &'a QueryResult,
    /// `result`, `option`, `beside`, `point`, `under`, `first`, `second` or `difference`.
    kind: &'static str,
    label: &'a str,
    status: &'static str,
    value: Interval,
    counts: Counts,
    /// Settings beside those of the result.
    own: &'a [(String, String)],
    /// What it is a number of, and its unit, where that is not what the result is of.
    of: Option<&'a str>,
    unit: Option<&'a str>,
    /// The bound of a point of a curve.
    at: Option<f64>,
    seed: u64,
}

fn rows(result: &QueryResult, seed: u64) -> Vec<Row<'_>> {
    let estimate = result.estimate.unwrap_or(f64::NAN);
    let chosen = result.rank.as_ref().and_then(|ranking| ranking.choice.as_deref());
    let whole = Row {
        result,
        kind: "result",
        label: chosen.unwrap_or_default(),
        status: result.shortfall().map_or("", |shortfall| shortfall.name()),
        value: Interval { estimate, low: result.low, high: result.high },
        counts: result.consumed.counts,
        own: &[],
        of: None,
        unit: None,
        at: None,
        seed,
    };
    let mut rows = vec![whole];
    if let Some(Comparison { first, second, difference }) = &result.compare {
        let sides = [("first", first), ("second", second), ("difference", difference)];
        rows.extend(sides.map(|(kind, side)| {
            let Side { label, value, counts } = side;
            Row { kind, label, status: "", value: *value, counts: *counts, ..whole }
        }));
    }
    for option in result.rank.iter().flat_map(|ranking| &ranking.options) {
        let RankedOption { label, settings: own, value, counts, status, also, .. } = option;
        let (status, value, counts) = (status.name(), *value, *counts);
        let row = Row { kind: "option", label, status, value, counts, own, ..whole };
        rows.push(row);
        rows.extend(also.iter().map(|also| {
            let status = also.holds.map_or("", |holds| if holds { "satisfied" } else { "violated" });
            let (of, unit) = (Some(also.what.as_str()), Some(also.unit.as_str()));
            Row { kind: "beside", status, value: also.value, of, unit, ..row }
        }));
    }
    let curve = result.distribution.as_ref().and_then(|found| found.curve.as_ref());
    rows.extend(curve.iter().flat_map(|curve| &curve.points).map(|point| Row {
        kind: "point",
        value: point.value,
        of: Some(&result.asked.text),
        at: Some(point.at),
        ..whole
    }));
    rows.extend(result.every.iter().flat_map(|every| &every.parts).map(|part| {
        let best = part.best.as_ref().map_or("", |(option, _)| option.as_str());
        Row {
            kind: "under",
            label: best,
            status: part.verdict.map_or("", Verdict::name),
            value: part.figure,
            counts: part.counts,
            own: std::slice::from_ref(&part.setting),
            ..whole
        }
    }));
    rows
}

impl Row<'_> {
    /// The columns of the settings and what is in them.
    fn settings(&self) -> impl Iterator<Item = (String, String)> {
        let settings = self.result.asked.settings.iter().chain(self.own);
        let settings = settings.map(|(name, text)| match setting::parts(text) {
            (Some(value), "") => (name.clone(), value.to_string()),
            (Some(value), unit) => (format!("{name} ({unit})"), value.to_string()),
            (None, text) => (name.clone(), text.to_owned()),
        });
        let curve = self.result.distribution.as_ref().and_then(|found| found.curve.as_ref());
        let bound = self.at.zip(curve);
        settings.chain(bound.map(|(at, curve)| (format!("{} ({})", curve.name, curve.unit), number(at))))
    }

    /// What only the row of a whole result has.
    fn of_whole(&self, text: impl Fn(&QueryResult) -> String) -> String {
        if self.kind == "result" { text(self.result) } else { String::new() }
    }
}

/// All digits; nothing of what is unknown.
fn number(x: f64) -> String {
    if x.is_nan() { String::new() } else { x.to_string() }
}
