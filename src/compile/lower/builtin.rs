//! Names of the built-in functions and distributions.

/// Built-in functions by name, for hints.
pub(in crate::compile) const FUNCTIONS: [&str; 41] = [
    "abs",
    "area",
    "atan2",
    "ceil",
    "centroid",
    "clearance",
    "contact",
    "cos",
    "count",
    "density",
    "distance",
    "driving_speed",
    "exp",
    "floor",
    "heading",
    "if",
    "ln",
    "mass",
    "max",
    "min",
    "members",
    "modulo",
    "norm",
    "others",
    "position",
    "present",
    "radius",
    "robustness",
    "round",
    "sin",
    "speed",
    "spread",
    "sqrt",
    "sum",
    "mean",
    "time_to_collision",
    "time_until",
    "travelled",
    "velocity",
    "x",
    "y",
];

/// Distributions: they are values of fields, not of expressions.
pub(in crate::compile) const DISTRIBUTIONS: [&str; 11] = [
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

/// Names that stand for something unless they are declared.
pub(in crate::compile) const BUILT_IN: [&str; 3] = ["time", "everyone", "pi"];

/// Operators of property files that a scenario may use as names.
pub(in crate::compile) const OPERATORS: [&str; 6] = ["F", "G", "X", "U", "W", "R"];
