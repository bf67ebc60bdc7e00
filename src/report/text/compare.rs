//! The block of a comparison: both sides and the difference.

use super::columns::Cell;
use super::rows;
use crate::engine::outcome::{Comparison, QueryResult, Side};
use crate::report::number::{count, counted, some};
use crate::report::palette::{Paint, Palette};

/// Writes the lines under the head.
pub(super) fn write(text: &mut String, result: &QueryResult, comparison: &Comparison, palette: Palette) {
    let Comparison { first, second, difference } = comparison;
    if difference.counts.trials == 0 {
        rows::line(text, "nothing was sampled");
        return;
    }
    let row = |side: &Side, paint: Option<Paint>, noun: &str, remark: String| {
        let (estimate, interval) = rows::printed(result, &side.value);
        let estimate = Cell::left(estimate);
        vec![
            Cell::left(side.label.clone()),
            match paint {
                Some(paint) => estimate.paint(paint),
                None => estimate,
            },
            Cell::left(interval),
            Cell::right(counted(side.counts.trials, noun)),
            Cell::left(remark),
        ]
    };
    let unresolved = |n: u64| some(n, "unresolved");
    let counts = difference.counts;
    let mut pairs = String::new();
    if counts.successes + counts.failures > 0 {
        pairs = format!(
            "only the first holds {}, only the second {}",
            count(counts.successes),
            count(counts.failures)
        );
    }
    let rows = [
        row(first, None, "trial", unresolved(first.counts.unresolved)),
        row(second, None, "trial", unresolved(second.counts.unresolved)),
        row(difference, Some(Paint::Strong), "pair", pairs),
    ];
    rows::table(text, &rows, palette);
    rows::intervals(text, result, palette);
}
