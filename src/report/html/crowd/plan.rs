//! The plan below and above a heat map, in the style of a page: walls, obstacles, lines, and a bar as long as some metres.

use crate::base::geometry::{Bounds, Segment, Shape, Vec2};
use crate::engine::traces::Trace;
use crate::model::{Scene, storeys::APART};
use crate::report::number::plain;
use std::fmt::Write as _;

/// Width of a drawing: three beside each other, or one alone; its greatest height, and the room of the legend below.
const WIDTH: f64 = 300.0;
const WIDE: f64 = 900.0;
const MOST_HEIGHT: f64 = 620.0;
const LEGEND: f64 = 70.0;
/// A plan that is longer than this has all the width, m.
const LARGE: f64 = 12.0;

/// A scene and where people were in it.
#[derive(Debug)]
pub(super) struct Plan {
    /// The level or the stairs that it is of; empty without levels.
    pub(super) name: String,
    /// Around all places, m.
    walked: Bounds,
    /// Around the scene, too, m.
    bounds: Bounds,
    /// User units per metre.
    scale: f64,
    /// What is drawn above the map.
    barriers: String,
}

impl Plan {
    /// The plan of some traces in a scene, or on one island of it; none where nobody was there.
    pub(super) fn of(scene: &Scene, island: Option<usize>, traces: &[&Trace]) -> Option<Self> {
        let of_island = island.map(|island| (scene.island(island), &scene.storeys.islands[island]));
        let (scene, island) =
            of_island.as_ref().map_or((scene, None), |(scene, island)| (scene, Some(*island)));
        let tracks = traces.iter().flat_map(|trace| &trace.motion.tracks);
        let points = tracks.flat_map(|track| &track.points);
        let places = points.map(|[x, y]| Vec2::new(f64::from(*x), f64::from(*y)) / 1000.0);
        let is_here = |p: &Vec2| island.is_none_or(|island| island.bounds.distance(*p) < 0.5 * APART);
        let walked = Bounds::around(places.filter(is_here))?;
        let barriers = scene.barriers.iter().filter_map(|barrier| barrier.obstacle.bounds());
        let lines = scene.lines.iter().filter_map(|line| Bounds::around([line.segment.a, line.segment.b]));
        let corners = barriers.chain(lines).chain([walked]).flat_map(|bounds| [bounds.low, bounds.high]);
        let inner = Bounds::around(corners)?;
        let size = inner.high - inner.low;
        let room = Vec2::repeat((0.03 * size.x.max(size.y)).max(0.2));
        let bounds = Bounds { low: inner.low - room, high: inner.high + room };
        let size = bounds.high - bounds.low;
        let width = if size.x > LARGE { WIDE } else { WIDTH };
        let scale = (width / size.x).min(MOST_HEIGHT / size.y);
        let name = island.map_or(String::new(), |island| island.name.clone());
        let mut plan = Self { name, walked, bounds, scale, barriers: String::new() };
        plan.barriers = plan.drawn(scene);
        Some(plan)
    }

    /// The bounds of the places of people.
    pub(super) fn walked(&self) -> &Bounds {
        &self.walked
    }

    /// Whether it takes all the width of a page.
    pub(super) fn is_wide(&self) -> bool {
        self.bounds.high.x - self.bounds.low.x > LARGE
    }

    /// Width of a shade in the legend.
    pub(super) fn shade(&self) -> f64 {
        if self.is_wide() { 60.0 } else { 38.0 }
    }

    fn at(&self, p: Vec2) -> String {
        let to = Vec2::new(p.x - self.bounds.low.x, self.bounds.high.y - p.y) * self.scale;
        format!("{:.1} {:.1}", to.x, to.y)
    }

    fn path(&self, points: &[Vec2]) -> String {
        let part = |(k, p): (usize, &Vec2)| format!("{}{}", if k == 0 { "M" } else { "L" }, self.at(*p));
        points.iter().enumerate().map(part).collect()
    }

    fn drawn(&self, scene: &Scene) -> String {
        let line = |line: &Segment| self.path(&[line.a, line.b]);
        let solid = |shape: &Shape| match shape {
            Shape::Circle { centre, radius } => {
                let radius = radius * self.scale;
                let start = self.at(Vec2::new(centre.x - radius / self.scale, centre.y));
                let arc = |dx: f64| format!("a{radius:.1} {radius:.1} 0 1 0 {dx:.1} 0");
                format!("M{start}{}{}Z", arc(2.0 * radius), arc(-2.0 * radius))
            }
            Shape::Polygon(polygon) => {
                let rings = std::iter::once(&polygon.outline).chain(&polygon.holes);
                rings.map(|ring| self.path(ring) + "Z").collect()
            }
            Shape::Parts(_) => String::new(),
        };
        let walls: String = scene.with_closed(0).walls().map(line).collect();
        let solids: String = scene.solids().map(solid).collect();
        let lines: String = scene.lines.iter().map(|one| line(&one.segment)).collect();
        let mut drawn = String::new();
        // A rim below the walls sets them apart from dark cells.
        for (class, path) in
            [("rim", &walls), ("solid", &solids), ("wall", &walls), ("rim", &lines), ("passage", &lines)]
        {
            if !path.is_empty() {
                let _ = writeln!(drawn, "<path class=\"{class}\" d=\"{path}\"/>");
            }
        }
        drawn
    }

    /// A drawing with a grid of cells of some side from a corner on, and a legend below.
    pub(super) fn finish(&self, title: &str, (low, side): (Vec2, f64), cells: &str, legend: &str) -> String {
        let size = (self.bounds.high - self.bounds.low) * self.scale;
        let width = size.x.max(if self.is_wide() { WIDE } else { WIDTH });
        let (corner, cell) = (self.at(low), side * self.scale);
        let metres = [100.0, 50.0, 20.0, 10.0, 5.0, 2.0, 1.0].into_iter().find(|m| m * self.scale <= 70.0);
        let metres = metres.unwrap_or(0.5);
        format!(
            "<svg class=\"heat\" viewBox=\"0 0 {width:.0} {:.0}\" width=\"{width:.0}\" role=\"img\" aria-label=\"{title}\">\n\
             <g transform=\"translate({corner}) scale({cell:.4} -{cell:.4})\" shape-rendering=\"crispEdges\">\n{cells}</g>\n\
             {}<path class=\"scale\" d=\"M4 {:.1}h{:.1}\"/><text class=\"tick first\" x=\"{:.1}\" y=\"{:.1}\">{} m</text>\n\
             <g transform=\"translate(10 {:.1})\">{legend}</g>\n</svg>\n",
            size.y + LEGEND,
            self.barriers,
            size.y + 10.0,
            metres * self.scale,
            metres * self.scale + 10.0,
            size.y + 14.0,
            plain(metres),
            size.y + 24.0,
        )
    }
}

// A figure: a drawing with its caption.

/// A drawing and what it shows.
#[derive(Clone, Debug)]
pub(in crate::report::html) struct Figure {
    pub(in crate::report::html) caption: String,
    /// SVG, in which all texts are escaped.
    pub(in crate::report::html) svg: String,
    /// Whether it takes all the width of a page.
    pub(in crate::report::html) is_wide: bool,
}
