//! The procedures that queries can name: a file for the rule of each test and estimator of a probability, and the table that
//! names, makes, forecasts and explains all procedures.

pub mod calibrated;
pub mod clopper_pearson;
pub mod eprocess;
pub mod gbas;
pub mod massart;
pub mod okamoto;
pub mod plan;
pub mod spending;
pub mod sprt;
pub mod two_sprt;

pub use calibrated::Calibrated;
pub use clopper_pearson::FixedSize;
pub use eprocess::{Evidence, ThreeWay};
pub use gbas::Gbas;
pub use massart::Massart;
pub use okamoto::Okamoto;
pub use plan::Plan;
pub use spending::Spending;
pub use sprt::Sprt;
pub use two_sprt::TwoSprt;

use super::ranking::{Allocation, Ranking};
use super::sequential::any_rule;
use super::spec::{
    ALPHA, Argument, BETA, DELTA, EPSILON, Forecast, Guess, Kind, Make, Serves, Spec, TEST_SCATTER,
};
use super::{Bounded, Counts, Decision, Estimator, Interval, Mean, Statement, Test, Weights, mean};
use crate::base::math;
use crate::base::special::normal_quantile;

any_rule! {
    /// Any of the tests.
    AnyTest: Test { Sprt, TwoSprt, Plan, Evidence, ThreeWay }
}

any_rule! {
    /// Any of the estimators of a probability.
    AnyEstimator: Estimator { Calibrated, Spending, Okamoto, Massart, FixedSize, Gbas }
}

impl Test for AnyTest {
    fn weights(&self, counts: Counts) -> Option<Weights> {
        self.inner().weights(counts)
    }

    fn certifies(&self, decision: Decision) -> Statement {
        self.inner().certifies(decision)
    }
}

impl Estimator for AnyEstimator {
    fn error(&self) -> f64 {
        self.inner().error()
    }

    fn at_stop(&self, counts: Counts) -> Interval {
        self.inner().at_stop(counts)
    }

    fn estimate(&self, counts: Counts) -> f64 {
        self.inner().estimate(counts)
    }

    fn is_capped(&self, counts: Counts) -> bool {
        self.inner().is_capped(counts)
    }
}

/// The procedures that queries can name, as they are listed to users.
pub const PROCEDURES: &[&Spec] = &[
    &SPRT,
    &SPRT2,
    &PLAN,
    &EPROCESS,
    &THREE_WAY,
    &OKAMOTO,
    &MASSART,
    &SPENDING,
    &CLOPPER_PEARSON,
    &FIXED_SIZE,
    &GBAS,
    &SPLITTING,
    &FIXED_EFFORT,
    &MEAN_OKAMOTO,
    &MEAN_FIXED,
    &TAIL_FIXED,
    &QUANTILE_FIXED,
    &DKW,
    &CURVE_FIXED,
    &BETTING,
    &ONE_CHALLENGER,
    &RANKING_OKAMOTO,
];

/// Those that are taken where a query names none.
pub const UNNAMED: &[&Spec] =
    &[&PROBABILITY_WITHIN, &MEAN_RUNNING, &MEAN_WITHIN, &TAIL_RUNNING, &TAIL_WITHIN];

/// The procedure as queries name it.
pub const SPRT: Spec = Spec {
    name: "sprt",
    reported: "sprt",
    serves: Serves::Check,
    arguments: &[ALPHA, BETA, Argument::indifference(0.0)],
    summary: "SPRT, alpha {alpha}, beta {beta}, indifference {indifference}",
    guarantee: "satisfied certifies P > theta - indifference, violated P < theta + indifference",
    make: Make::Test(|against, values| {
        Ok(Sprt::new(against.theta, values[2], values[0], values[1])?.into_any())
    }),
    forecast: Some(WALD),
};

