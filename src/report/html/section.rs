//! The part of a page about one query: alone, or under several settings.

use super::chart;
use super::chart::Mark;
use crate::engine::at_most;
use crate::engine::outcome::{
    Histogram, Interval, Kind, QueryResult, RankedOption, Shortfall, Side, Verdict, Witness,
};
use crate::report::number::{count, counted, plain};
use crate::report::palette::Paint;
use crate::report::phrase::{self, endless, one_line, settings};
use crate::report::svg::scale::Scale;
use crate::report::{figure, json, text};
use std::fmt::Write as _;

/// What the page says of a query.
#[derive(Clone, Debug, Default)]
pub(super) struct Section<'r> {
    /// Its anchor.
    pub(super) id: String,
    /// The anchor of the line of the query, if the page has its text.
    pub(super) line: Option<String>,
    /// The word of the verdict, which is also its class.
    pub(super) word: &'static str,
    pub(super) query: String,
    pub(super) place: String,
    /// The answer in the table of all queries, and how sure it is.
    pub(super) answer: String,
    pub(super) sure: String,
    /// The intervals as SVG; may be empty.
    pub(super) chart: String,
    /// Kind and level of the intervals; empty where they differ.
    pub(super) intervals: String,
    /// What a ranking recommends.
    pub(super) choice: Option<Recommended>,
    pub(super) results: Vec<Facts<'r>>,
}

/// The recommendation of a ranking: an option between two texts.
#[derive(Clone, Debug, Default)]
pub(super) struct Recommended {
    pub(super) before: &'static str,
    pub(super) option: String,
    pub(super) after: String,
}

/// What is said of one result under the chart.
#[derive(Clone, Debug)]
pub(super) struct Facts<'r> {
    pub(super) of: &'r QueryResult,
    /// The settings where there are several; else empty.
    pub(super) head: String,
    /// The histogram as SVG; may be empty.
    pub(super) histogram: String,
    /// Distribution function and evidence as SVG; may be empty.
    pub(super) figure: String,
    pub(super) witnesses: Vec<Shown<'r>>,
}

/// A witness.
#[derive(Clone, Debug)]
pub(super) struct Shown<'r> {
    pub(super) of: &'r Witness,
    pub(super) moment: String,
    /// Its number in the player, if it is there.
    pub(super) played: Option<usize>,
}

/// What a page says of a query; `played` gives the number of a witness in the player, by the place of its result.
pub(super) fn section<'r>(
    group: &[(usize, &'r QueryResult)],
    played: &impl Fn(usize, &Witness) -> Option<usize>,
) -> Section<'r> {
    let Some((_, first)) = group.first() else { return Section::default() };
    let words = group.iter().map(|(_, result)| word(result));
    let word = words.max_by_key(|word| severity(word)).unwrap_or("estimated");
    let swept = group.len() > 1;
    let marks: Vec<Mark> = if swept {
        group.iter().filter_map(|(_, result)| mark(result, &settings(result))).collect()
    } else {
        marks(first)
    };
    let theta = |result: &QueryResult| {
        result.method.numbers.iter().find(|(name, _)| name == "theta").map(|(_, value)| *value)
    };
    // A threshold may be a parameter, and is then another in each row.
    let threshold = theta(first).filter(|_| group.iter().all(|(_, result)| theta(result) == theta(first)));
    let is_one = group.iter().all(|(_, result)| result.interval == first.interval);
    Section {
        word,
        query: one_line(&first.asked.text),
        place: phrase::place(first).unwrap_or_default(),
        answer: if swept { counted(group.len() as u64, "setting") } else { answer(first) },
        sure: if swept { String::new() } else { sure(first) },
        chart: chart::intervals(&marks, &first.unit, threshold, first.censored),
        intervals: if is_one { first.interval.clone() } else { String::new() },
        choice: recommended(first),
        results: group.iter().map(|(k, result)| facts(*k, result, swept, played)).collect(),
        ..Section::default()
    }
}

