//! Placements that no trial can make: more bodies than fit into a shape.

use super::arrival::Arrivals;
use crate::base::geometry::Nearby;
use crate::base::geometry::{Bounds, Shape, Vec2};
use crate::model::{AgentId, Law, Parameter, Position, Scenario};
use std::f64::consts::PI;

/// Discs that are thrown and pushed jam at about this share of an area.
pub const JAMMED: f64 = 0.84;

/// Fewer bodies than this are judged by area alone: beside a rim, or one behind the other, few fill more than many do.
const FEW: usize = 20;

/// Points of the grid along each axis on which free area is measured.
const GRID: u32 = 160;

/// A shape into which more bodies are to be placed than fit.
#[derive(Clone, Debug, PartialEq)]
pub struct Crowding {
    /// Those who start in it.
    pub agents: Vec<AgentId>,
    /// Expected area of their bodies, m^2; of few the least.
    pub bodies: f64,
    /// Free area that bodies with their centres in the shape can cover, m^2.
    pub free: f64,
    /// The greatest share of it that can be filled; of few nothing is said but that it is free.
    pub share: Option<f64>,
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
    let reaches = |shape: &&Shape| {
        let other = shape.bounds();
        other.low.x < bounds.high.x
            && other.high.x > bounds.low.x
            && other.low.y < bounds.high.y
            && other.high.y > bounds.low.y
    };
    scenario.scene.solids().filter(reaches).collect()
}

/// A grid over the surroundings of a shape.
struct Grid<'a> {
    shape: &'a Shape,
    /// How far bodies reach out of the shape.
    reach: f64,
    bounds: Bounds,
    cell: Vec2,
    solids: &'a [&'a Shape],
    nearby: Nearby,
}

impl<'a> Grid<'a> {
    fn new(shape: &'a Shape, reach: f64, bounds: Bounds, solids: &'a [&'a Shape]) -> Self {
        let nearby = Nearby::new(&solids.iter().map(|solid| solid.bounds()).collect::<Vec<_>>());
        let cell = (bounds.high - bounds.low) / f64::from(GRID);
        Self { shape, reach, bounds, cell, solids, nearby }
    }

    /// The middles of the cells.
    fn points(&self) -> impl Iterator<Item = Vec2> {
        (0..GRID * GRID).map(|k| {
            let place = Vec2::new(f64::from(k % GRID) + 0.5, f64::from(k / GRID) + 0.5);
            self.bounds.low + place.component_mul(&self.cell)
        })
    }

    /// Area of some cells.
    fn area(&self, cells: usize) -> f64 {
        cells as f64 * self.cell.x * self.cell.y
    }

    /// Area of what lies within reach of the shape and in none of the solids: in the shape, and out of it.
    fn free(&self) -> (f64, f64) {
        let outside = |p: Vec2| move |solid: &u32| !self.solids[*solid as usize].contains(p);
        let (mut inner, mut outer) = (0, 0);
        for p in self.points() {
            let distance = self.shape.distance(p);
            if distance <= self.reach && self.nearby.within(p, 0.0).iter().all(outside(p)) {
                *(if distance > 0.0 { &mut outer } else { &mut inner }) += 1;
            }
        }
        (self.area(inner), self.area(outer))
    }

    /// Area that surely holds what lies within reach of the shape and in none of the solids: all cells of which some part
    /// may be free.
    fn most_free(&self) -> f64 {
        let half = self.cell / 2.0;
        let reach = self.reach + half.norm();
        let corners = [half, -half, Vec2::new(half.x, -half.y), Vec2::new(-half.x, half.y)];
        let is_filled = |p: Vec2| {
            self.nearby.within(p, 0.0).iter().any(|solid| {
                let solid = self.solids[*solid as usize];
                solid.contains(p) && corners.iter().all(|corner| solid.contains(p + corner))
            })
        };
        self.area(self.points().filter(|p| self.shape.distance(*p) <= reach && !is_filled(*p)).count())
    }
}

/// Those who start in one shape.
struct Crowd<'a> {
    shape: &'a Shape,
    agents: Vec<AgentId>,
    /// Of their radii: the sum of the mean squares, and the greatest of them; the same of the least radii.
    mean: (f64, f64),
    least: (f64, f64),
}

