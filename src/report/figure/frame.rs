//! The frame of a figure as SVG: two axes with round ticks and units, lines, bands, intervals and levels. Lines differ in
//! brightness and dashes, so that a figure survives print in grey and colour blindness.

use crate::base::math;
use crate::report::escape::escape;
use crate::report::number::plain;
use crate::report::svg::chart::LINES;
use std::fmt::Write as _;

/// The name of the language, which a picture alone needs.
pub(super) const LANGUAGE: &str = " xmlns=\"http://www.w3.org/2000/svg\"";
/// Size of the area between the axes, pixels.
const AREA: (f64, f64) = (520.0, 300.0);
/// Room at the left, above, at the right and below, pixels.
const ROOM: [f64; 4] = [64.0, 30.0, 24.0, 46.0];
/// Width of a letter and height of a line of text, pixels.
const LETTER: f64 = 6.2;
const LINE: f64 = 16.0;
/// Most letters of a name.
const LETTERS: usize = 48;
/// Decades over which an axis has ticks at powers of ten alone.
const DECADES: i32 = 2;

/// How numbers become places on an axis.
#[derive(Clone, Debug)]
pub(super) struct Scale {
    low: f64,
    high: f64,
    ticks: Vec<f64>,
    is_log: bool,
}

impl Scale {
    /// A linear axis around numbers; infinite ones are left out.
    pub(super) fn linear(numbers: impl IntoIterator<Item = f64>) -> Self {
        let (low, high) = ends(numbers);
        let pad = if low < high { 0.0 } else { 0.5 * low.abs().max(1.0) };
        let (low, high) = (low - pad, high + pad);
        let step = round_step((high - low) / 6.0);
        let (first, last) = ((low / step).floor(), (high / step).ceil());
        let ticks = (0..=((last - first) as usize).min(20)).map(|k| (first + k as f64) * step);
        Self { low: first * step, high: last * step, ticks: ticks.collect(), is_log: false }
    }

    /// An axis on which equal factors are equally long, around positive numbers.
    pub(super) fn log(numbers: impl IntoIterator<Item = f64>) -> Self {
        let (low, high) = ends(numbers.into_iter().filter(|x| *x > 0.0));
        let (low, high) = if low < high { (low, high) } else { (0.5 * high.max(2.0), 2.0 * high.max(2.0)) };
        let factors: &[f64] = if high / low > power(DECADES) { &[1.0] } else { &[1.0, 2.0, 5.0] };
        let tick = |k: i32| factors.iter().map(move |factor| factor * power(k));
        let ticks = (exponent(low)..=exponent(high))
            .flat_map(tick)
            .filter(|tick| (low..=high * 1.000_001).contains(tick));
        Self { low, high, ticks: ticks.collect(), is_log: true }
    }

    /// From 0 to 1.
    pub(super) fn shares() -> Self {
        Self::linear([0.0, 1.0])
    }

    /// Places `0 .. n` without ticks.
    pub(super) fn places(n: usize) -> Self {
        Self { low: -0.5, high: n as f64 - 0.5, ticks: Vec::new(), is_log: false }
    }

    fn share(&self, x: f64) -> f64 {
        let of = |x: f64| if self.is_log { math::ln(x.max(f64::MIN_POSITIVE)) } else { x };
        ((of(x) - of(self.low)) / (of(self.high) - of(self.low))).clamp(0.0, 1.0)
    }
}

/// The least and the largest of the finite numbers.
fn ends(numbers: impl IntoIterator<Item = f64>) -> (f64, f64) {
    let finite = numbers.into_iter().filter(|x| x.is_finite());
    let (low, high) =
        finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
    if low <= high { (low, high) } else { (0.0, 1.0) }
}

/// The exponent of a positive number in decimal digits.
fn exponent(x: f64) -> i32 {
    format!("{x:e}").split_once('e').and_then(|(_, digits)| digits.parse().ok()).unwrap_or(0)
}

