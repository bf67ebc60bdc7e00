//! Floor 1: statistical procedures: tests of a probability, estimators, comparison and ranking.
//!
//! Every procedure is a small state machine that consumes outcomes one by one **in the order of their
//! trial index**, keeps whole numbers as state, and stops at an index that depends on the outcomes alone.
//! Nothing here knows what a trial is, how it is run, or how a result is written.
//!
//! A procedure is one file: its [`Rule`] and its [`Spec`]. The lists at the end of this file name all of them.
//!
//! | question | type |
//! | --- | --- |
//! | P >= theta, with an indifference region | [`Sprt`], [`TwoSprt`], [`Plan`] |
//! | P >= theta, without | [`Evidence`], [`ThreeWay`] |
//! | P within a half-width | [`Calibrated`], [`Spending`], [`Okamoto`], [`Massart`], [`FixedSize`] |
//! | P to a relative error | [`Gbas`] |
//! | P at any time | [`sequence`] |
//! | mean of a bounded metric | [`Mean`] |
//! | quantiles, distribution | [`quantile`], [`Histogram`] |
//! | difference of two probabilities | [`Difference`] |
//! | which of k moves | [`ranking`] |
//! | P far below one in a million | [`splitting`] |
//! | has P drifted | [`Cusum`] |

pub mod calibrated;
pub mod calibration;
pub mod clopper_pearson;
pub mod counts;
pub mod cusum;
pub mod difference;
pub mod eprocess;
pub mod estimator;
pub mod gbas;
pub mod histogram;
pub mod invalid;
pub mod massart;
pub mod mean;
pub mod okamoto;
pub mod plan;
pub mod quantile;
pub mod ranking;
pub mod sequence;
pub mod sequential;
pub mod spec;
pub mod spending;
pub mod splitting;
pub mod sprt;
pub mod test;
pub mod two_sprt;
mod width;

pub use calibrated::Calibrated;
pub use clopper_pearson::FixedSize;
pub use counts::{Counts, Outcome};
pub use cusum::Cusum;
pub use difference::Difference;
pub use eprocess::{Evidence, ThreeWay};
pub use estimator::{Coverage, Estimator, Interval, Levels};
pub use gbas::Gbas;
pub use histogram::Histogram;
pub use invalid::Invalid;
pub use massart::Massart;
pub use mean::Mean;
pub use okamoto::Okamoto;
pub use plan::Plan;
pub use sequential::{Readings, Rule, Sequential};
pub use spec::{Chosen, Spec};
pub use spending::Spending;
pub use sprt::Sprt;
pub use test::{Claim, Decision, Hypothesis, Statement, Test, Verdict};
pub use two_sprt::TwoSprt;

sequential::any_rule! {
    /// Any of the tests.
    AnyTest: Test { Sprt, TwoSprt, Plan, Evidence, ThreeWay }
}

sequential::any_rule! {
    /// Any of the estimators of a probability.
    AnyEstimator: Estimator { Calibrated, Spending, Okamoto, Massart, FixedSize, Gbas }
}

/// The procedures that queries can name, as they are listed to users.
pub const PROCEDURES: &[&Spec] = &[
    &sprt::SPRT,
    &two_sprt::SPRT2,
    &plan::PLAN,
    &eprocess::EPROCESS,
    &eprocess::THREE_WAY,
    &okamoto::OKAMOTO,
    &massart::MASSART,
    &spending::SPENDING,
    &clopper_pearson::CLOPPER_PEARSON,
    &clopper_pearson::FIXED,
    &gbas::GBAS,
    &splitting::SPLITTING,
    &splitting::FIXED_EFFORT,
    &mean::OKAMOTO,
    &mean::FIXED,
    &quantile::FIXED,
    &quantile::DKW,
    &ranking::BETTING,
    &ranking::ONE_CHALLENGER,
    &ranking::OKAMOTO,
];