impl Crowd<'_> {
    fn add(&mut self, id: AgentId, radius: &Law, wider: f64) {
        let add = |(sum, greatest): &mut (f64, f64), square: f64| {
            *sum += square;
            *greatest = if square > *greatest { square } else { *greatest };
        };
        self.agents.push(id);
        add(&mut self.mean, mean_square(radius) * wider * wider);
        let least = radius.bounds().0 * wider;
        add(&mut self.least, least * least);
    }

    /// Whether they surely do not fit.
    fn crowding(self, scenario: &Scenario) -> Option<Crowding> {
        let is_few = self.agents.len() < FEW;
        // Whoever does not fit with the least radius does not fit with any.
        let (squares, greatest) = if is_few { self.least } else { self.mean };
        let (bodies, reach) = (PI * squares, greatest.sqrt());
        let (around, bounds) = (Vec2::new(reach, reach), self.shape.bounds());
        let bounds = Bounds { low: bounds.low - around, high: bounds.high + around };
        let solids = solids(scenario, &bounds);
        // The grid is needed only where it may be tight: no more is taken than all solids together have.
        let taken: f64 = solids.iter().map(|solid| solid.area()).sum();
        if bodies <= JAMMED * (self.shape.area() - taken) {
            return None;
        }
        let grid = Grid::new(self.shape, reach, bounds, &solids);
        if is_few {
            let free = grid.most_free();
            return (bodies > free).then_some(Crowding { agents: self.agents, bodies, free, share: None });
        }
        // Bodies jam where they are among others. What they cover beyond the rim, where no centre can be, may be filled.
        let (inner, outer) = grid.free();
        let (free, most) = (inner + outer, JAMMED * inner + outer);
        let share = if free > 0.0 { most / free } else { JAMMED };
        (bodies > most).then_some(Crowding { agents: self.agents, bodies, free, share: Some(share) })
    }
}

/// The shapes whose bodies cannot all fit, judged by area before anything is drawn. A body counts as in the
/// shape when its centre is, so what lies within a radius of the shape counts as room.
pub fn check_area(scenario: &Scenario) -> Vec<Crowding> {
    let mut crowds: Vec<Crowd<'_>> = Vec::new();
    // Who comes in later waits until there is room.
    let arrivals = Arrivals::new(scenario);
    for (k, agent) in scenario.agents.iter().enumerate().filter(|(k, _)| !arrivals.comes(*k)) {
        let Position::Within(shape) = &agent.start.position else { continue };
        let wider = agent.particle.map_or(1.0, |particle| particle.radius_factor);
        let index = crowds.iter().rposition(|crowd| crowd.shape == shape).unwrap_or_else(|| {
            crowds.push(Crowd { shape, agents: Vec::new(), mean: (0.0, 0.0), least: (0.0, 0.0) });
            crowds.len() - 1
        });
        crowds[index].add(AgentId(k as u32), &agent.body[Parameter::Radius], wider);
    }
    crowds.into_iter().filter_map(|crowd| crowd.crowding(scenario)).collect()
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
        let grid = Grid::new(&hall, 0.0, hall.bounds(), &solids);
        let (free, outer) = grid.free();
        // The grid's points are half a metre apart and fall into each block alike.
        assert!((free - 6_000.0).abs() < 1e-6 && outer == 0.0, "{free} {outer}");
        let all = grid.points().filter(|p| !solids.iter().any(|solid| solid.contains(*p))).count();
        assert_eq!(free, grid.area(all));
        assert!(grid.most_free() >= free);
    }

    #[test]
    fn of_a_disc_no_less_is_free_than_it_takes() {
        for k in 0..40 {
            let (radius, reach) = (f64::from(k) * 0.01, 0.25);
            let spot = Shape::Circle { centre: Vec2::new(0.3, 0.1), radius };
            let around = Vec2::new(radius + reach, radius + reach);
            let bounds = Bounds { low: Vec2::new(0.3, 0.1) - around, high: Vec2::new(0.3, 0.1) + around };
            let free = Grid::new(&spot, reach, bounds, &[]).most_free();
            let exact = PI * (radius + reach) * (radius + reach);
            assert!(exact <= free && free < 1.04 * exact, "{radius}: {free} {exact}");
        }
    }
}
