//! Drawings of the plane as SVG: axes in metres, and colours that differ in brightness, so that they survive
//! print in grey.

pub mod frame;
pub mod picture;
pub mod plan;
pub mod scale;
pub mod steps;

use super::escape::escape;
use super::number::plain;
use crate::base::geometry::{Bounds, Shape, Vec2};
use frame::write_text;
use std::fmt::Write as _;

/// Width and height of the longer side, pixels.
const SIZE: f64 = 900.0;
/// Room for axes and labels, pixels.
const MARGIN: f64 = 46.0;
/// Room above and at the right, pixels.
const END: f64 = 10.0;

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
    /// A named route: violet and dashed.
    pub const ROUTE: Self = Self(
        r##"fill="none" stroke="#7a5195" stroke-width="2" stroke-dasharray="6 4" stroke-linejoin="round""##,
    );
    /// A joint of a path: small and dark.
    pub const JOINT: Self = Self(r##"fill="#ffffff" stroke="#37474f" stroke-width="1.5""##);
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

/// What is drawn in the plane.
#[derive(Clone, Debug)]
enum Mark {
    Line(Vec<Vec2>, Ink),
    Shape(Shape, Ink),
    /// Lower left corner, side, m, and how dark.
    Cell(Vec2, f64, f64),
    Dot(Vec2, Ink),
    Text(Vec2, String),
}

/// A drawing of a part of the plane.
#[derive(Clone, Debug)]
pub struct Drawing {
    bounds: Bounds,
    marks: Vec<Mark>,
    legend: Vec<(Ink, String)>,
    note: String,
}

impl Drawing {
    /// An empty drawing of what lies within some bounds, m.
    pub fn new(bounds: Bounds) -> Self {
        let size = bounds.high - bounds.low;
        let room = Vec2::repeat(0.03 * size.x.max(size.y).max(1e-3));
        let bounds = Bounds { low: bounds.low - room, high: bounds.high + room };
        Self { bounds, marks: Vec::new(), legend: Vec::new(), note: String::new() }
    }

    /// A line through points, m.
    pub fn line(&mut self, points: &[Vec2], ink: Ink) {
        self.marks.push(Mark::Line(points.to_vec(), ink));
    }

    /// A shape, with holes.
    pub fn shape(&mut self, shape: &Shape, ink: Ink) {
        self.marks.push(Mark::Shape(shape.clone(), ink));
    }

    /// A square cell from its lower left corner, m, the darker the larger a share in 0 .. 1.
    pub fn cell(&mut self, low: Vec2, side: f64, share: f64) {
        self.marks.push(Mark::Cell(low, side, share));
    }

    /// A dot.
    pub fn dot(&mut self, p: Vec2, ink: Ink) {
        self.marks.push(Mark::Dot(p, ink));
    }

    /// A text whose middle is at a place, m, or near it where another text stands there.
    pub fn text(&mut self, p: Vec2, text: &str) {
        self.marks.push(Mark::Text(p, text.to_owned()));
    }

    /// A line of text below the axes.
    pub fn note(&mut self, text: &str) {
        text.clone_into(&mut self.note);
    }

    /// A name of what is drawn with an ink.
    pub fn name(&mut self, ink: Ink, name: &str) {
        self.legend.push((ink, name.to_owned()));
    }

    /// The drawing with axes and legend, so many pixels wide if that is wanted, and its size. It is one of some `columns`.
    fn drawn(&self, width: Option<f64>, columns: f64) -> (String, [f64; 2]) {
        let size = self.bounds.high - self.bounds.low;
        let longest = size.x.max(size.y);
        let scale = match width {
            // Not higher than twice the width.
            Some(width) => ((width - MARGIN - END) / size.x).min(2.0 * width / size.y),
            None => SIZE / columns / longest,
        };
        let mut plate = Plate { bounds: self.bounds, scale, body: String::new(), taken: Vec::new() };
        let is_text = |mark: &&Mark| matches!(mark, Mark::Text(..));
        for mark in self.marks.iter().filter(|mark| !is_text(mark)).chain(self.marks.iter().filter(is_text)) {
            plate.mark(mark);
        }
        plate.axes();
        let mut y = END + size.y * scale + MARGIN;
        for (ink, name) in &self.legend {
            plate.sample(*ink, name, y - 4.0);
            y += frame::LINE;
        }
        if !self.note.is_empty() {
            let _ = writeln!(plate.body, "<text x=\"8\" y=\"{:.1}\">{}</text>", y - 0.5, escape(&self.note));
            y += frame::LINE;
        }
        (plate.body, [width.unwrap_or(MARGIN + size.x * scale + END), y])
    }
}

/// A drawing at a scale, pixels per metre.
struct Plate {
    bounds: Bounds,
    scale: f64,
    body: String,
    /// Where texts stand: left, top, right, bottom, pixels.
    taken: Vec<[f64; 4]>,
}

impl Plate {
    /// Pixels of a place, m; the y axis points up.
    fn at(&self, p: Vec2) -> (f64, f64) {
        (MARGIN + (p.x - self.bounds.low.x) * self.scale, END + (self.bounds.high.y - p.y) * self.scale)
    }

    fn points(&self, points: &[Vec2]) -> String {
        let pixels = points.iter().map(|p| self.at(*p));
        pixels.map(|(x, y)| format!("{x:.1},{y:.1}")).collect::<Vec<_>>().join(" ")
    }

    fn mark(&mut self, mark: &Mark) {
        match mark {
            Mark::Line(points, ink) => {
                let points = self.points(points);
                let _ = writeln!(self.body, "<polyline points=\"{points}\" {} fill-opacity=\"0\"/>", ink.0);
            }
            Mark::Shape(Shape::Parts(parts), ink) => {
                for part in parts {
                    self.mark(&Mark::Shape(part.clone(), *ink));
                }
            }
            Mark::Shape(shape, ink) => {
                let drawn = match shape {
                    Shape::Circle { centre, radius } => {
                        let (x, y) = self.at(*centre);
                        format!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{:.1}\"", radius * self.scale)
                    }
                    Shape::Polygon(polygon) => {
                        let rings = std::iter::once(&polygon.outline).chain(&polygon.holes);
                        let path: Vec<String> =
                            rings.map(|ring| format!("M{}Z", self.points(ring))).collect();
                        format!("<path fill-rule=\"evenodd\" d=\"{}\"", path.join(" "))
                    }
                    Shape::Parts(_) => String::new(),
                };
                let opacity = if *ink == Ink::START { 0.7 } else { 1.0 };
                let _ = writeln!(self.body, "{drawn} {} fill-opacity=\"{opacity}\"/>", ink.0);
            }
            Mark::Cell(low, side, share) => {
                let ((x, y), size) = (self.at(low + Vec2::new(0.0, *side)), side * self.scale);
                let _ = writeln!(
                    self.body,
                    "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{size:.1}\" height=\"{size:.1}\" fill=\"#1d4e89\" fill-opacity=\"{:.2}\"/>",
                    0.85 * share
                );
            }
            Mark::Dot(p, ink) => {
                let (x, y) = self.at(*p);
                self.spot(x, y, *ink);
            }
            Mark::Text(p, text) => self.text(*p, text),
        }
    }

    fn spot(&mut self, x: f64, y: f64, ink: Ink) {
        let _ =
            writeln!(self.body, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4\" {} fill-opacity=\"1\"/>", ink.0);
    }

    /// A text at a place, or as near above or below it as no other text stands.
    fn text(&mut self, p: Vec2, text: &str) {
        let (x, y) = self.at(p);
        let half = 0.5 * frame::LETTER * text.chars().count() as f64;
        let place = |row: i32| {
            let y = y + f64::from(row) * 13.0;
            [x - half, y - 6.0, x + half, y + 6.0]
        };
        let is_free = |[left, top, right, bottom]: [f64; 4]| {
            let apart = |[l, t, r, b]: &[f64; 4]| right < *l || left > *r || bottom < *t || top > *b;
            self.taken.iter().all(apart)
        };
        let rows = [0, -1, 1, -2, 2, -3, 3];
        let at = rows.into_iter().map(place).find(|at| is_free(*at)).unwrap_or(place(0));
        self.taken.push(at);
        // A white rim below the letters, drawn first: not every program knows `paint-order`.
        for rim in [" stroke=\"#ffffff\" stroke-width=\"3\"", ""] {
            write_text(&mut self.body, (x, at[3] - 2.0), &format!(" text-anchor=\"middle\"{rim}"), text);
        }
    }

    /// A line of the legend: as lines and shapes are drawn, or as dots are.
    fn sample(&mut self, ink: Ink, name: &str, y: f64) {
        if ink.0.contains("fill=\"none\"") {
            let _ = writeln!(self.body, "<path d=\"M{MARGIN:.1},{y:.1}h24\" {}/>", ink.0);
        } else {
            self.spot(MARGIN + 12.0, y, ink);
        }
        write_text(&mut self.body, (MARGIN + 32.0, y + 4.0), "", name);
    }

    /// Ticks, numbers and names at the left and lower rim.
    fn axes(&mut self) {
        let (low, high) = (self.bounds.low, self.bounds.high);
        let size = high - low;
        let (left, bottom) = self.at(low);
        let (right, top) = self.at(high);
        let mut step = round_step(size.x.max(size.y) / 8.0);
        while step * self.scale < 36.0 && step < 1e9 {
            step = round_step(step * 2.5);
        }
        let middle = " text-anchor=\"middle\" fill=\"#404040\"";
        let _ = writeln!(
            self.body,
            "<path d=\"M{left:.1},{top:.1}V{bottom:.1}H{right:.1}\" fill=\"none\" stroke=\"#808080\"/>"
        );
        write_text(&mut self.body, (0.5 * (left + right), bottom + 29.0), middle, "x (m)");
        let turned = format!("translate(10 {:.1}) rotate(-90)", 0.5 * (top + bottom));
        let _ = writeln!(self.body, "<text transform=\"{turned}\"{middle}>y (m)</text>");
        let ticks = |from: f64, to: f64| {
            ((from / step).ceil() as i64..=(to / step).floor() as i64).map(|k| k as f64 * step)
        };
        let label = |v: f64| plain((v * 1e6).round() / 1e6);
        for x in ticks(low.x, high.x) {
            let (at, _) = self.at(Vec2::new(x, low.y));
            let _ = write!(self.body, "<path d=\"M{at:.1},{bottom:.1}v4\" stroke=\"#808080\"/>");
            write_text(&mut self.body, (at, bottom + 15.0), middle, &label(x));
        }
        for y in ticks(low.y, high.y) {
            let (_, at) = self.at(Vec2::new(low.x, y));
            let _ = write!(self.body, "<path d=\"M{left:.1},{at:.1}h-4\" stroke=\"#808080\"/>");
            let end = " text-anchor=\"end\" fill=\"#404040\"";
            write_text(&mut self.body, (left - 6.0, at + 4.0), end, &label(y));
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
        let text = picture::Picture::plan("a & b", drawing).svg(picture::Paper::default());
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
        assert!(text.contains(">x (m)</text>") && text.contains(">10</text>"), "{text}");
    }
}
