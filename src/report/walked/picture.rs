//! A picture of many walks: all of them as thin lines, and cells that are the darker the more walks pass them.

use super::Walked;
use crate::base::geometry::Vec2;
use crate::model::Scenario;
use crate::report::number::count;
use crate::report::svg::{Ink, plan};
use std::collections::{BTreeMap, BTreeSet};

/// Side of a cell, m.
const SIDE: f64 = 0.1;

/// Points of a drawn walk are at least so far apart, m.
const APART: f64 = 0.05;

fn cell(p: Vec2) -> (i64, i64) {
    ((p.x / SIDE).floor() as i64, (p.y / SIDE).floor() as i64)
}

/// The points of a walk that are drawn.
fn thinned(points: &[Vec2]) -> Vec<Vec2> {
    let mut drawn: Vec<Vec2> = Vec::new();
    for point in points {
        if drawn.last().is_none_or(|last| (point - last).norm() >= APART) {
            drawn.push(*point);
        }
    }
    drawn.extend(points.last());
    drawn
}

/// The picture as SVG.
pub fn draw(scenario: &Scenario, walked: &Walked) -> String {
    let walks = walked.legs.iter().flat_map(|leg| &leg.walks);
    let walks: Vec<Vec<Vec2>> =
        walks.map(|walk| walk.places.iter().map(|place| place.position).collect()).collect();
    let mut passed = BTreeMap::<(i64, i64), u64>::new();
    for walk in &walks {
        for cell in walk.iter().map(|point| cell(*point)).collect::<BTreeSet<_>>() {
            *passed.entry(cell).or_default() += 1;
        }
    }
    let most = passed.values().copied().max().unwrap_or(1);
    let mut drawing = plan::drawn(scenario, walks.iter().flatten().copied());
    for ((x, y), walks) in passed {
        drawing.cell(Vec2::new(x as f64, y as f64) * SIDE, SIDE, walks as f64 / most as f64);
    }
    for walk in walks.iter().filter(|walk| walk.len() > 1) {
        drawing.line(&thinned(walk), Ink::WALK);
    }
    plan::name_places(&mut drawing, scenario);
    let (all, most) = (count(walks.len() as u64), count(most));
    drawing.note(&format!("{all} walks; cells of {SIDE} m, the darkest is passed by {most}"));
    drawing.finish(if walked.title.is_empty() { "walks" } else { &walked.title })
}
