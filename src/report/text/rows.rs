//! Lines and tables under the head of a result.

use super::columns::{Cell, lines};
use crate::engine::outcome::{Interval, QueryResult};
use crate::report::number::{interval, readable};
use crate::report::palette::{Paint, Palette};
use std::fmt::Write;

/// Width of the verdict's column, blanks after it included.
pub(super) const MARGIN: usize = 11;

/// A line under the head.
pub(super) fn line(text: &mut String, content: &str) {
    let _ = writeln!(text, "{:MARGIN$}{content}", "");
}

/// Aligned lines under the head.
pub(super) fn table(text: &mut String, rows: &[Vec<Cell>], palette: Palette) {
    for row in lines(rows, palette) {
        line(text, &row);
    }
}

/// Which intervals a table has.
pub(super) fn intervals(text: &mut String, result: &QueryResult, palette: Palette) {
    if !result.interval.is_empty() {
        line(text, &palette.paint(Paint::Faint, &format!("intervals: {}", result.interval)));
    }
}

/// A number in another unit, which has so many of the given one.
pub(super) fn in_size(value: &Interval, size: f64) -> Interval {
    Interval { estimate: value.estimate / size, low: value.low / size, high: value.high / size }
}

/// A number and its interval, each with its unit, of what has no result of its own.
pub(in crate::report) fn in_unit(value: &Interval, unit: &str) -> (String, String) {
    let printed = interval(value, None);
    let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
    (format!("{}{unit}", printed.estimate), format!("{}{unit}", printed.interval))
}

/// The estimate and its interval, each with its unit. Long times are in minutes or hours.
pub(in crate::report) fn printed(result: &QueryResult, value: &Interval) -> (String, String) {
    let (unit, size) = readable(&result.unit, result.estimate.unwrap_or(result.low));
    let printed = interval(&in_size(value, size), result.censored.map(|horizon| horizon / size));
    let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
    let mut estimate = format!("{}{unit}", printed.estimate);
    if value.estimate == f64::INFINITY && result.censored.is_some() {
        estimate += " (within the horizon)";
    }
    (estimate, format!("{}{unit}", printed.interval))
}
