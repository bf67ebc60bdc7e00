//! One aim of several: whether one arm is worse than another in it, or less than epsilon better.
//!
//! Probabilities and means are compared by bets on the differences of paired trials. The mean of the largest share of a
//! metric is no mean of differences; there the intervals of the arms are compared, which hold jointly.

use super::{Booleans, Scores, Table};
use crate::base::math;
use crate::stats::invalid::Invalid;
use crate::stats::spec::Range;
use crate::stats::{Interval, Running};

/// What is aimed at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Goal {
    /// The probability of a formula.
    Probability,
    /// The mean of a metric in a range.
    Mean(Range),
    /// The mean of the largest share of a metric in a range.
    Tail(Range, f64),
}

impl Goal {
    /// The range of its values.
    pub const fn range(self) -> Range {
        match self {
            Self::Probability => (0.0, 1.0),
            Self::Mean(range) | Self::Tail(range, _) => range,
        }
    }

    /// A confidence sequence for it.
    pub fn running(self, delta: f64) -> Result<Running, Invalid> {
        match self {
            Self::Probability => Ok(Running::share(delta)),
            Self::Mean(range) => Running::number(range, None, delta),
            Self::Tail(range, share) => Running::number(range, Some(share), delta),
        }
    }
}

/// Arms in one aim.
#[derive(Clone, Debug)]
pub(super) enum Aim {
    Probability(Box<Booleans>),
    Mean(Scores, Range),
    Tail { arms: Vec<(Running, Interval)>, epsilon: f64 },
}

impl Aim {
    /// `epsilon` is in the unit of the aim. All intervals of arms miss with probability at most `delta` together.
    pub(super) fn new(goal: Goal, arms: usize, epsilon: f64, delta: f64) -> Result<Self, Invalid> {
        Ok(match goal {
            Goal::Probability => Self::Probability(Box::new(Booleans::new(arms, epsilon))),
            Goal::Mean(range) => Self::Mean(Scores::new(arms, epsilon / (range.1 - range.0)), range),
            Goal::Tail(..) => {
                let one = goal.running(delta / arms as f64)?;
                let none = one.interval();
                Self::Tail { arms: vec![(one, none); arms], epsilon }
            }
        })
    }

    /// Appends the next scores of an arm, `None` where they are unresolved.
    pub(super) fn push(&mut self, arm: usize, scores: &[Option<f64>]) {
        match self {
            Self::Probability(table) => table.push(arm, &Booleans::outcomes(scores, (0.0, 1.0))),
            Self::Mean(table, range) => table.push(arm, &Scores::outcomes(scores, *range)),
            Self::Tail { arms, .. } => {
                let (running, interval) = &mut arms[arm];
                running.observe_all(scores);
                *interval = running.interval();
            }
        }
    }

    /// Trials of an arm.
    pub(super) fn trials(&self, arm: usize) -> u64 {
        match self {
            Self::Probability(table) => table.trials(arm),
            Self::Mean(table, _) => table.trials(arm),
            Self::Tail { arms, .. } => arms[arm].0.trials(),
        }
    }

    /// The estimate of an arm, for its order among others.
    pub(super) fn estimate(&self, arm: usize) -> f64 {
        match self {
            Self::Probability(table) => table.mean(arm),
            Self::Mean(table, _) => table.mean(arm),
            Self::Tail { arms, .. } => arms[arm].0.estimate(),
        }
    }

    /// Whether `rival` is certainly worse than `leader`, and whether it is certainly less than epsilon better.
    pub(super) fn passes(&mut self, rival: usize, leader: usize, threshold: f64) -> (bool, bool) {
        match self {
            Self::Probability(table) => table.passes(rival, leader, threshold),
            Self::Mean(table, _) => table.passes(rival, leader, threshold),
            Self::Tail { arms, epsilon } => {
                let (high, low) = (arms[rival].1.high, arms[leader].1.low);
                (high < low, high <= low + *epsilon)
            }
        }
    }

    /// The smallest gap, in the unit of the aim, such that no rival is certainly that much better than `leader`.
    pub(super) fn gap(&mut self, rivals: &[usize], leader: usize, threshold: f64) -> f64 {
        match self {
            Self::Probability(table) => {
                super::gap::smallest(1.0, |gap| table.least_evidence(rivals, leader, gap) - threshold)
            }
            Self::Mean(table, (low, high)) => {
                (*high - *low)
                    * super::gap::smallest(1.0, |gap| table.least_evidence(rivals, leader, gap) - threshold)
            }
            Self::Tail { arms, .. } => {
                let best =
                    rivals.iter().map(|rival| arms[*rival].1.high).fold(f64::NEG_INFINITY, math::at_least);
                math::at_least(best - arms[leader].1.low, 0.0)
            }
        }
    }
}
