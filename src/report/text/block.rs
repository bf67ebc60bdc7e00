//! The block of one result.

use super::columns::Cell;
use super::every;
use super::rows;
use super::rows::{MARGIN, in_size, line, printed};
use crate::engine::at_most;
use crate::engine::outcome::{
    Comparison, Curve, Distribution, Histogram, Interval, Kind, Quantile, QueryResult, RankedOption, Ranking,
    Rare, Shortfall, Shows, Side, Stop, Verdict, Witness,
};
use crate::report::number::{brief, clock, count, counted, duration, interval, plain, readable, some};
use crate::report::palette::{Paint, Palette};
use crate::report::phrase::{self, certified, endless, one_line, settings};
use std::fmt::Write as _;

/// Writes the block of one result.
pub(super) fn write(text: &mut String, result: &QueryResult, palette: Palette, is_verbose: bool) {
    head(text, result, palette);
    let with = settings(result);
    if !with.is_empty() {
        line(text, &format!("where {with}"));
    }
    if let Some(ranking) = &result.rank {
        write_ranking(text, result, ranking, palette);
    } else if let Some(comparison) = &result.compare {
        write_comparison(text, result, comparison, palette);
    } else {
        value(text, result, palette);
    }
    every::write(text, result, palette);
    let statement = certified(result);
    if !statement.is_empty() {
        line(text, &format!("certified: {statement}"));
    }
    if let Some(error) = &result.model {
        line(text, &format!("model: {}", phrase::model(error)));
    }
    if let Some(given) = &result.asked.given {
        line(text, &format!("given: {given}"));
    }
    line(text, &trials(result));
    shortfall(text, result, palette);
    if let Some(rare) = &result.rare {
        self::rare(text, rare);
    }
    if is_verbose {
        method(text, result, palette);
    }
    if let Some(found) = &result.distribution {
        write_distribution(text, result, found, palette);
    }
    remarks(text, result, "", palette);
    for witness in &result.witnesses {
        self::witness(text, witness, result.of.is_some(), palette);
    }
}

/// The first line: the verdict, the query as written, where it stands.
pub(super) fn head(text: &mut String, result: &QueryResult, palette: Palette) {
    let (word, paint) = word(result);
    let place = phrase::place(result).map_or(String::new(), |place| format!("  {place}"));
    let pad = " ".repeat(MARGIN - word.len());
    // The word already says what is asked; only a verdict needs the keyword again.
    let query = one_line(&result.asked.text);
    let asked = query.strip_prefix(word).map_or(query.as_str(), str::trim_start);
    let query = palette.paint(Paint::Strong, asked);
    let _ =
        writeln!(text, "{}{pad}{query}{}", palette.paint(paint, word), palette.paint(Paint::Faint, &place));
}

/// The word at the head of a result.
pub(in crate::report) fn word(result: &QueryResult) -> (&'static str, Paint) {
    match result.verdict {
        Some(verdict @ Verdict::Satisfied) => (verdict.name(), Paint::Good),
        Some(verdict @ Verdict::Violated) => (verdict.name(), Paint::Bad),
        Some(verdict @ Verdict::Undecided) => (verdict.name(), Paint::Caution),
        None => (result.asked.kind.name(), Paint::Neutral),
    }
}

fn value(text: &mut String, result: &QueryResult, palette: Palette) {
    let Some(value) = result.value() else {
        let sampled = result.consumed.counts.trials > 0;
        line(text, if sampled { "no result" } else { "nothing was sampled" });
        return;
    };
    let (shown, range) = printed(result, &value);
    let kind = if result.interval.is_empty() { String::new() } else { format!("  {}", result.interval) };
    let of = result.of.as_ref().map_or(String::new(), |of| format!("{of}: "));
    let (shown, kind) = (palette.paint(Paint::Strong, &shown), palette.paint(Paint::Faint, &kind));
    line(text, &format!("{of}{shown}  {range}{kind}"));
}

/// The procedure with all its numbers, where the query does not name them itself.
pub(super) fn method(text: &mut String, result: &QueryResult, palette: Palette) {
    let name = &result.method.name;
    let query = one_line(&result.asked.text);
    // The threshold stands in every check.
    let said = |number: &str| number == "theta" || query.contains(&format!("{number} ="));
    let named = query.contains(&format!("by {name}("));
    if name.is_empty() || named && result.method.numbers.iter().all(|(number, _)| said(number)) {
        return;
    }
    let shown = |(name, value): &(String, f64)| match name.as_str() {
        "alpha" | "beta" | "delta" => format!("{name} = {}", plain(at_most(*value))),
        // As it was written: rounded it may be another test, or none.
        "theta" if result.unit.is_empty() => format!("{name} = {value}"),
        // These are in the unit of what is measured.
        "theta" | "epsilon" if !result.unit.is_empty() => {
            format!("{name} = {} {}", plain(*value), result.unit)
        }
        _ => format!("{name} = {}", plain(*value)),
    };
    let numbers: Vec<String> = result.method.numbers.iter().map(shown).collect();
    line(text, &palette.paint(Paint::Faint, &format!("method: {name}({})", numbers.join(", "))));
}