/// The answer in a few words: the choice, or the number with its interval.
fn answer(result: &QueryResult) -> String {
    if let Some(ranking) = &result.rank {
        return phrase::ranked(result, ranking);
    }
    result.value().map_or(String::new(), |value| {
        let (estimate, interval) = text::printed(result, &value);
        format!("{estimate} {interval}")
    })
}

/// How sure the answer is.
fn sure(result: &QueryResult) -> String {
    match &result.certificate {
        Some(certificate) => format!("certified, error at most {}", plain(at_most(certificate.error))),
        None if result.value().is_some() => result.interval.clone(),
        None => "nothing is certified".to_owned(),
    }
}

fn recommended(result: &QueryResult) -> Option<Recommended> {
    let ranking = result.rank.as_ref()?;
    let plain = |before| Recommended { before, ..Recommended::default() };
    Some(match &ranking.choice {
        None if ranking.is_empty => plain("No option satisfies the constraints."),
        None if result.asked.kind == Kind::Pareto && result.consumed.counts.trials > 0 => {
            let option = phrase::ranked(result, ranking);
            Recommended { before: "None dominates ", option, after: ".".to_owned() }
        }
        None if result.consumed.counts.trials > 0 => plain("No choice: no trial is resolved."),
        None => plain("No choice: nothing was sampled."),
        Some(choice) if !result.certifies.is_empty() => {
            let means = ranking.means.as_ref().map_or(String::new(), |means| format!(": {means}"));
            let tied = if ranking.tied { "; options marked tied have the same certificate" } else { "" };
            Recommended { before: "Choose ", option: choice.clone(), after: format!("{means}{tied}.") }
        }
        Some(choice) => {
            let after = " is best so far, but nothing is certified.".to_owned();
            Recommended { before: "", option: choice.clone(), after }
        }
    })
}

fn severity(word: &str) -> u8 {
    match word {
        "violated" => 3,
        "undecided" => 2,
        "satisfied" | "incomplete" | "not begun" => 1,
        _ => 0,
    }
}

fn word(result: &QueryResult) -> &'static str {
    let estimated = result.shortfall().map_or("estimated", Shortfall::name);
    result.verdict.map_or(estimated, Verdict::name)
}

fn facts<'r>(
    place: usize,
    result: &'r QueryResult,
    swept: bool,
    played: &impl Fn(usize, &Witness) -> Option<usize>,
) -> Facts<'r> {
    let histogram = result.distribution.as_ref().and_then(|d| d.histogram.as_ref());
    let histogram = histogram.map(|bins| bars(bins, &result.unit, endless(result)));
    let witness = |witness: &'r Witness| {
        let Witness { shows, trial, time, unit, .. } = witness;
        let (word, at) = (text::shown(*shows, result.of.is_some()), text::moment(*time, unit));
        let moment = format!("{word} in trial {} at {at}", count(*trial));
        Shown { of: witness, moment, played: played(place, witness) }
    };
    Facts {
        of: result,
        head: if swept { settings(result) } else { String::new() },
        histogram: histogram.unwrap_or_default(),
        figure: if swept { String::new() } else { figure::of_result(&json::result(result)) },
        witnesses: result.witnesses.iter().map(witness).collect(),
    }
}

/// The rows of the chart of one result.
fn marks(result: &QueryResult) -> Vec<Mark> {
    if let Some(ranking) = &result.rank {
        let row = |o: &RankedOption| {
            let also = o.also.iter().map(|also| {
                let (estimate, interval) = text::in_unit(&also.value, &also.unit);
                let mark = also.holds.map_or("", |holds| if holds { " satisfied" } else { " violated" });
                format!(", {}: {estimate} {interval}{mark}", also.what)
            });
            let trials = counted(o.counts.trials, "trial");
            let note = format!("{}, {trials}{}", o.status.name(), also.collect::<String>());
            labelled(result, &o.label, o.value, o.status.into(), &note)
        };
        return ranking.options.iter().map(row).collect();
    }
    if let Some(sides) = &result.compare {
        let row = |side: &Side, tone| labelled(result, &side.label, side.value, tone, "");
        let [first, second] = [&sides.first, &sides.second].map(|side| row(side, Paint::Neutral));
        return vec![first, second, row(&sides.difference, Paint::Good)];
    }
    mark(result, "").into_iter().collect()
}

