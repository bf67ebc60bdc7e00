//! A path as a profile sees it: stretches, limits, and why there is no profile.

use thiserror::Error;

/// A line, an arc or a stop of a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    /// Its length, m.
    pub length: f64,
    /// Its radius, m: infinite on a line, 0 (and length 0) where an agent stops and turns.
    pub radius: f64,
}

/// Limits of speed and acceleration: v <= speed and `(a_t / along)^2 + (a_n / across)^2 <= 1`, where `a_t` is the
/// acceleration along the path and `a_n` = v^2 / radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Largest speed, m/s.
    pub speed: f64,
    /// Largest acceleration along the path, m/s^2.
    pub along: f64,
    /// Largest acceleration across the path, m/s^2.
    pub across: f64,
}

/// Why a profile does not exist.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum Infeasible {
    /// A limit that is not a positive number.
    #[error("every limit of speed and acceleration must be positive and finite")]
    Limits,
    /// A stretch that is neither a line, an arc nor a stop.
    #[error(
        "stretch {index} must have a length of at least 0 m and a positive radius, or be a stop (length and radius 0)"
    )]
    Stretch {
        /// Its place in the path, from 0.
        index: usize,
    },
    /// The floor of a varied profile is invalid.
    #[error("the floor of a varied profile must be above 0 and at most 1 (got {floor})")]
    Floor {
        /// Its value.
        floor: f64,
    },
    /// A law of speeds with an invalid number.
    #[error("the preferred speed must be positive and its spread at least 0 (got {speed} m/s and {spread})")]
    Law {
        /// The preferred speed, m/s.
        speed: f64,
        /// The relative spread.
        spread: f64,
    },
    /// The start speed is negative, above a limit, or too large to brake in time.
    #[error("the start speed must be from 0 to {largest} m/s (got {speed} m/s)")]
    Start {
        /// The start speed, m/s.
        speed: f64,
        /// The largest speed that has a profile, m/s.
        largest: f64,
    },
    /// The end speed is negative, above a limit, or too large to be reached.
    #[error("the end speed must be from 0 to {largest} m/s (got {speed} m/s)")]
    End {
        /// The end speed, m/s.
        speed: f64,
        /// The largest speed that has a profile, m/s.
        largest: f64,
    },
    /// The end speeds have a fastest profile, but so close to it that none of straight pieces in u exists.
    #[error("the start and end speeds are too close to the limits for a varied profile")]
    Tight,
}

/// A stretch in terms of x and u = v^2.
#[derive(Clone, Copy, Debug)]
pub(super) struct Span {
    /// Where it begins, m.
    pub(super) start: f64,
    /// Where it ends, m.
    pub(super) end: f64,
    /// The u at which turning alone uses up the acceleration: across · radius, m^2/s^2; infinite on a line.
    pub(super) bend: f64,
    /// Largest u, m^2/s^2; 0 at a stop.
    pub(super) cap: f64,
}

impl Span {
    /// Its length, m.
    pub(super) fn length(&self) -> f64 {
        self.end - self.start
    }

    /// Whether it is a stop.
    pub(super) fn is_stop(&self) -> bool {
        self.cap == 0.0
    }
}

/// The spans of a path; an error names the invalid number.
pub(super) fn spans(stretches: &[Stretch], limits: Limits) -> Result<Vec<Span>, Infeasible> {
    let Limits { speed, along, across } = limits;
    if ![speed, along, across].iter().all(|limit| *limit > 0.0 && limit.is_finite()) {
        return Err(Infeasible::Limits);
    }
    let (top, mut start) = (speed * speed, 0.0);
    let mut spans = Vec::with_capacity(stretches.len());
    for (index, &Stretch { length, radius }) in stretches.iter().enumerate() {
        let is_stop = length == 0.0 && radius == 0.0;
        let (end, bend) = (start + length, across * radius);
        if !(is_stop || length >= 0.0 && end.is_finite() && bend > 0.0) {
            return Err(Infeasible::Stretch { index });
        }
        // An arc without length turns nowhere, so it limits nothing.
        let bend = if end > start { bend } else { f64::INFINITY };
        let cap = if is_stop { 0.0 } else { top.min(bend) };
        spans.push(Span { start, end, bend, cap });
        start = end;
    }
    Ok(spans)
}
