//! A report for people: one block per query, a summary, and the command that gives it again.

mod block;
pub(super) mod columns;
mod compare;
mod distribution;
mod rank;
mod rows;
mod sweep;

pub(super) use block::{counts, moment, shown, trials, word};
pub(super) use rows::printed;

use super::number::{count, counted, duration, rate};
use super::palette::{Paint, Palette};
use crate::engine::outcome::{CallResult, QueryResult, Shortfall, Verdict};
use std::fmt::Write as _;

/// The report of a run, ending with its replay line.
pub fn render(run: &CallResult, palette: Palette) -> String {
    let mut text = String::new();
    if !run.scenario.is_empty() {
        let _ = writeln!(text, "{}", palette.paint(Paint::Strong, &run.scenario));
        for (name, velocity) in &run.tracks {
            let _ = writeln!(text, "velocities of the tracks `{name}`: {velocity}");
        }
        text.push('\n');
    }
    for group in by_query(&run.results).chunk_by(|a, b| same_sweep(a, b)) {
        match group {
            [one] => block::write(&mut text, one, palette),
            many => sweep::write(&mut text, many, palette),
        }
        text.push('\n');
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
    block::write(&mut text, result, palette);
    text
}

/// Whether two successive results are of one query under different settings.
pub(super) fn same_sweep(a: &QueryResult, b: &QueryResult) -> bool {
    let simple = |r: &QueryResult| r.compare.is_none() && r.rank.is_none();
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

/// How many queries there are of each verdict, and of those without one how many are computed, fall short, and have no trial;
/// each with its word.
pub(super) fn tally(run: &CallResult) -> Vec<(u64, &'static str, Paint)> {
    let number = |verdict| run.results.iter().filter(|r| r.verdict == Some(verdict)).count() as u64;
    let computed = |shortfall| {
        run.results.iter().filter(|r| r.verdict.is_none() && r.shortfall() == shortfall).count() as u64
    };
    let all = [
        (number(Verdict::Satisfied), "satisfied", Paint::Good),
        (number(Verdict::Violated), "violated", Paint::Bad),
        (number(Verdict::Undecided), "undecided", Paint::Caution),
        (computed(None), "computed", Paint::Neutral),
        (computed(Some(Shortfall::Incomplete)), Shortfall::Incomplete.name(), Paint::Caution),
        (computed(Some(Shortfall::NotBegun)), Shortfall::NotBegun.name(), Paint::Caution),
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
