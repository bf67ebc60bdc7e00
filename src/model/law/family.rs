//! Distribution functions and quantiles of every family, by the parameters that people know: mean and
//! standard deviation of the variable itself.

use super::{Family, discrete};
use crate::base::math;
use crate::base::special::{
    Tails, beta, beta_quantile, beta_upper_quantile, gamma, gamma_quantile, gamma_upper_quantile, ln_gamma,
    normal, normal_quantile,
};

/// A family with its own parameters worked out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Shape {
    Point(f64),
    Normal {
        mean: f64,
        sd: f64,
    },
    /// The logarithm has mean `mu` and standard deviation `sigma`.
    LogNormal {
        mu: f64,
        sigma: f64,
    },
    Uniform {
        low: f64,
        high: f64,
    },
    Gamma {
        shape: f64,
        scale: f64,
    },
    Weibull {
        shape: f64,
        scale: f64,
    },
    Beta {
        a: f64,
        b: f64,
    },
}

impl Shape {
    /// None for discrete families.
    pub(super) fn of(family: &Family) -> Option<Self> {
        let shape = match *family {
            Family::Normal { mean, sd }
            | Family::LogNormal { mean, sd }
            | Family::Gamma { mean, sd }
            | Family::Weibull { mean, sd }
            | Family::Beta { mean, sd }
                if sd == 0.0 =>
            {
                Self::Point(mean)
            }
            Family::Normal { mean, sd } => Self::Normal { mean, sd },
            Family::LogNormal { mean, sd } => {
                let variance = math::ln_1p((sd / mean) * (sd / mean));
                Self::LogNormal { mu: math::ln(mean) - 0.5 * variance, sigma: variance.sqrt() }
            }
            Family::Uniform { low, high } => Self::Uniform { low, high },
            Family::Exponential { mean } => Self::Gamma { shape: 1.0, scale: mean },
            Family::Gamma { mean, sd } => {
                Self::Gamma { shape: (mean / sd) * (mean / sd), scale: sd * (sd / mean) }
            }
            Family::Weibull { mean, sd } => {
                let shape = weibull_shape(sd / mean);
                Self::Weibull { shape, scale: mean / math::exp(ln_gamma(1.0 + 1.0 / shape)) }
            }
            Family::Beta { mean, sd } => {
                let size = mean * (1.0 - mean) / (sd * sd) - 1.0;
                Self::Beta { a: mean * size, b: (1.0 - mean) * size }
            }
            Family::UniformInt { .. }
            | Family::Poisson { .. }
            | Family::Bernoulli { .. }
            | Family::Choice(_)
            | Family::Multiple { .. } => return None,
        };
        Some(shape)
    }

    /// ln P(X <= x) and ln P(X > x).
    pub(super) fn tails(self, x: f64) -> Tails {
        match self {
            Self::Point(value) => {
                if x < value {
                    Tails::NONE
                } else {
                    Tails::ALL
                }
            }
            Self::Normal { mean, sd } => normal::normal_tails((x - mean) / sd),
            Self::LogNormal { mu, sigma } => {
                if x <= 0.0 {
                    Tails::NONE
                } else {
                    normal::normal_tails((math::ln(x) - mu) / sigma)
                }
            }
            Self::Uniform { low, high } => {
                let part = math::at_most(math::at_least((x - low) / (high - low), 0.0), 1.0);
                let rest = math::at_most(math::at_least((high - x) / (high - low), 0.0), 1.0);
                Tails { ln_lower: math::ln(part), ln_upper: math::ln(rest) }
            }
            Self::Gamma { shape, scale } => gamma::gamma_tails(shape, x / scale),
            Self::Weibull { shape, scale } => gamma::gamma_tails(1.0, weibull_hazard(shape, scale, x)),
            Self::Beta { a, b } => beta::beta_tails(a, b, x, 1.0 - x),
        }
    }

    /// The tails of the law with density proportional to x f(x), whose mass on an interval, times the
    /// mean, is the partial expectation there; only for families on x >= 0.
    pub(super) fn size_biased_tails(self, x: f64) -> Tails {
        match self {
            Self::LogNormal { mu, sigma } => Self::LogNormal { mu: mu + sigma * sigma, sigma }.tails(x),
            Self::Gamma { shape, scale } => gamma::gamma_tails(shape + 1.0, x / scale),
            Self::Weibull { shape, scale } => {
                gamma::gamma_tails(1.0 + 1.0 / shape, weibull_hazard(shape, scale, x))
            }
            Self::Beta { a, b } => beta::beta_tails(a + 1.0, b, x, 1.0 - x),
            Self::Point(_) | Self::Normal { .. } | Self::Uniform { .. } => self.tails(x),
        }
    }

