//! Floor 1: statistical procedures: tests of a probability, estimators, comparison and ranking.
//!
//! Every procedure is a small state machine that consumes outcomes one by one **in the order of their
//! trial index**, keeps whole numbers as state, and stops at an index that depends on the outcomes alone.
//! Nothing here knows what a trial is, how it is run, or how a result is written.
//!
//! [`procedures`] has the rules of tests and estimators of a probability, and the table of all procedures that queries
//! can name.
//!
//! | question | type |
//! | --- | --- |
//! | P >= theta, with an indifference region | [`Sprt`], [`TwoSprt`], [`Plan`] |
//! | P >= theta, without | [`Evidence`], [`ThreeWay`] |
//! | P within a half-width | [`Calibrated`], [`Spending`], [`Okamoto`], [`Massart`], [`FixedSize`] |
//! | P to a relative error | [`Gbas`] |
//! | P at any time | [`sequence`] |
//! | mean of a bounded metric | [`Mean`] |
//! | mean of its largest share | [`Tail`] |
//! | quantiles, distribution | [`quantile`], [`Histogram`] |
//! | difference of two probabilities | [`Difference`] |
//! | which of k moves | [`ranking`] |
//! | P far below one in a million | [`splitting`] |
//! | has P drifted | [`Cusum`] |
//! | do two samples have one distribution | [`twosample`] |
//! | how good are predicted probabilities | [`Predictions`], [`BrierScore`], [`Quality`] |
//! | a statistic of persons, each with many instants | [`Bootstrap`] |

mod bets;
mod bisection;
pub mod bootstrap;
mod bounded;
pub mod brier;
pub mod calibration;
pub mod counts;
pub mod cusum;
mod default_estimator;
pub mod difference;
pub mod estimator;
pub mod evolution;
pub mod histogram;
mod intake;
mod interval;
pub mod invalid;
pub mod mean;
pub mod procedures;
pub mod quality;
pub mod quantile;
pub mod ranking;
mod running;
pub mod sequence;
pub mod sequential;
pub mod spec;
pub mod splitting;
mod tail;
pub mod test;
pub mod twosample;
mod width;

pub use bootstrap::{Bootstrap, Estimate};
pub use bounded::Bounded;
pub use brier::{BrierScore, Prediction, Predictions};
pub use counts::{Counts, Outcome};
pub use cusum::Cusum;
pub use default_estimator::Levels;
pub use difference::Difference;
pub use estimator::Estimator;
pub use histogram::Histogram;
pub use intake::Intake;
pub use interval::{Coverage, Interval};
pub use invalid::Invalid;
pub use mean::Mean;
pub use procedures::{
    AnyEstimator, AnyTest, Calibrated, Evidence, FixedSize, Gbas, Massart, Okamoto, PROCEDURES, Plan,
    Spending, Sprt, ThreeWay, TwoSprt, UNNAMED, calibrated, clopper_pearson, eprocess, gbas, massart,
    okamoto, plan, spending, sprt, two_sprt,
};
pub use quality::Quality;
pub use running::Running;
pub use sequential::{Readings, Rule, Sequential};
pub use spec::{Chosen, Spec};
pub use tail::Tail;
pub use test::{Claim, Decision, Hypothesis, Statement, Test, Verdict, Weight, Weights};
