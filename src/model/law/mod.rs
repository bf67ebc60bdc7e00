//! Laws of parameters: a constant or a distribution, perhaps truncated.
//!
//! `normal`, `lognormal`, `gamma`, `weibull` and `beta` take mean and standard deviation of the variable
//! itself, `exponential` its mean. Truncation is by the inverse distribution function, so that every draw
//! takes one uniform number.

mod discrete;
mod draw;
mod family;
mod scaled;
mod validate;

pub use draw::Ready;

/// How a number of each agent and trial comes about.
#[derive(Clone, Debug, PartialEq)]
pub enum Law {
    /// The same everywhere.
    Constant(f64),
    /// Drawn from a distribution.
    Random {
        /// Which distribution.
        family: Family,
        /// Lower end of the truncation.
        low: f64,
        /// Upper end of the truncation.
        high: f64,
    },
}

/// Families of distributions, in SI units.
#[derive(Clone, Debug, PartialEq)]
pub enum Family {
    /// Normal.
    Normal {
        /// Mean.
        mean: f64,
        /// Standard deviation.
        sd: f64,
    },
    /// Log-normal.
    LogNormal {
        /// Mean of the variable itself.
        mean: f64,
        /// Standard deviation of the variable itself.
        sd: f64,
    },
    /// Uniform.
    Uniform {
        /// Lower end.
        low: f64,
        /// Upper end.
        high: f64,
    },
    /// Uniform on whole numbers, ends included.
    UniformInt {
        /// Lowest.
        low: i64,
        /// Highest.
        high: i64,
    },
    /// Exponential.
    Exponential {
        /// Mean.
        mean: f64,
    },
    /// Poisson.
    Poisson {
        /// Mean.
        mean: f64,
    },
    /// 1 with probability `p`, else 0.
    Bernoulli {
        /// Probability of 1.
        p: f64,
    },
    /// Beta on (0, 1).
    Beta {
        /// Mean.
        mean: f64,
        /// Standard deviation.
        sd: f64,
    },
    /// Gamma.
    Gamma {
        /// Mean.
        mean: f64,
        /// Standard deviation.
        sd: f64,
    },
    /// Weibull.
    Weibull {
        /// Mean.
        mean: f64,
        /// Standard deviation.
        sd: f64,
    },
    /// One of some values, with weights that sum to 1.
    Choice(
        /// Values and their probabilities.
        Vec<(f64, f64)>,
    ),
    /// A multiple of a family of whole numbers, drawn as a choice.
    Multiple {
        /// The family.
        of: Box<Self>,
        /// What its values are multiplied by.
        by: f64,
        /// The products and their probabilities.
        options: Vec<(f64, f64)>,
    },
}

impl Law {
    /// The law of `by` times the number, `by` positive; `None` for families that have no such multiple.
    pub fn scaled(&self, by: f64) -> Option<Self> {
        Some(match self {
            Self::Constant(value) => Self::Constant(value * by),
            Self::Random { family, low, high } => {
                Self::Random { family: family.scaled(by)?, low: low * by, high: high * by }
            }
        })
    }

    /// Whether all numbers that it draws are whole.
    pub fn is_whole(&self) -> bool {
        let whole = |value: &f64| value.fract() == 0.0;
        match self {
            Self::Constant(value) => whole(value),
            Self::Random { family, .. } => match family {
                Family::UniformInt { .. } | Family::Poisson { .. } | Family::Bernoulli { .. } => true,
                Family::Choice(options) | Family::Multiple { options, .. } => {
                    options.iter().all(|(value, _)| whole(value))
                }
                _ => false,
            },
        }
    }

    /// The constant, if it is one.
    pub const fn constant(&self) -> Option<f64> {
        match self {
            Self::Constant(value) => Some(*value),
            Self::Random { .. } => None,
        }
    }
}

#[cfg(test)]
#[allow(clippy::disallowed_methods, reason = "the platform's functions are the reference")]
mod tests;
