//! The rows under a result that was found under every value of a parameter.
//!
//! ```text
//! people = smc1  0.994  [0.98, 1]    200 trials  satisfied
//! people = cfs2  0.93   [0.89, 0.96] 400 trials  satisfied, least favourable
//! ```

use super::columns::Cell;
use super::rows::{line, printed, table};
use crate::engine::outcome::{Every, QueryResult, UnderOne, Verdict};
use crate::report::number::{brief, counted};
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
        let [value, estimate, interval] = [value, estimate, interval].map(Cell::left);
        vec![value, estimate, interval, Cell::right(trials), Cell::left(remark).paint(paint)]
    };
    let rows: Vec<_> = every.parts.iter().enumerate().map(row).collect();
    table(text, &rows, palette);
    let said = whole(result, every);
    if !said.is_empty() {
        line(text, &said);
    }
}

/// How many values agree: `satisfied under 2 of 3`; for a choice how often it is the best, and what it loses.
fn whole(result: &QueryResult, every: &Every) -> String {
    let all = every.parts.len();
    let Some(choice) = result.rank.as_ref().and_then(|ranking| ranking.choice.as_ref()) else {
        let satisfied = every.parts.iter().filter(|part| part.verdict == Some(Verdict::Satisfied)).count();
        return result.verdict.map_or(String::new(), |_| format!("satisfied under {satisfied} of {all}"));
    };
    let best = || every.parts.iter().filter_map(|part| Some((part, part.best.as_ref()?)));
    let lost = best().map(|(part, (_, worth))| worth - part.figure.estimate).fold(0.0, f64::max);
    match best().filter(|(_, (option, _))| option == choice).count() {
        count if count == all => "the choice survives: it is best under each value".to_owned(),
        count => {
            let unit = if result.unit.is_empty() { String::new() } else { format!(" {}", result.unit) };
            format!("best under {count} of {all}; it loses {}{unit} at most, by the estimates", brief(lost))
        }
    }
}

/// The rows as lines of text.
pub(in crate::report) fn lines(result: &QueryResult) -> Vec<String> {
    let Some(every) = &result.every else { return Vec::new() };
    let line = |part| {
        let [value, estimate, interval, trials, remark] = cells(result, every, part);
        format!("{value}: {estimate} {interval}, {trials}, {remark}")
    };
    let lines = every.parts.iter().enumerate().map(line);
    lines.chain(Some(whole(result, every)).filter(|said| !said.is_empty())).collect()
}

fn cells(result: &QueryResult, every: &Every, (at, part): (usize, &UnderOne)) -> [String; 5] {
    // A value without a trial has no figure.
    let has_figure = part.counts.trials > 0;
    let (estimate, interval) = if has_figure { printed(result, &part.figure) } else { Default::default() };
    let choice = result.rank.as_ref().and_then(|ranking| ranking.choice.as_ref());
    let mut remark = match (&part.verdict, &part.best) {
        (Some(verdict), _) => verdict.name().to_owned(),
        (None, Some((best, _))) if Some(best) == choice => "best here".to_owned(),
        (None, Some((best, worth))) => format!("best here: {best}, {}", brief(*worth)),
        (None, None) => "nothing was sampled".to_owned(),
    };
    if at == every.least && every.parts.len() > 1 {
        remark += "; least favourable";
    }
    let trials = counted(part.counts.trials, "trial");
    let value = format!("{} = {}", part.setting.0, part.setting.1);
    [value, estimate, interval, trials, remark]
}
