//! One line a query: the verdict, the query, its setting, the figures, the number of trials.

use super::palette::{Paint, Palette};
use super::phrase::{self, one_line, settings};
use super::text::columns::{Cell, lines};
use super::text::{by_query, printed, word};
use crate::engine::outcome::{CallResult, QueryResult};
use crate::report::number::counted;
use std::fmt::Write as _;

/// The lines of a run, each ending with a line end.
pub fn render(run: &CallResult, palette: Palette) -> String {
    let rows: Vec<Vec<Cell>> = by_query(&run.results).into_iter().map(row).collect();
    let mut text = String::new();
    for line in lines(&rows, palette) {
        let _ = writeln!(text, "{}", line.trim_end());
    }
    if run.interrupted {
        let _ =
            writeln!(text, "{}", palette.paint(Paint::Caution, "interrupted: these are the results so far"));
    }
    if let Some(failure) = &run.failure {
        let _ = writeln!(text, "{}{}", palette.paint(Paint::Bad, "stopped: "), failure.message());
    }
    text
}

/// The verdicts of a run in one line, without what was asked: an editor shows it beside the query.
pub fn beside(run: &CallResult) -> String {
    let said = |result: &QueryResult| {
        let cells = row(result);
        let told = cells.iter().enumerate().filter(|(at, cell)| *at != 1 && !cell.text().is_empty());
        told.map(|(_, cell)| cell.text().trim().to_owned()).collect::<Vec<_>>().join(", ")
    };
    let failure = run.failure.iter().map(|failure| format!("stopped: {}", failure.message()));
    run.results.iter().map(said).chain(failure).collect::<Vec<_>>().join(" · ")
}

fn row(result: &QueryResult) -> Vec<Cell> {
    let (word, paint) = word(result);
    let query = one_line(&result.asked.text);
    let asked = query.strip_prefix(word).map_or(query.as_str(), str::trim_start);
    let (mut estimate, interval) = result.value().map(|value| printed(result, &value)).unwrap_or_default();
    if let Some(of) = result.of.as_ref().filter(|_| !estimate.is_empty()) {
        estimate = format!("{of}: {estimate}");
    }
    let choice = result.rank.as_ref().map(|ranking| phrase::ranked(result, ranking));
    let choice = choice.map(|said| said.strip_prefix("choose ").map(str::to_owned).unwrap_or(said));
    vec![
        Cell::left(word).paint(paint),
        Cell::left(asked).paint(Paint::Strong),
        Cell::left(settings(result)),
        Cell::left(choice.unwrap_or_default()),
        Cell::left(estimate),
        Cell::left(interval),
        Cell::right(counted(result.consumed.counts.trials, "trial")),
        Cell::left(result.model.as_ref().map_or(String::new(), phrase::model)),
        Cell::left(result.shortfall().map_or("", |shortfall| shortfall.name())).paint(Paint::Caution),
    ]
}
