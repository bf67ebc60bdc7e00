//! The frame of a figure as SVG: two axes with round ticks and units, lines, bands, intervals and levels. Lines differ in
//! brightness and dashes, so that a figure survives print in grey and colour blindness. Colours are those of paper; a page
//! gives the same classes the colours of its theme.

use super::scale::Scale;
use crate::report::escape::escape;
use crate::report::number::plain;
use std::fmt::Write as _;

/// Size of a frame from left to right unless the paper says another, pixels.
pub(super) const WIDTH: f64 = 608.0;
/// Size of the area between the axes, pixels.
const AREA: (f64, f64) = (520.0, 300.0);
/// Least width of that area.
const LEAST: f64 = 80.0;
/// Room at the left, above, at the right and below, pixels.
const ROOM: [f64; 4] = [64.0, 30.0, 24.0, 46.0];
/// Width of a letter and height of a line of text, pixels.
pub(super) const LETTER: f64 = 6.2;
pub(super) const LINE: f64 = 16.0;
/// Most letters of a name.
const LETTERS: usize = 48;
/// Colours of lines, with their widths and dashes, in order.
const LINES: [(&str, &str); 6] = [
    ("#c2410c", "stroke-width=\"2\""),
    ("#1d4e89", "stroke-width=\"2\" stroke-dasharray=\"7 3\""),
    ("#5b8c5a", "stroke-width=\"2\" stroke-dasharray=\"2 3\""),
    ("#000000", "stroke-width=\"1.5\""),
    ("#8a8a8a", "stroke-width=\"1.5\" stroke-dasharray=\"10 4 2 4\""),
    ("#b39ddb", "stroke-width=\"2\" stroke-dasharray=\"4 2\""),
];

/// What is drawn in a frame; the last number of each is that of its style.
#[derive(Clone, Debug)]
enum Mark {
    Line(Vec<(f64, f64)>, usize),
    Band(Vec<(f64, f64)>, usize),
    Upright(f64, [f64; 3], usize),
    Lying(usize, [f64; 3], usize),
    Cloud(Vec<(f64, f64)>, usize),
    Dot(f64, f64, usize),
    Level(f64, String),
}

/// A frame with what is drawn in it.
#[derive(Clone, Debug)]
pub struct Frame {
    x: Scale,
    y: Scale,
    rows: Vec<String>,
    height: f64,
    marks: Vec<Mark>,
    legend: Vec<(String, usize)>,
    axes: [String; 2],
}

impl Frame {
    /// An empty frame; axes are named with their units.
    pub fn new(axes: [&str; 2], x: Scale, y: Scale) -> Self {
        Self {
            x,
            y,
            rows: Vec::new(),
            height: AREA.1,
            marks: Vec::new(),
            legend: Vec::new(),
            axes: axes.map(str::to_owned),
        }
    }

    /// A frame with a row for each name, from above.
    pub fn rows(axis: &str, x: Scale, names: &[String]) -> Self {
        let rows: Vec<String> = names.iter().map(|name| shortened(name)).collect();
        let height = 1.5 * LINE * names.len() as f64;
        Self { rows, height, ..Self::new([axis, ""], x, Scale::places(names.len())) }
    }

    /// Half as high.
    pub fn low(mut self) -> Self {
        self.height = 0.5 * AREA.1;
        self
    }

    /// A name of what has style number `k`, for the legend.
    pub fn name(&mut self, name: &str, k: usize) {
        self.legend.push((shortened(name), k));
    }

    /// A line in style number `k`.
    pub fn line(&mut self, points: impl IntoIterator<Item = (f64, f64)>, k: usize) {
        self.marks.push(Mark::Line(points.into_iter().collect(), k));
    }

    /// The area between two lines over the same places.
    pub fn band(&mut self, points: &[(f64, f64, f64)], k: usize) {
        let above = points.iter().map(|(x, _, high)| (*x, *high));
        let below = points.iter().rev().map(|(x, low, _)| (*x, *low));
        self.marks.push(Mark::Band(above.chain(below).collect(), k));
    }

    /// An interval that stands at a place, with its estimate.
    pub fn upright(&mut self, x: f64, interval: [f64; 3], k: usize) {
        self.marks.push(Mark::Upright(x, interval, k));
    }

    /// An interval in row number `row`, with its estimate.
    pub fn lying(&mut self, row: usize, interval: [f64; 3], k: usize) {
        self.marks.push(Mark::Lying(row, interval, k));
    }

    /// Pale dots, of which those at one place look like one.
    pub fn cloud(&mut self, points: impl IntoIterator<Item = (f64, f64)>, k: usize) {
        self.marks.push(Mark::Cloud(points.into_iter().collect(), k));
    }

