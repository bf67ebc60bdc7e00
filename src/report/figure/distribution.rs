//! The empirical distribution function of a metric with its simultaneous band (Dvoretzky, Kiefer and Wolfowitz 1956; Massart
//! 1990). For `time_until(p)` it is P(F<=t p) over t.

use super::answer::{Answer, Needed, interval, number, with_unit};
use super::flaw::Flaw;
use crate::report::svg::frame::Frame;
use crate::report::svg::picture::Picture;
use crate::report::svg::scale::Scale;
use serde_json::Value;

/// What it needs.
const NEEDED: Needed =
    ("a distribution", "ask for a quantile or an expectation, such as `estimate Q(0.5, time_until(safe))`");

pub(super) fn draw(file: &Value, only: Option<&str>) -> Result<Picture, Flaw> {
    let has_one = |results: &[&Value]| {
        results.iter().any(|one| {
            one["distribution"]["empirical"].as_array().is_some_and(|all| !all.is_empty())
                || one["distribution"]["curve"].is_object()
        })
    };
    let answer = Answer::of(file, only, NEEDED, has_one)?;
    let frames = answer.results.iter().filter_map(|one| frame(one)).collect();
    Ok(Picture::charts(answer.query, frames))
}

/// A probability as a function of a bound, with its band.
fn curve(found: &Value, points: &[Value]) -> Option<Frame> {
    let all: Vec<(f64, [f64; 3])> =
        points.iter().map(|point| (number(&point["at"]), interval(point))).collect();
    let (first, last) = (all.first()?.0, all.last()?.0);
    let word = |key: &str| found[key].as_str().unwrap_or_default();
    let axis = with_unit(word("name"), word("unit"));
    let mut frame =
        Frame::new([&axis, "probability, with its band"], Scale::linear([first, last]), Scale::shares());
    frame.band(&all.iter().map(|(x, [low, _, high])| (*x, *low, *high)).collect::<Vec<_>>(), 1);
    frame.line(all.iter().map(|(x, [_, estimate, _])| (*x, *estimate)), 3);
    Some(frame)
}

/// The function of one result; `None` where it has no finite value.
pub(super) fn frame(result: &Value) -> Option<Frame> {
    let found = &result["distribution"];
    if let Some(points) = found["curve"]["points"].as_array() {
        return curve(&found["curve"], points);
    }
    let steps = found["empirical"].as_array()?;
    // What is infinite is no number in the file: below all values it comes first, above them last.
    let (mut below, mut points) = (0.0, Vec::new());
    for step in steps {
        match step["value"].as_f64() {
            Some(value) => points.push((value, number(&step["share"]))),
            None if points.is_empty() => below = number(&step["share"]),
            None => {}
        }
    }
    let (first, last) = (points.first()?.0, points.last()?.0);
    let room = 0.05 * (last - first).max(1e-9);
    let scale = Scale::linear([first - room, last + room].map(|x| if first >= 0.0 { x.max(0.0) } else { x }));
    let unit = result["unit"].as_str().unwrap_or_default();
    let axis = with_unit("value", unit);
    let band = found["band"].as_f64();
    let share =
        if band.is_some() { "share of trials at most, with its band" } else { "share of trials at most" };
    let mut frame = Frame::new([&axis, share], scale, Scale::shares());
    let mut corners = vec![(f64::NEG_INFINITY, below)];
    for (value, share) in &points {
        let before = corners.last().map_or(0.0, |(_, share)| *share);
        corners.extend([(*value, before), (*value, *share)]);
    }
    corners.push((f64::INFINITY, corners.last().map_or(1.0, |(_, share)| *share)));
    if let Some(band) = band {
        let ends: Vec<(f64, f64, f64)> =
            corners.iter().map(|(x, share)| (*x, (share - band).max(0.0), (share + band).min(1.0))).collect();
        frame.band(&ends, 1);
    }
    frame.line(corners, 3);
    for quantile in found["quantiles"].as_array().into_iter().flatten() {
        let level = number(&quantile["level"]);
        frame.level(level, &format!("quantile {level}"));
        if let Some(value) = quantile["estimate"].as_f64() {
            frame.mark(value, level, 0);
        }
    }
    Some(frame)
}
