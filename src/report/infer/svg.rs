//! Inferred traces and groups as a picture, as Figures 3 to 6 of Given-Wilson, Legay, Sedwards, Zendra 2017: traces
//! black, their starts blue, their ends red, and at each instant a circle for each group, sized by its members.

use super::InferredFile;
use crate::base::geometry::{Bounds, Shape, Vec2};
use crate::report::svg::{Drawing, Ink};
use std::collections::BTreeMap;

/// Radius of the circle of one person, m; it grows with the root of the number.
const RADIUS: f64 = 0.2;

/// The picture.
pub fn to_svg(report: &InferredFile) -> String {
    let found = report.inference;
    let places = found.points.iter().map(|one| one.point.position);
    let low = places.clone().fold(Vec2::repeat(f64::INFINITY), |a, p| a.inf(&p));
    let high = places.fold(Vec2::repeat(f64::NEG_INFINITY), |a, p| a.sup(&p));
    let bounds = if found.points.is_empty() {
        Bounds { low: Vec2::zeros(), high: Vec2::repeat(1.0) }
    } else {
        Bounds { low: low - Vec2::repeat(0.5), high: high + Vec2::repeat(0.5) }
    };
    let mut drawing = Drawing::new(bounds);
    for instant in found.points.chunk_by(|a, b| a.point.time == b.point.time) {
        let mut groups = BTreeMap::<u64, (Vec2, f64)>::new();
        for one in instant {
            let (sum, count) = groups.entry(one.group).or_insert((Vec2::zeros(), 0.0));
            *sum += one.point.position;
            *count += 1.0;
        }
        for (sum, count) in groups.into_values() {
            drawing.shape(&Shape::Circle { centre: sum / count, radius: RADIUS * count.sqrt() }, Ink::GROUP);
        }
    }
    for one in &found.traces {
        let points: Vec<Vec2> = one.trace.points.iter().map(|point| point.position).collect();
        drawing.line(&points, Ink::TRACE);
        if let (Some(first), Some(last)) = (points.first(), points.last()) {
            drawing.dot(*first, Ink::TRACE_START);
            drawing.dot(*last, Ink::TRACE_END);
        }
    }
    drawing.finish(&format!("Traces and groups of {} ({} velocities)", report.file, report.velocity.name()))
}