/// The result of the plain trials alone, and the cost of the runs of splitting.
fn rare(text: &mut String, rare: &Rare) {
    let Rare { plain_low, plain_high, .. } = *rare;
    let plain_middle =
        Interval { estimate: 0.5 * (plain_low + plain_high), low: plain_low, high: plain_high };
    let range = interval(&plain_middle, None).interval;
    line(text, &format!("plain trials alone: {range}, 99 %"));
    if rare.runs > 0 {
        let levels = plain((10.0 * rare.levels).round() / 10.0);
        let noun = if levels == "1" { "level" } else { "levels" };
        let (runs, paths) = (counted(rare.runs, "run"), counted(rare.paths, "path"));
        let steps = counted(rare.steps, "step");
        line(text, &format!("splitting: {runs}, {levels} {noun} each, {paths}, {steps}"));
    }
}

/// How a result falls short of its query.
pub(super) fn shortfall(text: &mut String, result: &QueryResult, palette: Palette) {
    let Some(shortfall) = result.shortfall() else { return };
    let lacking = match result.stopped_by {
        Stop::Cap => "too few trials",
        Stop::Missing => "too few outcomes",
        _ => "too little time",
    };
    let wanted = match (shortfall, result.asked.kind) {
        (Shortfall::NotBegun, _) => "a trial",
        (Shortfall::Incomplete, Kind::Rank) => "a choice with the requested certificate",
        (Shortfall::Incomplete, _) => "the requested result",
    };
    let said = match (shortfall, result.stopped_by) {
        (Shortfall::NotBegun, Stop::Cap) => "the budget has no trial".to_owned(),
        (Shortfall::NotBegun, Stop::Missing) => "no outcome is there".to_owned(),
        _ => format!("{lacking} for {wanted}"),
    };
    let word = palette.paint(Paint::Caution, &format!("{}:", shortfall.name()));
    line(text, &format!("{word} {said}"));
}

/// The counts and why sampling stopped.
pub(in crate::report) fn trials(result: &QueryResult) -> String {
    format!("{}, {}, {}", counts(result), cause(result), duration(result.elapsed_s))
}

/// The counts.
pub(in crate::report) fn counts(result: &QueryResult) -> String {
    let counts = result.consumed.counts;
    let text = counted(counts.trials, "trial");
    let mut parts = Vec::new();
    if counts.successes + counts.failures > 0 {
        // Of a quantile the event is not the claim, so that it does not hold or fail.
        let words = if result.of.is_some() { ["with it", "without"] } else { ["hold", "fail"] };
        parts.push(format!("{} {}", count(counts.successes), words[0]));
        parts.push(format!("{} {}", count(counts.failures), words[1]));
    }
    let odd = [(counts.unresolved, "unresolved"), (result.consumed.clipped, "clipped to the range")];
    parts.extend(odd.iter().filter(|(n, _)| *n > 0).map(|(n, what)| some(*n, what)));
    if parts.is_empty() { text } else { format!("{text} ({})", parts.join(", ")) }
}

/// Why sampling stopped.
pub(super) fn cause(result: &QueryResult) -> &'static str {
    let counts = result.consumed.counts;
    match result.stopped_by {
        Stop::Boundary => "stopped at the boundary of the test",
        Stop::Width if result.rank.as_ref().is_some_and(|ranking| ranking.is_empty) => {
            "stopped when all options were excluded"
        }
        Stop::Width if result.asked.kind == Kind::Pareto => "stopped when each option was decided",
        Stop::Width if result.rank.is_some() => "stopped when the choice was certified",
        Stop::Width => "stopped when narrow enough",
        Stop::Unresolved if counts.unresolved == counts.trials => "stopped because all trials are unresolved",
        Stop::Unresolved if result.asked.kind == Kind::Check => {
            "stopped: the verdict depends on the unresolved trials, and more trials cannot change that"
        }
        Stop::Unresolved => {
            "stopped when narrow enough for unresolved trials read as failures and as successes, but not for both together"
        }
        Stop::Plan => "as planned",
        Stop::Cap => "stopped at the largest number of trials",
        Stop::Deadline => "stopped at the time limit",
        Stop::Interrupt => "interrupted",
        Stop::Missing => "stopped where outcomes are missing",
    }
}

