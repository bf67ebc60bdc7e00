//! How well a model predicts steps that it was not fitted to: proper scores (Gneiting and Raftery 2007) and the coverage of
//! intervals.

use super::LearnedGait;
use super::Warning;
use super::columns::{Columns, plus, seen_from};
use super::fit::{pairs, usual};
use crate::base::math;
use crate::base::random::{Purpose, Stream, TrialKey};
use crate::base::special::normal_cdf;
use crate::gait::{Draws, Phase, RecordedStep, Shape};
use serde::Serialize;
use std::collections::BTreeSet;
use std::f64::consts::PI;
use std::sync::Arc;

/// Scores of a model.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Scores {
    /// Pairs of steps that were held out.
    pub pairs: usize,
    /// Steps that are left out, as in a fit: shorter than 0.15 m or with a turn of more than 120 degrees.
    pub left_out: usize,
    /// Mean negative logarithm of the predicted density of the components of the next step, nats for each; the prediction is
    /// taken as normal, whatever residuals are drawn.
    pub nlpd: f64,
    /// Mean continuous ranked probability score of the components, in their standard deviations.
    pub crps: f64,
    /// Shares of the steps that 90 % of the drawn steps enclose.
    pub coverage: Coverage,
}

/// Shares of steps inside of the central 90 % of what a model draws.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Coverage {
    /// Of their length (begin to end).
    pub length: f64,
    /// Of the direction at their end.
    pub turn: f64,
    /// Of their duration.
    pub duration: f64,
}

/// Length (m), turn (rad) and duration (s) of a step.
pub(super) fn quantities(shape: &Shape) -> [f64; 3] {
    let end = shape.curve().tangent(1.0);
    let [.., last] = shape.landmarks;
    [last.norm(), math::atan2(end.y, end.x), shape.duration]
}

/// Scores of a model for steps that were held out. The offset of a subject that the model does not know is predicted from its
/// steps in the same take up to the first one of each pair.
pub fn score(model: &LearnedGait, held_out: &[RecordedStep]) -> Scores {
    const DRAWS: u32 = 400;
    let shared = Arc::new(model.clone());
    let (usual, left_out) = usual(held_out);
    let held_out = &usual[..];
    let pairs = pairs(held_out, model.as_published);
    let (mut density, mut ranked, mut numbers) = (0.0, 0.0, 0usize);
    let mut inside = [0usize; 3];
    for (number, (from, to)) in pairs.iter().enumerate() {
        let (step, next) = (&held_out[*from], &held_out[*to]);
        let person = shared.with_offset(&offset(model, held_out, step));
        let began = step.phase == Phase::First;
        for (error, log_deviation) in person.errors(step.foot, &step.shape, began, &next.shape) {
            density += 0.5 * (error * error + math::ln(2.0 * PI)) + log_deviation;
            let normal = math::exp(-0.5 * error * error) / (2.0 * PI).sqrt();
            let unit = error * (2.0 * normal_cdf(error) - 1.0) + 2.0 * normal - 1.0 / PI.sqrt();
            ranked += math::exp(log_deviation) * unit;
            numbers += 1;
        }
        let trial = TrialKey { seed: 0, index: number as u64, branch: 0 };
        let stream = Stream::of(trial, 0, Purpose::Run);
        let draw = |k: u32| quantities(&person.next(step.foot, &step.shape, began, Draws::of(stream, 0, k)));
        let drawn: Vec<[f64; 3]> = (0..DRAWS).map(draw).collect();
        let found = quantities(&next.shape);
        for q in 0..3 {
            let below = drawn.iter().filter(|d| d[q] < found[q]).count() as f64 / f64::from(DRAWS);
            inside[q] += usize::from((0.05..=0.95).contains(&below));
        }
    }
    let count = pairs.len().max(1) as f64;
    let numbers = numbers.max(1) as f64;
    let [length, turn, duration] = inside.map(|n| n as f64 / count);
    let left_out = match left_out {
        Some(Warning::LeftOut { short, turning }) => short + turning,
        _ => 0,
    };
    Scores {
        pairs: pairs.len(),
        left_out,
        nlpd: density / numbers,
        crps: ranked / numbers,
        coverage: Coverage { length, turn, duration },
    }
}

