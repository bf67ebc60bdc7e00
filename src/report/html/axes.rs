//! Two axes with units as SVG in the style of a page, and what is drawn between them: lines, a band, dots.

use super::chart::Axis;
use crate::base::geometry::Vec2;
use crate::report::escape::escape;
use crate::report::number::plain;
use std::fmt::Write as _;

/// Size between the axes, and room around it for their numbers and names, user units.
const SIZE: (f64, f64) = (560.0, 240.0);
const LEFT: f64 = 58.0;
const TOP: f64 = 24.0;
const BELOW: f64 = 40.0;

/// A drawing between two axes.
#[derive(Clone, Debug)]
pub(super) struct Axes {
    x: Axis,
    y: Axis,
    body: String,
}

impl Axes {
    /// Empty axes with their names and units.
    pub(super) fn new((x, x_name): (Axis, &str), (y, y_name): (Axis, &str)) -> Self {
        let mut axes = Self { x, y, body: String::new() };
        let (right, bottom) = (LEFT + SIZE.0, TOP + SIZE.1);
        for &tick in axes.x.ticks() {
            let at = LEFT + SIZE.0 * axes.x.share(tick);
            let _ = writeln!(
                axes.body,
                "<line class=\"grid\" x1=\"{at:.1}\" x2=\"{at:.1}\" y1=\"{TOP}\" y2=\"{bottom}\"/>\
                 <text class=\"tick\" x=\"{at:.1}\" y=\"{:.1}\">{}</text>",
                bottom + 15.0,
                plain(tick)
            );
        }
        for &tick in axes.y.ticks() {
            let at = bottom - SIZE.1 * axes.y.share(tick);
            let _ = writeln!(
                axes.body,
                "<line class=\"grid\" x1=\"{LEFT}\" x2=\"{right}\" y1=\"{at:.1}\" y2=\"{at:.1}\"/>\
                 <text class=\"tick last\" x=\"{:.1}\" y=\"{:.1}\">{}</text>",
                LEFT - 6.0,
                at + 4.0,
                plain(tick)
            );
        }
        let _ = writeln!(
            axes.body,
            "<text class=\"tick last\" x=\"{right}\" y=\"{:.1}\">{}</text>\
             <text class=\"tick first\" x=\"4\" y=\"12\">{}</text>",
            bottom + 33.0,
            escape(x_name),
            escape(y_name)
        );
        axes
    }

    fn at(&self, p: Vec2) -> String {
        let y = TOP + SIZE.1 * (1.0 - self.y.share(p.y));
        format!("{:.1},{y:.1}", LEFT + SIZE.0 * self.x.share(p.x))
    }

    fn points(&self, points: impl Iterator<Item = Vec2>) -> String {
        points.map(|p| self.at(p)).collect::<Vec<_>>().join(" ")
    }

    /// A line through points.
    pub(super) fn line(&mut self, points: impl Iterator<Item = Vec2>) {
        let points = self.points(points);
        let _ = writeln!(self.body, "<polyline class=\"curve\" points=\"{points}\"/>");
    }

    /// The area between two lines, given by the ends of their points.
    pub(super) fn band(&mut self, ends: &[(f64, [f64; 2])]) {
        let low = ends.iter().map(|(x, [low, _])| Vec2::new(*x, *low));
        let high = ends.iter().rev().map(|(x, [_, high])| Vec2::new(*x, *high));
        let points = self.points(low.chain(high));
        let _ = writeln!(self.body, "<polygon class=\"band\" points=\"{points}\"/>");
    }

    /// Dots, of which those at one place look like one.
    pub(super) fn dots(&mut self, points: impl Iterator<Item = Vec2>) {
        let mut places: Vec<String> = points.map(|p| self.at(p)).collect();
        places.sort_unstable();
        places.dedup();
        let dots: String = places.iter().map(|place| format!("M{place}h0")).collect();
        let _ = writeln!(self.body, "<path class=\"dots\" d=\"{dots}\"/>");
    }

    /// The drawing; `label` is what it shows, for those who do not see it.
    pub(super) fn finish(self, label: &str) -> String {
        let (width, height) = (LEFT + SIZE.0 + 14.0, TOP + SIZE.1 + BELOW);
        format!(
            "<svg viewBox=\"0 0 {width} {height}\" width=\"{width}\" role=\"img\" aria-label=\"{}\">\n{}</svg>\n",
            escape(label),
            self.body
        )
    }
}
