//! The name of a procedure and all its numbers, for reports: with them, the seed and the inputs a result can be had again.

use super::budget::DEFAULT_TRIALS;
use super::outcome::Method;
use super::procedure::{MASSART_SHARE, Procedure};
use crate::compile::study::{Ask, Estimator, Measure, MeasureKind, Ranking, Test};
use crate::stats::{self, AnyEstimator, AnyTest};

/// What a procedure knows of a measure: the range of a metric, the level of a quantile.
fn ends(measure: &Measure) -> Vec<(&'static str, f64)> {
    match measure.kind {
        MeasureKind::Probability => Vec::new(),
        MeasureKind::Expectation { range: (low, high), .. } => vec![("low", low), ("high", high)],
        MeasureKind::Quantile { level, .. } => vec![("level", level)],
    }
}

/// The name and numbers of a procedure, for reports.
pub(super) fn of(ask: &Ask, procedure: Option<&Procedure>) -> Method {
    let named = |name: &str, numbers: &[(&str, f64)]| Method {
        name: name.to_owned(),
        numbers: numbers.iter().map(|(n, v)| ((*n).to_owned(), *v)).collect(),
    };
    match ask {
        Ask::Check { threshold, test, measure, .. } => {
            let theta = ("theta", *threshold);
            match *test {
                Test::Sprt { alpha, beta, indifference } => {
                    named("sprt", &[("alpha", alpha), ("beta", beta), theta, ("indifference", indifference)])
                }
                Test::Sprt2 { alpha, beta, indifference } => {
                    named("sprt2", &[("alpha", alpha), ("beta", beta), theta, ("indifference", indifference)])
                }
                Test::Plan { alpha, beta, indifference } => {
                    let mut numbers =
                        vec![("alpha", alpha), ("beta", beta), theta, ("indifference", indifference)];
                    if let Some(Procedure::Test(test)) = procedure
                        && let AnyTest::Plan(plan) = test.readings().0
                    {
                        let (trials, accept) = plan.size();
                        numbers.extend([("trials", trials as f64), ("accept", accept as f64)]);
                    }
                    named("plan", &numbers)
                }
                Test::EProcess { alpha, beta } => {
                    let weight = ("weight", stats::eprocess::weight(*threshold));
                    named("eprocess", &[("alpha", alpha), ("beta", beta), theta, weight])
                }
                Test::ThreeWay { alpha, indifference } => {
                    named("three_way", &[("alpha", alpha), theta, ("indifference", indifference)])
                }
                Test::Interval { delta } => {
                    let numbers = [("delta", delta), theta];
                    named("empirical_bernstein", &[&numbers[..], &ends(measure)].concat())
                }
            }
        }
        Ask::Estimate { estimator, measure } => match (*estimator, &measure.kind) {
            (Estimator::Default { epsilon, delta }, MeasureKind::Probability) => {
                let name = match procedure {
                    Some(Procedure::Probability(p)) => match p.readings().0 {
                        AnyEstimator::Calibrated(c) => {
                            let asked = [("epsilon", epsilon), ("delta", delta)];
                            let Some(gamma) = c.gamma() else {
                                // It was stopped before it mattered which procedure it is.
                                return named("default", &asked);
                            };
                            return named("calibrated", &[&asked[..], &[("gamma", gamma)]].concat());
                        }
                        AnyEstimator::Spending(spending) => {
                            let looks = ("looks", spending.looks().len() as f64);
                            return named("spending", &[("epsilon", epsilon), ("delta", delta), looks]);
                        }
                        _ => "okamoto",
                    },
                    _ => "calibrated",
                };
                let mut numbers = vec![("epsilon", epsilon), ("delta", delta)];
                numbers.extend(procedure.and_then(Procedure::limit).map(|n| ("trials", n as f64)));
                named(name, &numbers)
            }
            (Estimator::Default { epsilon, delta }, _) => {
                let cap = procedure.and_then(Procedure::limit).map(|n| ("cap", n as f64));
                let numbers: Vec<_> =
                    [("epsilon", epsilon), ("delta", delta)].into_iter().chain(cap).collect();
                named("empirical_bernstein", &[&numbers[..], &ends(measure)].concat())
            }
            (Estimator::Okamoto { epsilon, delta }, _) => {
                let trials = procedure.and_then(Procedure::limit).map(|n| ("trials", n as f64));
                let numbers: Vec<_> =
                    [("epsilon", epsilon), ("delta", delta)].into_iter().chain(trials).collect();
                named("okamoto", &[&numbers[..], &ends(measure)].concat())
            }
            (Estimator::Massart { epsilon, delta }, _) => {
                let auxiliary = ("auxiliary", MASSART_SHARE * delta);
                named("massart", &[("epsilon", epsilon), ("delta", delta), auxiliary])
            }
            (Estimator::Spending { epsilon, delta }, _) => {
                let looks = match procedure {
                    Some(Procedure::Probability(p)) => match p.readings().0 {
                        AnyEstimator::Spending(spending) => Some(("looks", spending.looks().len() as f64)),
                        _ => None,
                    },
                    _ => None,
                };
                let numbers: Vec<_> =
                    [("epsilon", epsilon), ("delta", delta)].into_iter().chain(looks).collect();
                named("spending", &numbers)
            }
            (Estimator::Relative { epsilon, delta }, _) => {
                let mut numbers = vec![("epsilon", epsilon), ("delta", delta)];
                if let Some(Procedure::Probability(p)) = procedure
                    && let AnyEstimator::Gbas(gbas) = p.readings().0
                {
                    numbers.extend([("successes", gbas.needed() as f64), ("cap", DEFAULT_TRIALS as f64)]);
                }
                named("gbas", &numbers)
            }
            (Estimator::Band { trials, delta }, _) => {
                named("dkw", &[&[("trials", trials as f64), ("delta", delta)], &ends(measure)[..]].concat())
            }
            (Estimator::Splitting(rule), _) => {
                let name = if rule.adaptive { "splitting" } else { "fixed_effort" };
                let mut numbers = vec![("replicas", rule.replicas as f64), ("runs", rule.runs as f64)];
                numbers.extend(rule.adaptive.then_some(("kill", rule.kill as f64)));
                numbers.extend([("plain", rule.plain as f64), ("delta", rule.delta)]);
                named(name, &numbers)
            }
            (Estimator::Fixed { trials, delta }, kind) => {
                let name = match kind {
                    MeasureKind::Probability => "clopper_pearson",
                    MeasureKind::Expectation { .. } => "empirical_bernstein",
                    MeasureKind::Quantile { .. } => "order_statistics",
                };
                named(name, &[&[("trials", trials as f64), ("delta", delta)], &ends(measure)[..]].concat())
            }
        },
        Ask::Compare { first, within, delta, .. } => {
            let planned = ("trials", crate::compile::methods::PLANNED_TRIALS as f64);
            let numbers = [("delta", *delta), within.map_or(planned, |w| ("epsilon", w))];
            // The mean of the differences of two metrics, or the difference of two shares.
            let name = match first.kind {
                MeasureKind::Expectation { .. } => "empirical_bernstein",
                _ => "paired_betting",
            };
            named(name, &[&numbers[..], &ends(first)].concat())
        }
        Ask::Rank { epsilon, delta, ranking, measure, .. } => {
            let name = match ranking {
                Ranking::Betting => "betting",
                Ranking::OneChallenger => "one_challenger",
                Ranking::Okamoto => "okamoto",
            };
            let word = ("word", super::rank::WORD as f64);
            named(name, &[&[("epsilon", *epsilon), ("delta", *delta), word], &ends(measure)[..]].concat())
        }
    }
}
