//! Moves: what a helper may suggest to an agent.

use super::agent::{Agent, AgentId, Route};
use crate::base::tick::Tick;

/// The options of one agent.
#[derive(Clone, Debug, PartialEq)]
pub struct Moves {
    /// Whose; of a group its first member.
    pub agent: AgentId,
    /// The other members of a group, who all take the same option.
    pub others: Vec<AgentId>,
    /// For how long a heading or a stop holds; then the route goes on.
    pub duration: Tick,
    /// The options.
    pub options: Vec<(String, Move)>,
    /// The routes that are options.
    pub routes: Vec<Route>,
    /// Where the options are paths on a roadmap, how much longer than the shortest each is, m; known when the roadmap is.
    pub paths: Option<Vec<f64>>,
}

impl Moves {
    /// Everybody who takes an option.
    pub fn agents(&self) -> impl Iterator<Item = AgentId> {
        std::iter::once(self.agent).chain(self.others.iter().copied())
    }

    /// The name of the one whose they are, or of the group: `party` of `party[1]`.
    pub fn owner<'n>(&self, agents: &'n [Agent]) -> Option<&'n str> {
        let name = agents.get(self.agent.0 as usize)?.name.as_str();
        Some(if self.others.is_empty() { name } else { name.split('[').next().unwrap_or(name) })
    }

    /// Whose they are and whether they are paths, and in a word what they are.
    pub fn key(&self) -> ((AgentId, bool), &'static str) {
        let what = if self.paths.is_some() { "paths" } else { "moves" };
        ((self.agent, self.paths.is_some()), what)
    }

    /// How far each option departs from the direct way. With a route among them that is not known, and their order of
    /// writing stands for it.
    pub fn deviations(&self) -> Vec<f64> {
        if let Some(lengths) = &self.paths {
            let known = |k| lengths.get(k).copied().unwrap_or(k as f64);
            return (0..self.options.len()).map(known).collect();
        }
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
    /// No advice: the agent goes on as it would.
    Own,
    /// Take this one of the routes instead of the own one, for good.
    Route(usize),
    /// Take the path of this class on the roadmap.
    Path(u32),
}

impl Move {
    /// How far it departs from the direct way, rad; a stop departs most, and of a route or path nobody knows.
    fn deviation(self) -> f64 {
        match self {
            Self::Own => 0.0,
            Self::Heading(angle) => angle.abs(),
            Self::Stop | Self::Route(_) | Self::Path(_) => f64::INFINITY,
        }
    }
}
