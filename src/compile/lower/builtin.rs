//! Names that stand for something: distributions, values and operators. Functions are in `model::function`.

/// Distributions: they are values of fields, not of expressions.
pub const DISTRIBUTIONS: [&str; 11] = [
    "normal",
    "lognormal",
    "uniform",
    "uniform_int",
    "exponential",
    "poisson",
    "bernoulli",
    "beta",
    "gamma",
    "weibull",
    "choice",
];

/// Goals that are one of several exits, and the one of them that counts those who wait.
pub(crate) const CHOICES: [&str; 2] = ["nearest", QUICKEST];
pub(crate) const QUICKEST: &str = "quickest";

/// Names that stand for something unless they are declared.
pub const BUILT_IN: [&str; 3] = ["time", "everyone", "pi"];

/// Operators of property files that a scenario may use as names.
pub(crate) const OPERATORS: [&str; 6] = ["F", "G", "X", "U", "W", "R"];
