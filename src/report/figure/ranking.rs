//! The options of a ranking with their joint intervals, the choice first.

use super::answer::{Answer, Needed, interval, with_unit};
use super::flaw::Flaw;
use crate::report::svg::frame::Frame;
use crate::report::svg::picture::Picture;
use crate::report::svg::scale::Scale;
use serde_json::Value;

/// What it needs.
const NEEDED: Needed = ("a ranking", "ask a ranking: `rank … by P(…)`");

/// Most options that are drawn.
const MOST: usize = 40;

/// Options in two aims, the first from left to right, each with its intervals: those that none dominates bright, the others
/// pale. `None` unless it is that.
pub(super) fn front(result: &Value) -> Option<Frame> {
    let options = result["options"].as_array().filter(|_| result["kind"] == "pareto")?;
    let second = |option: &Value| interval(&option["also"][0]);
    let is_known = |option: &&Value| option["estimate"].is_number();
    let known: Vec<&Value> = options.iter().filter(is_known).collect();
    let first = known.first()?;
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    let axes = [
        with_unit(&text(&result["aim"]), &text(&result["unit"])),
        with_unit(&text(&first["also"][0]["what"]), &text(&first["also"][0]["unit"])),
    ];
    let finite = |ends: [f64; 3]| ends.into_iter().filter(|x| x.is_finite());
    let x = Scale::linear(known.iter().flat_map(|option| finite(interval(option))));
    let y = Scale::linear(known.iter().flat_map(|option| finite(second(option))));
    let mut frame = Frame::new([&axes[0], &axes[1]], x, y);
    for style in [4, 1, 0] {
        for option in &known {
            let own = match option["status"].as_str() {
                Some("front") => 0,
                Some("beaten") => 4,
                _ => 1,
            };
            if own == style {
                let ([low, middle, high], other) = (interval(option), second(option));
                frame.upright(middle, other, style);
                frame.line([(low, other[1]), (high, other[1])], style);
            }
        }
    }
    frame.name("none dominates", 0);
    frame.name("dominated", 4);
    Some(frame)
}

pub(super) fn draw(file: &Value, only: Option<&str>) -> Result<Picture, Flaw> {
    let is_ranking = |results: &[&Value]| results.len() == 1 && results[0]["options"].is_array();
    let answer = Answer::of(file, only, NEEDED, is_ranking)?;
    if let Some(frame) = front(answer.results[0]) {
        return Ok(Picture::charts(answer.query, vec![frame]));
    }
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
            Some("beaten" | "excluded") => 4,
            _ => 1,
        };
        frame.lying(row, interval(option), style);
    }
    Ok(Picture::charts(answer.query, vec![frame]))
}
