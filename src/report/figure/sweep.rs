//! Results over the values of a swept parameter, with their intervals; a line for each combination of other parameters.

use super::answer::{Answer, Needed, interval, number, with_unit};
use super::flaw::Flaw;
use crate::report::svg::frame::Frame;
use crate::report::svg::picture::Picture;
use crate::report::svg::scale::Scale;
use serde_json::Value;

/// What it needs.
const NEEDED: Needed =
    ("results under several settings", "sweep a parameter: `smc check … --set 'width=0.8..1.6 by 0.2'`");

/// A line: the other parameters in words, and the place and interval of each result.
type Line = (String, Vec<(f64, [f64; 3])>);

pub(super) fn draw(file: &Value, only: Option<&str>) -> Result<Picture, Flaw> {
    let answer = Answer::of(file, only, NEEDED, |results| results.len() > 1)?;
    let settings: Vec<_> = answer.results.iter().filter_map(|one| one["settings"].as_object()).collect();
    let names = settings.first().map(|first| first.keys()).into_iter().flatten();
    let varies = |name: &&String| {
        let values: Vec<f64> = settings.iter().map(|one| number(&one[*name]["value"])).collect();
        values.iter().all(|value| value.is_finite()) && values.iter().any(|value| *value != values[0])
    };
    let Some(name) = names.clone().find(varies) else {
        return Err(Flaw::new(
            "the values of the swept parameter are no numbers",
            "sweep a parameter whose values are numbers, or draw the results from the table of `--format csv`",
        ));
    };
    let mut lines: Vec<Line> = Vec::new();
    for (one, settings) in answer.results.iter().zip(&settings) {
        let others = names.clone().filter(|other| *other != name);
        let label: Vec<String> =
            others.map(|other| format!("{other} = {}", said(&settings[other]))).collect();
        let point = (number(&settings[name]["value"]), interval(one));
        let label = label.join(", ");
        match lines.iter_mut().find(|(known, _)| *known == label) {
            Some((_, points)) => points.push(point),
            None => lines.push((label, vec![point])),
        }
    }
    let unit = settings[0][name]["unit"].as_str().unwrap_or_default();
    let axis = with_unit(name, unit);
    let theta = answer.results.iter().map(|one| number(&one["method"]["theta"])).find(|x| x.is_finite());
    let all = || lines.iter().flat_map(|(_, points)| points);
    let x = Scale::linear(all().map(|(x, _)| *x));
    let y = Scale::linear(all().flat_map(|(_, interval)| *interval).chain(theta));
    let mut frame = Frame::new([&axis, &answer.axis()], x, y);
    if let Some(theta) = theta {
        frame.level(theta, "threshold");
    }
    for (k, (label, points)) in lines.iter_mut().enumerate() {
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        frame.line(points.iter().map(|(x, [_, estimate, _])| (*x, *estimate)), k);
        for (x, interval) in points.iter() {
            frame.upright(*x, *interval, k);
        }
        if !label.is_empty() {
            frame.name(label, k);
        }
    }
    Ok(Picture::charts(answer.query, vec![frame]))
}

/// A value with its unit.
fn said(value: &Value) -> String {
    let text = value["value"].as_str().map_or_else(|| value["value"].to_string(), str::to_owned);
    format!("{text} {}", value["unit"].as_str().unwrap_or_default()).trim_end().to_owned()
}
