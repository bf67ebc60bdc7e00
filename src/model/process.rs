//! Processes: variables that chance changes, by guarded commands.
//!
//! At a step every process with an enabled command fires one; all of them read the state before the step.
//! A process without an enabled command stutters. Commands with a rate or a delay fire at their own times.

use super::expression::{Bool, Num};
use super::index::VariableId;
use super::law::Law;
use super::outside::Outside;
use crate::base::decimal::Decimal;
use std::sync::Arc;

/// What a variable may hold. Truth values are kept as 0 and 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Domain {
    /// Whole numbers, ends included.
    Whole {
        /// Smallest.
        low: i64,
        /// Largest.
        high: i64,
    },
    /// A truth value.
    Truth,
    /// Any finite number, SI units.
    Real,
}

impl Domain {
    /// Whether it holds a value.
    pub fn contains(self, value: f64) -> bool {
        match self {
            Self::Whole { low, high } => value >= low as f64 && value <= high as f64 && value.fract() == 0.0,
            Self::Truth => value == 0.0 || value == 1.0,
            Self::Real => value.is_finite(),
        }
    }

    /// A value as it is kept: of what is whole there is one zero.
    pub fn kept(self, value: f64) -> f64 {
        match self {
            Self::Whole { .. } | Self::Truth => value + 0.0,
            Self::Real => value,
        }
    }

    /// Smallest value and number of values, where they are finitely many.
    pub fn values(self) -> Option<(f64, u64)> {
        match self {
            Self::Whole { low, high } => Some((low as f64, high.checked_sub(low)?.unsigned_abs() + 1)),
            Self::Truth => Some((0.0, 2)),
            Self::Real => None,
        }
    }
}

/// A variable.
#[derive(Clone, Debug, PartialEq)]
pub struct Variable {
    /// `die.s`, `sensor[2].works`
    pub name: String,
    /// Its domain.
    pub domain: Domain,
    /// Its value at the start.
    pub initial: f64,
}

/// When an enabled command fires.
#[derive(Clone, Debug, PartialEq)]
pub enum Timing {
    /// At the next step.
    Step,
    /// After an exponential time with this rate, 1/s.
    Rate(Num),
    /// After a drawn time since it became enabled, s; the times it can be, and what they are exactly, as far as they are few
    /// and not rounded.
    Delay(Law, Vec<(f64, Decimal)>),
}

/// The branches of a command.
#[derive(Clone, Debug, PartialEq)]
pub struct Branch {
    /// Its probability.
    pub weight: Num,
    /// New values, all computed from the state before.
    pub updates: Vec<(VariableId, Num)>,
}

/// A guarded command.
#[derive(Clone, Debug, PartialEq)]
pub struct Command {
    /// When it is enabled.
    pub guard: Bool,
    /// When it fires.
    pub timing: Timing,
    /// The branches; the probabilities sum to 1.
    pub branches: Vec<Branch>,
}

/// A process.
#[derive(Clone, Debug, PartialEq)]
pub struct Process {
    /// `die`, `sensor[2]`
    pub name: String,
    /// Stable number of 24 bits from the path of its declaration; addresses its random numbers.
    pub entity: u32,
    /// Its commands in order of writing.
    pub commands: Vec<Command>,
    /// Whether each of several enabled commands is as likely as the others. If not, two are an error.
    pub choose: bool,
}

/// All processes of a scenario.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Processes {
    /// Variables of all processes.
    pub variables: Vec<Variable>,
    /// The processes.
    pub list: Vec<Process>,
    /// The program elsewhere whose traces tell the variables and where people are, if one stands for the model.
    pub outside: Option<Arc<Outside>>,
}

/// How far the probabilities of a command may be from 1 together: what rounding can do.
pub const WEIGHT_SLACK: f64 = 1e-9;

/// The error of numbers as probabilities of all branches, if there is one.
pub fn wrong_weights(weights: &[f64]) -> Option<String> {
    if are_weights(weights.iter().copied()) {
        return None;
    }
    Some(if weights.iter().any(|w| *w < 0.0) {
        "a probability is negative".to_owned()
    } else {
        let sum: f64 = weights.iter().sum();
        // `0.1 + 0.2` is shown as 0.3; what is farther from 1 than the slack stays so.
        let shown = if sum < 1e3 { (sum * 1e12).round() / 1e12 } else { sum };
        format!("the probabilities must sum to 1 (got {shown})")
    })
}

/// Whether numbers are probabilities of all branches of a command.
pub fn are_weights(weights: impl IntoIterator<Item = f64>) -> bool {
    let mut sum = 0.0;
    for weight in weights {
        if weight.is_nan() || weight < 0.0 {
            return false;
        }
        sum += weight;
    }
    (sum - 1.0).abs() <= WEIGHT_SLACK
}