/// The offset of the subject of a step, as far as it is known when the step has been made.
fn offset(model: &LearnedGait, steps: &[RecordedStep], step: &RecordedStep) -> Columns {
    if let Some(known) = model.people.recorded(&step.subject) {
        return known;
    }
    let known = |s: &&RecordedStep| s.take == step.take && s.number <= step.number && s.phase == Phase::Inner;
    let (mut sum, mut count) = (Columns::default(), 0);
    for s in steps.iter().filter(known) {
        let row = plus(&super::columns::of(&s.shape), -1.0, &model.side(s.foot).basis.center);
        sum = plus(&sum, 1.0, &seen_from(s.foot, &row));
        count += 1;
    }
    if count == 0 {
        model.people.typical
    } else {
        model.people.shrunk(&sum.map(|x| x / f64::from(count)), count as usize)
    }
}

/// The fold of each step: takes, or all takes of a subject, go to the folds in turn, sorted by name.
pub fn folds(steps: &[RecordedStep], count: usize, by_subject: bool) -> Vec<usize> {
    let name = |s: &'_ RecordedStep| if by_subject { s.subject.clone() } else { s.take.clone() };
    let names: BTreeSet<String> = steps.iter().map(name).collect();
    let place = |s: &RecordedStep| names.iter().position(|n| *n == name(s)).unwrap_or(0);
    steps.iter().map(|s| place(s) % count.max(1)).collect()
}

#[cfg(test)]
mod tests {
    use super::super::{Method, Options, fit, made};
    use super::*;

    #[test]
    fn held_out_steps_are_predicted_and_covered() {
        let steps = made::steps(80, 16);
        let fold = folds(&steps, 5, false);
        let part = |held: bool| -> Vec<RecordedStep> {
            steps.iter().zip(&fold).filter(|(_, f)| (**f == 4) == held).map(|(s, _)| s.clone()).collect()
        };
        let scores = |options: Options| score(&fit(&part(false), &options).unwrap().0, &part(true));
        let sparse = scores(Options::default());
        let exact = scores(Options { method: Method::Exact, ..Options::default() });
        let linear = scores(Options { method: Method::Linear, ..Options::default() });
        let published = scores(Options { as_published: true, ..Options::default() });
        assert!((sparse.nlpd - exact.nlpd).abs() < 0.01 && (sparse.crps - exact.crps).abs() < 0.003);
        // These steps are a linear process: nothing is lost by the kernel, and much by what was published.
        assert!((sparse.nlpd - linear.nlpd).abs() < 0.05, "{sparse:?} {linear:?}");
        assert!(published.nlpd > sparse.nlpd + 0.02 && published.coverage.duration == 0.0, "{published:?}");
        for covered in [sparse.coverage.length, sparse.coverage.turn, sparse.coverage.duration] {
            assert!((0.82..0.97).contains(&covered), "{sparse:?}");
        }
    }

    #[test]
    fn folds_keep_takes_and_subjects_together() {
        let steps = made::steps(10, 3);
        for (by_subject, name) in [(false, 0), (true, 1)] {
            let fold = folds(&steps, 3, by_subject);
            let of = |s: &RecordedStep| if name == 0 { s.take.clone() } else { s.subject.clone() };
            for (s, f) in steps.iter().zip(&fold) {
                assert!(*f < 3 && steps.iter().zip(&fold).all(|(t, g)| of(s) != of(t) || f == g));
            }
        }
        assert_eq!(folds(&steps, 3, false)[3..6], [1, 1, 1]);
    }
}