/// A power of ten.
fn power(exponent: i32) -> f64 {
    format!("1e{exponent}").parse().unwrap_or(1.0)
}

/// The smallest of 1, 2, 5, 10 times a power of ten that is not below a length.
fn round_step(length: f64) -> f64 {
    let power = power(exponent(length));
    [1.0, 2.0, 5.0]
        .map(|factor| factor * power)
        .into_iter()
        .find(|step| *step >= length)
        .unwrap_or(10.0 * power)
}

/// A frame with what is drawn in it.
#[derive(Clone, Debug)]
pub(super) struct Frame {
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
    pub(super) fn new(axes: [&str; 2], x: Scale, y: Scale) -> Self {
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
    pub(super) fn rows(axis: &str, x: Scale, names: &[String]) -> Self {
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
    pub(super) fn low(mut self) -> Self {
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
    pub(super) fn name(&mut self, name: &str, k: usize) {
        self.legend.push((shortened(name), k));
    }

    /// A line in style number `k`.
    pub(super) fn line(&mut self, points: impl IntoIterator<Item = (f64, f64)>, k: usize) {
        let points = self.points(points);
        let _ = writeln!(self.body, "<polyline points=\"{points}\" fill=\"none\" {}/>", style(k));
    }

    /// The area between two lines over the same places.
    pub(super) fn band(&mut self, points: &[(f64, f64, f64)], k: usize) {
        let above = points.iter().map(|(x, _, high)| (*x, *high));
        let below = points.iter().rev().map(|(x, low, _)| (*x, *low));
        let points = self.points(above.chain(below));
        let (colour, _) = LINES[k % LINES.len()];
        let _ = writeln!(
            self.body,
            "<polygon points=\"{points}\" fill=\"{colour}\" fill-opacity=\"0.18\" stroke=\"none\"/>"
        );
    }

    /// An interval that stands at a place, with its estimate.
    pub(super) fn upright(&mut self, x: f64, [low, middle, high]: [f64; 3], k: usize) {
        let ((at, from), (_, to)) = (self.at(x, low), self.at(x, high));
        self.whisker(&format!("M{at:.1},{from:.1}V{to:.1}m-3,0h6M{:.1},{from:.1}h6", at - 3.0), k);
        if !middle.is_nan() {
            let place = self.at(x, middle);
            self.dot(place, k);
        }
    }

    /// An interval in row number `row`, with its estimate.
    pub(super) fn lying(&mut self, row: usize, [low, middle, high]: [f64; 3], k: usize) {
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
            "<path d=\"{path}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.2\"/>"
        );
    }

    /// Circle, square, triangle or diamond.
    fn dot(&mut self, (x, y): (f64, f64), k: usize) {
        let (colour, _) = LINES[k % LINES.len()];
        let shape = [
            "m-3.5,0a3.5,3.5 0 1 0 7,0a3.5,3.5 0 1 0 -7,0z",
            "m-3,-3h6v6h-6z",
            "m0,-4l4,7h-8z",
            "m0,-4l4,4l-4,4l-4,-4z",
        ][k % 4];
        let _ = writeln!(self.body, "<path d=\"M{x:.1},{y:.1}{shape}\" fill=\"{colour}\" stroke=\"none\"/>");
    }

    /// A dot at a place.
    pub(super) fn mark(&mut self, x: f64, y: f64, k: usize) {
        let place = self.at(x, y);
        self.dot(place, k);
    }

    /// A thin dashed line at a height, with its name.
    pub(super) fn level(&mut self, y: f64, name: &str) {
        let ((left, at), (right, _)) = (self.at(self.x.low, y), self.at(self.x.high, y));
        let _ = writeln!(
            self.body,
            "<path d=\"M{left:.1},{at:.1}H{right:.1}\" stroke=\"#606060\" stroke-dasharray=\"3 3\"/>"
        );
        text(&mut self.body, (right - 4.0, at - 4.0), "end", &shortened(name));
    }

    /// Frame, ticks, names and legend.
    fn finish(mut self) -> (String, [f64; 2]) {
        let (left, top, right, bottom) = (self.left, ROOM[1], self.left + AREA.0, ROOM[1] + self.height);
        let mut grid = String::new();
        for tick in self.x.ticks.clone() {
            let (x, _) = self.at(tick, self.y.low);
            let _ = writeln!(grid, "<path d=\"M{x:.1},{top:.1}V{:.1}\" stroke=\"#d8d8d8\"/>", bottom + 4.0);
            text(&mut self.body, (x, bottom + 17.0), "middle", &rounded(tick));
        }
        for tick in self.y.ticks.clone() {
            let (_, y) = self.at(self.x.low, tick);
            let _ = writeln!(grid, "<path d=\"M{:.1},{y:.1}H{right:.1}\" stroke=\"#d8d8d8\"/>", left - 4.0);
            text(&mut self.body, (left - 7.0, y + 4.0), "end", &rounded(tick));
        }
        let _ = writeln!(
            self.body,
            "<rect x=\"{left:.1}\" y=\"{top:.1}\" width=\"{:.1}\" height=\"{:.1}\" fill=\"none\" stroke=\"#606060\"/>",
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
        (grid + &self.body, [right + ROOM[2], y])
    }
}

/// The height of row number `k` from above, pixels.
fn height_of_row(k: usize) -> f64 {
    ROOM[1] + 1.5 * LINE * (k as f64 + 0.5)
}

/// Frames below each other as one picture.
pub(super) fn picture(title: &str, frames: Vec<Frame>) -> String {
    let (mut body, mut width, mut y) = (String::new(), 0.0_f64, 2.0 * LINE);
    for frame in frames {
        let (drawn, [wide, high]) = frame.finish();
        let _ = writeln!(body, "<g transform=\"translate(0 {y:.1})\">\n{drawn}</g>");
        (width, y) = (width.max(wide), y + high + 8.0);
    }
    let letters = (width / LETTER) as usize - 4;
    format!(
        "<svg{LANGUAGE} viewBox=\"0 0 {width:.0} {y:.0}\" width=\"{width:.0}\" role=\"img\" font-family=\"sans-serif\" font-size=\"11\">\n<title>{}</title>\n<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n<text x=\"12\" y=\"20\" font-size=\"12\">{}</text>\n{body}</svg>\n",
        escape(title),
        escape(&cut(title, letters))
    )
}

fn style(k: usize) -> String {
    let (colour, shape) = LINES[k % LINES.len()];
    format!("stroke=\"{colour}\" {shape}")
}

fn text(body: &mut String, (x, y): (f64, f64), anchor: &str, text: &str) {
    let _ = writeln!(
        body,
        "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\" fill=\"#202020\">{}</text>",
        escape(text)
    );
}

/// A tick without the rounding of its product.
fn rounded(tick: f64) -> String {
    format!("{tick:.9e}").parse().map_or_else(|_| plain(tick), plain)
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_contain_the_numbers() {
        let scale = Scale::linear([0.13, 0.97]);
        assert_eq!((scale.low, scale.high), (0.0, 1.0));
        assert_eq!(
            scale.ticks.iter().map(|tick| rounded(*tick)).collect::<Vec<_>>(),
            ["0", "0.2", "0.4", "0.6", "0.8", "1"]
        );
        let lone = Scale::linear([7.0]);
        assert!(lone.low < 7.0 && lone.high > 7.0);
        let log = Scale::log([1.0, 1000.0]);
        assert_eq!(
            log.ticks.iter().map(|tick| rounded(*tick)).collect::<Vec<_>>(),
            ["1", "10", "100", "1000"]
        );
        assert!((log.share(10.0) - 1.0 / 3.0).abs() < 1e-12);
        assert_eq!([0.9, 1.0, 4.9, 5.0, 19.0].map(round_step), [1.0, 1.0, 5.0, 5.0, 20.0]);
    }
}
