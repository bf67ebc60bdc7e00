//! The options of a ranking with their joint intervals, the choice first.

use super::answer::{Answer, Needed, interval};
use super::flaw::Flaw;
use crate::report::svg::frame::Frame;
use crate::report::svg::picture::Picture;
use crate::report::svg::scale::Scale;
use serde_json::Value;

/// What it needs.
const NEEDED: Needed = ("a ranking", "ask a ranking: `rank … by P(…)`");

/// Most options that are drawn.
const MOST: usize = 40;

pub(super) fn draw(file: &Value, only: Option<&str>) -> Result<Picture, Flaw> {
    let is_ranking = |results: &[&Value]| results.len() == 1 && results[0]["options"].is_array();
    let answer = Answer::of(file, only, NEEDED, is_ranking)?;
    let options = answer.results[0]["options"].as_array().map_or(&[][..], Vec::as_slice);
    let shown = &options[..options.len().min(MOST)];
    let word = |option: &Value, key: &str| option[key].as_str().unwrap_or_default().to_owned();
    let name = |option: &Value| format!("{} ({})", word(option, "option"), word(option, "status"));
    let mut names: Vec<String> = shown.iter().map(name).collect();
    if options.len() > shown.len() {
        names.push(format!("and {} more", options.len() - shown.len()));
    }
    let mut frame = Frame::rows(&answer.axis(), Scale::linear(shown.iter().flat_map(interval)), &names);
    for (row, option) in shown.iter().enumerate() {
        let style = match option["status"].as_str() {
            Some("chosen") => 0,
            Some("beaten") => 4,
            _ => 1,
        };
        frame.lying(row, interval(option), style);
    }
    Ok(Picture::charts(answer.query, vec![frame]))
}
