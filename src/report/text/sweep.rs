//! The block of a query swept over values of parameters: one row per setting.

use super::columns::Cell;
use super::{block, rows};
use crate::engine::outcome::{QueryResult, Verdict};
use crate::report::number::{counted, some};
use crate::report::palette::{Paint, Palette};
use crate::report::phrase::{certified, settings};

/// Writes all results of one query.
pub(super) fn write(text: &mut String, results: &[&QueryResult], palette: Palette) {
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
    block::method(text, &common(first, results), palette);
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
