//! Moves: what a helper may suggest to an agent.

use super::agent::AgentId;
use crate::base::tick::Tick;

/// The options of one agent.
#[derive(Clone, Debug, PartialEq)]
pub struct Moves {
    /// Whose.
    pub agent: AgentId,
    /// For how long an option holds; then the route goes on.
    pub duration: Tick,
    /// The options.
    pub options: Vec<(String, Move)>,
}

/// One option.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Move {
    /// Walk in the direction of the next waypoint at the start, turned left by so many radians.
    Heading(f64),
    /// Driving velocity zero.
    Stop,
}

impl Move {
    /// How far it departs from the direct way, rad; a stop departs most.
    pub fn deviation(self) -> f64 {
        match self {
            Self::Heading(angle) => angle.abs(),
            Self::Stop => f64::INFINITY,
        }
    }
}