    /// A dot at a place.
    pub fn mark(&mut self, x: f64, y: f64, k: usize) {
        self.marks.push(Mark::Dot(x, y, k));
    }

    /// A thin dashed line at a height, with its name.
    pub fn level(&mut self, y: f64, name: &str) {
        self.marks.push(Mark::Level(y, shortened(name)));
    }

    /// Frame, marks, ticks, names and legend in so many pixels from left to right, and how high it is.
    pub(super) fn drawn(&self, width: f64) -> (String, f64) {
        let letters = self.rows.iter().map(|name| name.chars().count()).max();
        let left = letters.map_or(ROOM[0], |letters| (20.0 + LETTER * letters as f64).max(ROOM[0]));
        let wide = (width - left - ROOM[2]).max(LEAST);
        let part = if self.rows.is_empty() { (wide / AREA.0).clamp(0.6, 1.0) } else { 1.0 };
        Layout { frame: self, left, width: wide, height: part * self.height, body: String::new() }.finish()
    }

    /// Whether a style has dots.
    fn has_dots(&self, k: usize) -> bool {
        self.marks.iter().any(|mark| {
            matches!(mark, Mark::Upright(_, _, of) | Mark::Lying(_, _, of) | Mark::Dot(_, _, of)
                | Mark::Cloud(_, of) if *of == k)
        })
    }
}

/// A frame of a size, pixels, and what is drawn of it.
struct Layout<'f> {
    frame: &'f Frame,
    left: f64,
    width: f64,
    height: f64,
    body: String,
}

impl Layout<'_> {
    fn at(&self, x: f64, y: f64) -> (f64, f64) {
        let (x, y) = (self.frame.x.share(x), self.frame.y.share(y));
        (self.left + self.width * x, ROOM[1] + self.height * (1.0 - y))
    }

    fn points(&self, points: &[(f64, f64)]) -> String {
        let known = points.iter().filter(|(x, y)| !x.is_nan() && !y.is_nan());
        let pixels = known.map(|(x, y)| self.at(*x, *y)).map(|(x, y)| format!("{x:.1},{y:.1}"));
        pixels.collect::<Vec<_>>().join(" ")
    }

    fn mark(&mut self, mark: &Mark) {
        match mark {
            Mark::Line(points, k) => {
                let points = self.points(points);
                let _ = writeln!(self.body, "<polyline points=\"{points}\" fill=\"none\" {}/>", style(*k));
            }
            Mark::Band(points, k) => {
                let points = self.points(points);
                let _ = writeln!(
                    self.body,
                    "<polygon points=\"{points}\" {} fill-opacity=\"0.18\" stroke=\"none\"/>",
                    filled(*k)
                );
            }
            Mark::Upright(x, [low, middle, high], k) => {
                let ((at, from), (_, to)) = (self.at(*x, *low), self.at(*x, *high));
                let path = format!("M{at:.1},{from:.1}V{to:.1}m-3,0h6M{:.1},{from:.1}h6", at - 3.0);
                self.interval(&path, self.at(*x, *middle), *k);
            }
            Mark::Lying(row, [low, middle, high], k) => {
                let y = height_of_row(*row);
                let ((from, _), (to, _)) = (self.at(*low, 0.0), self.at(*high, 0.0));
                let path = format!("M{from:.1},{y:.1}H{to:.1}m0,-3v6M{from:.1},{:.1}v6", y - 3.0);
                self.interval(&path, (self.at(*middle, 0.0).0, y), *k);
            }
            Mark::Cloud(points, k) => {
                let pixels = points.iter().map(|(x, y)| self.at(*x, *y));
                let mut places: Vec<String> = pixels.map(|(x, y)| format!("M{x:.1},{y:.1}h0")).collect();
                places.sort_unstable();
                places.dedup();
                let shape = "stroke-width=\"5\" stroke-linecap=\"round\" stroke-opacity=\"0.5\"";
                self.path(&places.concat(), *k, shape);
            }
            Mark::Dot(x, y, k) => self.dot(self.at(*x, *y), *k),
            Mark::Level(y, name) => {
                let (left, right) = (self.left, self.left + self.width);
                let (_, at) = self.at(0.0, *y);
                let _ = writeln!(
                    self.body,
                    "<path class=\"rim\" d=\"M{left:.1},{at:.1}H{right:.1}\" stroke=\"#606060\" stroke-dasharray=\"3 3\"/>"
                );
                text(&mut self.body, (right - 4.0, at - 4.0), "end", name);
            }
        }
    }

    /// A path in the colour of a style.
    fn path(&mut self, path: &str, k: usize, shape: &str) {
        let _ = writeln!(self.body, "<path d=\"{path}\" fill=\"none\" {} {shape}/>", stroke(k));
    }

    /// The ends of an interval, and its estimate if there is one.
    fn interval(&mut self, ends: &str, estimate: (f64, f64), k: usize) {
        self.path(ends, k, "stroke-width=\"1.2\"");
        if !estimate.0.is_nan() && !estimate.1.is_nan() {
            self.dot(estimate, k);
        }
    }

    /// Circle, square, triangle or diamond.
    fn dot(&mut self, (x, y): (f64, f64), k: usize) {
        let shape = [
            "m-3.5,0a3.5,3.5 0 1 0 7,0a3.5,3.5 0 1 0 -7,0z",
            "m-3,-3h6v6h-6z",
            "m0,-4l4,7h-8z",
            "m0,-4l4,4l-4,4l-4,-4z",
        ][k % 4];
        let _ = writeln!(self.body, "<path d=\"M{x:.1},{y:.1}{shape}\" {} stroke=\"none\"/>", filled(k));
    }

    fn finish(mut self) -> (String, f64) {
        let frame = self.frame;
        for (k, name) in frame.rows.iter().enumerate() {
            text(&mut self.body, (self.left - 10.0, height_of_row(k) + 4.0), "end", name);
        }
        frame.marks.iter().for_each(|mark| self.mark(mark));
        let (left, top, right, bottom) = (self.left, ROOM[1], self.left + self.width, ROOM[1] + self.height);
        let mut lines = String::new();
        let mut grid = |path: String| {
            let _ = writeln!(lines, "<path class=\"grid\" d=\"{path}\" stroke=\"#d8d8d8\"/>");
        };
        // Numbers that would touch each other are left out.
        let mut free = f64::NEG_INFINITY;
        for &tick in frame.x.ticks() {
            let (x, number) = (left + self.width * frame.x.share(tick), plain(tick));
            let half = 0.5 * LETTER * number.chars().count() as f64;
            grid(format!("M{x:.1},{top:.1}V{:.1}", bottom + 4.0));
            if x - half > free {
                text(&mut self.body, (x, bottom + 17.0), "middle", &number);
                free = x + half + LETTER;
            }
        }
        for &tick in frame.y.ticks() {
            let y = bottom - self.height * frame.y.share(tick);
            grid(format!("M{:.1},{y:.1}H{right:.1}", left - 4.0));
            text(&mut self.body, (left - 7.0, y + 4.0), "end", &plain(tick));
        }
        let _ = writeln!(
            self.body,
            "<rect class=\"rim\" x=\"{left:.1}\" y=\"{top:.1}\" width=\"{:.1}\" height=\"{:.1}\" fill=\"none\" stroke=\"#606060\"/>",
            self.width, self.height
        );
        let [below, above] = &frame.axes;
        text(&mut self.body, (right, bottom + 36.0), "end", below);
        text(&mut self.body, (left, top - 10.0), "start", above);
        let mut y = bottom + ROOM[3] + 4.0;
        for (name, k) in &frame.legend {
            let _ = writeln!(self.body, "<path d=\"M{left:.1},{y:.1}h28\" fill=\"none\" {}/>", style(*k));
            if frame.has_dots(*k) {
                self.dot((left + 14.0, y), *k);
            }
            text(&mut self.body, (left + 36.0, y + 4.0), "start", name);
            y += LINE;
        }
        (lines + &self.body, y)
    }
}

