//! Behaviours: automata that belong to agents and change their parameters while a state lasts.
//!
//! A behaviour is in one of its states. At a step it looks at the state of the trial before the step: the first
//! transition, in order of writing, whose condition holds there fires; else the one whose time has come. Parameters
//! that a state changes are computed from the agent's own values on entering it, so nothing ever compounds.

use super::agent::{AgentId, Route};
use super::expression::{Bool, Num};
use super::index::BehaviourId;
use super::law::Law;
use super::parameter::Parameter;
use std::sync::Arc;

/// All behaviours of a scenario.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Behaviours {
    /// Those declared.
    pub declared: Vec<Behaviour>,
    /// Those that agents have, by agent ascending, of one agent in order of `with`.
    pub attached: Vec<Attached>,
}

impl Behaviours {
    /// Whether a state of one that an agent has changes a parameter.
    pub fn change(&self, parameter: Parameter) -> bool {
        let modes = self.attached.iter().flat_map(|one| &one.conduct.states);
        modes.flat_map(|mode| &mode.changes).any(|(changed, _)| *changed == parameter)
    }
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

impl Behaviours {
    /// The behaviours of one agent.
    pub fn of(&self, agent: AgentId) -> &[Attached] {
        let from = self.attached.partition_point(|one| one.agent < agent);
        let to = self.attached.partition_point(|one| one.agent <= agent);
        &self.attached[from..to]
    }
}
