//! A whole scenario.

use super::agent::{Agent, Group, Route};
use super::behaviour::Behaviours;
use super::door::Door;
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
    /// When doors are closed that open or close during a trial, in the order of `scene.doors`.
    pub doors: Vec<Door>,
}

/// Most agents whose moves are followed at once, and most options of each.
const MOST_TOGETHER: usize = 4;
const MOST_MOVES: usize = 1 << 12;

impl Scenario {
    /// All routes that somebody may take: own ones, those of behaviours, and those among moves.
    pub fn routes(&self) -> impl Iterator<Item = &Route> {
        let modes = self.behaviours.attached.iter().flat_map(|one| &one.conduct.states);
        let named = self.moves.iter().flat_map(|moves| &moves.routes);
        let own = self.agents.iter().map(|agent| &agent.route);
        own.chain(modes.filter_map(|mode| mode.route.as_ref())).chain(named)
    }

    /// The number of several moves at once, each with its declaration and option: a digit for each of them, the first the
    /// lowest. One alone is its own number; `None` if they are too many.
    pub fn together(&self, moves: &[(usize, usize)]) -> Option<(usize, usize)> {
        let base = self.moves.len() + 1;
        match moves {
            [one] => Some(*one),
            [] => None,
            all if all.len() > MOST_TOGETHER || all.iter().any(|(_, option)| *option >= MOST_MOVES) => None,
            all => Some(all.iter().rev().fold((0, 0), |number, (declaration, option)| {
                (number.0 * base + declaration + 1, number.1 * MOST_MOVES + option)
            }))
            .map(|(declarations, option)| (self.moves.len() + declarations, option)),
        }
    }

    /// The moves that a number stands for, each with its declaration and option; `None` if there are none.
    pub fn singles(
        &self,
        (declaration, option): (usize, usize),
    ) -> Option<[Option<(usize, usize)>; MOST_TOGETHER]> {
        let (all, base) = (self.moves.len(), self.moves.len() + 1);
        let known = |(at, option): (usize, usize)| {
            self.moves.get(at).filter(|moves| option < moves.options.len()).map(|_| (at, option))
        };
        let mut singles = [None; MOST_TOGETHER];
        if declaration < all {
            singles[0] = Some(known((declaration, option))?);
            return Some(singles);
        }
        let (mut declarations, mut options) = (declaration - all, option);
        for single in &mut singles {
            if declarations == 0 {
                break;
            }
            *single = Some(known(((declarations % base).checked_sub(1)?, options % MOST_MOVES))?);
            (declarations, options) = (declarations / base, options / MOST_MOVES);
        }
        (declarations == 0 && singles[1].is_some()).then_some(singles)
    }

    /// The name by which an option of a declaration of moves is chosen: its own, `stop`, or with whose it is, `user: stop`,
    /// where several people have one of that name; of several agents all, `a: stop and b: own way`.
    pub fn move_name(&self, advice: (usize, usize)) -> Option<String> {
        let singles = self.singles(advice)?;
        if singles[1].is_some() {
            let named = |(declaration, option): (usize, usize)| {
                let moves = &self.moves[declaration];
                Some(format!("{}: {}", moves.owner(&self.agents)?, moves.options[option].0))
            };
            let names: Option<Vec<String>> = singles.into_iter().flatten().map(named).collect();
            return Some(names?.join(" and "));
        }
        let (declaration, option) = advice;
        let moves = self.moves.get(declaration)?;
        let (label, _) = moves.options.get(option)?;
        let same =
            |(k, other): (usize, &Moves)| k != declaration && other.options.iter().any(|(l, _)| l == label);
        if !self.moves.iter().enumerate().any(same) {
            return Some(label.clone());
        }
        Some(format!("{}: {label}", moves.owner(&self.agents)?))
    }
}
