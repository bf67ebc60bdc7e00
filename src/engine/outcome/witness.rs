//! Trials that show why a result is as it is.

use crate::engine::witness::decider::Decider;

/// What a witness is one of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Shows {
    /// The first trial in which the formula fails, or in which the metric lies on the failing side.
    Fails,
    /// The first trial in which the formula holds, or in which the metric lies on the passing side.
    Holds,
    /// The trial with the smallest value of the metric, the first of several.
    Lowest,
    /// The trial with the largest value of the metric, the first of several.
    Highest,
}

impl Shows {
    /// Its word.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Fails => "fails",
            Self::Holds => "holds",
            Self::Lowest => "lowest",
            Self::Highest => "highest",
        }
    }
}

/// A trial that shows why.
#[derive(Clone, Debug, PartialEq)]
pub struct Witness {
    /// What it is one of.
    pub shows: Shows,
    /// Index of the trial.
    pub trial: u64,
    /// Value of the metric, SI; `None` of a formula.
    pub value: Option<f64>,
    /// When the formula was decided, or the metric got its value.
    pub time: f64,
    /// Unit of the time: `s`, or `steps` where steps have no length.
    pub unit: &'static str,
    /// The atom or number that decided it, with its agents.
    pub what: String,
    /// The agent that decided it, with the number that was compared.
    pub decider: Option<Decider>,
    /// The agents that `what` names.
    pub agents: Vec<String>,
    /// Command that shows the trial.
    pub command: String,
}
