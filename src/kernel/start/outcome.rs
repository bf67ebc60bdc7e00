//! What loading a trial found, and why a trial cannot begin.

use crate::kernel::parameters::Impossible;
use crate::model::{AgentId, BarrierId};
use std::sync::Arc;

/// What loading a trial found worth counting.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Loaded {
    /// Bodies that overlapped something at the start and whose radii were shrunk to touch it.
    pub shrunk: Vec<Shrunk>,
    /// Bodies that found no free place by chance and were pushed apart.
    pub pushed: u32,
}

/// A body that was made smaller at the start of a trial.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shrunk {
    /// Whose body.
    pub agent: AgentId,
    /// What it overlapped.
    pub at: Overlapped,
    /// Its radius before, m.
    pub from: f64,
    /// Its radius after, m.
    pub to: f64,
}

/// What a body overlapped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Overlapped {
    /// The body of another agent, which was made smaller by the same factor.
    Agent(AgentId),
    /// A wall or an obstacle.
    Barrier(BarrierId),
}

/// Why a trial cannot begin.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Fault {
    /// A parameter has a value with which nobody can move.
    #[error("parameter `{name}` of agent {} is {value}", agent.0)]
    Parameter {
        /// Whose.
        agent: AgentId,
        /// Which.
        name: &'static str,
        /// Its value, SI units.
        value: f64,
    },
    /// A start that is no point of the plane.
    #[error("agent {} has no place to start", agent.0)]
    Nowhere {
        /// Whose.
        agent: AgentId,
    },
    /// An agent is to start near one that is placed after it.
    #[error("agent {} starts near an agent that is placed after it", agent.0)]
    Order {
        /// Whose start it is.
        agent: AgentId,
    },
    /// By chance somebody is placed in an obstacle or on a wall, out of which nothing could push them.
    #[error("agent {} is placed in an obstacle or on a wall", agent.0)]
    Inside {
        /// Whom.
        agent: AgentId,
    },
    /// By chance somebody is pushed farther from another than they may start, with a wall on the way back.
    #[error("agent {} starts too far from another", agent.0)]
    Far {
        /// Whom.
        agent: AgentId,
    },
    /// Two are placed at one point.
    #[error("agents {} and {} are placed at one point", agents.0.0, agents.1.0)]
    Together {
        /// Whom.
        agents: (AgentId, AgentId),
    },
    /// There is no such option.
    #[error("there is no option {option} in declaration {declaration} of moves")]
    Advice {
        /// Which declaration of moves.
        declaration: usize,
        /// Which of its options.
        option: usize,
    },
    /// A program elsewhere has run no trial to its end.
    #[error("{0}")]
    Program(Arc<str>),
}

impl From<Impossible> for Fault {
    fn from(Impossible { agent, parameter, value }: Impossible) -> Self {
        Self::Parameter { agent, name: parameter.name(), value }
    }
}
