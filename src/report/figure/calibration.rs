//! Reliability of predictions that `smc evaluate --format json` has written: the share that happened over the predicted
//! probability (Murphy and Winkler 1977), a frame a property, a line a kind.

use super::answer::number;
use super::flaw::Flaw;
use crate::report::svg::frame::{Frame, picture};
use crate::report::svg::scale::Scale;
use serde_json::Value;

/// The schema of evaluated predictions that is read.
const SCHEMA: u64 = 1;

pub(super) fn draw(file: &Value, only: Option<&str>) -> Result<String, Flaw> {
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
        let axes = [name.as_str(), "share that happened"].map(str::to_owned);
        let axes = [format!("predicted probability of `{}`", axes[0]), axes[1].clone()];
        let mut frame = Frame::new([&axes[0], &axes[1]], Scale::shares(), Scale::shares());
        frame.line([(0.0, 0.0), (1.0, 1.0)], 4);
        for (k, kind) in kinds.iter().enumerate() {
            let of_name = properties(kind).into_iter().find(|one| one["name"].as_str() == Some(name));
            let bins = of_name.and_then(|one| one["bins"].as_array().cloned()).unwrap_or_default();
            let points: Vec<(f64, f64)> =
                bins.iter().map(|bin| (number(&bin["mean"]), number(&bin["share"]))).collect();
            for (x, y) in &points {
                frame.mark(*x, *y, k);
            }
            frame.line(points, k);
            frame.name(kind["name"].as_str().unwrap_or_default(), k);
        }
        frames.push(frame);
    }
    let recording = file["recording"].as_str().unwrap_or_default();
    Ok(picture(&format!("Reliability on {recording}"), frames))
}