    /// The x with P(X <= x) = p.
    pub(super) fn quantile(self, p: f64) -> f64 {
        match self {
            Self::Point(value) => value,
            Self::Normal { mean, sd } => mean + sd * normal_quantile(p),
            Self::LogNormal { mu, sigma } => math::exp(mu + sigma * normal_quantile(p)),
            Self::Uniform { low, high } => low + p * (high - low),
            Self::Gamma { shape, scale } => scale * gamma_quantile(shape, p),
            Self::Weibull { shape, scale } => scale * math::pow(-math::ln_1p(-p), 1.0 / shape),
            Self::Beta { a, b } => beta_quantile(a, b, p),
        }
    }

    /// The x with P(X > x) = q.
    pub(super) fn upper_quantile(self, q: f64) -> f64 {
        match self {
            Self::Point(value) => value,
            Self::Normal { mean, sd } => mean - sd * normal_quantile(q),
            Self::LogNormal { mu, sigma } => math::exp(mu - sigma * normal_quantile(q)),
            Self::Uniform { low, high } => high - q * (high - low),
            Self::Gamma { shape, scale } => scale * gamma_upper_quantile(shape, q),
            Self::Weibull { shape, scale } => scale * math::pow(-math::ln(q), 1.0 / shape),
            Self::Beta { a, b } => beta_upper_quantile(a, b, q),
        }
    }
}

/// The exponent in P(X > x) = exp(-(x / scale)^shape).
fn weibull_hazard(shape: f64, scale: f64, x: f64) -> f64 {
    if x <= 0.0 { 0.0 } else { math::pow(x / scale, shape) }
}

/// The shape k with the coefficient of variation `cv`: Gamma(1 + 2/k) / Gamma(1 + 1/k)^2 = 1 + cv^2.
///
/// The left side falls in k; bisection of ln k on the range that `Family::validate` admits.
fn weibull_shape(cv: f64) -> f64 {
    let target = math::ln_1p(cv * cv);
    let (mut low, mut high) = (-3.0, 9.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        let inverse = math::exp(-middle);
        if ln_gamma(1.0 + 2.0 * inverse) - 2.0 * ln_gamma(1.0 + inverse) > target {
            low = middle;
        } else {
            high = middle;
        }
    }
    math::exp(0.5 * (low + high))
}

impl Family {
    /// P(X <= x), before truncation.
    pub fn cdf(&self, x: f64) -> f64 {
        match Shape::of(self) {
            Some(shape) => shape.tails(x).lower(),
            None => discrete::cdf(self, x),
        }
    }

    /// The smallest x with P(X <= x) >= p, before truncation; p in [0, 1].
    pub fn quantile(&self, p: f64) -> f64 {
        match Shape::of(self) {
            Some(shape) => shape.quantile(p),
            None => discrete::quantile(self, p),
        }
    }

    /// The mean, before truncation.
    pub fn mean(&self) -> f64 {
        match self {
            Self::Normal { mean, .. }
            | Self::LogNormal { mean, .. }
            | Self::Exponential { mean }
            | Self::Poisson { mean }
            | Self::Beta { mean, .. }
            | Self::Gamma { mean, .. }
            | Self::Weibull { mean, .. } => *mean,
            Self::Uniform { low, high } => 0.5 * low + 0.5 * high,
            Self::UniformInt { low, high } => 0.5 * *low as f64 + 0.5 * *high as f64,
            Self::Bernoulli { p } => *p,
            Self::Choice(options) | Self::Multiple { options, .. } => {
                options.iter().map(|(value, weight)| value * weight).sum()
            }
        }
    }

    /// The ends of the values that can occur, before truncation.
    pub fn support(&self) -> (f64, f64) {
        match self {
            Self::Normal { mean, sd }
            | Self::LogNormal { mean, sd }
            | Self::Gamma { mean, sd }
            | Self::Weibull { mean, sd }
            | Self::Beta { mean, sd }
                if *sd == 0.0 =>
            {
                (*mean, *mean)
            }
            Self::Normal { .. } => (f64::NEG_INFINITY, f64::INFINITY),
            Self::LogNormal { .. }
            | Self::Gamma { .. }
            | Self::Weibull { .. }
            | Self::Exponential { .. }
            | Self::Poisson { .. } => (0.0, f64::INFINITY),
            Self::Beta { .. } => (0.0, 1.0),
            Self::Uniform { low, high } => (*low, *high),
            Self::UniformInt { low, high } => (*low as f64, *high as f64),
            Self::Bernoulli { p } => (f64::from(*p >= 1.0), f64::from(*p > 0.0)),
            Self::Choice(options) | Self::Multiple { options, .. } => options
                .iter()
                .filter(|(_, weight)| *weight > 0.0)
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), (value, _)| {
                    (math::at_most(low, *value), math::at_least(high, *value))
                }),
        }
    }
}
