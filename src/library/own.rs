//! Drivers that somebody outside gives to some agents of a model; all others keep theirs.

use super::diagnostics::Diagnostics;
use super::model::Model;
use crate::compile::study::Query;
use crate::kernel::driver::{Driver, Drivers};
use crate::model::{AgentId, Scenario};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::Diagnostic;
use std::sync::Arc;

/// Drivers with the names of the agents that have them; no name stands for all agents.
#[derive(Clone, Debug, Default)]
pub(super) struct OwnDrivers(Vec<(Option<String>, Arc<dyn Driver>)>);

impl OwnDrivers {
    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Puts them in the place of others.
    pub(super) fn join(&self, drivers: Drivers, scenario: &Scenario) -> Drivers {
        self.0.iter().fold(drivers, |all, (name, driver)| {
            all.with(named(scenario, name.as_deref()), Arc::clone(driver))
        })
    }

    /// Queries learn that their results are conditional on them.
    pub(super) fn condition(&self, queries: &mut [Query]) {
        let names: Vec<&str> =
            self.0.iter().map(|(name, _)| name.as_deref().unwrap_or("all agents")).collect();
        if names.is_empty() {
            return;
        }
        let own = format!("the given drivers of {}, if they decide by the situation alone", names.join(", "));
        for query in queries {
            query.given = Some(query.given.iter().chain([&own]).cloned().collect::<Vec<_>>().join("; "));
        }
    }
}

/// The agents of a name: one, or those of a list of agents.
fn named(scenario: &Scenario, name: Option<&str>) -> Vec<AgentId> {
    let is_named = |own: &str| {
        name.is_none_or(|name| {
            own.strip_prefix(name).is_some_and(|rest| rest.is_empty() || rest.starts_with('['))
        })
    };
    let all = (0..).map(AgentId).zip(&scenario.agents);
    all.filter(|(_, agent)| is_named(&agent.name)).map(|(id, _)| id).collect()
}

impl Model {
    /// Gives an agent, the agents of a list, or all agents a driver; those of other names keep theirs. One trial in a hundred
    /// of a check runs twice, and results are conditional on the driver.
    ///
    /// # Errors
    /// Where there is no such agent, or it moves by plans, steps or a program; in continuous time, and where the scene has levels.
    pub fn with_driver(mut self, name: Option<&str>, driver: Arc<dyn Driver>) -> Result<Self, Diagnostics> {
        self.drivable(name)?;
        self.own.0.push((name.map(str::to_owned), driver));
        Ok(self)
    }

    /// The agents of a name, if somebody outside may drive them.
    pub(super) fn drivable(&self, name: Option<&str>) -> Result<Vec<AgentId>, Diagnostics> {
        let scenario = self.scenario();
        let found = named(scenario, name);
        if found.is_empty() {
            let names: Vec<&str> = scenario.agents.iter().take(8).map(|one| one.name.as_str()).collect();
            let hint = match names.as_slice() {
                [] => "the scenario has no agents".to_owned(),
                names => format!("the agents are {}", names.join(", ")),
            };
            return refuse(format!("there is no agent `{}`", name.unwrap_or("all")), hint);
        }
        let is_led = |id: &&AgentId| {
            let body = &scenario.agents[id.0 as usize].body;
            body.planner.is_some() || body.stepper.is_some()
        };
        if !scenario.scene.storeys.are_none() {
            return refuse(
                "drivers from outside know no levels".to_owned(),
                "drive agents in a scene without levels".to_owned(),
            );
        }
        if let Some(program) = &scenario.processes.outside {
            let said = format!("the program `{}` moves everybody, so nobody can be driven", program.name);
            return refuse(said, "drive agents in a scenario without a program".to_owned());
        }
        let led = if scenario.clock.is_jumps() { found.first() } else { found.iter().find(is_led) };
        if let Some(AgentId(id)) = led {
            let said = format!(
                "`{}` follows plans of its own, and cannot be driven",
                scenario.agents[*id as usize].name
            );
            return refuse(said, "declare it as `sfm` or `cfs`, in a scenario with a step".to_owned());
        }
        Ok(found)
    }
}

/// A call that cannot be done.
pub(super) fn refuse<T>(said: String, hint: String) -> Result<T, Diagnostics> {
    Err(Diagnostics::new(vec![Diagnostic::placeless(Code::E0705, said).hint(hint)], Vec::new()))
}
