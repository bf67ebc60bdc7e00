//! The frame of a figure as SVG: two axes with round ticks and units, lines, bands, intervals and levels. Lines differ in
//! brightness and dashes, so that a figure survives print in grey and colour blindness. Colours are those of paper; a page
//! gives the same classes the colours of its theme.

use super::scale::Scale;
use crate::report::escape::escape;
use crate::report::number::plain;
use std::fmt::Write as _;

/// The name of the language, which a picture alone needs.
const LANGUAGE: &str = " xmlns=\"http://www.w3.org/2000/svg\"";
/// Size of the area between the axes, pixels.
const AREA: (f64, f64) = (520.0, 300.0);
/// Room at the left, above, at the right and below, pixels.
const ROOM: [f64; 4] = [64.0, 30.0, 24.0, 46.0];
/// Width of a letter and height of a line of text, pixels.
const LETTER: f64 = 6.2;
const LINE: f64 = 16.0;
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

/// A frame with what is drawn in it.
#[derive(Clone, Debug)]
pub struct Frame {
    x: Scale,
    y: Scale,
    left: f64,
    height: f64,
    body: String,
    legend: Vec<(String, usize)>,
    axes: [String; 2],
}

impl Frame {
    /// An empty frame; axes are named with their units.
    pub fn new(axes: [&str; 2], x: Scale, y: Scale) -> Self {
        Self {
            x,
            y,
            left: ROOM[0],
            height: AREA.1,
            body: String::new(),
            legend: Vec::new(),
            axes: axes.map(str::to_owned),
        }
    }

    /// A frame with a row for each name, from above.
    pub fn rows(axis: &str, x: Scale, names: &[String]) -> Self {
        let mut frame = Self::new([axis, ""], x, Scale::places(names.len()));
        let names: Vec<String> = names.iter().map(|name| shortened(name)).collect();
        let letters = names.iter().map(|name| name.chars().count()).max().unwrap_or(0);
        frame.left = (20.0 + LETTER * letters as f64).max(ROOM[0]);
        frame.height = 1.5 * LINE * names.len() as f64;
        for (k, name) in names.iter().enumerate() {
            let y = height_of_row(k);
            let x = frame.left - 10.0;
            text(&mut frame.body, (x, y + 4.0), "end", name);
        }
        frame
    }

    /// Half as high.
    pub fn low(mut self) -> Self {
        self.height = 0.5 * AREA.1;
        self
    }

    fn at(&self, x: f64, y: f64) -> (f64, f64) {
        (self.left + AREA.0 * self.x.share(x), ROOM[1] + self.height * (1.0 - self.y.share(y)))
    }

    fn points(&self, points: impl IntoIterator<Item = (f64, f64)>) -> String {
        let known = points.into_iter().filter(|(x, y)| !x.is_nan() && !y.is_nan());
        let pixels = known.map(|(x, y)| self.at(x, y)).map(|(x, y)| format!("{x:.1},{y:.1}"));
        pixels.collect::<Vec<_>>().join(" ")
    }

    /// A name of what has style number `k`, for the legend.
    pub fn name(&mut self, name: &str, k: usize) {
        self.legend.push((shortened(name), k));
    }

    /// A line in style number `k`.
    pub fn line(&mut self, points: impl IntoIterator<Item = (f64, f64)>, k: usize) {
        let points = self.points(points);
        let _ = writeln!(self.body, "<polyline points=\"{points}\" fill=\"none\" {}/>", style(k));
    }

    /// The area between two lines over the same places.
    pub fn band(&mut self, points: &[(f64, f64, f64)], k: usize) {
        let above = points.iter().map(|(x, _, high)| (*x, *high));
        let below = points.iter().rev().map(|(x, low, _)| (*x, *low));
        let points = self.points(above.chain(below));
        let _ = writeln!(
            self.body,
            "<polygon points=\"{points}\" {} fill-opacity=\"0.18\" stroke=\"none\"/>",
            filled(k)
        );
    }

    /// An interval that stands at a place, with its estimate.
    pub fn upright(&mut self, x: f64, [low, middle, high]: [f64; 3], k: usize) {
        let ((at, from), (_, to)) = (self.at(x, low), self.at(x, high));
        self.whisker(&format!("M{at:.1},{from:.1}V{to:.1}m-3,0h6M{:.1},{from:.1}h6", at - 3.0), k);
        if !middle.is_nan() {
            let place = self.at(x, middle);
            self.dot(place, k);
        }
    }

    /// An interval in row number `row`, with its estimate.
    pub fn lying(&mut self, row: usize, [low, middle, high]: [f64; 3], k: usize) {
        let y = height_of_row(row);
        let ((from, _), (to, _)) = (self.at(low, 0.0), self.at(high, 0.0));
        self.whisker(&format!("M{from:.1},{y:.1}H{to:.1}m0,-3v6M{from:.1},{:.1}v6", y - 3.0), k);
        if !middle.is_nan() {
            let (x, _) = self.at(middle, 0.0);
            self.dot((x, y), k);
        }
    }

