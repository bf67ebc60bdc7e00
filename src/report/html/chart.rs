//! A chart of intervals in SVG: one row per number, a dot for the estimate and a bar from end to end.

use crate::engine::outcome::Interval;
use crate::report::escape::escape;
use crate::report::number::plain;
use crate::report::palette::Paint;
use crate::report::svg::scale::Scale;
use std::fmt::Write as _;

/// Widths in user units: one letter of a label, plot, numbers.
const LETTER: f64 = 7.2;
const PLOT: f64 = 340.0;
const NUMBERS: f64 = 300.0;
const ROW: f64 = 24.0;
const AXIS: f64 = 26.0;

/// One row.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Mark {
    pub(super) label: String,
    pub(super) value: Interval,
    /// How it looks.
    pub(super) tone: Paint,
    /// The numbers in words, at the right.
    pub(super) said: String,
}

/// The chart; empty without rows. What lies beyond the horizon is drawn at the end of the axis.
pub(super) fn intervals(marks: &[Mark], unit: &str, threshold: Option<f64>, horizon: Option<f64>) -> String {
    if marks.is_empty() {
        return String::new();
    }
    let numbers = marks
        .iter()
        .flat_map(|m| [m.value.estimate, m.value.low, m.value.high])
        .chain(threshold)
        .chain(horizon);
    let axis = if unit.is_empty() { Scale::probabilities(numbers) } else { Scale::linear(numbers) };
    let letters = marks.iter().map(|m| m.label.chars().count()).max().unwrap_or(0);
    let labels = (20.0 + LETTER * letters as f64).max(30.0);
    let x = |value: f64| labels + PLOT * axis.share(value);
    let bottom = ROW * marks.len() as f64 + 4.0;
    let (width, height) = (labels + PLOT + NUMBERS, bottom + AXIS);
    let mut svg = format!("<svg viewBox=\"0 0 {width:.0} {height:.0}\" width=\"{width:.0}\" role=\"img\">\n");
    for &tick in axis.ticks() {
        let at = x(tick);
        let _ = writeln!(
            svg,
            "<line class=\"grid\" x1=\"{at:.1}\" x2=\"{at:.1}\" y1=\"4\" y2=\"{bottom:.1}\"/>\
             <text class=\"tick\" x=\"{at:.1}\" y=\"{:.1}\">{}</text>",
            bottom + 16.0,
            plain(tick)
        );
    }
    if let Some(threshold) = threshold {
        let at = x(threshold);
        let _ = writeln!(
            svg,
            "<line class=\"threshold\" x1=\"{at:.1}\" x2=\"{at:.1}\" y1=\"0\" y2=\"{bottom:.1}\"><title>threshold {}</title></line>",
            plain(threshold)
        );
    }
    for (k, mark) in marks.iter().enumerate() {
        row(&mut svg, mark, ROW * (k as f64 + 0.5) + 4.0, labels, &x);
    }
    svg.push_str("</svg>\n");
    svg
}

fn row(svg: &mut String, mark: &Mark, y: f64, labels: f64, x: &impl Fn(f64) -> f64) {
    let class = mark.tone.class();
    let text = y + 4.0;
    let (low, high) = (x(mark.value.low), x(mark.value.high));
    let _ = writeln!(
        svg,
        "<text class=\"label\" x=\"{:.1}\" y=\"{text:.1}\">{}</text>\
         <line class=\"whisker {class}\" x1=\"{low:.1}\" x2=\"{high:.1}\" y1=\"{y:.1}\" y2=\"{y:.1}\"/>",
        labels - 10.0,
        escape(&mark.label)
    );
    if !mark.value.estimate.is_nan() {
        let at = x(mark.value.estimate);
        let _ = writeln!(svg, "<circle class=\"dot {class}\" cx=\"{at:.1}\" cy=\"{y:.1}\" r=\"3.5\"/>");
    }
    let _ = writeln!(
        svg,
        "<text class=\"said\" x=\"{:.1}\" y=\"{text:.1}\">{}</text>",
        labels + PLOT + 14.0,
        escape(&mark.said)
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chart_without_rows_is_nothing() {
        assert_eq!(intervals(&[], "m", None, None), "");
    }
}
