//! A report for people: one block per query, a summary, and the command that gives it again.

mod block;
pub(super) mod columns;
mod every;
mod rows;

use super::number::{count, counted, duration, rate, some};
use super::palette::{Paint, Palette};
use crate::engine::outcome::{CallResult, QueryResult, Shortfall, Verdict};
use crate::report::phrase::{self, certified, settings};
pub(super) use block::{counts, moment, shown, trials, word};
use columns::Cell;
pub(super) use every::lines as under_each;
pub(super) use rows::{in_unit, printed};
use std::fmt::{self, Write as _};

/// The report of a run, ending with its replay line; if verbose, with the procedure of each query and its numbers.
pub fn render(run: &CallResult, palette: Palette, is_verbose: bool) -> String {
    let mut text = String::new();
    if !run.scenario.is_empty() {
        let _ = writeln!(text, "{}", palette.paint(Paint::Strong, &run.scenario));
        if !run.people.is_empty() {
            let _ = writeln!(text, "people as {}", run.people.join(", "));
        }
        for (name, velocity) in &run.tracks {
            let _ = writeln!(text, "velocities of the tracks `{name}`: {velocity}");
        }
        text.push('\n');
    }
    for group in by_query(&run.results).chunk_by(|a, b| same_sweep(a, b)) {
        match group {
            [one] => block::write(&mut text, one, palette, is_verbose),
            many => write_sweep(&mut text, many, palette, is_verbose),
        }
        text.push('\n');
    }
    if run.results.iter().all(|result| result.model.is_none()) && !run.people.is_empty() {
        let _ =
            writeln!(text, "model error: not known; `smc calibrate` measures it where people were recorded");
    }
    for warning in &run.warnings {
        let _ = writeln!(text, "{}{warning}", palette.paint(Paint::Caution, "warning: "));
    }
    if run.interrupted {
        let _ =
            writeln!(text, "{}these are the results so far", palette.paint(Paint::Caution, "interrupted: "));
    }
    if let Some(failure) = &run.failure {
        let by = if failure.is_bug() { "stopped by a bug in smc: " } else { "stopped by an error: " };
        let _ = writeln!(text, "{}{}", palette.paint(Paint::Bad, by), failure.message());
    }
    let _ = writeln!(text, "{}", summary(run, palette));
    for (at, line) in run.replay.lines().enumerate() {
        let head = if at == 0 { "replay:" } else { "       " };
        let _ = writeln!(text, "{} {line}", palette.paint(Paint::Faint, head));
    }
    text
}

/// The block of one result alone.
pub fn block(result: &QueryResult, palette: Palette) -> String {
    let mut text = String::new();
    block::write(&mut text, result, palette, true);
    text
}

impl fmt::Display for QueryResult {
    /// As in the report of `smc check`, the lines of this result.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(block(self, Palette::PLAIN).trim_end())
    }
}

impl fmt::Display for CallResult {
    /// The report of `smc check`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(render(self, Palette::PLAIN, false).trim_end())
    }
}

/// Whether two successive results are of one query under different settings.
pub(super) fn same_sweep(a: &QueryResult, b: &QueryResult) -> bool {
    let simple = |r: &QueryResult| r.compare.is_none() && r.rank.is_none() && r.every.is_none();
    a.asked.index == b.asked.index
        && !a.asked.settings.is_empty()
        && !b.asked.settings.is_empty()
        && simple(a)
        && simple(b)
}

/// Results query by query: a sweep comes point by point, with all queries at each.
pub(super) fn by_query(results: &[QueryResult]) -> Vec<&QueryResult> {
    let mut ordered: Vec<&QueryResult> = results.iter().collect();
    ordered.sort_by_key(|result| result.asked.index);
    ordered
}

/// How many queries there are of each verdict, and of those without one how many are estimated, fall short, and have no trial;
/// each with its word.
pub(super) fn tally(run: &CallResult) -> Vec<(u64, &'static str, Paint)> {
    let number = |verdict| run.results.iter().filter(|r| r.verdict == Some(verdict)).count() as u64;
    let estimated = |shortfall| {
        run.results.iter().filter(|r| r.verdict.is_none() && r.shortfall() == shortfall).count() as u64
    };
    let all = [
        (number(Verdict::Satisfied), "satisfied", Paint::Good),
        (number(Verdict::Violated), "violated", Paint::Bad),
        (number(Verdict::Undecided), "undecided", Paint::Caution),
        (estimated(None), "estimated", Paint::Neutral),
        (estimated(Some(Shortfall::Incomplete)), Shortfall::Incomplete.name(), Paint::Caution),
        (estimated(Some(Shortfall::NotBegun)), Shortfall::NotBegun.name(), Paint::Caution),
    ];
    all.into_iter().filter(|(n, ..)| *n > 0).collect()
}

