//! A whole scenario.

use super::agent::{Agent, Group, Route};
use super::behaviour::Behaviours;
use super::moves::Moves;
use super::process::Processes;
use super::scene::Scene;
use super::source::Source;
use crate::base::tick::{Clock, Tick};

/// Everything the kernel needs to know to run a trial.
#[derive(Clone, Debug, PartialEq)]
pub struct Scenario {
    /// Its title.
    pub title: String,
    /// How time goes on.
    pub clock: Clock,
    /// Tick of the last state.
    pub horizon: Tick,
    /// Walls, obstacles, regions and points.
    pub scene: Scene,
    /// The agents.
    pub agents: Vec<Agent>,
    /// Groups whose members attract each other.
    pub groups: Vec<Group>,
    /// The moves, each with its agent.
    pub moves: Vec<Moves>,
    /// The processes.
    pub processes: Processes,
    /// Automata of agents.
    pub behaviours: Behaviours,
    /// Where people come in; their members are agents of the list above who are absent at first.
    pub sources: Vec<Source>,
}

impl Scenario {
    /// All routes that somebody may take: own ones, those of behaviours, and those among moves.
    pub fn routes(&self) -> impl Iterator<Item = &Route> {
        let modes = self.behaviours.attached.iter().flat_map(|one| &one.conduct.states);
        let named = self.moves.iter().flat_map(|moves| &moves.routes);
        let own = self.agents.iter().map(|agent| &agent.route);
        own.chain(modes.filter_map(|mode| mode.route.as_ref())).chain(named)
    }

    /// The name by which an option of a declaration of moves is chosen: its own, `stop`, or with whose it is, `user: stop`,
    /// where several people have one of that name.
    pub fn move_name(&self, (declaration, option): (usize, usize)) -> Option<String> {
        let moves = self.moves.get(declaration)?;
        let (label, _) = moves.options.get(option)?;
        let same =
            |(k, other): (usize, &Moves)| k != declaration && other.options.iter().any(|(l, _)| l == label);
        if !self.moves.iter().enumerate().any(same) {
            return Some(label.clone());
        }
        Some(format!("{}: {label}", self.agents.get(moves.agent.0 as usize)?.name))
    }
}
