//! Phrases about a result that several formats share.

use super::number::plain;
use crate::engine::outcome::{AskedQuery, Kind, ModelError, QueryResult, Ranking, Status};

/// A query on one line, as written.
pub(super) fn one_line(query: &str) -> String {
    query.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// A query on one line with its settings: `check P(safe) >= 0.9 where people = 5`
pub(super) fn asked(result: &QueryResult) -> String {
    let (query, with) = (one_line(&result.asked.text), settings(result));
    if with.is_empty() { query } else { format!("{query} where {with}") }
}

/// Where a query stands: `safe.bltl:3`
pub(super) fn place(result: &QueryResult) -> Option<String> {
    let AskedQuery { file, line, .. } = &result.asked;
    (!file.is_empty()).then(|| format!("{file}:{line}"))
}

/// `density = 0.2 /m^2, step = 0.02 s`
pub(super) fn settings(result: &QueryResult) -> String {
    listed(&result.asked.settings)
}

/// Settings with their names.
pub(super) fn listed(settings: &[(String, String)]) -> String {
    settings.iter().map(|(name, value)| format!("{name} = {value}")).collect::<Vec<_>>().join(", ")
}

/// What values above all numbers are called: a time that does not come lies beyond the horizon, a distance to
/// nobody is infinite. Where the query names a metric that is declared
/// elsewhere it cannot be told which, and "infinite" is true of both.
pub(super) fn endless(result: &QueryResult) -> &'static str {
    let time = result.censored.is_some()
        || ["time_until", "leg_"].iter().any(|word| result.asked.text.contains(word));
    if time { "beyond the horizon" } else { "infinite" }
}

/// The answer of a ranking in a few words.
pub(super) fn ranked(result: &QueryResult, ranking: &Ranking) -> String {
    if ranking.is_empty {
        return "no option satisfies the constraints".to_owned();
    }
    if result.asked.kind == Kind::Pareto {
        return match front(ranking).collect::<Vec<_>>().as_slice() {
            [] => "no option is decided yet".to_owned(),
            names => names.join("; "),
        };
    }
    ranking.choice.as_ref().map_or_else(|| "no choice".to_owned(), |choice| format!("choose {choice}"))
}

/// The options that none dominates.
pub(super) fn front(ranking: &Ranking) -> impl Iterator<Item = &str> {
    let front = ranking.options.iter().filter(|option| option.status == Status::Front);
    front.map(|option| option.label.as_str())
}

/// The certified statement with the horizon it is conditional on; empty where nothing is certified.
pub(super) fn certified(result: &QueryResult) -> String {
    match &result.asked.horizon {
        Some(horizon) if !result.certifies.is_empty() => {
            format!("{}, within the horizon of {horizon}", result.certifies)
        }
        _ => result.certifies.clone(),
    }
}

/// How often a verdict was true of recorded people.
pub(super) fn model(error: &ModelError) -> String {
    let ModelError { site, date, from, to, asked, persons, held, low, high } = error;
    let when = date.as_ref().map_or(String::new(), |date| format!(" on {date}"));
    let people = format!("of {asked} persons recorded at {site}{when}");
    if *persons == 0 {
        return format!("{people} none had P {}, so nothing is known", span(*from, *to));
    }
    let (low, high) = ((100.0 * low).floor(), (100.0 * high).ceil());
    let bound = match (from, to) {
        (_, to) if *to >= 1.0 => format!("at least {low} %"),
        (from, _) if *from <= 0.0 => format!("at most {high} %"),
        _ => format!("{low} to {high} %"),
    };
    format!(
        "{people} {persons} had P {}; it was true of {held}, so of {bound} of such verdicts (95 %)",
        span(*from, *to)
    )
}

/// `>= 0.9`, `in 0.5 .. 0.9`, `< 0.1`
pub(super) fn span(from: f64, to: f64) -> String {
    match (from <= 0.0, to >= 1.0) {
        (false, true) => format!(">= {}", plain(from)),
        (true, false) => format!("< {}", plain(to)),
        _ => format!("in {} .. {}", plain(from), plain(to)),
    }
}
