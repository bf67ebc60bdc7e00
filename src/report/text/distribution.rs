//! How the values of a metric are distributed: quantiles, and a histogram in one line.

use super::rows;
use crate::engine::outcome::{Distribution, Histogram, Interval, QueryResult};
use crate::report::number::{brief, count, interval, plain, readable};
use crate::report::palette::{Paint, Palette};
use crate::report::phrase::endless;

const BARS: [char; 8] = ['▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];

/// Writes the lines of a distribution.
pub(super) fn write(text: &mut String, result: &QueryResult, found: &Distribution, palette: Palette) {
    let (unit, size) = readable(&result.unit, result.estimate.unwrap_or(result.low));
    let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
    // A single one is what was estimated, and stands above.
    if found.quantiles.len() > 1 {
        let parts: Vec<String> = found
            .quantiles
            .iter()
            .map(|q| {
                let Interval { estimate, low, high } = q.value;
                let value = Interval { estimate: estimate / size, low: low / size, high: high / size };
                let horizon = result.censored.map(|horizon| horizon / size);
                format!("{} %: {}{unit}", plain(100.0 * q.level), interval(&value, horizon).estimate)
            })
            .collect();
        rows::line(text, &format!("quantiles {}", parts.join(", ")));
    }
    if let Some(histogram) = &found.histogram {
        let bars = palette.paint(Paint::Neutral, &bars(histogram));
        let [low, high] = [histogram.low, histogram.high].map(|end| brief(end / size));
        let mut said = format!("{low}{unit} {bars} {high}{unit}");
        if histogram.below > 0 {
            said = format!("{} at -∞, {said}", count(histogram.below));
        }
        if histogram.beyond > 0 {
            said = format!("{said}, {} {}", count(histogram.beyond), endless(result));
        }
        if let Some(band) = found.band {
            said = format!("{said}, distribution function to ± {}", plain((band * 1000.0).ceil() / 1000.0));
        }
        rows::line(text, &said);
    }
}

/// One bar per bin; an empty bin is a dot, the fullest has full height.
fn bars(histogram: &Histogram) -> String {
    let most = histogram.counts.iter().copied().max().unwrap_or(0).max(1);
    histogram
        .counts
        .iter()
        .map(|&n| if n == 0 { '·' } else { BARS[((n as f64 / most as f64) * 7.0).round() as usize] })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_empty_bin_shows() {
        let histogram = Histogram { low: 0.0, high: 1.0, counts: vec![0, 1, 100, 50], below: 0, beyond: 0 };
        assert_eq!(bars(&histogram), "·▁█▅");
        assert_eq!(bars(&Histogram { counts: vec![], ..histogram }), "");
    }
}
