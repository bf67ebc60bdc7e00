//! The name of a procedure and all its numbers, for reports: with them, the seed and the inputs a result can be had again.

use crate::compile::methods::PLANNED_TRIALS;
use crate::compile::study::{Ask, Beside, Measure, MeasureKind, Role};
use crate::engine::outcome::Method;
use crate::engine::sampling::procedure::Procedure;
use crate::stats::procedures::{PROBABILITY_WITHIN, TAIL_RUNNING};
use crate::stats::splitting;
use crate::stats::{Chosen, Coverage};

/// Names and numbers, in the order of a report.
type Numbers = Vec<(&'static str, f64)>;

/// What a procedure knows of a measure: the range of a metric, the level of a quantile.
fn ends(measure: &Measure) -> Numbers {
    match measure.kind {
        MeasureKind::Probability | MeasureKind::Curve { .. } => Vec::new(),
        MeasureKind::Expectation { range: (low, high), level, .. } => {
            let level = level.map(|level| ("level", level));
            level.into_iter().chain([("low", low), ("high", high)]).collect()
        }
        MeasureKind::Quantile { level, .. } => vec![("level", level)],
    }
}

/// The values of the arguments of a procedure.
fn values(chosen: &Chosen) -> Numbers {
    chosen.numbers().map(|(argument, value)| (argument.name, value)).collect()
}

/// The name and numbers of a procedure, for reports.
pub(in crate::engine) fn of(ask: &Ask, procedure: Option<&Procedure>) -> Method {
    let found = procedure.map_or_else(Vec::new, Procedure::numbers);
    let (name, numbers) = match ask {
        Ask::Check { threshold, test, measure, .. } => {
            // The threshold stands behind the errors.
            let errors = test.spec.arguments.iter().take_while(|argument| argument.is_error()).count();
            let mut numbers = values(test);
            numbers.insert(errors, ("theta", *threshold));
            (test.spec.reported, [numbers, found, ends(measure)].concat())
        }
        Ask::Estimate { estimator, measure, .. } => {
            if let Some(rule) = splitting::Rule::of(estimator) {
                return method(estimator.spec.reported, &rule.numbers());
            }
            let name = match procedure {
                Some(Procedure::Probability(readings)) if estimator.spec.name == PROBABILITY_WITHIN.name => {
                    readings.readings().0.rule().chosen()
                }
                _ => estimator.spec.reported,
            };
            (name, [values(estimator), found, ends(measure)].concat())
        }
        Ask::Compare { first, within, delta, .. } => {
            let planned = ("trials", PLANNED_TRIALS as f64);
            let numbers = vec![("delta", *delta), within.map_or(planned, |w| ("epsilon", w))];
            // The mean of the differences of two metrics, or the difference of two shares.
            let name = match first.kind {
                MeasureKind::Expectation { level: Some(_), .. } => TAIL_RUNNING.reported,
                MeasureKind::Expectation { .. } => "empirical_bernstein",
                _ => "paired_betting",
            };
            (name, [numbers, ends(first)].concat())
        }
        Ask::Rank { ranking, measure, models, beside, .. } => {
            let word = vec![("word", crate::engine::sampling::rank::WORD as f64)];
            let name = match beside.first() {
                Some(Beside { role: Role::Constraint { .. }, .. }) => "constrained_betting",
                Some(Beside { role: Role::Aim { .. }, .. }) => "pareto_betting",
                None if *models > 1 => crate::engine::sampling::least::NAME,
                None if measure.kind.share().is_some() => TAIL_RUNNING.reported,
                None => ranking.spec.reported,
            };
            (name, [values(ranking), word, ends(measure)].concat())
        }
    };
    method(name, &numbers)
}

/// The interval of the plain trials of splitting, where it is the result.
pub(in crate::engine) fn plain(coverage: Coverage, trials: u64, delta: f64) -> Method {
    let name = if coverage == Coverage::FixedSize { "clopper_pearson" } else { "confidence_sequence" };
    method(name, &[("trials", trials as f64), ("delta", delta)])
}

fn method(name: &str, numbers: &[(&'static str, f64)]) -> Method {
    let numbers = numbers.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect();
    Method { name: name.to_owned(), numbers }
}
