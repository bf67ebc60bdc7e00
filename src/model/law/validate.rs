//! Which parameters make a law.

use super::draw::interval_mass;
use super::{Family, Law};

/// The relative spreads for which the shape of a Weibull law is found.
const WEIBULL_SPREAD: (f64, f64) = (0.000_2, 1e4);
/// Those for which draws of a gamma law keep their digits: shapes of 1e-6 to 1e14.
const GAMMA_SPREAD: (f64, f64) = (1e-7, 1e3);
/// The largest of a lognormal law: of more, the mean is what no trial ever draws.
const LOGNORMAL_SPREAD: f64 = 1e6;
/// Poisson means beyond this are a mistake of units, and slow.
const POISSON_LIMIT: f64 = 1e9;

fn finite(name: &str, value: f64) -> Result<(), String> {
    if value.is_finite() { Ok(()) } else { Err(format!("{name} is {value}; it must be a finite number")) }
}

fn spread(sd: f64) -> Result<(), String> {
    finite("standard deviation", sd)?;
    if sd < 0.0 {
        return Err(format!("standard deviation is {sd}; it must not be negative"));
    }
    Ok(())
}

fn positive(name: &str, value: f64) -> Result<(), String> {
    finite(name, value)?;
    if value <= 0.0 {
        return Err(format!("{name} is {value}; it must be positive"));
    }
    Ok(())
}

/// A standard deviation that is zero or within some multiples of the mean.
fn spread_within(sd: f64, mean: f64, (least, most): (f64, f64)) -> Result<(), String> {
    if sd == 0.0 || (least * mean..=most * mean).contains(&sd) {
        return Ok(());
    }
    Err(if sd > most * mean {
        format!("standard deviation {sd} is more than {most} times the mean {mean}")
    } else {
        format!("standard deviation {sd} is not between {least} and {most} times the mean {mean}")
    })
}

impl Family {
    /// Whether the parameters make a distribution; else why not, naming the number.
    pub fn validate(&self) -> Result<(), String> {
        match self {
            Self::Normal { mean, sd } => {
                finite("mean", *mean)?;
                spread(*sd)
            }
            Self::LogNormal { mean, sd } => {
                positive("mean", *mean)?;
                spread(*sd)?;
                spread_within(*sd, *mean, (0.0, LOGNORMAL_SPREAD))
            }
            Self::Gamma { mean, sd } => {
                positive("mean", *mean)?;
                spread(*sd)?;
                spread_within(*sd, *mean, GAMMA_SPREAD)
            }
            Self::Weibull { mean, sd } => {
                positive("mean", *mean)?;
                spread(*sd)?;
                spread_within(*sd, *mean, WEIBULL_SPREAD)
            }
            Self::Beta { mean, sd } => {
                finite("mean", *mean)?;
                spread(*sd)?;
                if !(0.0 < *mean && *mean < 1.0) {
                    return Err(format!("mean of a beta distribution is {mean}; it must be between 0 and 1"));
                }
                let limit = (mean * (1.0 - mean)).sqrt();
                if *sd >= limit {
                    return Err(format!(
                        "standard deviation {sd} is too large for a beta distribution of mean {mean}: it must be below sqrt(mean (1 - mean)) = {limit}"
                    ));
                }
                Ok(())
            }
            Self::Uniform { low, high } => {
                finite("lower end", *low)?;
                finite("upper end", *high)?;
                if low >= high {
                    return Err(format!("lower end {low} is not below upper end {high}"));
                }
                finite("width", high - low)
            }
            Self::UniformInt { low, high } => {
                if low > high {
                    return Err(format!("lower end {low} is above upper end {high}"));
                }
                // Beyond 2^52 doubles no longer hold every whole number.
                if low.unsigned_abs() > 1 << 52 || high.unsigned_abs() > 1 << 52 {
                    return Err(format!("ends {low} and {high} are too large for exact whole numbers"));
                }
                Ok(())
            }
            Self::Exponential { mean } => positive("mean", *mean),
            Self::Poisson { mean } => {
                finite("mean", *mean)?;
                if !(0.0..=POISSON_LIMIT).contains(mean) {
                    return Err(format!(
                        "mean of a Poisson distribution is {mean}; it must be between 0 and 1e9"
                    ));
                }
                Ok(())
            }
            Self::Bernoulli { p } => {
                if !(0.0..=1.0).contains(p) {
                    return Err(format!("probability is {p}; it must be between 0 and 1"));
                }
                Ok(())
            }
            Self::Choice(options) | Self::Multiple { options, .. } => {
                if options.is_empty() {
                    return Err("a choice needs at least one value".to_owned());
                }
                for (value, weight) in options {
                    finite("value", *value)?;
                    if !(0.0..=1.0).contains(weight) {
                        return Err(format!(
                            "probability of {value} is {weight}; it must be between 0 and 1"
                        ));
                    }
                }
                let sum: f64 = options.iter().map(|(_, weight)| weight).sum();
                if (sum - 1.0).abs() > 1e-9 {
                    return Err(format!("the probabilities sum to {sum}; they must sum to 1"));
                }
                Ok(())
            }
        }
    }
}

impl Law {
    /// Whether numbers can be drawn: the family's parameters, and a truncation that leaves some mass.
    pub fn validate(&self) -> Result<(), String> {
        match self {
            Self::Constant(value) => finite("value", *value),
            Self::Random { family, low, high } => {
                family.validate()?;
                if low.is_nan() || high.is_nan() || low > high {
                    return Err(format!("the truncation from {low} to {high} is empty"));
                }
                let free = *low == f64::NEG_INFINITY && *high == f64::INFINITY;
                // Written so that a mass that is not a number is refused too.
                let some = interval_mass(family, *low, *high) > 0.0;
                if !free && !some {
                    return Err(format!("the distribution has no probability between {low} and {high}"));
                }
                Ok(())
            }
        }
    }
}
