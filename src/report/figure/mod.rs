//! Figures for papers and for pages: each is drawn from the JSON of results as SVG, the same bytes everywhere.

mod answer;
mod calibration;
mod distribution;
mod evidence;
mod flaw;
mod ranking;
mod sweep;

use super::svg::picture::Picture;
pub use flaw::Flaw;
use serde_json::Value;

/// What is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Figure {
    /// Results over a swept parameter.
    Sweep,
    /// Options of a ranking with their intervals.
    Ranking,
    /// The distribution function of a metric with its band.
    Distribution,
    /// How the evidence grew over the trials.
    Evidence,
    /// Predicted probabilities against what happened.
    Calibration,
}

/// The figure of what a file says; of several queries that could be drawn `only` names one.
///
/// # Errors
/// The file has another schema, or not what the figure needs.
pub fn draw(figure: Figure, file: &Value, only: Option<&str>) -> Result<Picture, Flaw> {
    match figure {
        Figure::Sweep => sweep::draw(file, only),
        Figure::Ranking => ranking::draw(file, only),
        Figure::Distribution => distribution::draw(file, only),
        Figure::Evidence => evidence::draw(file, only),
        Figure::Calibration => calibration::draw(file, only),
    }
}

/// The distribution function and the evidence of a result, for its part of a page; empty if it has neither.
pub(super) fn of_result(result: &Value) -> String {
    let first = ranking::front(result).or_else(|| distribution::frame(result));
    let frames: Vec<_> = first.into_iter().chain(evidence::frames(result)).collect();
    if frames.is_empty() {
        return String::new();
    }
    Picture::charts(result["query"].as_str().unwrap_or_default(), frames).part_of_page()
}

#[cfg(test)]
mod tests;
