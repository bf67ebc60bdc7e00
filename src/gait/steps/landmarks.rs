//! The landmarks of a stretch of the root path.

use crate::base::geometry::Vec2;
use crate::data::mocap::Take;
use crate::gait::{Curve, SPANS, Shape};
use nalgebra::{SMatrix, SVector};

/// Landmarks between the two ends.
const INNER: usize = SPANS - 1;

/// The frame before a time, and the share of the way to the next one.
pub(super) fn frame(take: &Take, time: f64) -> (usize, f64) {
    let last = take.root.len().saturating_sub(2);
    let at = if time > 0.0 { time * take.fps } else { 0.0 };
    let k = (at as usize).min(last);
    (k, (at - k as f64).min(1.0))
}

/// The root at a time.
pub(super) fn root(take: &Take, time: f64) -> Vec2 {
    let (k, share) = frame(take, time);
    take.root[k] + (take.root[k + 1] - take.root[k]) * share
}

/// The curve that begins and ends where the root does, and is nearest to it in all frames between (least squares).
pub(super) fn shape(take: &Take, (from, to): (f64, f64)) -> Shape {
    let duration = to - from;
    let begin = root(take, from);
    let at = |k: usize| root(take, from + duration * (k + 1) as f64 / SPANS as f64) - begin;
    let mut shape = Shape { landmarks: std::array::from_fn(at), duration };
    // The curve is linear in its landmarks: the errors of the samples are fitted with what each inner landmark adds.
    let sampled = shape.curve();
    let parts: [Curve; INNER] = std::array::from_fn(|k| {
        let mut part = Shape { duration, ..Shape::default() };
        part.landmarks[k].x = 1.0;
        part.curve()
    });
    let mut normal = SMatrix::<f64, INNER, INNER>::zeros();
    let mut sides = SMatrix::<f64, INNER, 2>::zeros();
    for k in frame(take, from).0 + 1..=frame(take, to).0 {
        let share = (k as f64 / take.fps - from) / duration;
        let error = take.root[k] - begin - sampled.place(share);
        let row = SVector::<f64, INNER>::from_fn(|part, _| parts[part].place(share).x);
        normal += row * row.transpose();
        sides += row * error.transpose();
    }
    // With too few frames there is no unique curve; the samples then are one.
    if let Some(better) = normal.cholesky().map(|normal| normal.solve(&sides)) {
        for (k, landmark) in shape.landmarks.iter_mut().take(INNER).enumerate() {
            *landmark += Vec2::new(better[(k, 0)], better[(k, 1)]);
        }
    }
    shape
}
