//! The name and numbers of a procedure, for reports.

use super::budget::DEFAULT_TRIALS;
use super::outcome::Method;
use super::procedure::{MASSART_SHARE, Procedure};
use crate::compile::study::{Ask, Estimator, MeasureKind, Ranking, Test};
use crate::stats::{self, AnyEstimator, AnyTest};

/// The name and numbers of a procedure, for reports.
pub(super) fn of(ask: &Ask, procedure: Option<&Procedure>) -> Method {
    let named = |name: &str, numbers: &[(&str, f64)]| Method {
        name: name.to_owned(),
        numbers: numbers.iter().map(|(n, v)| ((*n).to_owned(), *v)).collect(),
    };
    match ask {
        Ask::Check { threshold, test, .. } => {
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
                Test::Interval { delta } => named("empirical_bernstein", &[("delta", delta), theta]),
            }
        }
        Ask::Estimate { estimator, measure } => match (*estimator, &measure.kind) {
            (Estimator::Default { epsilon, delta }, MeasureKind::Probability) => {
                let name = match procedure {
                    Some(Procedure::Probability(p)) => match p.readings().0 {
                        AnyEstimator::Calibrated(c) => {
                            return named(
                                "calibrated",
                                &[("epsilon", epsilon), ("delta", delta), ("gamma", c.gamma())],
                            );
                        }
                        AnyEstimator::Spending(_) => "spending",
                        _ => "okamoto",
                    },
                    _ => "calibrated",
                };
                named(name, &[("epsilon", epsilon), ("delta", delta)])
            }
            (Estimator::Default { epsilon, delta }, _) => {
                named("empirical_bernstein", &[("epsilon", epsilon), ("delta", delta)])
            }
            (Estimator::Okamoto { epsilon, delta }, _) => {
                let trials = procedure.and_then(Procedure::limit).map(|n| ("trials", n as f64));
                let numbers: Vec<_> =
                    [("epsilon", epsilon), ("delta", delta)].into_iter().chain(trials).collect();
                named("okamoto", &numbers)
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
                named("dkw", &[("trials", trials as f64), ("delta", delta)])
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
                named(name, &[("trials", trials as f64), ("delta", delta)])
            }
        },
        Ask::Compare { within, delta, .. } => {
            let mut numbers = vec![("delta", *delta)];
            numbers.extend(within.map(|w| ("epsilon", w)));
            named("paired_betting", &numbers)
        }
        Ask::Rank { epsilon, delta, ranking, .. } => {
            let name = match ranking {
                Ranking::Betting => "betting",
                Ranking::OneChallenger => "one_challenger",
                Ranking::Okamoto => "okamoto",
            };
            named(name, &[("epsilon", *epsilon), ("delta", *delta)])
        }
    }
}
