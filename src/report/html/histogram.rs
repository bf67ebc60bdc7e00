//! A histogram in SVG.

use crate::engine::outcome::Histogram;
use crate::report::number::{count, plain};
use crate::report::svg::scale::Scale;
use std::fmt::Write as _;

const WIDTH: f64 = 520.0;
const HEIGHT: f64 = 120.0;
const MARGIN: f64 = 10.0;

/// The bars, each with its range and count as a tooltip; empty without bins. `endless` is what the values above
/// all bins are.
pub(super) fn bars(histogram: &Histogram, unit: &str, endless: &str) -> String {
    let most = histogram.counts.iter().copied().max().unwrap_or(0);
    if most == 0 {
        return String::new();
    }
    let bins = histogram.counts.len() as f64;
    let bin = (histogram.high - histogram.low) / bins;
    let width = WIDTH / bins;
    let height = Scale::linear([0.0, most as f64]);
    let mut svg = format!(
        "<svg viewBox=\"0 0 {:.0} {:.0}\" width=\"{:.0}\" role=\"img\">\n",
        WIDTH + 2.0 * MARGIN,
        HEIGHT + 22.0,
        WIDTH + 2.0 * MARGIN
    );
    for (k, &n) in histogram.counts.iter().enumerate() {
        let tall = HEIGHT * height.share(n as f64);
        let from = histogram.low + bin * k as f64;
        let _ = writeln!(
            svg,
            "<rect class=\"bar\" x=\"{:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{tall:.1}\">\
             <title>{} to {} {unit}: {}</title></rect>",
            MARGIN + width * k as f64,
            HEIGHT - tall,
            (width - 1.0).max(0.5),
            plain(from),
            plain(from + bin),
            count(n)
        );
    }
    for (at, value) in [(MARGIN, histogram.low), (MARGIN + WIDTH, histogram.high)] {
        let class = if at > MARGIN { "last" } else { "first" };
        let _ = writeln!(
            svg,
            "<text class=\"tick {class}\" x=\"{at:.1}\" y=\"{:.1}\">{} {unit}</text>",
            HEIGHT + 16.0,
            plain(value)
        );
    }
    svg.push_str("</svg>\n");
    for (some, where_) in [(histogram.below, "at -∞"), (histogram.beyond, endless)] {
        if some > 0 {
            let _ = writeln!(svg, "<p class=\"faint\">{} {where_}</p>", count(some));
        }
    }
    svg
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_bar_per_bin() {
        let histogram = Histogram { low: 0.0, high: 2.0, counts: vec![1, 0, 4, 2], below: 5, beyond: 3 };
        let svg = bars(&histogram, "m", "infinite");
        assert_eq!(svg.matches("<rect").count(), 4);
        assert!(
            svg.contains("<title>1 to 1.5 m: 4</title>")
                && svg.contains("3 infinite")
                && svg.contains("5 at -∞")
        );
        assert_eq!(bars(&Histogram { counts: vec![0, 0], ..histogram }, "", "infinite"), "");
    }
}
