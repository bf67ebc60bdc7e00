//! How a scene was understood: walls, regions, lines, levels and stairs.

use super::model::number;
use super::number::counted;
use crate::base::geometry::{Segment, Shape, Vec2};
use crate::model::{Obstacle, Scenario, Scene};
use std::fmt::Write;

/// All that stands still, with the coordinates of each level.
pub(super) fn scene(scenario: &Scenario) -> String {
    let (scene, mut out) = (&scenario.scene, String::new());
    for (axis, period) in [("x", scene.periods.x), ("y", scene.periods.y)] {
        if let Some(period) = period {
            let _ = writeln!(out, "  periodic {axis}: {} .. {} m", number(period.low), number(period.high()));
        }
    }
    storeys(&mut out, scene);
    for (k, barrier) in scenario.scene.barriers.iter().enumerate() {
        let name = if barrier.name.is_empty() { String::new() } else { format!(" {}", barrier.name) };
        if scene.doors.iter().any(|door| door.0 as usize == k) {
            let _ = writeln!(out, "  door{name}: opens or closes during a trial");
            continue;
        }
        let _ = match &barrier.obstacle {
            Obstacle::Wall(segments) => {
                let length = number(segments.iter().map(Segment::length).sum());
                writeln!(out, "  wall{name}: {}, {length} m", counted(segments.len() as u64, "segment"))
            }
            Obstacle::Solid(solid) => writeln!(out, "  obstacle{name}: {}", area(scene, solid)),
        };
    }
    for region in scenario.scene.regions.iter().filter(|region| region.is_declared()) {
        let _ = writeln!(out, "  region {}: {}", region.name, area(scene, &region.shape));
    }
    for (name, at) in &scenario.scene.points {
        let _ =
            writeln!(out, "  point {name}: {} m", point(scene.storeys.local(*at).map_or(*at, |(_, at)| at)));
    }
    for line in &scenario.scene.lines {
        let Segment { a, b } = line.segment;
        let [a, b] = [a, b].map(|p| scene.storeys.local(p).map_or(p, |(_, p)| p));
        let _ = writeln!(out, "  line {}: {} -- {} m", line.name, point(a), point(b));
    }
    out
}

/// Levels and stairs; coordinates are those on each level.
fn storeys(out: &mut String, scene: &Scene) {
    let storeys = &scene.storeys;
    for (k, island) in storeys.islands.iter().enumerate() {
        if let Some(height) = island.height {
            let _ = writeln!(out, "  level {}: height {} m", island.name, number(height));
            continue;
        }
        let into: Vec<_> = storeys.portals.iter().filter(|portal| portal.islands[1] as usize == k).collect();
        let [up, down] = into[..] else { continue };
        let [low, high] = [up, down].map(|portal| storeys.islands[portal.islands[0] as usize].name.as_str());
        let size = island.bounds.high - island.bounds.low;
        let (run, width) = (number(size.x), number(size.y));
        let speeds = [up, down].map(|portal| number((portal.speed * 1000.0).round() / 1000.0));
        let name = &island.name;
        let _ = writeln!(
            out,
            "  stairs {name}: from {low} to {high}, {run} m long in the plan, {width} m wide, at {} of the speed up and {} down",
            speeds[0], speeds[1]
        );
    }
}

/// The name of the level on which a place lies, with a blank; nothing without levels.
fn level(scene: &Scene, p: Vec2) -> String {
    scene.storeys.local(p).map_or(String::new(), |(island, _)| format!("{} ", island.name))
}

/// A place on its level.
pub(super) fn place(scene: &Scene, p: Vec2) -> String {
    format!("{}{}", level(scene, p), point(scene.storeys.local(p).map_or(p, |(_, own)| own)))
}

/// A shape in the coordinates of its levels, which are named where there are several.
fn area(scene: &Scene, all: &Shape) -> String {
    let parts = all.parts();
    let is_elsewhere = |part: &Shape| scene.storeys.separate(part.inner_point(), parts[0].inner_point());
    let has_several = parts.iter().any(is_elsewhere);
    let own = |part: &Shape| {
        let at = part.inner_point();
        let moved = scene.storeys.local(at).map_or_else(|| part.clone(), |(_, own)| part.moved(own - at));
        let level = if has_several { level(scene, at) } else { String::new() };
        level + &shape(&moved)
    };
    parts.iter().map(own).collect::<Vec<_>>().join(", ")
}

/// A shape with its level.
pub(super) fn area_on(scene: &Scene, shape: &Shape) -> String {
    let (area, level) = (area(scene, shape), level(scene, shape.inner_point()));
    if area.starts_with(&level) { area } else { level + &area }
}

/// A point, in m.
pub(super) fn point(p: Vec2) -> String {
    format!("({}, {})", number(p.x), number(p.y))
}

/// A shape with its size.
pub(super) fn shape(shape: &Shape) -> String {
    match shape {
        Shape::Parts(parts) => parts.iter().map(self::shape).collect::<Vec<_>>().join(", "),
        Shape::Circle { centre, radius } => format!("circle {} radius {} m", point(*centre), number(*radius)),
        Shape::Polygon(polygon) => {
            let corners = polygon.outline.len();
            let holes = match polygon.holes.len() as u64 {
                0 => String::new(),
                several => format!(", {}", counted(several, "hole")),
            };
            let bounds = shape.bounds();
            let (width, height) = (bounds.high.x - bounds.low.x, bounds.high.y - bounds.low.y);
            let (low, high, area) = (point(bounds.low), point(bounds.high), number(polygon.area()));
            if corners == 4 && holes.is_empty() && polygon.area() == width * height {
                return format!("rect {low} .. {high}, {area} m^2");
            }
            format!("{corners} corners{holes}, {low} .. {high}, {area} m^2")
        }
    }
}
