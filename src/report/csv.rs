//! A table for programs that plot: one row a result, a side of a comparison and an option of a ranking, each number in a
//! column of its own.
//!
//! Columns of settings hold their unit in the header, `width (m)`; a setting written in two units has two columns. Numbers of
//! the procedures have a column each. What is infinite is `inf`, what is unknown is empty. Everything but `elapsed (s)` is a
//! function of input, seed and version.

use super::phrase::one_line;
use super::setting;
use crate::engine::outcome::{CallResult, Counts, Interval, QueryResult, Verdict};

/// Columns that every table has, before those of procedures and settings.
const COLUMNS: [&str; 27] = [
    "query",
    "name",
    "text",
    "file",
    "line",
    "kind",
    "row",
    "option",
    "verdict",
    "status",
    "estimate",
    "low",
    "high",
    "unit",
    "of",
    "interval",
    "gap",
    "trials",
    "successes",
    "failures",
    "unresolved",
    "clipped",
    "steps",
    "stopped by",
    "method",
    "seed",
    "elapsed (s)",
];

/// The table of a run, ending with a line end.
pub fn render(run: &CallResult) -> String {
    let results = super::text::by_query(&run.results);
    let rows: Vec<Row> = results.iter().flat_map(|result| rows(result)).collect();
    let (mut methods, mut settings) = (Vec::new(), Vec::new());
    for row in &rows {
        add(&mut methods, row.result.method.numbers.iter().map(|(name, _)| name.clone()));
        add(&mut settings, row.settings().map(|(header, _)| header));
    }
    let mut table = csv::Writer::from_writer(Vec::new());
    // Writing into memory does not fail.
    let header = COLUMNS.iter().map(|column| (*column).to_owned());
    let _ = table.write_record(header.chain(methods.iter().cloned()).chain(settings.iter().cloned()));
    for row in &rows {
        let of_method = |name: &String| {
            let found = row.result.method.numbers.iter().find(|(known, _)| known == name);
            found.map_or(String::new(), |(_, value)| value.to_string())
        };
        let of_setting = |header: &String| {
            row.settings().find(|(known, _)| known == header).map_or(String::new(), |(_, value)| value)
        };
        let cells = row.cells(run.seed).into_iter();
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
struct Row<'a> {
    result: &'a QueryResult,
    /// `result`, `option`, `first`, `second` or `difference`.
    kind: &'static str,
    label: &'a str,
    status: &'static str,
    value: Interval,
    counts: Counts,
    /// Settings beside those of the result.
    own: &'a [(String, String)],
}

fn rows(result: &QueryResult) -> Vec<Row<'_>> {
    let estimate = result.estimate.unwrap_or(f64::NAN);
    let chosen = result.rank.as_ref().and_then(|ranking| ranking.choice.as_deref());
    let mut rows = vec![Row {
        result,
        kind: "result",
        label: chosen.unwrap_or_default(),
        status: result.shortfall().map_or("", |shortfall| shortfall.name()),
        value: Interval { estimate, low: result.low, high: result.high },
        counts: result.consumed.counts,
        own: &[],
    }];
    if let Some(comparison) = &result.compare {
        let sides = [
            ("first", &comparison.first),
            ("second", &comparison.second),
            ("difference", &comparison.difference),
        ];
        rows.extend(sides.map(|(kind, side)| Row {
            result,
            kind,
            label: &side.label,
            status: "",
            value: side.value,
            counts: side.counts,
            own: &[],
        }));
    }
    rows.extend(result.rank.iter().flat_map(|ranking| &ranking.options).map(|option| Row {
        result,
        kind: "option",
        label: &option.label,
        status: option.status.name(),
        value: option.value,
        counts: option.counts,
        own: &option.settings,
    }));
    rows
}

impl Row<'_> {
    /// The columns of the settings and what is in them.
    fn settings(&self) -> impl Iterator<Item = (String, String)> {
        self.result.asked.settings.iter().chain(self.own).map(|(name, text)| match setting::parts(text) {
            (Some(value), "") => (name.clone(), value.to_string()),
            (Some(value), unit) => (format!("{name} ({unit})"), value.to_string()),
            (None, text) => (name.clone(), text.to_owned()),
        })
    }

    fn cells(&self, seed: u64) -> [String; COLUMNS.len()] {
        let Row { result, value, counts, .. } = self;
        let whole = self.kind == "result";
        let only = |text: String| if whole { text } else { String::new() };
        let gap = result.rank.as_ref().map_or(String::new(), |ranking| number(ranking.gap));
        [
            result.asked.index.to_string(),
            result.asked.name.clone().unwrap_or_default(),
            one_line(&result.asked.text),
            result.asked.file.clone(),
            result.asked.line.to_string(),
            result.asked.kind.name().to_owned(),
            self.kind.to_owned(),
            self.label.to_owned(),
            only(result.verdict.map_or("", Verdict::name).to_owned()),
            self.status.to_owned(),
            number(value.estimate),
            number(value.low),
            number(value.high),
            result.unit.clone(),
            result.of.clone().unwrap_or_default(),
            result.interval.clone(),
            only(gap),
            counts.trials.to_string(),
            counts.successes.to_string(),
            counts.failures.to_string(),
            counts.unresolved.to_string(),
            only(result.consumed.clipped.to_string()),
            only(result.consumed.steps.to_string()),
            only(result.stopped_by.name().to_owned()),
            result.method.name.clone(),
            seed.to_string(),
            only(result.elapsed_s.to_string()),
        ]
    }
}

/// All digits; nothing of what is unknown.
fn number(x: f64) -> String {
    if x.is_nan() { String::new() } else { x.to_string() }
}