/// The procedure as queries name it.
pub const SPRT2: Spec = Spec {
    name: "sprt2",
    reported: "sprt2",
    arguments: &[ALPHA, BETA, Argument::indifference(1e-5)],
    summary: "2-SPRT, alpha {alpha}, beta {beta}, indifference {indifference}",
    guarantee: "as sprt, and the number of trials is bounded",
    make: Make::Test(|against, values| {
        Ok(TwoSprt::new(against.theta, values[2], values[0], values[1])?.into_any())
    }),
    ..SPRT
};

/// The procedure as queries name it.
pub const PLAN: Spec = Spec {
    name: "plan",
    reported: "plan",
    serves: Serves::Check,
    arguments: &[ALPHA, BETA, Argument::indifference(5e-4)],
    summary: "exact plan of fixed size, alpha {alpha}, beta {beta}, indifference {indifference}",
    guarantee: "as sprt, at a fixed size; it stops before that once the answer is forced",
    make: Make::Test(|against, values| {
        Ok(Plan::new(against.theta, values[2], values[0], values[1])?.into_any())
    }),
    forecast: None,
};

/// The procedure as queries name it; the default of checks.
pub const EPROCESS: Spec = Spec {
    name: "eprocess",
    reported: "eprocess",
    serves: Serves::Check,
    arguments: &[ALPHA, BETA],
    summary: "one-sided e-process, errors {alpha} and {beta}",
    guarantee: "satisfied certifies P >= theta, violated P < theta, whatever P is; the default",
    make: Make::Test(|against, values| {
        Ok(Evidence::new(against.hypothesis, against.theta, values[0], values[1])?.into_any())
    }),
    forecast: Some(Forecast {
        trials: |values, Guess { share: p, theta, .. }| {
            let kl = p * math::ln(p / theta) + (1.0 - p) * math::ln((1.0 - p) / (1.0 - theta));
            (5.0 - math::ln(values[0])) / math::at_least(kl, 1e-9)
        },
        scatter: TEST_SCATTER,
    }),
};

/// The procedure as queries name it.
pub const THREE_WAY: Spec = Spec {
    name: "three_way",
    reported: "three_way",
    serves: Serves::Check,
    arguments: &[ALPHA, Argument::indifference(0.0)],
    summary: "three-way e-process, error {alpha}, indifference {indifference}",
    guarantee: "as eprocess at alpha for all answers together, and a third answer: P within the indifference of theta",
    make: Make::Test(|against, values| {
        Ok(ThreeWay::new(against.hypothesis, against.theta, values[1], values[0])?.into_any())
    }),
    forecast: Some(Forecast {
        trials: |values, guess| {
            // Each of the two tests at the ends of the region has to decide.
            let (alpha, half) = (values[0], 0.5 * values[1]);
            let one = |theta: f64| sprt::expected(guess.share, theta, half, alpha, alpha);
            math::at_least(one(guess.theta - half), one(guess.theta + half))
        },
        scatter: TEST_SCATTER,
    }),
};

/// The procedure as estimates of probabilities name it.
pub const OKAMOTO: Spec = Spec {
    name: "okamoto",
    reported: "okamoto",
    serves: Serves::Probability,
    arguments: &[EPSILON, DELTA],
    summary: "Okamoto bound for ± {epsilon}, error {delta}",
    guarantee: "P in the interval of half width epsilon, at a fixed size",
    make: Make::Estimator(|values, _| Ok(Okamoto::new(values[0], values[1])?.into_any())),
    forecast: None,
};

/// The procedure as queries name it.
pub const MASSART: Spec = Spec {
    name: "massart",
    reported: "massart",
    summary: "sequential Massart bound for ± {epsilon}, error {delta}",
    guarantee: "P in the interval of half width epsilon, argued rather than proven",
    make: Make::Estimator(|values, _| {
        Ok(Massart::new(values[0], values[1], massart::SHARE * values[1])?.into_any())
    }),
    forecast: Some(Forecast { trials: until_narrow, scatter: (0.9, 2.2) }),
    ..OKAMOTO
};

