//! What watches one column: a monitor of a formula or a metric, or the robustness of a formula.

use super::cell::Reading;
use crate::base::lanes::{LANES, Lanes, Mask};
use crate::compile::study::Sought;
use crate::kernel::Readings;
use crate::logic::{Monitor, Relation, Robustness};

/// What watches one column.
#[allow(clippy::large_enum_variant, reason = "there is one for each column of a worker")]
pub(super) enum Observer {
    /// Of a formula.
    Formula(Monitor),
    /// Of a metric.
    Metric(Monitor),
    /// Of a robustness, as far as it is wanted.
    Robustness(Robustness, Sought),
}

impl Observer {
    /// A new trial begins in this lane.
    pub(super) fn start(&mut self, lane: usize) {
        match self {
            Self::Formula(monitor) | Self::Metric(monitor) => monitor.start(lane),
            Self::Robustness(robustness, _) => robustness.start(lane),
        }
    }

    /// The next state of these lanes.
    #[inline]
    pub(super) fn observe(&mut self, lanes: Mask, readings: &Readings) {
        match self {
            Self::Formula(monitor) | Self::Metric(monitor) => {
                monitor.observe(lanes, &readings.atoms, &readings.signals);
            }
            Self::Robustness(robustness, _) => robustness.observe(lanes, &[], &readings.signals),
        }
    }

    /// The lanes in which what is wanted is known.
    #[inline]
    pub(super) fn decided(&self) -> Mask {
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
    pub(super) fn reading(&self, lane: usize) -> Reading {
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
    pub(super) fn triggered(&self, lane: usize) -> u64 {
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
pub(super) fn wanted((lower, upper): (f64, f64), sought: Sought) -> Option<Reading> {
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
