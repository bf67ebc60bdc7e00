//! Floor 7: reports of a run, one file per format.
//!
//! A report is a function of a [`Run`]; no clock and no environment. What a verdict must say follows
//! `docs/language.md`: the certified statement, the estimate with its interval and the kind of that
//! interval, all counts, why sampling stopped, and the command that gives the result again.

pub mod behaviours;
mod exit;
pub mod github;
pub mod html;
pub mod json;
pub mod junit;
pub mod model;
pub mod number;
pub mod outlook;
pub mod palette;
pub mod text;

pub use exit::{ExitCode, exit_code};
pub use palette::Palette;

use crate::engine::outcome::{QueryResult, Run};

/// Formats of a report.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Format {
    /// For people.
    #[default]
    Text,
    /// One JSON object, `docs/schema/verdict.schema.json`.
    Json,
    /// `JUnit` XML for continuous integration.
    Junit,
    /// Workflow commands of GitHub.
    Github,
    /// A page that needs nothing but a browser.
    Html,
}

/// The report of a run, ending with a line end. Only text uses the palette.
pub fn render(run: &Run, format: Format, palette: Palette) -> String {
    match format {
        Format::Text => text::render(run, palette),
        Format::Json => json::render(run),
        Format::Junit => junit::render(run),
        Format::Github => github::render(run),
        Format::Html => html::render(run),
    }
}

/// A query on one line, as written.
fn one_line(query: &str) -> String {
    query.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// `density = 0.2 /m^2, step = 0.02 s`
fn settings(result: &QueryResult) -> String {
    result.settings.iter().map(|(name, value)| format!("{name} = {value}")).collect::<Vec<_>>().join(", ")
}

/// What values above all numbers are called: a time that does not come lies beyond the horizon, a distance to
/// nobody is infinite. Where the query names a metric that is declared
/// elsewhere it cannot be told which, and "infinite" is true of both.
fn endless(result: &QueryResult) -> &'static str {
    let time = result.censored.is_some() || result.query.contains("time_until");
    if time { "beyond the horizon" } else { "infinite" }
}

/// The certified statement with the horizon it is conditional on; empty where nothing is certified.
fn certified(result: &QueryResult) -> String {
    match &result.within {
        Some(within) if !result.certifies.is_empty() => format!("{}, within {within}", result.certifies),
        _ => result.certifies.clone(),
    }
}