/// The procedure as queries name it.
pub const SPENDING: Spec = Spec {
    name: "spending",
    reported: "spending",
    summary: "Clopper-Pearson with alpha spending for ± {epsilon}, error {delta}",
    guarantee: "P in the interval of half width epsilon, by a union bound over looks",
    make: Make::Estimator(|values, _| Ok(Spending::new(values[0], values[1])?.into_any())),
    forecast: Some(Forecast { trials: until_narrow, scatter: (0.9, 2.2) }),
    ..OKAMOTO
};

/// The procedure as queries name it.
pub const CLOPPER_PEARSON: Spec = Spec {
    name: "clopper_pearson",
    reported: "clopper_pearson",
    arguments: &[Argument::trials(1_000_000_000_000), DELTA],
    summary: "{trials} trials, error {delta}",
    guarantee: "an exact interval at a number of trials fixed in advance",
    make: Make::Estimator(|values, _| Ok(FixedSize::new(values[0] as u64, values[1])?.into_any())),
    ..OKAMOTO
};

/// The same under the name that estimates of every kind share.
pub const FIXED_SIZE: Spec = Spec { name: "fixed", ..CLOPPER_PEARSON };

/// The procedure as queries name it.
pub const GBAS: Spec = Spec {
    name: "gbas",
    reported: "gbas",
    serves: Serves::Probability,
    arguments: &[Argument { name: "epsilon", kind: Kind::Relative }, DELTA],
    summary: "relative error {epsilon}, error {delta}",
    guarantee: "relative error epsilon; it stops at a million trials, with an exact interval then",
    make: Make::Estimator(|values, seed| {
        Ok(Gbas::new(values[0], values[1], Some(gbas::CAP), seed)?.into_any())
    }),
    forecast: Some(Forecast {
        trials: |values, guess| {
            let z = normal_quantile(1.0 - 0.5 * values[1]);
            z * z / (values[0] * values[0] * guess.share)
        },
        scatter: WIDTH_SCATTER,
    }),
};

/// The default of estimates of a probability, which nothing names.
pub const PROBABILITY_WITHIN: Spec = Spec {
    name: "default",
    reported: "calibrated",
    summary: "fewest trials for ± {epsilon}, error {delta}",
    guarantee: "P in the interval of half width epsilon",
    make: Make::Estimator(|values, _| AnyEstimator::within(values[0], values[1])),
    forecast: Some(Forecast { trials: until_narrow, scatter: WIDTH_SCATTER }),
    ..OKAMOTO
};

/// The procedure as queries name it.
pub const SPLITTING: Spec = Spec {
    name: "splitting",
    reported: "splitting",
    arguments: &[
        whole("replicas", 10.0, |_| 1e6, |_| 1000.0, None),
        whole("runs", 2.0, |_| 1000.0, |_| 20.0, None),
        whole(
            "plain",
            100.0,
            |_| 1e9,
            |values| math::at_least((values[0] * values[1] / 2.0).floor(), 100.0),
            None,
        ),
        DELTA,
        // How many are killed is at most how many there are.
        whole(
            "kill",
            1.0,
            |values| values[0] - 1.0,
            |values| math::at_least((values[0] / 10.0).floor(), 1.0),
            Some(0),
        ),
    ],
    summary: "adaptive splitting, {runs} runs of {replicas} paths, after {plain} plain trials",
    guarantee: "a lower bound of P from the runs, an upper one from plain trials",
    make: Make::Splitting { adaptive: true },
    ..OKAMOTO
};

/// The same at the levels of a pilot run.
pub const FIXED_EFFORT: Spec = Spec {
    name: "fixed_effort",
    reported: "fixed_effort",
    summary: "splitting with fixed effort, {runs} runs of {replicas} paths, after {plain} plain trials",
    make: Make::Splitting { adaptive: false },
    ..SPLITTING
};

