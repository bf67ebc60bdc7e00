//! How evidence grew over the trials, or the pairs of a comparison: the confidence sequence; the evidence of a test, for above upwards and for below
//! downwards, between its thresholds; the trials of each option of a ranking, up to where it was eliminated.

use super::answer::{Answer, Needed, interval, number, with_unit};
use super::flaw::Flaw;
use crate::report::svg::frame::Frame;
use crate::report::svg::picture::Picture;
use crate::report::svg::scale::Scale;
use serde_json::Value;

/// What it needs.
const NEEDED: Needed = ("evidence", "add `--evidence` to the call of `smc check` that makes the file");

/// Options that are named.
const NAMED: usize = 12;

pub(super) fn draw(file: &Value, only: Option<&str>) -> Result<Picture, Flaw> {
    let answer =
        Answer::of(file, only, NEEDED, |results| results.len() == 1 && !frames(results[0]).is_empty())?;
    Ok(Picture::charts(answer.query, frames(answer.results[0])))
}

/// The frames of one result; none if it has no evidence.
pub(super) fn frames(result: &Value) -> Vec<Frame> {
    let evidence = &result["evidence"];
    let snapshots = evidence["snapshots"].as_array().map_or(&[][..], Vec::as_slice);
    if snapshots.is_empty() {
        return Vec::new();
    }
    if let Some(labels) = evidence["options"].as_array() {
        return vec![race(labels, snapshots)];
    }
    let mut frames = vec![sequence(result, snapshots)];
    frames.extend(weights(&evidence["thresholds"], snapshots));
    frames
}

fn trials(snapshot: &Value) -> f64 {
    number(&snapshot["trials"])
}

fn sequence(result: &Value, snapshots: &[Value]) -> Frame {
    let unit = result["unit"].as_str().unwrap_or_default();
    let is_difference = result["kind"] == "compare";
    let (trials_axis, what) = match (is_difference, unit) {
        (true, _) => ("pairs of trials", "difference"),
        (false, "") => ("trials", "probability"),
        (false, _) => ("trials", "value"),
    };
    let level = if is_difference { Some((0.0, "no difference")) } else { None };
    let level = level.or_else(|| Some((result["method"]["theta"].as_f64()?, "threshold")));
    let numbers = snapshots.iter().flat_map(interval).chain(level.map(|(at, _)| at));
    let y = match (unit, is_difference) {
        ("", false) => Scale::shares(),
        _ => Scale::linear(numbers),
    };
    let axes = [trials_axis, &format!("{}, with its interval", with_unit(what, unit))];
    let mut frame = Frame::new(axes, Scale::log(snapshots.iter().map(trials)), y);
    let band = snapshots.iter().map(|one| (trials(one), interval(one)));
    let band: Vec<(f64, f64, f64)> = band.map(|(x, [low, _, high])| (x, low, high)).collect();
    frame.band(&band, 1);
    frame.line(snapshots.iter().map(|one| (trials(one), number(&one["estimate"]))), 1);
    if let Some((at, name)) = level {
        frame.level(at, name);
    }
    frame
}

fn weights(thresholds: &Value, snapshots: &[Value]) -> Option<Frame> {
    let (above, below) = (thresholds["above"].as_f64()?, thresholds["below"].as_f64()?);
    let of = |key: &'static str, sign: f64| {
        snapshots.iter().map(move |one| (trials(one), sign * number(&one[key])))
    };
    // Evidence far on the other side says no more.
    let y = Scale::linear([-1.3 * below, 1.3 * above]);
    let axis = "logarithm of the evidence: for above, and downwards for below";
    let mut frame = Frame::new(["trials", axis], Scale::log(snapshots.iter().map(trials)), y).low();
    frame.line(of("above", 1.0), 0);
    frame.line(of("below", -1.0), 1);
    frame.level(above, "decides above");
    frame.level(-below, "decides below");
    frame.name("for above", 0);
    frame.name("for below", 1);
    Some(frame)
}

fn race(labels: &[Value], snapshots: &[Value]) -> Frame {
    let option = |snapshot: &Value, k: usize| {
        let one = &snapshot["options"][k];
        (number(&one["trials"]), one["open"].as_bool().unwrap_or(false))
    };
    let most = snapshots.iter().flat_map(|one| (0..labels.len()).map(move |k| option(one, k).0));
    let (x, y) = (Scale::log(snapshots.iter().map(trials)), Scale::linear(most.chain([0.0])));
    let mut frame =
        Frame::new(["trials of all options", "trials of an option, up to where it is eliminated"], x, y);
    let last = snapshots.last();
    let mut order: Vec<usize> = (0..labels.len()).collect();
    order.sort_by(|a, b| {
        let trials = |k: usize| last.map_or(0.0, |last| option(last, k).0);
        trials(*b).total_cmp(&trials(*a)).then(a.cmp(b))
    });
    for (place, k) in order.into_iter().enumerate() {
        let style = if place < NAMED { place } else { 4 };
        let open = snapshots.iter().take_while(|one| option(one, k).1).count();
        let shown = &snapshots[..(open + 1).min(snapshots.len())];
        frame.line(shown.iter().map(|one| (trials(one), option(one, k).0)), style);
        if let Some(end) = shown.last().filter(|_| open < snapshots.len()) {
            frame.mark(trials(end), option(end, k).0, style);
        }
        if place < NAMED {
            frame.name(labels[k].as_str().unwrap_or_default(), style);
        }
    }
    frame
}