/// The height of row number `k` from above, pixels.
fn height_of_row(k: usize) -> f64 {
    ROOM[1] + 1.5 * LINE * (k as f64 + 0.5)
}

fn style(k: usize) -> String {
    format!("{} {}", stroke(k), LINES[k % LINES.len()].1)
}

fn stroke(k: usize) -> String {
    let (colour, _) = LINES[k % LINES.len()];
    format!("class=\"line-{}\" stroke=\"{colour}\"", k % LINES.len())
}

fn filled(k: usize) -> String {
    let (colour, _) = LINES[k % LINES.len()];
    format!("class=\"fill-{}\" fill=\"{colour}\"", k % LINES.len())
}

fn text(body: &mut String, at: (f64, f64), anchor: &str, text: &str) {
    write_text(body, at, &format!(" text-anchor=\"{anchor}\" fill=\"#202020\""), text);
}

/// Writes a text with further attributes, which begin with a blank.
pub(super) fn write_text(body: &mut String, (x, y): (f64, f64), attributes: &str, text: &str) {
    let _ = writeln!(body, "<text x=\"{x:.1}\" y=\"{y:.1}\"{attributes}>{}</text>", escape(text));
}

fn shortened(name: &str) -> String {
    cut(name, LETTERS)
}

pub(super) fn cut(name: &str, letters: usize) -> String {
    match name.char_indices().nth(letters) {
        Some((end, _)) => format!("{}…", &name[..end]),
        None => name.to_owned(),
    }
}
