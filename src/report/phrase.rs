//! Phrases about a result that several formats share.

use crate::engine::outcome::QueryResult;

/// A query on one line, as written.
pub(super) fn one_line(query: &str) -> String {
    query.split_whitespace().collect::<Vec<_>>().join(" ")
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

/// The certified statement with the horizon it is conditional on; empty where nothing is certified.
pub(super) fn certified(result: &QueryResult) -> String {
    match &result.asked.horizon {
        Some(horizon) if !result.certifies.is_empty() => {
            format!("{}, within the horizon of {horizon}", result.certifies)
        }
        _ => result.certifies.clone(),
    }
}