/// The procedure of checks of an expectation, which nothing names.
pub const MEAN_RUNNING: Spec = Spec {
    name: "running",
    reported: "empirical_bernstein",
    serves: Serves::Expectation,
    arguments: &[DELTA],
    summary: "time-uniform interval of the mean, error {delta}",
    guarantee: "an interval that holds at all numbers of trials at once",
    make: Make::Mean(|range, share, values| Bounded::running(range, share, values[0])),
    forecast: Some(Forecast {
        trials: |values, guess| {
            let gap = math::at_least((guess.mean - guess.theta).abs(), 1e-6 * guess.range);
            mean::until_narrow(guess.variance, guess.range, gap, values[0])
        },
        scatter: TEST_SCATTER,
    }),
};

/// The default of estimates of an expectation with a width, which nothing names.
pub const MEAN_WITHIN: Spec = Spec {
    name: "default",
    arguments: &[EPSILON, DELTA],
    summary: "fewest trials for ± {epsilon}, error {delta}",
    guarantee: "the expectation in the interval of half width epsilon",
    make: Make::Mean(|range, share, values| Bounded::within(range, share, values[0], values[1])),
    forecast: Some(Forecast {
        trials: |values, guess| mean::until_narrow(guess.variance, guess.range, values[0], values[1]),
        scatter: (0.4, 2.0),
    }),
    ..MEAN_RUNNING
};

/// The procedure as estimates of expectations name it.
pub const MEAN_OKAMOTO: Spec = Spec {
    name: "okamoto",
    reported: "okamoto",
    arguments: &[EPSILON, DELTA],
    summary: "Okamoto bound for ± {epsilon}, error {delta}",
    guarantee: "the expectation in the interval of half width epsilon, at a fixed size",
    make: Make::Mean(|(low, high), _, values| {
        Ok(Bounded::Mean(Mean::planned(low, high, values[0], values[1])?))
    }),
    forecast: None,
    ..MEAN_RUNNING
};

/// The same for a number of trials fixed in advance; the default without a width.
pub const MEAN_FIXED: Spec = Spec {
    name: "fixed",
    arguments: &[Argument::trials(1_000_000_000_000), DELTA],
    summary: "{trials} trials, error {delta}",
    guarantee: "an interval at a number of trials fixed in advance",
    make: Make::Mean(|range, share, values| Bounded::fixed(range, share, values[0] as u64, values[1])),
    forecast: None,
    ..MEAN_RUNNING
};

/// The procedure of checks of the mean of the largest share, which nothing names.
pub const TAIL_RUNNING: Spec = Spec {
    reported: "tail_betting",
    serves: Serves::Tail,
    summary: "time-uniform interval of the mean of the largest values, error {delta}",
    forecast: Some(Forecast {
        trials: |values, guess| {
            let gap = math::at_least((guess.mean - guess.theta).abs(), 1e-6 * guess.range);
            tail_until_narrow(gap, values[0], guess)
        },
        scatter: TEST_SCATTER,
    }),
    ..MEAN_RUNNING
};

/// The default of estimates of it with a width, which nothing names.
pub const TAIL_WITHIN: Spec = Spec {
    name: "default",
    arguments: &[EPSILON, DELTA],
    summary: "fewest trials for ± {epsilon}, error {delta}",
    guarantee: "the mean of the largest values in the interval of half width epsilon",
    make: MEAN_WITHIN.make,
    forecast: Some(Forecast {
        trials: |values, guess| tail_until_narrow(values[0], values[1], guess),
        scatter: (0.3, 3.0),
    }),
    ..TAIL_RUNNING
};

/// The procedure as estimates of it name it; the default without a width.
pub const TAIL_FIXED: Spec = Spec {
    name: "fixed",
    arguments: MEAN_FIXED.arguments,
    summary: "{trials} trials, error {delta}",
    guarantee: "an interval that holds at this number of trials, and at all before",
    make: MEAN_FIXED.make,
    forecast: None,
    ..TAIL_RUNNING
};