    fn whisker(&mut self, path: &str, k: usize) {
        let (colour, _) = LINES[k % LINES.len()];
        let _ = writeln!(
            self.body,
            "<path d=\"{path}\" fill=\"none\" class=\"line-{}\" stroke=\"{colour}\" stroke-width=\"1.2\"/>",
            k % LINES.len()
        );
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

    /// Pale dots, of which those at one place look like one.
    pub fn cloud(&mut self, points: impl IntoIterator<Item = (f64, f64)>, k: usize) {
        let mut places: Vec<String> = points
            .into_iter()
            .map(|(x, y)| self.at(x, y))
            .map(|(x, y)| format!("M{x:.1},{y:.1}h0"))
            .collect();
        places.sort_unstable();
        places.dedup();
        let (colour, _) = LINES[k % LINES.len()];
        let _ = writeln!(
            self.body,
            "<path d=\"{}\" fill=\"none\" class=\"line-{}\" stroke=\"{colour}\" stroke-width=\"5\" stroke-linecap=\"round\" stroke-opacity=\"0.5\"/>",
            places.concat(),
            k % LINES.len()
        );
    }

    /// A dot at a place.
    pub fn mark(&mut self, x: f64, y: f64, k: usize) {
        let place = self.at(x, y);
        self.dot(place, k);
    }

    /// A thin dashed line at a height, with its name.
    pub fn level(&mut self, y: f64, name: &str) {
        let (left, right) = (self.left, self.left + AREA.0);
        let (_, at) = self.at(0.0, y);
        let _ = writeln!(
            self.body,
            "<path class=\"rim\" d=\"M{left:.1},{at:.1}H{right:.1}\" stroke=\"#606060\" stroke-dasharray=\"3 3\"/>"
        );
        text(&mut self.body, (right - 4.0, at - 4.0), "end", &shortened(name));
    }

    /// Frame, ticks, names and legend.
    fn finish(mut self) -> (String, [f64; 2]) {
        let (left, top, right, bottom) = (self.left, ROOM[1], self.left + AREA.0, ROOM[1] + self.height);
        let mut lines = String::new();
        let mut grid = |path: String| {
            let _ = writeln!(lines, "<path class=\"grid\" d=\"{path}\" stroke=\"#d8d8d8\"/>");
        };
        for &tick in self.x.ticks() {
            let x = left + AREA.0 * self.x.share(tick);
            grid(format!("M{x:.1},{top:.1}V{:.1}", bottom + 4.0));
            text(&mut self.body, (x, bottom + 17.0), "middle", &plain(tick));
        }
        for &tick in self.y.ticks() {
            let y = bottom - self.height * self.y.share(tick);
            grid(format!("M{:.1},{y:.1}H{right:.1}", left - 4.0));
            text(&mut self.body, (left - 7.0, y + 4.0), "end", &plain(tick));
        }
        let _ = writeln!(
            self.body,
            "<rect class=\"rim\" x=\"{left:.1}\" y=\"{top:.1}\" width=\"{:.1}\" height=\"{:.1}\" fill=\"none\" stroke=\"#606060\"/>",
            AREA.0, self.height
        );
        let [below, above] = self.axes.clone();
        text(&mut self.body, (right, bottom + 36.0), "end", &below);
        text(&mut self.body, (left, top - 10.0), "start", &above);
        let mut y = bottom + ROOM[3] + 4.0;
        for (name, k) in std::mem::take(&mut self.legend) {
            let _ = writeln!(self.body, "<path d=\"M{left:.1},{y:.1}h28\" fill=\"none\" {}/>", style(k));
            self.dot((left + 14.0, y), k);
            text(&mut self.body, (left + 36.0, y + 4.0), "start", &name);
            y += LINE;
        }
        (lines + &self.body, [right + ROOM[2], y])
    }
}

/// The height of row number `k` from above, pixels.
fn height_of_row(k: usize) -> f64 {
    ROOM[1] + 1.5 * LINE * (k as f64 + 0.5)
}

/// Frames below each other as one picture, for a file of its own.
pub fn picture(title: &str, frames: Vec<Frame>) -> String {
    drawn(title, frames, LANGUAGE)
}

/// The same for a place within a page.
pub fn part_of_page(title: &str, frames: Vec<Frame>) -> String {
    drawn(title, frames, "")
}

fn drawn(title: &str, frames: Vec<Frame>, language: &str) -> String {
    let (mut body, mut width, mut y) = (String::new(), 0.0_f64, 2.0 * LINE);
    for frame in frames {
        let (drawn, [wide, high]) = frame.finish();
        let _ = writeln!(body, "<g transform=\"translate(0 {y:.1})\">\n{drawn}</g>");
        (width, y) = (width.max(wide), y + high + 8.0);
    }
    let letters = (width / LETTER) as usize - 4;
    format!(
        "<svg{language} viewBox=\"0 0 {width:.0} {y:.0}\" width=\"{width:.0}\" role=\"img\" font-family=\"sans-serif\" font-size=\"11\">\n<title>{}</title>\n<rect class=\"paper\" width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n<text x=\"12\" y=\"20\" font-size=\"12\">{}</text>\n{body}</svg>\n",
        escape(title),
        escape(&cut(title, letters))
    )
}

fn style(k: usize) -> String {
    let (colour, shape) = LINES[k % LINES.len()];
    format!("class=\"line-{}\" stroke=\"{colour}\" {shape}", k % LINES.len())
}

fn filled(k: usize) -> String {
    let (colour, _) = LINES[k % LINES.len()];
    format!("class=\"fill-{}\" fill=\"{colour}\"", k % LINES.len())
}

fn text(body: &mut String, (x, y): (f64, f64), anchor: &str, text: &str) {
    let _ = writeln!(
        body,
        "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\" fill=\"#202020\">{}</text>",
        escape(text)
    );
}

fn shortened(name: &str) -> String {
    cut(name, LETTERS)
}

fn cut(name: &str, letters: usize) -> String {
    match name.char_indices().nth(letters) {
        Some((end, _)) => format!("{}…", &name[..end]),
        None => name.to_owned(),
    }
}
