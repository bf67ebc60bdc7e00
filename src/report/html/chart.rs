//! A chart of intervals: one row per number with its label, a bar from end to end with a dot for the estimate, and the numbers in
//! words. The rows share an axis; on a narrow screen label, bar and numbers stand below each other. Places along the axis are shares
//! of its width, so that a row fits any width.

use crate::engine::outcome::Interval;
use crate::report::escape::escape;
use crate::report::number::plain;
use crate::report::palette::Paint;
use crate::report::svg::scale::Scale;
use std::fmt::Write as _;

/// One row.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Mark {
    pub(super) label: String,
    pub(super) value: Interval,
    /// How it looks.
    pub(super) tone: Paint,
    /// The numbers in words.
    pub(super) said: String,
}

/// The chart; empty without rows. A value beyond the horizon is drawn at the end of the axis.
pub(super) fn intervals(marks: &[Mark], unit: &str, threshold: Option<f64>, horizon: Option<f64>) -> String {
    if marks.is_empty() {
        return String::new();
    }
    let ends = marks.iter().flat_map(|m| [m.value.estimate, m.value.low, m.value.high]);
    let numbers = ends.chain(threshold).chain(horizon);
    let axis = if unit.is_empty() { Scale::probabilities(numbers) } else { Scale::linear(numbers) };
    // Dots and words at the ends of the axis have room.
    let x = |value: f64| 3.0 + 94.0 * axis.share(value);
    let mut below = String::new();
    let mut ticks = String::new();
    for &tick in axis.ticks() {
        let at = x(tick);
        let _ = write!(below, "<line class=\"grid\" x1=\"{at:.2}%\" x2=\"{at:.2}%\" y1=\"0\" y2=\"100%\"/>");
        let _ = write!(ticks, "<text class=\"tick\" x=\"{at:.2}%\" y=\"12\">{}</text>", plain(tick));
    }
    if let Some(threshold) = threshold {
        let at = x(threshold);
        let title = format!("<title>threshold {}</title>", plain(threshold));
        let _ = write!(
            below,
            "<line class=\"threshold\" x1=\"{at:.2}%\" x2=\"{at:.2}%\" y1=\"0\" y2=\"100%\">{title}</line>"
        );
    }
    let mut rows = String::from("<div class=\"intervals\">\n");
    for mark in marks {
        let class = mark.tone.class();
        let (low, high) = (x(mark.value.low), x(mark.value.high));
        let _ = write!(
            rows,
            "<span class=\"name\">{}</span><svg height=\"24\" role=\"img\">{below}\
             <line class=\"whisker {class}\" x1=\"{low:.2}%\" x2=\"{high:.2}%\" y1=\"12\" y2=\"12\"/>",
            escape(&mark.label)
        );
        if !mark.value.estimate.is_nan() {
            let at = x(mark.value.estimate);
            let _ = write!(rows, "<circle class=\"dot {class}\" cx=\"{at:.2}%\" cy=\"12\" r=\"3.5\"/>");
        }
        let _ = writeln!(rows, "</svg><span class=\"said\">{}</span>", escape(&mark.said));
    }
    let _ = writeln!(rows, "<span></span><svg height=\"18\" role=\"img\">{ticks}</svg><span></span>\n</div>");
    rows
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chart_without_rows_is_nothing() {
        assert_eq!(intervals(&[], "m", None, None), "");
    }
}
