//! A number of a metric with a declared range: its mean, or the mean of its largest share.

use super::invalid::Invalid;
use super::spec::Range;
use super::{Intake, Interval, Mean, Tail};
use std::ops::Deref;

/// An estimator of one of the two.
#[derive(Clone, Debug, PartialEq)]
pub enum Bounded {
    /// The mean.
    Mean(Mean),
    /// The mean of the largest share.
    Tail(Tail),
}

impl Deref for Bounded {
    type Target = Intake;

    fn deref(&self) -> &Intake {
        match self {
            Self::Mean(mean) => mean,
            Self::Tail(tail) => tail,
        }
    }
}

impl Bounded {
    /// Of values in a range, or of their largest share, to half width `epsilon` in the same unit, error `delta`.
    pub fn within(range: Range, share: Option<f64>, epsilon: f64, delta: f64) -> Result<Self, Invalid> {
        Ok(match share {
            None => Self::Mean(Mean::within(range.0, range.1, epsilon, delta)?),
            Some(share) => Self::Tail(Tail::within(range, share, epsilon, delta)?),
        })
    }

    /// The same of a fixed number of trials.
    pub fn fixed(range: Range, share: Option<f64>, trials: u64, delta: f64) -> Result<Self, Invalid> {
        Ok(match share {
            None => Self::Mean(Mean::fixed(range.0, range.1, trials, delta)?),
            Some(share) => Self::Tail(Tail::fixed(range, share, trials, delta)?),
        })
    }

    /// The same of as many trials as somebody shows it: the interval holds at all times.
    pub fn running(range: Range, share: Option<f64>, delta: f64) -> Result<Self, Invalid> {
        Ok(match share {
            None => Self::Mean(Mean::running(range.0, range.1, delta)?),
            Some(share) => Self::Tail(Tail::running(range, share, delta)?),
        })
    }

    /// Reads the next value, `None` (or NaN) if it is unresolved; true once finished.
    pub fn observe(&mut self, value: Option<f64>) -> bool {
        match self {
            Self::Mean(mean) => mean.observe(value),
            Self::Tail(tail) => tail.observe(value),
        }
    }

    /// The interval where it is time to look at it.
    pub fn look(&mut self) -> Option<Interval> {
        match self {
            Self::Mean(mean) => Some(mean.interval()),
            Self::Tail(tail) => tail.look(),
        }
    }

    /// The interval.
    pub fn interval(&self) -> Interval {
        match self {
            Self::Mean(mean) => mean.interval(),
            Self::Tail(tail) => tail.interval(),
        }
    }

    /// The estimates of both readings of unresolved trials; the same without any.
    pub fn estimate(&self) -> (f64, f64) {
        match self {
            Self::Mean(mean) => mean.estimate(),
            Self::Tail(tail) => tail.estimate(),
        }
    }

    /// Whether how unresolved trials are read decides on which side of `theta` it is.
    pub fn splits(&self, theta: f64) -> bool {
        match self {
            Self::Mean(mean) => mean.splits(theta),
            Self::Tail(tail) => tail.splits(theta),
        }
    }

    /// The largest number of trials that follows from a width, for reports.
    pub fn numbers(&self) -> Option<(&'static str, f64)> {
        match self {
            Self::Mean(mean) => mean.numbers(),
            Self::Tail(_) => None,
        }
    }
}
