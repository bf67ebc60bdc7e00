//! Reliability of predictions that `smc evaluate --format json` has written: the share that happened over the predicted
//! probability, and below it how many predictions were made (Murphy and Winkler 1977); two frames a property, a line a kind.

use super::answer::number;
use super::flaw::Flaw;
use crate::report::svg::frame::Frame;
use crate::report::svg::picture::Picture;
use crate::report::svg::scale::Scale;
use serde_json::Value;

/// The schema of evaluated predictions that is read.
const SCHEMA: u64 = 1;

pub(super) fn draw(file: &Value, only: Option<&str>) -> Result<Picture, Flaw> {
    let kinds = file["kinds"].as_array().filter(|_| file["schema"].as_u64() == Some(SCHEMA));
    let Some(kinds) = kinds.filter(|kinds| !kinds.is_empty()) else {
        return Err(Flaw::new(
            format!("the file has no evaluated predictions of schema {SCHEMA}"),
            "make the file with `smc evaluate … --format json` of this version",
        ));
    };
    let properties = |kind: &Value| kind["properties"].as_array().cloned().unwrap_or_default();
    let names: Vec<String> =
        properties(&kinds[0]).iter().filter_map(|one| one["name"].as_str().map(str::to_owned)).collect();
    let shown: Vec<&String> = names.iter().filter(|name| only.is_none_or(|only| *name == only)).collect();
    if shown.is_empty() {
        let known: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
        return Err(Flaw::new(
            "the file has no such property",
            format!("write one of {} after `--only`", known.join(", ")),
        ));
    }
    let mut frames = Vec::new();
    for name in shown {
        let axis = format!("predicted probability of `{name}`");
        let mut frame = Frame::new([&axis, "share that happened"], Scale::shares(), Scale::shares());
        frame.line([(0.0, 0.0), (1.0, 1.0)], 4);
        let mut numbers = Vec::new();
        for (k, kind) in kinds.iter().enumerate() {
            let of_name = properties(kind).into_iter().find(|one| one["name"].as_str() == Some(name));
            let list =
                |key: &str| of_name.as_ref().and_then(|one| one[key].as_array().cloned()).unwrap_or_default();
            let bins = list("bins");
            numbers.push(list("histogram").iter().map(number).collect::<Vec<f64>>());
            let points: Vec<(f64, f64)> =
                bins.iter().map(|bin| (number(&bin["mean"]), number(&bin["share"]))).collect();
            for (x, y) in &points {
                frame.mark(*x, *y, k);
            }
            frame.line(points, k);
            frame.name(kind["name"].as_str().unwrap_or_default(), k);
        }
        frames.extend([frame, predictions(&numbers)]);
    }
    let recording = file["recording"].as_str().unwrap_or_default();
    Ok(Picture::charts(&format!("Reliability on {recording}"), frames))
}

/// How many predictions lie in each tenth: an outline for each kind.
fn predictions(numbers: &[Vec<f64>]) -> Frame {
    let y = Scale::linear(numbers.iter().flatten().copied().chain([0.0]));
    let mut frame = Frame::new(["predicted probability", "predictions"], Scale::shares(), y).low();
    for (k, numbers) in numbers.iter().enumerate() {
        let tenths = numbers.iter().zip(0_u32..);
        frame.line(
            tenths.flat_map(|(n, tenth)| [(f64::from(tenth) / 10.0, *n), (f64::from(tenth + 1) / 10.0, *n)]),
            k,
        );
    }
    frame
}
