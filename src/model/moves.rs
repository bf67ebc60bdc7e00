//! Moves: what a helper may suggest to an agent.

use super::agent::{AgentId, Route};
use crate::base::tick::Tick;

/// The options of one agent.
#[derive(Clone, Debug, PartialEq)]
pub struct Moves {
    /// Whose.
    pub agent: AgentId,
    /// For how long a heading or a stop holds; then the route goes on.
    pub duration: Tick,
    /// The options.
    pub options: Vec<(String, Move)>,
    /// The routes that are options.
    pub routes: Vec<Route>,
}

impl Moves {
    /// How far each option departs from the direct way. With a route among them that is not known, and their order of
    /// writing stands for it.
    pub fn deviations(&self) -> Vec<f64> {
        let all = self.options.iter().enumerate();
        all.map(|(k, (_, option))| if self.routes.is_empty() { option.deviation() } else { k as f64 })
            .collect()
    }
}

/// One option.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Move {
    /// Walk in the direction of the next waypoint at the start, turned left by so many radians.
    Heading(f64),
    /// Driving velocity zero.
    Stop,
    /// Take this one of the routes instead of the own one, for good.
    Route(usize),
}

impl Move {
    /// How far it departs from the direct way, rad; a stop departs most, and of a route nobody knows.
    fn deviation(self) -> f64 {
        match self {
            Self::Heading(angle) => angle.abs(),
            Self::Stop | Self::Route(_) => f64::INFINITY,
        }
    }
}
