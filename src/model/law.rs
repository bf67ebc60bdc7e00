//! Laws of parameters: a constant or a distribution, perhaps truncated.
//!
//! `normal`, `lognormal`, `gamma`, `weibull` and `beta` take mean and standard deviation of the variable
//! itself, `exponential` its mean. Truncation is by the inverse distribution function, so that every draw
//! takes one uniform number.

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
}

impl Law {
    /// The value at a uniform number in (0, 1), by the inverse distribution function.
    pub fn draw(&self, uniform: f64) -> f64 {
        let Self::Random { family, low, high } = self else { return self.constant().unwrap_or(f64::NAN) };
        let value = match family {
            Family::Uniform { low, high } => low + (high - low) * uniform,
            Family::Normal { mean, sd } => {
                // Abramowitz and Stegun 26.2.23, absolute error below 4.5e-4.
                let tail = if uniform < 0.5 { uniform } else { 1.0 - uniform };
                let t = (-2.0 * crate::base::math::ln(tail)).sqrt();
                let z = t
                    - (2.515_517 + t * (0.802_853 + t * 0.010_328))
                        / (1.0 + t * (1.432_788 + t * (0.189_269 + t * 0.001_308)));
                mean + sd * if uniform < 0.5 { -z } else { z }
            }
            _ => uniform,
        };
        value.clamp(*low, *high)
    }

    /// The constant, if it is one.
    pub const fn constant(&self) -> Option<f64> {
        match self {
            Self::Constant(value) => Some(*value),
            Self::Random { .. } => None,
        }
    }
}
