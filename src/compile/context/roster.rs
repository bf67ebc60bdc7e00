//! The agents of a world under compilation: their names, routes and starts, and who of them may be absent.

use crate::model::{AgentId, Scenario};
use crate::syntax::source::Span;
use std::collections::BTreeSet;
use std::sync::Arc;

/// The agents so far.
pub(crate) struct Roster {
    /// Their names.
    pub(crate) agent_names: Vec<String>,
    /// The presets from which kinds of people start.
    pub(crate) presets: BTreeSet<&'static str>,
    /// How many legs their routes have; of routes among moves, the most.
    pub(crate) legs: Vec<u32>,
    /// Where their starts are written.
    pub(crate) places: Places,
    /// The starts of agents, in a scenario with other errors.
    pub(crate) starts: Option<Starts>,
    /// Stand-ins for people whose declaration is wrong.
    pub(crate) undeclared: BTreeSet<AgentId>,
    /// Agents who come or leave during a trial.
    pub(crate) passing: BTreeSet<AgentId>,
    /// Whether agents can arrive during a trial.
    pub(crate) coming: bool,
    /// An earlier error makes the checks of start positions unreliable; skip them.
    pub(crate) any_start: bool,
    /// The agents with moves, and with paths (true); `None` if some of these have errors.
    pub(crate) advised: Option<BTreeSet<(AgentId, bool)>>,
}

impl Default for Roster {
    fn default() -> Self {
        Self {
            agent_names: Vec::new(),
            presets: BTreeSet::new(),
            legs: Vec::new(),
            places: Places::default(),
            starts: None,
            undeclared: BTreeSet::new(),
            passing: BTreeSet::new(),
            coming: false,
            any_start: false,
            advised: Some(BTreeSet::new()),
        }
    }
}

impl Roster {
    /// All agents of the scenario.
    pub(crate) fn everyone(&self) -> Arc<[AgentId]> {
        (0..self.agent_names.len() as u32).map(AgentId).collect()
    }
}

/// Where the start of a declaration is written, by the first of its people.
pub(crate) type Places = Vec<(AgentId, Span)>;

/// The place where the start of an agent is written.
pub(crate) fn written(places: &[(AgentId, Span)], agent: AgentId) -> Option<Span> {
    let after = places.partition_point(|(first, _)| *first <= agent);
    Some(places.get(after.checked_sub(1)?)?.1)
}

/// The people of a world and where they start.
#[derive(Clone, Debug)]
pub struct Starts {
    /// The scenario; where something in it is wrong, only its scene, its people and its sources.
    pub scenario: Arc<Scenario>,
    /// Where the starts of the people of each declaration are written, by the first of them; ascending.
    pub(crate) places: Vec<(AgentId, Span)>,
}

impl Starts {
    /// The place where the start of an agent is written.
    pub fn place_of(&self, agent: AgentId) -> Option<Span> {
        written(&self.places, agent)
    }
}
