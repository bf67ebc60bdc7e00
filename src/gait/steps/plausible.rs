//! Whether a take can be one of a person who walks: the height of the hip, the feet and the steps.

use super::cut::{Cut, NoSteps};
use super::signal::percentile;
use crate::data::mocap::Take;

/// The height of the hip over the lower foot, m.
const HIPS: (f64, f64) = (0.6, 1.3);
/// The distance between ankle and toe, m.
const FEET: (f64, f64) = (0.05, 0.45);
/// The median length of the steps, m.
const STEPS: (f64, f64) = (0.25, 1.4);

/// The number of a take that no person who walks has, and those of people.
pub fn doubt(take: &Take, cut: &Result<Cut, NoSteps>) -> Option<String> {
    let feet = || take.feet.iter().flat_map(|foot| foot.ankle.iter().zip(&foot.toe));
    let [left, right] = &take.feet;
    let low = |k: usize| [left.ankle[k], left.toe[k], right.ankle[k], right.toe[k]].map(|place| place[2]);
    let hips =
        take.hip.iter().enumerate().map(|(k, hip)| hip - low(k).into_iter().fold(f64::INFINITY, f64::min));
    let long = feet().map(|(a, t)| (0..3).map(|k| (a[k] - t[k]) * (a[k] - t[k])).sum::<f64>().sqrt());
    let steps = cut.iter().flat_map(|cut| &cut.steps).map(|step| step.shape.curve().length());
    let numbers: [(&str, &str, Vec<f64>, (f64, f64)); 3] = [
        ("its hip is", "high (0.7 to 1.2 m are usual)", hips.collect(), HIPS),
        ("its feet are", "long from ankle to toe (0.05 to 0.45 m are usual)", long.collect(), FEET),
        ("its steps are", "long (0.3 to 1 m are usual)", steps.collect(), STEPS),
    ];
    let strange = numbers
        .into_iter()
        .map(|(what, usual, all, range)| (what, usual, percentile(&all, 0.5), range, all.is_empty()));
    let mut strange =
        strange.filter(|(_, _, median, (low, high), none)| !none && !(*low..*high).contains(median));
    strange.next().map(|(what, usual, median, ..)| format!("{what} {median:.3} m {usual}"))
}
