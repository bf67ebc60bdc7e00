//! Drawings of the plane as SVG: axes in metres, a scale bar, and colours that differ in brightness, so that they survive
//! print in grey.

pub mod frame;
pub mod plan;
pub mod scale;
pub mod steps;

use super::escape::escape;
use super::number::plain;
use crate::base::geometry::{Bounds, Shape, Vec2};
use std::fmt::Write as _;

/// Width and height of the longer side, pixels.
const SIZE: f64 = 900.0;
/// Room for axes and labels, pixels.
const MARGIN: f64 = 46.0;

/// How something is drawn: the attributes of its element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ink(&'static str);

impl Ink {
    /// Walls and obstacles: nearly black.
    pub const BARRIER: Self = Self(r##"fill="#37474f" stroke="#1c262b" stroke-width="2""##);
    /// Regions: very light.
    pub const REGION: Self = Self(r##"fill="#fff3c4" stroke="#b8a35a" stroke-dasharray="4 3""##);
    /// Where agents start: light.
    pub const START: Self = Self(r##"fill="#bfe0f5" stroke="#5b93b5" stroke-dasharray="2 2""##);
    /// A way: of medium brightness.
    pub const WAY: Self = Self(r##"fill="none" stroke="#c2410c" stroke-width="2" stroke-linejoin="round""##);
    /// Edges of a roadmap: thin and light.
    pub const ROADMAP: Self = Self(r##"fill="none" stroke="#9aa5ab" stroke-width="0.5""##);
    /// Steps with the left foot: thin and dark.
    pub const LEFT_STEP: Self =
        Self(r##"fill="none" stroke="#1f4e79" stroke-width="0.6" stroke-opacity="0.5""##);
    /// Steps with the right foot: thin and light.
    pub const RIGHT_STEP: Self =
        Self(r##"fill="none" stroke="#e69f00" stroke-width="0.6" stroke-opacity="0.5""##);
    /// One of many walks: thin, and transparent.
    pub const WALK: Self = Self(concat!(
        r##"fill="none" stroke="#7c2d12" stroke-width="0.8" stroke-opacity="0.25""##,
        r#" stroke-linejoin="round""#
    ));
    /// An inferred trace: black.
    pub const TRACE: Self =
        Self(r##"fill="none" stroke="#000000" stroke-width="1" stroke-linejoin="round""##);
    /// The start of a trace: blue.
    pub const TRACE_START: Self = Self(r##"fill="#1d4ed8" stroke="none""##);
    /// The end of a trace: red.
    pub const TRACE_END: Self = Self(r##"fill="#dc2626" stroke="none""##);
    /// A group at an instant: a thin black rim.
    pub const GROUP: Self = Self(r##"fill="none" stroke="#000000" stroke-width="0.6""##);
}

/// A drawing of a part of the plane.
#[derive(Clone, Debug)]
pub struct Drawing {
    bounds: Bounds,
    /// Pixels per metre.
    scale: f64,
    body: String,
}

impl Drawing {
    /// An empty drawing of what lies within some bounds, m.
    pub fn new(bounds: Bounds) -> Self {
        let size = bounds.high - bounds.low;
        let longest = size.x.max(size.y).max(1e-3);
        let room = Vec2::repeat(0.03 * longest);
        let bounds = Bounds { low: bounds.low - room, high: bounds.high + room };
        Self { bounds, scale: SIZE / (1.06 * longest), body: String::new() }
    }

    /// Pixels of a place, m; the y axis points up.
    fn at(&self, p: Vec2) -> (f64, f64) {
        (MARGIN + (p.x - self.bounds.low.x) * self.scale, 10.0 + (self.bounds.high.y - p.y) * self.scale)
    }

    fn points(&self, points: &[Vec2]) -> String {
        let pixels = points.iter().map(|p| self.at(*p));
        pixels.map(|(x, y)| format!("{x:.1},{y:.1}")).collect::<Vec<_>>().join(" ")
    }

    /// A line through points, m.
    pub fn line(&mut self, points: &[Vec2], ink: Ink) {
        let points = self.points(points);
        let _ = writeln!(self.body, "<polyline points=\"{points}\" {} fill-opacity=\"0\"/>", ink.0);
    }

    /// A shape, with holes.
    pub fn shape(&mut self, shape: &Shape, ink: Ink) {
        let drawn = match shape {
            Shape::Circle { centre, radius } => {
                let (x, y) = self.at(*centre);
                format!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{:.1}\"", radius * self.scale)
            }
            Shape::Polygon(polygon) => {
                let rings = std::iter::once(&polygon.outline).chain(&polygon.holes);
                let path: Vec<String> = rings.map(|ring| format!("M{}Z", self.points(ring))).collect();
                format!("<path fill-rule=\"evenodd\" d=\"{}\"", path.join(" "))
            }
        };
        let opacity = if ink == Ink::START { 0.7 } else { 1.0 };
        let _ = writeln!(self.body, "{drawn} {} fill-opacity=\"{opacity}\"/>", ink.0);
    }

    /// A square cell from its lower left corner, m, the darker the larger a share in 0 .. 1.
    pub fn cell(&mut self, low: Vec2, side: f64, share: f64) {
        let ((x, y), size) = (self.at(low + Vec2::new(0.0, side)), side * self.scale);
        let _ = writeln!(
            self.body,
            "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{size:.1}\" height=\"{size:.1}\" fill=\"#1d4e89\" fill-opacity=\"{:.2}\"/>",
            0.85 * share
        );
    }

    /// A line of text below the axes, in the lower left corner.
    pub fn note(&mut self, text: &str) {
        let (x, y) = self.at(self.bounds.low);
        let _ =
            writeln!(self.body, "<text x=\"{x:.1}\" y=\"{:.1}\">{}</text>", y + MARGIN - 4.0, escape(text));
    }

    /// A dot.
    pub fn dot(&mut self, p: Vec2, ink: Ink) {
        let (x, y) = self.at(p);
        let _ =
            writeln!(self.body, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4\" {} fill-opacity=\"1\"/>", ink.0);
    }

    /// A text whose middle is at a place, m.
    pub fn text(&mut self, p: Vec2, text: &str) {
        let (x, y) = self.at(p);
        // A white rim below the letters, drawn first: not every program knows `paint-order`.
        for rim in [" stroke=\"#ffffff\" stroke-width=\"3\"", ""] {
            let _ = writeln!(
                self.body,
                "<text x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\"{rim}>{}</text>",
                y + 4.0,
                escape(text)
            );
        }
    }

    /// The picture, with axes and a scale bar.
    pub fn finish(mut self, title: &str) -> String {
        let size = self.bounds.high - self.bounds.low;
        let step = round_step(size.x.max(size.y) / 8.0);
        let (width, height) = (MARGIN + size.x * self.scale + 10.0, 10.0 + size.y * self.scale + MARGIN);
        self.axes(step);
        // A bar as long as a step of the axes, in the lower right corner.
        let end = self.bounds.high.x;
        let bar =
            [Vec2::new(end - 1.1 * step, self.bounds.low.y), Vec2::new(end - 0.1 * step, self.bounds.low.y)];
        let (from, to) = (self.at(bar[0]), self.at(bar[1]));
        let _ = writeln!(
            self.body,
            "<path d=\"M{:.1},{y:.1}H{:.1}\" stroke=\"#000000\" stroke-width=\"4\"/><text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{} m</text>",
            from.0,
            to.0,
            0.5 * (from.0 + to.0),
            height - 4.0,
            plain(step),
            y = height - 20.0,
        );
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width:.0} {height:.0}\" font-family=\"sans-serif\" font-size=\"11\">\n<title>{}</title>\n<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n{}</svg>\n",
            escape(title),
            self.body
        )
    }

    /// Ticks and numbers at the left and lower rim.
    fn axes(&mut self, step: f64) {
        let (low, high) = (self.bounds.low, self.bounds.high);
        let (left, bottom) = self.at(low);
        let (right, top) = self.at(high);
        let _ = writeln!(
            self.body,
            "<path d=\"M{left:.1},{top:.1}V{bottom:.1}H{right:.1}\" fill=\"none\" stroke=\"#808080\"/>"
        );
        let ticks = |from: f64, to: f64| {
            ((from / step).ceil() as i64..=(to / step).floor() as i64).map(|k| k as f64 * step)
        };
        let label = |v: f64| plain((v * 1e6).round() / 1e6);
        for x in ticks(low.x, high.x) {
            let (at, _) = self.at(Vec2::new(x, low.y));
            let _ = writeln!(
                self.body,
                "<path d=\"M{at:.1},{bottom:.1}v4\" stroke=\"#808080\"/><text x=\"{at:.1}\" y=\"{:.1}\" text-anchor=\"middle\" fill=\"#404040\">{}</text>",
                bottom + 15.0,
                label(x)
            );
        }
        for y in ticks(low.y, high.y) {
            let (_, at) = self.at(Vec2::new(low.x, y));
            let _ = writeln!(
                self.body,
                "<path d=\"M{left:.1},{at:.1}h-4\" stroke=\"#808080\"/><text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\" fill=\"#404040\">{}</text>",
                left - 6.0,
                at + 4.0,
                label(y)
            );
        }
    }
}

/// The largest of 1, 2 and 5 times a power of ten that is not above a length.
fn round_step(length: f64) -> f64 {
    let mut power = 1e-3;
    while power * 10.0 <= length && power < 1e9 {
        power *= 10.0;
    }
    [5.0, 2.0].into_iter().map(|factor| factor * power).find(|step| *step <= length).unwrap_or(power)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_of_axes_are_round_and_names_are_escaped() {
        assert_eq!([0.9, 1.0, 4.9, 5.0, 19.0, 20.0].map(round_step), [0.5, 1.0, 2.0, 5.0, 10.0, 20.0]);
        let mut drawing = Drawing::new(Bounds { low: Vec2::zeros(), high: Vec2::new(20.0, 10.0) });
        drawing.text(Vec2::new(1.0, 1.0), "</svg><script>");
        drawing.line(&[Vec2::zeros(), Vec2::new(3.0, 3.0)], Ink::START);
        for ink in [Ink::BARRIER, Ink::REGION, Ink::START, Ink::WAY, Ink::ROADMAP] {
            drawing.dot(Vec2::zeros(), ink);
            drawing.shape(&Shape::Circle { centre: Vec2::zeros(), radius: 1.0 }, ink);
        }
        let text = drawing.finish("a & b");
        for element in text.split('<') {
            let names = element.split('"').step_by(2).filter_map(|part| part.trim().strip_suffix('='));
            let names: Vec<&str> = names.map(|part| part.rsplit(' ').next().unwrap_or(part)).collect();
            let mut once = names.clone();
            once.sort_unstable();
            once.dedup();
            assert_eq!(once.len(), names.len(), "an attribute is given twice: {element}");
        }
        assert!(
            text.contains("&lt;/svg&gt;") && !text.contains("<script>") && text.contains("a &amp; b"),
            "{text}"
        );
        assert!(text.contains(">2 m</text>"), "{text}");
    }
}
