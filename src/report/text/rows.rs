//! Lines and tables under the head of a result.

use super::columns::{Cell, lines};
use crate::engine::outcome::{Interval, QueryResult};
use crate::report::Palette;
use crate::report::number::interval;
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

/// The estimate and its interval, each with its unit.
pub(in crate::report) fn printed(result: &QueryResult, value: &Interval) -> (String, String) {
    let printed = interval(value, result.censored);
    let unit = if result.unit.is_empty() { String::new() } else { format!(" {}", result.unit) };
    let mut estimate = format!("{}{unit}", printed.estimate);
    if value.estimate == f64::INFINITY && result.censored.is_some() {
        estimate += " (within the horizon)";
    }
    (estimate, format!("{}{unit}", printed.interval))
}