/// The procedure as estimates of quantiles name it; the default.
pub const QUANTILE_FIXED: Spec = Spec {
    name: "fixed",
    reported: "order_statistics",
    serves: Serves::Quantile,
    // The values are kept.
    arguments: &[Argument::trials(1_000_000_000), DELTA],
    summary: "{trials} trials, error {delta}",
    guarantee: "order statistics: exact for any distribution; several levels share the error; the default",
    make: Make::Quantile { band: false },
    forecast: None,
};

/// The band, as queries name it.
pub const DKW: Spec = Spec {
    name: "dkw",
    reported: "dkw",
    summary: "{trials} trials, band around the distribution function, error {delta}",
    guarantee: "the band of Dvoretzky, Kiefer and Wolfowitz: all levels at once",
    make: Make::Quantile { band: true },
    ..QUANTILE_FIXED
};

/// The procedure of curves; `within` gives the number of trials as well.
pub const CURVE_FIXED: Spec = Spec {
    name: "dkw",
    reported: "dkw",
    serves: Serves::Curve,
    guarantee: "the band of Dvoretzky, Kiefer and Wolfowitz: the whole curve at once; the default",
    make: Make::Curve,
    ..QUANTILE_FIXED
};

/// The procedure as queries name it; the default.
pub const BETTING: Spec = Spec {
    name: "betting",
    reported: "betting",
    serves: Serves::Ranking,
    arguments: &[EPSILON, DELTA],
    summary: "best within {epsilon}, error {delta}: paired betting, all challengers",
    guarantee: "the choice is within epsilon of the best, jointly, with error delta; at any deadline a certified gap; the default",
    make: Make::Ranking(Ranking::Betting(Allocation::AllFailing)),
    forecast: None,
};

/// The procedure as queries name it.
pub const ONE_CHALLENGER: Spec = Spec {
    name: "one_challenger",
    reported: "one_challenger",
    summary: "best within {epsilon}, error {delta}: paired betting, one challenger",
    guarantee: "as betting; better choices after few trials, wider gaps",
    make: Make::Ranking(Ranking::Betting(Allocation::OneChallenger)),
    ..BETTING
};

/// The procedure as queries name it.
pub const RANKING_OKAMOTO: Spec = Spec {
    name: "okamoto",
    reported: "okamoto",
    summary: "best within {epsilon}, error {delta}: Okamoto bound on each option",
    guarantee: "as betting, each option to half of epsilon; ranks by P(…) only",
    make: Make::Ranking(Ranking::Okamoto),
    ..BETTING
};

/// Wald's expected number of trials for the arguments alpha, beta, indifference.
const WALD: Forecast = Forecast {
    trials: |values, guess| sprt::expected(guess.share, guess.theta, values[2], values[0], values[1]),
    scatter: TEST_SCATTER,
};

/// Factors of forecasts of estimates.
pub(super) const WIDTH_SCATTER: (f64, f64) = (0.8, 1.25);

/// Trials of the arguments epsilon, delta: the normal approximation, with a factor for looking after each trial.
pub(super) fn until_narrow(values: &[f64], guess: &Guess) -> f64 {
    let (epsilon, p) = (values[0], guess.share);
    let z = normal_quantile(1.0 - 0.5 * values[1]);
    1.15 * z * z * p * (1.0 - p) / (epsilon * epsilon) + 2.0 / epsilon
}

/// Trials until the interval of the mean of the largest share is narrow: that share of all values scatters, and each of them
/// weighs so much more.
fn tail_until_narrow(epsilon: f64, delta: f64, guess: &Guess) -> f64 {
    mean::until_narrow(guess.variance / guess.tail, guess.range / guess.tail, epsilon, delta)
}

const fn whole(
    name: &'static str,
    low: f64,
    high: fn(&[f64]) -> f64,
    default: fn(&[f64]) -> f64,
    bounded_by: Option<usize>,
) -> Argument {
    Argument { name, kind: Kind::Number { whole: true, low, high, default, bounded_by } }
}
