//! Monitors of one column: of a formula or a metric, or the robustness of a formula; for all lanes with steps, for one trial
//! in continuous time.

use super::cell::Reading;
use super::setup::Setup;
use crate::base::instant::Instant;
use crate::base::lanes::{LANES, Lanes, Mask};
use crate::kernel::Readings;
use crate::logic::{self, Bounds, Invalid, Monitor, Relation, Robustness, SignalMonitor, SignalRobustness};
use crate::logic::{Root, Sought};

/// A monitor of one column, for all lanes of a batch.
#[allow(clippy::large_enum_variant, reason = "there is one for each column of a worker")]
pub enum Observer {
    /// Of a formula.
    Formula(Monitor),
    /// Of a metric.
    Metric(Monitor),
    /// Of a robustness, as far as it is wanted.
    Robustness(Robustness, Sought),
}

impl Observer {
    /// What watches a column.
    pub fn of(setup: &Setup, column: usize) -> Result<Self, Invalid> {
        match setup.columns[column] {
            Root::Robustness(_, sought) => Ok(Self::Robustness(setup.robustness(column)?, sought)),
            Root::Formula(_) => Ok(Self::Formula(setup.monitor(column)?)),
            Root::Metric(_) => Ok(Self::Metric(setup.monitor(column)?)),
        }
    }

    /// A new trial begins in this lane.
    pub fn start(&mut self, lane: usize) {
        match self {
            Self::Formula(monitor) | Self::Metric(monitor) => monitor.start(lane),
            Self::Robustness(robustness, _) => robustness.start(lane),
        }
    }

    /// The next state of these lanes.
    #[inline]
    pub fn observe(&mut self, lanes: Mask, readings: &Readings) {
        match self {
            Self::Formula(monitor) | Self::Metric(monitor) => {
                monitor.observe(lanes, &readings.atoms, &readings.signals);
            }
            Self::Robustness(robustness, _) => robustness.observe(lanes, &[], &readings.signals),
        }
    }

    /// The lanes in which what is wanted is known.
    #[inline]
    pub fn decided(&self) -> Mask {
        match self {
            Self::Formula(monitor) | Self::Metric(monitor) => monitor.decided(),
            Self::Robustness(robustness, sought) => (0..LANES)
                .filter(|&lane| found(robustness, *sought, lane).is_some())
                .fold(Mask::NONE, |mut all, lane| {
                    all |= Mask::lane(lane);
                    all
                }),
        }
    }

    /// What a decided lane came to.
    pub fn reading(&self, lane: usize) -> Reading {
        match self {
            Self::Formula(monitor) => Reading::Truth(monitor.truth().has(lane)),
            Self::Metric(monitor) => {
                let value = monitor.value().0[lane];
                if value.is_nan() { Reading::Unresolved } else { Reading::Value(value) }
            }
            Self::Robustness(robustness, sought) => {
                found(robustness, *sought, lane).unwrap_or(Reading::Unresolved)
            }
        }
    }

    /// The implications that the trial of a lane triggered, as bits.
    pub fn triggered(&self, lane: usize) -> u64 {
        match self {
            Self::Formula(monitor) | Self::Metric(monitor) => {
                let bits = monitor.antecedents().enumerate().filter(|(_, a)| a.triggered.has(lane));
                bits.fold(0, |all, (k, _)| all | 1 << k.min(63))
            }
            // Nobody asks: a robustness is no verdict.
            Self::Robustness(..) => u64::MAX,
        }
    }
}

fn found(robustness: &Robustness, sought: Sought, lane: usize) -> Option<Reading> {
    let (lower, upper): (Lanes, Lanes) = (robustness.lower(), robustness.upper());
    wanted((lower.0[lane], upper.0[lane]), sought)
}

/// What is wanted of a robustness, where the bounds of its value force it.
fn wanted((lower, upper): (f64, f64), sought: Sought) -> Option<Reading> {
    if let Sought::Compared(relation, bound) = sought {
        let (sure, never) = match relation {
            Relation::Greater => (lower > bound, upper <= bound),
            Relation::AtLeast => (lower >= bound, upper < bound),
            Relation::Less => (upper < bound, lower >= bound),
            Relation::AtMost => (upper <= bound, lower > bound),
            // The compiler asks for none of these.
            Relation::Equal | Relation::Unequal => (false, false),
        };
        return (sure || never).then_some(Reading::Truth(sure));
    }
    if lower == upper {
        return Some(Reading::Value(lower));
    }
    match sought {
        // Just outside: how far does not matter, but that it is outside is counted.
        Sought::Clipped(low, _) if upper < low => Some(Reading::Value(low.next_down())),
        Sought::Clipped(_, high) if lower > high => Some(Reading::Value(high.next_up())),
        _ => None,
    }
}

/// A monitor of one column in continuous time, one trial at a time.
#[derive(Clone)]
#[allow(clippy::large_enum_variant, reason = "there is one for each column of a worker and lane")]
pub enum SignalObserver {
    /// Of a formula or a metric.
    Plain(SignalMonitor),
    /// Of a robustness, as far as it is wanted.
    Robustness(SignalRobustness, Sought),
}

impl SignalObserver {
    /// Of a column of a setup.
    pub fn of(setup: &Setup, column: usize) -> Result<Self, Invalid> {
        Ok(match setup.columns[column] {
            Root::Robustness(_, sought) => Self::Robustness(setup.signal_robustness(column)?, sought),
            Root::Formula(_) | Root::Metric(_) => Self::Plain(setup.signal_monitor(column)?),
        })
    }

    /// A new trial begins.
    pub fn start(&mut self) {
        match self {
            Self::Plain(monitor) => monitor.start(),
            Self::Robustness(robustness, _) => robustness.start(),
        }
    }

    /// From `time` on, s, these values hold; what is wanted, if the states before it force it.
    #[inline]
    pub fn jump(&mut self, time: impl Into<Instant>, atoms: &[bool], signals: &[f64]) -> Option<Reading> {
        match self {
            Self::Plain(monitor) => monitor.jump(time, atoms, signals).map(reading_of),
            Self::Robustness(robustness, sought) => {
                let bounds = robustness.jump(time, atoms, signals);
                known(bounds, robustness.is_overfull(), *sought)
            }
        }
    }

    /// The trial has reached its horizon.
    pub fn finish(&mut self) -> Reading {
        match self {
            Self::Plain(monitor) => reading_of(monitor.finish()),
            Self::Robustness(robustness, sought) => {
                let bounds = robustness.finish();
                known(bounds, robustness.is_overfull(), *sought).unwrap_or(Reading::Unresolved)
            }
        }
    }

    /// Whether what is unresolved is so because the metric is no number.
    pub fn is_no_number(&self) -> bool {
        match self {
            Self::Plain(monitor) => {
                matches!(monitor.reading(), Some(logic::Reading::Value(value)) if value.is_nan())
            }
            Self::Robustness(..) => false,
        }
    }

    /// The implications that the trial triggered, as bits.
    pub fn triggered(&self) -> u64 {
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
