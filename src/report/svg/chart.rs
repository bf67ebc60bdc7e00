//! Lines over a number as SVG: axes with units, and lines that differ in brightness and dashes.

use super::{plain, round_step};
use crate::base::geometry::{Bounds, Vec2};
use crate::report::escape::escape;
use std::fmt::Write as _;

/// Size of the picture and room for axes, pixels.
const SIZE: (f64, f64) = (900.0, 420.0);
const MARGIN: f64 = 56.0;

/// Colours of lines, with their widths and dashes, in order.
pub(in crate::report) const LINES: [(&str, &str); 6] = [
    ("#c2410c", "stroke-width=\"2\""),
    ("#1d4e89", "stroke-width=\"2\" stroke-dasharray=\"7 3\""),
    ("#5b8c5a", "stroke-width=\"2\" stroke-dasharray=\"2 3\""),
    ("#000000", "stroke-width=\"1.5\""),
    ("#8a8a8a", "stroke-width=\"1.5\" stroke-dasharray=\"10 4 2 4\""),
    ("#b39ddb", "stroke-width=\"2\" stroke-dasharray=\"4 2\""),
];

/// Named lines over one number.
#[derive(Clone, Debug)]
pub struct Chart {
    axes: [String; 2],
    lines: Vec<(String, Vec<Vec2>)>,
}

impl Chart {
    /// An empty chart; the axes are named with their units.
    pub fn new(x: &str, y: &str) -> Self {
        Self { axes: [x.to_owned(), y.to_owned()], lines: Vec::new() }
    }

    /// A line through points. Points without a finite place are left out.
    pub fn line(&mut self, name: &str, points: impl IntoIterator<Item = Vec2>) {
        let points = points.into_iter().filter(|p| p.x.is_finite() && p.y.is_finite()).collect();
        self.lines.push((name.to_owned(), points));
    }

    /// The picture.
    pub fn finish(&self, title: &str) -> String {
        let all = self.lines.iter().flat_map(|(_, points)| points.iter().copied()).chain([Vec2::zeros()]);
        let bounds = Bounds::around(all).unwrap_or(Bounds { low: Vec2::zeros(), high: Vec2::zeros() });
        let mut size = (bounds.high - bounds.low).map(|side| side.max(1e-3));
        // Room for the names of the lines.
        size.y *= 1.0 + 0.05 * self.lines.len() as f64;
        let room = Vec2::new(SIZE.0 - 1.5 * MARGIN, SIZE.1 - 1.5 * MARGIN);
        let at = |p: Vec2| {
            let share = (p - bounds.low).component_div(&size);
            (MARGIN + share.x * room.x, 0.5 * MARGIN + (1.0 - share.y) * room.y)
        };
        let mut body = String::new();
        let (left, bottom) = at(bounds.low);
        let (right, top) = at(bounds.low + size);
        let _ = writeln!(
            body,
            "<path d=\"M{left:.1},{top:.1}V{bottom:.1}H{right:.1}\" fill=\"none\" stroke=\"#808080\"/>"
        );
        for axis in 0..2 {
            let step = round_step(size[axis] / 6.0);
            let ticks =
                (bounds.low[axis] / step).ceil() as i64..=((bounds.low + size)[axis] / step).floor() as i64;
            for value in ticks.map(|k| k as f64 * step) {
                let mut place = bounds.low;
                place[axis] = value;
                let (x, y) = at(place);
                let (mark, dx, dy, anchor) =
                    if axis == 0 { ("v4", 0.0, 16.0, "middle") } else { ("h-4", -7.0, 4.0, "end") };
                let _ = writeln!(
                    body,
                    "<path d=\"M{x:.1},{y:.1}{mark}\" stroke=\"#808080\"/><text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"{anchor}\" fill=\"#404040\">{}</text>",
                    x + dx,
                    y + dy,
                    plain((value * 1e6).round() / 1e6)
                );
            }
        }
        let _ = writeln!(
            body,
            "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{}</text><text x=\"{left:.1}\" y=\"16\" text-anchor=\"start\">{}</text>",
            right,
            bottom + 34.0,
            escape(&self.axes[0]),
            escape(&self.axes[1])
        );
        for (k, (name, points)) in self.lines.iter().enumerate() {
            let pixels = points.iter().map(|p| at(*p)).map(|(x, y)| format!("{x:.1},{y:.1}"));
            let (colour, shape) = LINES[k % LINES.len()];
            let style = format!("stroke=\"{colour}\" {shape}");
            let y = 16.0 + 14.0 * k as f64;
            let _ = writeln!(
                body,
                "<polyline points=\"{}\" fill=\"none\" {style}/><path d=\"M{:.1},{:.1}h28\" {style}/><text x=\"{:.1}\" y=\"{y:.1}\" text-anchor=\"end\">{}</text>",
                pixels.collect::<Vec<_>>().join(" "),
                right - 28.0,
                y - 4.0,
                right - 34.0,
                escape(name)
            );
        }
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {:.0} {:.0}\" font-family=\"sans-serif\" font-size=\"11\">\n<title>{}</title>\n<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n{body}</svg>\n",
            SIZE.0,
            SIZE.1,
            escape(title)
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_escaped_and_points_without_a_place_left_out() {
        let mut chart = Chart::new("x (m)", "v (m/s)");
        chart.line("a < b", [Vec2::new(0.0, 1.0), Vec2::new(1.0, f64::NAN), Vec2::new(2.0, 3.0)]);
        let text = chart.finish("t");
        assert!(text.contains("a &lt; b") && !text.contains("NaN"), "{text}");
        assert!(text.contains("x (m)") && text.contains("v (m/s)"));
    }
}
