//! Whether a take can be one of a person who walks: the height of the hip, the feet and the steps.

use super::cut::{Cut, NoSteps};
use super::signal::percentile;
use crate::data::mocap::Take;
use std::ops::Range;

/// The height of the hip over the lower foot, m.
const HIPS: Range<f64> = 0.6..1.3;
/// The distance between ankle and toe, m.
const FEET: Range<f64> = 0.05..0.45;
/// The length of the steps, m.
const STEPS: Range<f64> = 0.25..1.4;

/// The median of a take that no person who walks has, and those of people.
pub fn doubt(take: &Take, cut: &Result<Cut, NoSteps>) -> Option<String> {
    let [left, right] = &take.feet;
    let hip = |k: usize| {
        let places = [left.ankle[k], left.toe[k], right.ankle[k], right.toe[k]];
        take.hip[k] - places.iter().map(|place| place[2]).fold(f64::INFINITY, f64::min)
    };
    let feet = take.feet.iter().flat_map(|foot| foot.ankle.iter().zip(&foot.toe));
    let feet = feet.map(|(a, t)| (0..3).map(|k| (a[k] - t[k]) * (a[k] - t[k])).sum::<f64>().sqrt());
    let steps = cut.iter().flat_map(|cut| &cut.steps).map(|step| step.shape.curve().length());
    let strange = |what: &str, all: &[f64], range: Range<f64>, usual: &str| {
        let median = percentile(all, 0.5);
        let is_strange = !all.is_empty() && !range.contains(&median);
        is_strange.then(|| format!("its {what} {median:.3} m {usual} m are usual)"))
    };
    let (hips, feet): (Vec<f64>, Vec<f64>) = ((0..take.hip.len()).map(hip).collect(), feet.collect());
    strange("hip is", &hips, HIPS, "high (0.7 to 1.2")
        .or_else(|| strange("feet are", &feet, FEET, "long from ankle to toe (0.05 to 0.45"))
        .or_else(|| strange("steps are", &steps.collect::<Vec<_>>(), STEPS, "long (0.3 to 1"))
}
