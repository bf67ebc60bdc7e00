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

    /// The number of two moves of two agents at once: pairs of declarations are numbered behind the single ones, and pairs of
    /// options row by row.
    pub fn both(&self, first: (usize, usize), second: (usize, usize)) -> Option<(usize, usize)> {
        let count = self.moves.get(second.0)?.options.len();
        Some((self.moves.len() * (1 + first.0) + second.0, first.1 * count + second.1))
    }

    /// The moves, one or two, that a number stands for, each with its declaration and option; `None` if there are none.
    pub fn singles(&self, (declaration, option): (usize, usize)) -> Option<[Option<(usize, usize)>; 2]> {
        let all = self.moves.len();
        let known = |(at, option): (usize, usize)| {
            self.moves.get(at).filter(|moves| option < moves.options.len()).map(|_| (at, option))
        };
        if declaration < all {
            return Some([Some(known((declaration, option))?), None]);
        }
        let (first, second) = ((declaration - all).checked_div(all)?, (declaration - all) % all);
        let count = self.moves.get(second)?.options.len().max(1);
        Some([Some(known((first, option / count))?), Some(known((second, option % count))?)])
    }

    /// The name by which an option of a declaration of moves is chosen: its own, `stop`, or with whose it is, `user: stop`,
    /// where several people have one of that name; of two agents both, `a: stop and b: own way`.
    pub fn move_name(&self, advice: (usize, usize)) -> Option<String> {
        if let [Some(first), Some(second)] = self.singles(advice)? {
            let named = |(declaration, option): (usize, usize)| {
                let moves = &self.moves[declaration];
                Some(format!(
                    "{}: {}",
                    self.agents.get(moves.agent.0 as usize)?.name,
                    moves.options[option].0
                ))
            };
            return Some(format!("{} and {}", named(first)?, named(second)?));
        }
        let (declaration, option) = advice;
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
