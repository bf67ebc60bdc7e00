//! Floor 0: what every other floor may use and what knows nothing of people, languages or statistics.
//!
//! Geometry of the plane, mathematics with the same bits on every machine, counter-based random
//! streams, exact decimals, ticks of the clock and lane vectors.

pub mod decimal;
pub mod digest;
pub mod dimension;
pub mod elliptic;
pub mod fingerprint;
pub mod frontier;
pub mod geometry;
pub mod instant;
pub mod lanes;
#[allow(clippy::excessive_precision, reason = "coefficients stand as published")]
pub mod math;
pub mod random;
pub mod rounding;
pub mod special;
pub mod tick;
pub mod visible;
