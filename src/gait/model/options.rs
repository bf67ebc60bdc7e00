//! What a fit can be asked for, and what can be wrong with its data.

use crate::gait::Foot;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// How the steps that can follow a step vary about their mean.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Residuals {
    /// As after one of the 32 nearest recorded steps.
    #[default]
    Nearest,
    /// Normally distributed, with the covariance of all residuals.
    Gaussian,
}

/// How the mean of the next step is found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// A Gaussian process with inducing points.
    #[default]
    Sparse,
    /// A Gaussian process of all pairs. Above 2000 pairs of a foot, inducing points are used all the same.
    Exact,
    /// A linear function of the last step (an autoregression of order one), for comparison.
    Linear,
}

/// Options of a fit.
#[derive(Clone, Debug)]
pub struct Options {
    /// Share of the variance that the components hold, in (0, 1].
    pub variance: f64,
    /// How steps vary.
    pub residuals: Residuals,
    /// How their mean is found.
    pub method: Method,
    /// Number of inducing points, from 1 to 2000.
    pub inducing: usize,
    /// As Agethen et al. 2018 describe it, for comparison: columns not scaled, no noise term, one length scale, a density of all
    /// steps, no duration, no offsets of subjects.
    pub as_published: bool,
    /// Where the steps are from.
    pub source: String,
    /// What their license asks for.
    pub license: String,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            variance: 0.95,
            residuals: Residuals::default(),
            method: Method::default(),
            inducing: 128,
            as_published: false,
            source: String::new(),
            license: String::new(),
        }
    }
}

/// Why there is no model.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum FitError {
    /// Not enough pairs of consecutive steps.
    #[error("at least {wanted} pairs of consecutive steps are needed (got {pairs})")]
    TooFewPairs {
        /// Pairs there are.
        pairs: usize,
        /// Pairs needed.
        wanted: usize,
    },
    /// Not enough pairs that begin with one foot.
    #[error("at least {wanted} pairs that begin with each foot are needed (got {pairs} for the {foot} foot)")]
    OneSided {
        /// The foot.
        foot: Foot,
        /// Pairs there are.
        pairs: usize,
        /// Pairs needed.
        wanted: usize,
    },
    /// A step with an infinite number or a NaN.
    #[error("step {number} of take `{take}` has a number that is not finite")]
    NotFinite {
        /// The take.
        take: String,
        /// The step.
        number: u32,
    },
    /// The steps of a foot are all the same.
    #[error("the steps of the {0} foot do not vary")]
    NoVariation(Foot),
    /// The covariance of the pairs of a foot has no factor.
    #[error("the transition from the {0} foot cannot be fitted: the covariance of its pairs is singular")]
    Singular(Foot),
    /// A share of the variance outside of (0, 1].
    #[error("`variance` must be above 0 and at most 1 (got {0})")]
    Variance(f64),
    /// A wrong number of inducing points.
    #[error("the number of inducing points must be from 1 to 2000 (got {0})")]
    Inducing(usize),
}

/// What a user of a model has to know.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum Warning {
    /// Few pairs.
    #[error("the model has only {0} pairs of consecutive steps; below 200 it follows single steps closely")]
    FewPairs(usize),
    /// Steps that are no steps of a walk.
    #[error(
        "{short} steps shorter than 0.15 m and {turning} steps that turn by more than 120 degrees are left out"
    )]
    LeftOut {
        /// How many are short.
        short: usize,
        /// How many turn.
        turning: usize,
    },
    /// Few first steps of a foot.
    #[error("first steps of the {foot} foot that were recorded: {steps}; {instead} are used")]
    FewFirstSteps {
        /// The foot.
        foot: Foot,
        /// How many there are.
        steps: usize,
        /// What is used.
        instead: &'static str,
    },
    /// Too many pairs for an exact model.
    #[error("an exact model takes at most 2000 pairs of a foot (got {0}); inducing points are used")]
    TooManyForExact(usize),
    /// Nobody to compare with.
    #[error("all steps are from one subject: no difference between people is known")]
    OneSubject,
}