/// Warnings of a result.
pub(super) fn remarks(text: &mut String, result: &QueryResult, at: &str, palette: Palette) {
    let warning = palette.paint(Paint::Caution, "warning:");
    for said in &result.warnings {
        line(text, &format!("{warning} {at}{said}"));
    }
}

/// `3.42 s`, `6 min 12.5 s`, `step 5`
pub(in crate::report) fn moment(time: f64, unit: &str) -> String {
    match unit {
        "steps" => format!("step {}", plain(time)),
        "s" => clock(time),
        unit => format!("{} {unit}", plain(time)),
    }
}

/// The kind of a witness, in words. For a quantile the event is not the claim.
pub(in crate::report) fn shown(shows: Shows, of: bool) -> &'static str {
    match shows {
        Shows::Fails if of => "without it",
        Shows::Holds if of => "with it",
        _ => shows.name(),
    }
}

/// A trial that shows why, and the command that shows the trial.
pub(super) fn witness(text: &mut String, witness: &Witness, of: bool, palette: Palette) {
    let Witness { shows, trial, time, unit, what, command, .. } = witness;
    let paint = match shows {
        Shows::Fails => Paint::Bad,
        Shows::Holds => Paint::Good,
        Shows::Lowest | Shows::Highest => Paint::Neutral,
    };
    let (word, paint) = (shown(*shows, of), if of { Paint::Neutral } else { paint });
    let said = if what.is_empty() { String::new() } else { format!(": {what}") };
    let command = if command.is_empty() { String::new() } else { format!("  ({command})") };
    let (word, command) = (palette.paint(paint, word), palette.paint(Paint::Faint, &command));
    let (trial, at) = (count(*trial), moment(*time, unit));
    line(text, &format!("{word} in trial {trial} at {at}{said}{command}"));
}

// The block of a comparison: both sides and the difference.

/// Writes the lines under the head.
fn write_comparison(text: &mut String, result: &QueryResult, comparison: &Comparison, palette: Palette) {
    let Comparison { first, second, difference } = comparison;
    if difference.counts.trials == 0 {
        rows::line(text, "nothing was sampled");
        return;
    }
    let row = |side: &Side, paint: Option<Paint>, noun: &str, remark: String| {
        let (estimate, interval) = rows::printed(result, &side.value);
        let trials = Cell::right(counted(side.counts.trials, noun));
        let [label, estimate, interval] = [side.label.clone(), estimate, interval].map(Cell::left);
        vec![label, estimate.paint(paint), interval, trials, Cell::left(remark)]
    };
    let unresolved = |n: u64| some(n, "unresolved");
    let counts = difference.counts;
    let (first_alone, second_alone) = (count(counts.successes), count(counts.failures));
    let pairs = match counts.successes + counts.failures {
        0 => String::new(),
        _ => format!("only the first holds {first_alone}, only the second {second_alone}"),
    };
    let rows = [
        row(first, None, "trial", unresolved(first.counts.unresolved)),
        row(second, None, "trial", unresolved(second.counts.unresolved)),
        row(difference, Some(Paint::Strong), "pair", pairs),
    ];
    rows::table(text, &rows, palette);
    rows::intervals(text, result, palette);
}

// The block of a ranking: the choice, what is certified of it, and all options, best first.

/// Writes the lines under the head.
fn write_ranking(text: &mut String, result: &QueryResult, ranking: &Ranking, palette: Palette) {
    let (is_certified, is_sampled) = (!result.certifies.is_empty(), result.consumed.counts.trials > 0);
    let said = if ranking.is_empty {
        "no option satisfies the constraints".to_owned()
    } else if result.asked.kind == Kind::Pareto && is_sampled {
        let names: Vec<String> =
            phrase::front(ranking).map(|label| palette.paint(Paint::Good, label)).collect();
        let said = if is_certified { "that none dominates" } else { "so far, and not all is decided" };
        format!("{} {said}: {}", counted(names.len() as u64, "option"), names.join("; "))
    } else if let Some(choice) = &ranking.choice {
        let choice = palette.paint(Paint::Good, choice);
        let means = ranking.means.as_ref().map_or(String::new(), |means| format!(": {means}"));
        let tied = if ranking.tied { "; options marked tied have the same certificate" } else { "" };
        if is_certified {
            format!("choose {choice}{means}{tied}")
        } else {
            format!("{choice} is best so far, but nothing is certified{tied}")
        }
    } else {
        let why = if is_sampled { "no trial is resolved" } else { "nothing was sampled" };
        return rows::line(text, &format!("no choice: {why}"));
    };
    rows::line(text, &said);
    options(text, result, ranking, palette);
}

