//! The rows under a result that was found under every value of a parameter.
//!
//! ```text
//! people = smc1  0.994  [0.98, 1]    200 trials  satisfied
//! people = cfs2  0.93   [0.89, 0.96] 400 trials  satisfied, least favourable
//! ```

use super::columns::Cell;
use super::rows::{printed, table};
use crate::engine::outcome::{Every, QueryResult, UnderOne, Verdict};
use crate::report::number::{counted, plain};
use crate::report::palette::{Paint, Palette};

/// Writes the rows; nothing for a query without `under every`.
pub(super) fn write(text: &mut String, result: &QueryResult, palette: Palette) {
    let Some(every) = &result.every else { return };
    let row = |(at, part): (usize, &UnderOne)| {
        let [value, estimate, interval, trials, remark] = cells(result, every, (at, part));
        let paint = match part.verdict {
            Some(Verdict::Violated) => Paint::Bad,
            Some(Verdict::Undecided) => Paint::Caution,
            Some(Verdict::Satisfied) | None => Paint::Neutral,
        };
        vec![
            Cell::left(value),
            Cell::left(estimate),
            Cell::left(interval),
            Cell::right(trials),
            Cell::left(remark).paint(paint),
        ]
    };
    let rows: Vec<_> = every.parts.iter().enumerate().map(row).collect();
    table(text, &rows, palette);
}

/// The rows as lines of text.
pub(in crate::report) fn lines(result: &QueryResult) -> Vec<String> {
    let Some(every) = &result.every else { return Vec::new() };
    let line = |part| {
        let [value, estimate, interval, trials, remark] = cells(result, every, part);
        format!("{value}: {estimate} {interval}, {trials}, {remark}")
    };
    every.parts.iter().enumerate().map(line).collect()
}

fn cells(result: &QueryResult, every: &Every, (at, part): (usize, &UnderOne)) -> [String; 5] {
    let (estimate, interval) = printed(result, &part.figure);
    let choice = result.rank.as_ref().and_then(|ranking| ranking.choice.as_ref());
    let mut remark = match (&part.verdict, &part.best) {
        (Some(verdict), _) => verdict.name().to_owned(),
        (None, Some((best, _))) if Some(best) == choice => "best here".to_owned(),
        (None, Some((best, worth))) => format!("best here: {best}, {}", plain(*worth)),
        (None, None) => "nothing was sampled".to_owned(),
    };
    if at == every.least && every.parts.len() > 1 {
        remark += "; least favourable";
    }
    let trials = counted(part.counts.trials, "trial");
    let value = format!("{} = {}", part.setting.0, part.setting.1);
    // A value without a trial has no figure.
    if part.counts.trials == 0 {
        return [value, String::new(), String::new(), trials, remark];
    }
    [value, estimate, interval, trials, remark]
}
