//! The trait by which a higher floor tells agents where to go, and which agents have which driver.

use super::situation::Situation;
use crate::kernel::plan::{Memory, Plan};
use crate::kernel::tape::Player;
use crate::model::{AgentId, Scenario};
use std::fmt::Debug;
use std::sync::Arc;

/// Tells agents where to go. What it answers may depend on nothing but what it was made from and the situation, so that a
/// trial stays a function of model, seed and index; random numbers come from `Stream::of(situation.key, situation.entity,
/// purpose)`.
pub trait Driver: Debug + Send + Sync {
    /// Where an agent goes from now on. What it puts into the memory is there when it is asked about the same person again.
    fn plan(&self, situation: &Situation<'_>, memory: &mut Memory) -> Plan;
}

/// The drivers of a run: which agents have which.
#[derive(Clone, Debug, Default)]
pub struct Drivers {
    seed: u64,
    list: Vec<Arc<dyn Driver>>,
    /// Index into the list for each agent up to the last one that has a driver.
    of: Vec<Option<u32>>,
    /// Who plays trials of a program elsewhere.
    player: Option<Arc<dyn Player>>,
}

impl Drivers {
    /// None for a run with this seed: all agents head straight for the goals of their routes.
    pub fn new(seed: u64) -> Self {
        Self { seed, ..Self::default() }
    }

    /// Gives some agents a driver.
    #[must_use]
    pub fn with(mut self, agents: impl IntoIterator<Item = AgentId>, driver: Arc<dyn Driver>) -> Self {
        let index = self.list.len() as u32;
        self.list.push(driver);
        for AgentId(agent) in agents {
            if self.of.len() <= agent as usize {
                self.of.resize(agent as usize + 1, None);
            }
            self.of[agent as usize] = Some(index);
        }
        self
    }

    /// Trials of a program elsewhere are played by this one.
    #[must_use]
    pub fn played_by(self, player: Arc<dyn Player>) -> Self {
        Self { player: Some(player), ..self }
    }

    /// Who plays trials of a program elsewhere, if anybody may.
    pub(super) fn player(&self) -> Option<&dyn Player> {
        self.player.as_deref()
    }

    /// Seed of the run.
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// Whether no agent has a driver.
    pub fn is_empty(&self) -> bool {
        self.of.is_empty()
    }

    /// The driver of an agent.
    pub(super) fn of(&self, agent: usize) -> Option<&dyn Driver> {
        let index = self.of.get(agent).copied().flatten()?;
        self.list.get(index as usize).map(AsRef::as_ref)
    }
}

/// Makes the drivers of a run, from a scenario and the seed of the run.
pub type MakeDrivers = dyn Fn(&Scenario, u64) -> Drivers + Sync;

/// None: all agents head straight for the goals of their routes.
pub fn straight(_: &Scenario, seed: u64) -> Drivers {
    Drivers::new(seed)
}
