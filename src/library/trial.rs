//! A trial, state by state.

use crate::base::geometry::Vec2;
use crate::base::tick::{Clock, Tick};
use crate::kernel::{Address, End, Program, Run, Slot, State, start};
use crate::model::{AgentId, Parameter, Scenario};
use std::sync::Arc;

/// A trial under way: an iterator over its states from the first one to the horizon, or to where it ended.
#[derive(Debug)]
pub struct Trial {
    run: Run<'static>,
    scenario: Arc<Scenario>,
    begun: bool,
    end: Option<End>,
}

impl Trial {
    pub(super) fn new(program: Program, address: Address<'_>) -> Result<Self, start::Fault> {
        let scenario = program.scenario.clone();
        let (run, _) = Run::owned(program, address)?;
        Ok(Self { run, scenario, begun: false, end: None })
    }

    /// Goes to the next state, at first to the one at the start, and gives it as the kernel keeps it; `None` where the trial has
    /// ended.
    pub fn next_state(&mut self) -> Option<&State> {
        if self.end.is_some() {
            return None;
        }
        if std::mem::replace(&mut self.begun, true)
            && let Err(end) = self.run.next_state()
        {
            self.end = Some(end);
            return None;
        }
        Some(self.run.state())
    }

    /// Why the trial ended; `None` while it goes on.
    pub fn end(&self) -> Option<End> {
        self.end
    }

    fn snapshot(&self) -> Snapshot {
        let state = self.run.state();
        let slots = (0..self.scenario.agents.len()).map(|agent| (agent, state.slot(agent, 0)));
        let present = slots.filter(|(_, slot)| state.is_present(*slot));
        let body = |(agent, slot): (usize, Slot)| AgentState {
            name: state.name_of(&self.scenario, AgentId(agent as u32), 0),
            position: state.position(slot),
            velocity: state.velocity(slot),
            radius: slot.of(&state.bodies[Parameter::Radius]),
        };
        let variables = self.scenario.processes.variables.iter().zip(&state.variables);
        Snapshot {
            time: time(&self.scenario, state),
            agents: present.map(body).collect(),
            variables: variables.map(|(variable, lanes)| (variable.name.clone(), lanes.0[0])).collect(),
        }
    }
}

/// Seconds since the start of a trial; steps where steps have no length.
fn time(scenario: &Scenario, state: &State) -> f64 {
    match scenario.clock {
        Clock::Jumps(_) => state.clocks.now[0],
        clock => clock.seconds(Tick(state.ticks[0])),
    }
}

impl Iterator for Trial {
    type Item = Snapshot;

    fn next(&mut self) -> Option<Snapshot> {
        self.next_state()?;
        Some(self.snapshot())
    }
}

/// A state of a trial.
#[derive(Clone, Debug, PartialEq)]
pub struct Snapshot {
    /// Since the start of the trial, s; steps where steps have no length.
    pub time: f64,
    /// The agents that are present, in the order of their declarations.
    pub agents: Vec<AgentState>,
    /// Variables of processes by name, as `sensor.failed`; a truth value is 0 or 1.
    pub variables: Vec<(String, f64)>,
}

/// Where an agent is and how it moves.
#[derive(Clone, Debug, PartialEq)]
pub struct AgentState {
    /// Its name, as `crowd[3]`.
    pub name: String,
    /// Position of its centre, m.
    pub position: Vec2,
    /// Velocity, m/s.
    pub velocity: Vec2,
    /// Radius of its body, m.
    pub radius: f64,
}

impl Snapshot {
    /// The agent of a name, where it is present.
    pub fn agent(&self, name: &str) -> Option<&AgentState> {
        self.agents.iter().find(|agent| agent.name == name)
    }

    /// The value of a variable, where a process has it; a truth value is 0 or 1.
    pub fn variable(&self, name: &str) -> Option<f64> {
        self.variables.iter().find(|(known, _)| known == name).map(|(_, value)| *value)
    }
}
