//! The block of a ranking: the choice, what is certified of it, and all options, best first.

use super::columns::Cell;
use super::rows;
use crate::engine::outcome::{QueryResult, Ranking};
use crate::report::number::{counted, some};
use crate::report::palette::{Paint, Palette};

/// Writes the lines under the head.
pub(super) fn write(text: &mut String, result: &QueryResult, ranking: &Ranking, palette: Palette) {
    let Some(choice) = &ranking.choice else {
        let sampled = result.consumed.counts.trials > 0;
        let why = if sampled { "no trial is resolved" } else { "nothing was sampled" };
        rows::line(text, &format!("no choice: {why}"));
        return;
    };
    let choice = palette.paint(Paint::Good, choice);
    let mut said = if result.certifies.is_empty() {
        format!("{choice} is best so far, but nothing is certified")
    } else {
        format!("choose {choice}")
    };
    if ranking.tied {
        said += "; options marked tied have the same certificate";
    }
    rows::line(text, &said);
    let rows: Vec<Vec<Cell>> = ranking
        .options
        .iter()
        .map(|option| {
            let (estimate, interval) = rows::printed(result, &option.value);
            vec![
                Cell::left(option.label.clone()),
                Cell::left(estimate),
                Cell::left(interval),
                Cell::right(counted(option.counts.trials, "trial")),
                Cell::left(option.status.name()).paint(option.status.into()),
                Cell::left(some(option.counts.unresolved, "unresolved")),
            ]
        })
        .collect();
    rows::table(text, &rows, palette);
    rows::intervals(text, result, palette);
}