fn summary(run: &CallResult, palette: Palette) -> String {
    let parts: Vec<String> = tally(run)
        .into_iter()
        .map(|(n, word, paint)| palette.paint(paint, &format!("{} {word}", count(n))))
        .collect();
    let trials = run.trials;
    let mut text = if parts.is_empty() { "no results".to_owned() } else { parts.join(", ") };
    let _ = write!(text, "; {} in {}", counted(trials, "trial"), duration(run.elapsed_s));
    if run.elapsed_s > 0.0 && trials > 0 {
        let _ = write!(text, " ({} per second)", rate(trials as f64 / run.elapsed_s));
    }
    text
}

// The block of a query swept over values of parameters: one row per setting.

/// Writes all results of one query.
fn write_sweep(text: &mut String, results: &[&QueryResult], palette: Palette, is_verbose: bool) {
    let worst = |r: &&&QueryResult| match r.verdict {
        Some(Verdict::Violated) => 3,
        Some(Verdict::Undecided) => 2,
        Some(Verdict::Satisfied) => 1,
        None => 0,
    };
    let Some(first) = results.iter().max_by_key(worst) else { return };
    block::head(text, first, palette);
    let same_cause = results.iter().all(|r| block::cause(r) == block::cause(first));
    let rows: Vec<Vec<Cell>> = results.iter().map(|result| row(result, same_cause)).collect();
    rows::table(text, &rows, palette);
    if same_cause {
        rows::line(text, &format!("each {}", block::cause(first)));
    }
    if results.iter().all(|r| r.interval == first.interval) {
        rows::intervals(text, first, palette);
    }
    if is_verbose {
        block::method(text, &common(first, results), palette);
    }
    let statement = certified(first);
    if results.iter().all(|r| certified(r) == statement) {
        if !statement.is_empty() {
            rows::line(text, &format!("certified, each: {statement}"));
        }
    } else {
        for result in results.iter().filter(|r| !r.certifies.is_empty()) {
            rows::line(text, &format!("certified for {}: {}", settings(result), certified(result)));
        }
    }
    for result in results {
        if let Some(error) = &result.model {
            rows::line(text, &format!("model for {}: {}", settings(result), phrase::model(error)));
        }
        block::remarks(text, result, &format!("{}: ", settings(result)), palette);
        for witness in &result.witnesses {
            block::witness(text, witness, result.of.is_some(), palette);
        }
    }
}

/// A result with those numbers of the procedure that all have: a threshold may be a parameter.
fn common(first: &QueryResult, results: &[&QueryResult]) -> QueryResult {
    let mut shown = first.clone();
    shown.method.numbers.retain(|number| results.iter().all(|result| result.method.numbers.contains(number)));
    shown
}

fn row(result: &QueryResult, same_cause: bool) -> Vec<Cell> {
    let (word, paint) = match result.shortfall() {
        Some(shortfall) => (shortfall.name(), Paint::Caution),
        None if result.verdict.is_none() => ("", Paint::Neutral),
        None => block::word(result),
    };
    let (estimate, interval) = result.value().map(|value| rows::printed(result, &value)).unwrap_or_default();
    // Of a quantile the figures are those of a probability.
    let of = result.of.as_ref().map_or(String::new(), |of| format!("{of}:"));
    vec![
        Cell::left(settings(result)),
        Cell::left(word).paint(paint),
        Cell::left(of),
        Cell::left(estimate).paint(Paint::Strong),
        Cell::left(interval),
        Cell::right(counted(result.consumed.counts.trials, "trial")),
        Cell::left(some(result.consumed.counts.unresolved, "unresolved")),
        Cell::left(some(result.consumed.clipped, "clipped to the range")),
        Cell::left(if same_cause { "" } else { block::cause(result) }),
    ]
}
