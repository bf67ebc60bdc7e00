//! Placements that no trial can make: more bodies than fit into a shape.

use super::arrival::Arrivals;
use crate::base::geometry::{Bounds, Shape, Vec2};
use crate::kernel::nearby::Nearby;
use crate::model::{AgentId, Barrier, Law, Obstacle, Position, Scenario};
use std::f64::consts::PI;

/// Discs that are thrown and pushed jam at about this share of an area.
pub const JAMMED: f64 = 0.84;

/// Points of the grid along each axis on which free area is measured.
const GRID: u32 = 160;

/// A shape into which more bodies are to be placed than fit.
#[derive(Clone, Debug, PartialEq)]
pub struct Crowding {
    /// Those who start in it.
    pub agents: Vec<AgentId>,
    /// Expected area of their bodies, m^2.
    pub bodies: f64,
    /// Free area that bodies with their centres in the shape can cover, m^2.
    pub free: f64,
}

/// The mean of the square of a law, by the midpoint rule on its inverse distribution function.
fn mean_square(law: &Law) -> f64 {
    const POINTS: u32 = 64;
    if let Some(value) = law.constant() {
        return value * value;
    }
    let draw = |k| law.draw((f64::from(k) + 0.5) / f64::from(POINTS));
    (0..POINTS).map(draw).map(|r| r * r).sum::<f64>() / f64::from(POINTS)
}

/// The solids that reach into the surroundings of a shape. Walls take no area.
fn solids<'a>(scenario: &'a Scenario, bounds: &Bounds) -> Vec<&'a Shape> {
    let solid = |barrier: &'a Barrier| match &barrier.obstacle {
        Obstacle::Wall(_) => None,
        Obstacle::Solid(shape) => Some(shape),
    };
    let reaches = |shape: &&Shape| {
        let other = shape.bounds();
        other.low.x < bounds.high.x
            && other.high.x > bounds.low.x
            && other.low.y < bounds.high.y
            && other.high.y > bounds.low.y
    };
    scenario.scene.barriers.iter().filter_map(solid).filter(reaches).collect()
}

/// Area of what lies within `reach` of the shape and in none of the solids, by a grid over `bounds`.
fn free_area(shape: &Shape, reach: f64, bounds: &Bounds, solids: &[&Shape]) -> f64 {
    let nearby = Nearby::new(&solids.iter().map(|solid| solid.bounds()).collect::<Vec<_>>());
    let cell = (bounds.high - bounds.low) / f64::from(GRID);
    let mut count = 0u32;
    for row in 0..GRID {
        for column in 0..GRID {
            let place = Vec2::new(f64::from(column) + 0.5, f64::from(row) + 0.5);
            let p = bounds.low + place.component_mul(&cell);
            let outside = |solid: &u32| !solids[*solid as usize].contains(p);
            let free = || nearby.within(p, 0.0).iter().all(outside);
            count += u32::from(shape.distance(p) <= reach && free());
        }
    }
    f64::from(count) * cell.x * cell.y
}

/// The shapes whose bodies cannot all fit, judged by area before anything is drawn. A body counts as in the
/// shape when its centre is, so what lies within a radius of the shape counts as room.
pub fn check_area(scenario: &Scenario) -> Vec<Crowding> {
    let mut groups: Vec<(&Shape, Vec<AgentId>, f64, f64)> = Vec::new();
    // Who comes in later waits until there is room.
    let arrivals = Arrivals::new(scenario);
    for (k, agent) in scenario.agents.iter().enumerate().filter(|(k, _)| !arrivals.comes(*k)) {
        let Position::Within(shape) = &agent.start.position else { continue };
        let wider = agent.particle.map_or(1.0, |particle| particle.radius_factor);
        let square = mean_square(&agent.body.radius) * wider * wider;
        let index = groups.iter().rposition(|group| group.0 == shape).unwrap_or_else(|| {
            groups.push((shape, Vec::new(), 0.0, 0.0));
            groups.len() - 1
        });
        let group = &mut groups[index];
        group.1.push(AgentId(k as u32));
        group.2 += PI * square;
        group.3 = if square > group.3 { square } else { group.3 };
    }
    let mut out = Vec::new();
    for (shape, agents, bodies, square) in groups {
        let reach = square.sqrt();
        let (around, bounds) = (Vec2::new(reach, reach), shape.bounds());
        let bounds = Bounds { low: bounds.low - around, high: bounds.high + around };
        let solids = solids(scenario, &bounds);
        // The grid is needed only where it may be tight: no more is taken than all solids together have.
        let taken: f64 = solids.iter().map(|solid| solid.area()).sum();
        if bodies <= JAMMED * (shape.area() - taken) {
            continue;
        }
        let free = free_area(shape, reach, &bounds, &solids);
        if bodies > JAMMED * free {
            out.push(Crowding { agents, bodies, free });
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Blocks of 1 m every 4 m, 400 of them: a sixteenth of the plane.
    fn blocks() -> Vec<Shape> {
        let at = |k: u32| Vec2::new(f64::from(k % 20) * 4.0 + 1.0, f64::from(k / 20) * 4.0 + 1.0);
        (0..400).map(|k| Shape::rectangle(at(k), at(k) + Vec2::new(1.0, 1.0))).collect()
    }

    #[test]
    fn what_blocks_take_is_found_where_each_of_them_is() {
        let blocks = blocks();
        let solids: Vec<&Shape> = blocks.iter().collect();
        let hall = Shape::rectangle(Vec2::new(0.0, 0.0), Vec2::new(80.0, 80.0));
        let bounds = hall.bounds();
        let free = free_area(&hall, 0.0, &bounds, &solids);
        // The grid's points are half a metre apart and fall into each block alike.
        assert!((free - 6_000.0).abs() < 1e-6, "{free}");
        let cell = (bounds.high - bounds.low) / f64::from(GRID);
        let points = (0..GRID * GRID).map(|k| {
            let place = Vec2::new(f64::from(k % GRID) + 0.5, f64::from(k / GRID) + 0.5);
            bounds.low + place.component_mul(&cell)
        });
        let all = points.filter(|p| !solids.iter().any(|solid| solid.contains(*p))).count();
        assert_eq!(free, all as f64 * cell.x * cell.y);
    }
}
