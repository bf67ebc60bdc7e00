//! What watches one column in continuous time, one trial at a time.

use super::cell::Reading;
use super::observer::wanted;
use super::subject::Subject;
use crate::base::instant::Instant;
use crate::compile::study::{Root, Sought};
use crate::logic::{self, Bounds, Invalid, SignalMonitor, SignalRobustness};

/// What watches one column.
#[derive(Clone)]
#[allow(clippy::large_enum_variant, reason = "there is one for each column of a worker and lane")]
pub(super) enum Onlooker {
    /// Of a formula or a metric.
    Plain(SignalMonitor),
    /// Of a robustness, as far as it is wanted.
    Robustness(SignalRobustness, Sought),
}

impl Onlooker {
    /// Of a column of a subject.
    pub(super) fn of(subject: &Subject, column: usize) -> Result<Self, Invalid> {
        Ok(match subject.columns[column] {
            Root::Robustness(_, sought) => Self::Robustness(subject.signal_robustness(column)?, sought),
            Root::Formula(_) | Root::Metric(_) => Self::Plain(subject.signal_monitor(column)?),
        })
    }

    /// A new trial begins.
    pub(super) fn start(&mut self) {
        match self {
            Self::Plain(monitor) => monitor.start(),
            Self::Robustness(robustness, _) => robustness.start(),
        }
    }

    /// From `time` on, s, these values hold; what is wanted, if the states before it force it.
    #[inline]
    pub(super) fn jump(
        &mut self,
        time: impl Into<Instant>,
        atoms: &[bool],
        signals: &[f64],
    ) -> Option<Reading> {
        match self {
            Self::Plain(monitor) => monitor.jump(time, atoms, signals).map(reading_of),
            Self::Robustness(robustness, sought) => {
                let bounds = robustness.jump(time, atoms, signals);
                known(bounds, robustness.is_overfull(), *sought)
            }
        }
    }

    /// The trial has reached its horizon.
    pub(super) fn finish(&mut self) -> Reading {
        match self {
            Self::Plain(monitor) => reading_of(monitor.finish()),
            Self::Robustness(robustness, sought) => {
                let bounds = robustness.finish();
                known(bounds, robustness.is_overfull(), *sought).unwrap_or(Reading::Unresolved)
            }
        }
    }

    /// Whether what is unresolved is so because the metric is no number.
    pub(super) fn is_no_number(&self) -> bool {
        match self {
            Self::Plain(monitor) => {
                matches!(monitor.reading(), Some(logic::Reading::Value(value)) if value.is_nan())
            }
            Self::Robustness(..) => false,
        }
    }

    /// The implications that the trial triggered, as bits.
    pub(super) fn triggered(&self) -> u64 {
        match self {
            Self::Plain(monitor) => monitor.triggered(),
            // Nobody asks: a robustness is no verdict.
            Self::Robustness(..) => u64::MAX,
        }
    }
}

fn known(bounds: Bounds, overfull: bool, sought: Sought) -> Option<Reading> {
    if overfull { Some(Reading::Unresolved) } else { wanted((bounds.lower, bounds.upper), sought) }
}

fn reading_of(reading: logic::Reading) -> Reading {
    match reading {
        logic::Reading::Truth(truth) => Reading::Truth(truth),
        logic::Reading::Value(value) if !value.is_nan() => Reading::Value(value),
        logic::Reading::Value(_) | logic::Reading::Unresolved => Reading::Unresolved,
    }
}
