//! Expressions after names, units and types are settled.

use crate::base::geometry::Vec2;
use crate::compile::context::{number::Number, parts::Part};
use crate::compile::dimension::{Dimension, describe};
use crate::logic::{NodeId, TermId};
use crate::model::{BarrierId, BehaviourId, Bool, LineId, Num, RegionId, Set, Who};
use std::sync::Arc;

/// The type of an expression, with its value as far as it is known.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Typed {
    /// A number known now.
    Number(Number),
    /// `∞`
    Infinity,
    /// A text.
    Text(String),
    /// A point or vector known now.
    Point(Number, Number),
    /// A number of a state.
    Num(Num, Dimension),
    /// A vector of a state.
    Vector(Num, Num, Dimension),
    /// A truth value of a state, and how it was written where a witness may speak of it.
    Truth(Bool, Option<Arc<Part>>),
    /// One agent.
    Agent(Who),
    /// A set of agents.
    Agents {
        /// The set.
        set: Set,
        /// Whether one body stands for all.
        particle: bool,
    },
    /// One process.
    Process {
        /// Which declaration.
        process: u32,
        /// Which copy, from 0.
        copy: u32,
    },
    /// All copies of a process.
    Processes(u32),
    /// The state of a behaviour of an agent, to be compared.
    Mode {
        /// Which behaviour.
        behaviour: BehaviourId,
        /// Whose.
        who: Who,
    },
    /// A region.
    Region(RegionId),
    /// A wall or obstacle.
    Barrier(BarrierId),
    /// A measurement line.
    Line(LineId),
    /// A formula over states.
    Formula(NodeId),
    /// A number of the states from the present one on.
    Term(TermId, Dimension),
    /// How many of some formulas over states hold.
    Tally(Vec<NodeId>),
}

impl Typed {
    /// A place, m.
    pub(crate) fn point(p: Vec2) -> Self {
        Self::Point(Number::rounded(p.x, Dimension::LENGTH), Number::rounded(p.y, Dimension::LENGTH))
    }

    /// A truth value of a state.
    pub(crate) const fn truth(truth: Bool) -> Self {
        Self::Truth(truth, None)
    }

    /// How a truth value was written.
    pub(crate) fn phrase(&self) -> Option<Arc<Part>> {
        if let Self::Truth(_, phrase) = self { phrase.clone() } else { None }
    }

    /// The same, and what has it no more.
    pub(crate) fn take_phrase(&mut self) -> Option<Arc<Part>> {
        if let Self::Truth(_, phrase) = self { phrase.take() } else { None }
    }

    /// Its name in messages.
    pub(crate) fn noun(&self) -> String {
        match self {
            Self::Number(n) => describe(n.dimension),
            Self::Num(_, dimension) | Self::Term(_, dimension) => describe(*dimension),
            Self::Infinity => "infinity".to_owned(),
            Self::Text(_) => "a text".to_owned(),
            Self::Point(..) => "a point".to_owned(),
            Self::Vector(..) => "a vector".to_owned(),
            Self::Truth(..) => "a condition".to_owned(),
            Self::Agent(_) => "an agent".to_owned(),
            Self::Agents { .. } => "a set of agents".to_owned(),
            Self::Process { .. } => "a process".to_owned(),
            Self::Processes(_) => "an array of processes".to_owned(),
            Self::Mode { .. } => "a behaviour, whose state is compared: `user.phone == looking`".to_owned(),
            Self::Region(_) => "a region".to_owned(),
            Self::Barrier(_) => "a wall or obstacle".to_owned(),
            Self::Line(_) => "a line".to_owned(),
            Self::Formula(_) => "a temporal formula".to_owned(),
            Self::Tally(_) => "a count of temporal formulas".to_owned(),
        }
    }
}

/// Truth values of variables are 0 and 1.
pub(crate) fn as_number(truth: Bool) -> Num {
    match truth {
        Bool::Constant(value) => Num::Constant(f64::from(value)),
        truth => Num::If(Box::new(truth), Box::new(Num::Constant(1.0)), Box::new(Num::Constant(0.0))),
    }
}