/// A row for each option: its score, what was asked besides, its trials and its status.
fn options(text: &mut String, result: &QueryResult, ranking: &Ranking, palette: Palette) {
    let row = |option: &RankedOption| {
        let (estimate, interval) = rows::printed(result, &option.value);
        let mut row = vec![Cell::left(option.label.clone()), Cell::left(estimate), Cell::left(interval)];
        for also in &option.also {
            let (estimate, interval) = rows::in_unit(&also.value, &also.unit);
            let mark = match also.holds {
                Some(true) => " satisfied",
                Some(false) => " violated",
                None => "",
            };
            row.push(Cell::left(format!("{}: {estimate}", also.what)));
            row.push(Cell::left(format!("{interval}{mark}")));
        }
        row.push(Cell::right(counted(option.counts.trials, "trial")));
        row.push(Cell::left(option.status.name()).paint(Paint::from(option.status)));
        row.push(Cell::left(some(option.counts.unresolved, "unresolved")));
        row
    };
    let rows: Vec<Vec<Cell>> = ranking.options.iter().map(row).collect();
    rows::table(text, &rows, palette);
    rows::intervals(text, result, palette);
}

// How the values of a metric are distributed: quantiles, and a histogram in one line.

const BARS: [char; 8] = ['▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];

/// Writes the lines of a distribution.
fn write_distribution(text: &mut String, result: &QueryResult, found: &Distribution, palette: Palette) {
    let (unit, size) = readable(&result.unit, result.estimate.unwrap_or(result.low));
    let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
    if let Some(curve) = &found.curve {
        write_curve(text, curve, palette);
    }
    // A single one is what was estimated, and stands above.
    if found.quantiles.len() > 1 {
        let one = |one: &Quantile| {
            let (estimate, horizon) = (in_size(&one.value, size), result.censored.map(|end| end / size));
            format!("{} %: {}{unit}", plain(100.0 * one.level), interval(&estimate, horizon).estimate)
        };
        let parts: Vec<String> = found.quantiles.iter().map(one).collect();
        rows::line(text, &format!("quantiles {}", parts.join(", ")));
    }
    if let Some(histogram) = &found.histogram {
        let bars = palette.paint(Paint::Neutral, &bars(histogram));
        let [low, high] = [histogram.low, histogram.high].map(|end| brief(end / size));
        let mut said = format!("{low}{unit} {bars} {high}{unit}");
        if histogram.below > 0 {
            said = format!("{} at -∞, {said}", count(histogram.below));
        }
        if histogram.beyond > 0 {
            said = format!("{said}, {} {}", count(histogram.beyond), endless(result));
        }
        if let Some(band) = found.band {
            said = format!("{said}, distribution function to ± {}", plain((band * 1000.0).ceil() / 1000.0));
        }
        rows::line(text, &said);
    }
}

/// Most points of a curve in a line.
const MOST_POINTS: usize = 60;

/// The lines of a curve: its lower end, the estimate and its upper end as bars, and the times at its ends.
fn write_curve(text: &mut String, curve: &Curve, palette: Palette) {
    let (Some(first), Some(last)) = (curve.points.first(), curve.points.last()) else { return };
    let count = curve.points.len();
    let shown = count.min(MOST_POINTS);
    let place = |k: usize| if shown > 1 { k * (count - 1) / (shown - 1) } else { 0 };
    let line = |of: &dyn Fn(&Interval) -> f64| {
        (0..shown).map(|k| bar(of(&curve.points[place(k)].value))).collect::<String>()
    };
    let ends = format!("{} to {} {}", plain(first.at), plain(last.at), curve.unit);
    let rows: [(&str, String, Paint); 3] = [
        ("at most", line(&|value| value.high), Paint::Faint),
        ("estimate", line(&|value| value.estimate), Paint::Neutral),
        ("at least", line(&|value| value.low), Paint::Faint),
    ];
    for (name, bars, paint) in rows {
        rows::line(text, &format!("{name:<8} {}", palette.paint(paint, &bars)));
    }
    let reach = plain((curve.reach * 1000.0).ceil() / 1000.0);
    rows::line(text, &format!("at {count} bounds from {ends}, the whole curve to ± {reach}"));
}

/// One bar per bin; an empty bin is a dot, the fullest has full height.
fn bars(histogram: &Histogram) -> String {
    let most = histogram.counts.iter().copied().max().unwrap_or(0).max(1);
    histogram.counts.iter().map(|n| bar(*n as f64 / most as f64)).collect()
}

/// A bar of a height from 0 to 1.
fn bar(share: f64) -> char {
    if share <= 0.0 { '·' } else { BARS[(share * 7.0).round().clamp(0.0, 7.0) as usize] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_empty_bin_shows() {
        let histogram = Histogram { low: 0.0, high: 1.0, counts: vec![0, 1, 100, 50], below: 0, beyond: 0 };
        assert_eq!(bars(&histogram), "·▁█▅");
        assert_eq!(bars(&Histogram { counts: vec![], ..histogram }), "");
    }
}