fn mark(result: &QueryResult, label: &str) -> Option<Mark> {
    Some(labelled(result, label, result.value()?, text::word(result).1, ""))
}

fn labelled(result: &QueryResult, label: &str, value: Interval, tone: Paint, note: &str) -> Mark {
    let (estimate, interval) = text::printed(result, &value);
    let note = if note.is_empty() { String::new() } else { format!(" ({note})") };
    Mark { label: label.to_owned(), value, tone, said: format!("{estimate}  {interval}{note}") }
}

// A histogram in SVG.

const WIDTH: f64 = 330.0;
const HEIGHT: f64 = 120.0;
const MARGIN: f64 = 10.0;

/// The bars, each with its range and count as a tooltip; empty without bins. `endless` is what the values above
/// all bins are.
fn bars(histogram: &Histogram, unit: &str, endless: &str) -> String {
    let most = histogram.counts.iter().copied().max().unwrap_or(0);
    if most == 0 {
        return String::new();
    }
    let bins = histogram.counts.len() as f64;
    let bin = (histogram.high - histogram.low) / bins;
    let width = WIDTH / bins;
    let height = Scale::linear([0.0, most as f64]);
    let (wide, high) = (WIDTH + 2.0 * MARGIN, HEIGHT + 22.0);
    let mut svg = format!("<svg viewBox=\"0 0 {wide:.0} {high:.0}\" width=\"{wide:.0}\" role=\"img\">\n");
    for (k, &n) in histogram.counts.iter().enumerate() {
        let tall = HEIGHT * height.share(n as f64);
        let (x, y, wide) = (MARGIN + width * k as f64, HEIGHT - tall, (width - 1.0).max(0.5));
        let from = histogram.low + bin * k as f64;
        let [from, to] = [from, from + bin].map(plain);
        let _ = writeln!(
            svg,
            "<rect class=\"bar\" x=\"{x:.1}\" y=\"{y:.1}\" width=\"{wide:.1}\" height=\"{tall:.1}\">\
             <title>{from} to {to} {unit}: {}</title></rect>",
            count(n)
        );
    }
    for (at, value) in [(MARGIN, histogram.low), (MARGIN + WIDTH, histogram.high)] {
        let class = if at > MARGIN { "last" } else { "first" };
        let (y, value) = (HEIGHT + 16.0, plain(value));
        let _ =
            writeln!(svg, "<text class=\"tick {class}\" x=\"{at:.1}\" y=\"{y:.1}\">{value} {unit}</text>");
    }
    svg.push_str("</svg>\n");
    for (some, where_) in [(histogram.below, "at -∞"), (histogram.beyond, endless)] {
        if some > 0 {
            let _ = writeln!(svg, "<p class=\"faint\">{} {where_}</p>", count(some));
        }
    }
    svg
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_bar_per_bin() {
        let histogram = Histogram { low: 0.0, high: 2.0, counts: vec![1, 0, 4, 2], below: 5, beyond: 3 };
        let svg = bars(&histogram, "m", "infinite");
        assert_eq!(svg.matches("<rect").count(), 4);
        assert!(
            svg.contains("<title>1 to 1.5 m: 4</title>")
                && svg.contains("3 infinite")
                && svg.contains("5 at -∞")
        );
        assert_eq!(bars(&Histogram { counts: vec![0, 0], ..histogram }, "", "infinite"), "");
    }
}
