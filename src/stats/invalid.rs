//! Parameters that make no procedure.

use thiserror::Error;

/// Why a procedure cannot be built; the text names the numbers.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum Invalid {
    /// A probability that must lie strictly between 0 and 1.
    #[error("{name} must be strictly between 0 and 1 (got {value})")]
    Probability {
        /// The parameter.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// The indifference region leaves (0, 1).
    #[error("the indifference region of {indifference} around the threshold {theta} must be inside (0, 1)")]
    Indifference {
        /// The threshold.
        theta: f64,
        /// Half-width of the region.
        indifference: f64,
    },
    /// A number outside the range in which the procedure works.
    #[error("{name} must be between {low} and {high} (got {value})")]
    Range {
        /// The parameter.
        name: &'static str,
        /// Its value.
        value: f64,
        /// Least value.
        low: f64,
        /// Greatest value.
        high: f64,
    },
    /// Two numbers that must differ.
    #[error("{first} and {second} are both {value}, but must differ")]
    Equal {
        /// One parameter.
        first: &'static str,
        /// The other.
        second: &'static str,
        /// The value of both.
        value: f64,
    },
    /// Two numbers in the wrong order.
    #[error("{low_name} = {low} must be below {high_name} = {high}")]
    Order {
        /// The parameter that must be smaller.
        low_name: &'static str,
        /// Its value.
        low: f64,
        /// The parameter that must be larger.
        high_name: &'static str,
        /// Its value.
        high: f64,
    },
}

/// `value`, if it lies strictly between 0 and 1.
pub(super) fn probability(name: &'static str, value: f64) -> Result<f64, Invalid> {
    if value > 0.0 && value < 1.0 { Ok(value) } else { Err(Invalid::Probability { name, value }) }
}

/// `value`, if it lies in [low, high].
pub(super) fn range(name: &'static str, value: f64, low: f64, high: f64) -> Result<f64, Invalid> {
    if value >= low && value <= high { Ok(value) } else { Err(Invalid::Range { name, value, low, high }) }
}

/// The ends theta - indifference and theta + indifference of the region, if they lie in (0, 1).
pub(super) fn region(theta: f64, indifference: f64) -> Result<(f64, f64), Invalid> {
    probability("theta", theta)?;
    let (low, high) = (theta - indifference, theta + indifference);
    if indifference > 0.0 && low > 0.0 && high < 1.0 && low < theta && theta < high {
        Ok((low, high))
    } else {
        Err(Invalid::Indifference { theta, indifference })
    }
}
