//! Behaviours: automata that belong to agents and change their parameters while a state lasts.
//!
//! A behaviour is in one of its states. At a step it looks at the state of the trial before the step: the first
//! transition, in order of writing, whose condition holds there fires; else the one whose time has come. Parameters
//! that a state changes are computed from the agent's own values on entering it, so nothing ever compounds.

use super::agent::{AgentId, Route};
use super::expression::{Bool, Num};
use super::law::Law;
use std::sync::Arc;

/// Index of a declared behaviour.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct BehaviourId(pub u32);

/// All behaviours of a scenario.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Behaviours {
    /// Those declared.
    pub declared: Vec<Behaviour>,
    /// Those that agents have, by agent ascending, of one agent in order of `with`.
    pub attached: Vec<Attached>,
}

/// A declared behaviour.
#[derive(Clone, Debug, PartialEq)]
pub struct Behaviour {
    /// Its name.
    pub name: String,
    /// Names of its states; the first is the one at the start. May be empty.
    pub states: Vec<String>,
}

/// A behaviour of an agent.
#[derive(Clone, Debug, PartialEq)]
pub struct Attached {
    /// Whose.
    pub agent: AgentId,
    /// Which.
    pub behaviour: BehaviourId,
    /// Stable number of 24 bits from agent and behaviour; addresses its random numbers.
    pub entity: u32,
    /// Where the agent is a place of a source: the number for the n-th later person on it is n more than this one.
    pub later: u32,
    /// What it does, shared by the members of a declaration.
    pub conduct: Arc<Conduct>,
    /// The conditions of its transitions, about this agent.
    pub guards: Vec<Bool>,
}

/// What a behaviour does, with its arguments filled in.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Conduct {
    /// The states, in order of writing.
    pub states: Vec<Mode>,
    /// What is done about an advised move: probabilities and whether it is followed. Empty: it is followed.
    pub advice: Vec<(Num, bool)>,
}

/// A state of a behaviour.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mode {
    /// Parameters that it changes while it lasts.
    pub changes: Vec<(Parameter, Amount)>,
    /// Where the agent goes while it lasts, if elsewhere.
    pub route: Option<Route>,
    /// How it ends, in order of writing.
    pub transitions: Vec<Transition>,
}

/// The value of a changed parameter.
#[derive(Clone, Debug, PartialEq)]
pub enum Amount {
    /// Computed on entering the state. Its variables are those of the processes and, after them, the agent's
    /// own parameters in the order of [`Parameter::ALL`].
    Computed(Num),
    /// Drawn on entering the state.
    Drawn(Law),
}

/// How a state ends.
#[derive(Clone, Debug, PartialEq)]
pub struct Transition {
    /// When.
    pub trigger: Trigger,
    /// Probabilities, over variables of processes, and the states that follow. They sum to 1.
    pub targets: Vec<(Num, u32)>,
}

/// When a transition fires.
#[derive(Clone, Debug, PartialEq)]
pub enum Trigger {
    /// At the first state at or after a time drawn on entering, s.
    After(Law),
    /// When this one of the attached conditions holds.
    When(u32),
}

/// A parameter that a state of a behaviour may change.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Parameter {
    /// Driving speed, m/s.
    Speed,
    /// Relaxation time, s.
    Tau,
    /// Social force at touch, N.
    A,
    /// Its range, m.
    B,
    /// Weight of what is behind.
    Lambda,
    /// Second exponential term: force at touch, N.
    A2,
    /// Second exponential term: range, m.
    B2,
    /// Second exponential term: weight of what is behind.
    Lambda2,
    /// Standard deviation of each velocity component, m/s.
    Noise,
    /// Share of the social force that is felt, 0 to 1.
    Attention,
}

impl Parameter {
    /// All of them.
    pub const ALL: [Self; 10] = [
        Self::Speed,
        Self::Tau,
        Self::A,
        Self::B,
        Self::Lambda,
        Self::A2,
        Self::B2,
        Self::Lambda2,
        Self::Noise,
        Self::Attention,
    ];

    /// Its name in a scenario.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Speed => "speed",
            Self::Tau => "tau",
            Self::A => "A",
            Self::B => "B",
            Self::Lambda => "lambda",
            Self::A2 => "A2",
            Self::B2 => "B2",
            Self::Lambda2 => "lambda2",
            Self::Noise => "noise",
            Self::Attention => "attention",
        }
    }

    /// The parameter of a name.
    pub fn of(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|parameter| parameter.name() == name)
    }

    /// Whether someone can move with this value, SI units.
    pub fn allows(self, value: f64) -> bool {
        value.is_finite()
            && match self {
                Self::Tau | Self::B | Self::B2 => value > 0.0,
                Self::Lambda | Self::Lambda2 | Self::Attention => (0.0..=1.0).contains(&value),
                Self::Speed | Self::A | Self::A2 | Self::Noise => value >= 0.0,
            }
    }
}

impl Behaviours {
    /// The behaviours of one agent.
    pub fn of(&self, agent: AgentId) -> &[Attached] {
        let from = self.attached.partition_point(|one| one.agent < agent);
        let to = self.attached.partition_point(|one| one.agent <= agent);
        &self.attached[from..to]
    }
}
