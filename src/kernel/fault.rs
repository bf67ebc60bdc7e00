//! Errors of a model that show only while it runs.

use crate::base::lanes::{LANES, Mask};
use crate::model::{AgentId, Domain, Parameter, Processes, Scenario};

/// What a process did that it must not do. The numbers are those of the process, command or variable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fault {
    /// Two commands are enabled and nothing says which one fires.
    Ambiguous {
        /// The process.
        process: u32,
        /// The first two.
        commands: (u32, u32),
    },
    /// The probabilities of a command are negative or do not sum to 1.
    Weights {
        /// The process.
        process: u32,
        /// Its command.
        command: u32,
    },
    /// A variable would leave its range.
    Range {
        /// The variable.
        variable: u32,
        /// The value that it cannot hold.
        value: f64,
    },
    /// A rate is negative or not finite.
    Rate {
        /// The process.
        process: u32,
        /// Its command.
        command: u32,
        /// The rate, 1/s.
        value: f64,
    },
    /// Time does not go on: jump follows jump at one time.
    Stuck {
        /// The process that jumped last.
        process: u32,
    },
    /// The probabilities of a transition of a behaviour are negative or do not sum to 1.
    Branches {
        /// Which of the behaviours that agents have.
        attached: u32,
    },
    /// A state of a behaviour gives its agent a parameter with which nobody can move.
    Change {
        /// Which of the behaviours that agents have.
        attached: u32,
        /// Which parameter.
        parameter: Parameter,
        /// Its value, SI units.
        value: f64,
    },
    /// A program elsewhere gives something else when it runs again.
    Unrepeated,
    /// A driver answers otherwise when it is asked again.
    Unsteady {
        /// The agent that it drives.
        agent: AgentId,
    },
    /// A program elsewhere cannot be started.
    Unstarted {
        /// What the system says.
        why: std::io::ErrorKind,
    },
}

/// The first error of each lane in one step.
#[derive(Clone, Debug, Default)]
pub(in crate::kernel) struct Faults {
    lanes: Mask,
    first: [Option<Fault>; LANES],
}

impl Faults {
    /// None so far.
    pub(in crate::kernel) fn clear(&mut self) {
        self.lanes = Mask::NONE;
    }

    /// Another error; only the first of a lane is kept.
    pub(in crate::kernel) fn add(&mut self, lane: usize, fault: Fault) {
        if !self.lanes.has(lane) {
            self.lanes |= Mask::lane(lane);
            self.first[lane] = Some(fault);
        }
    }

    /// Lanes with an error.
    pub(in crate::kernel) fn lanes(&self) -> Mask {
        self.lanes
    }

    /// The error of a lane that has one.
    pub(in crate::kernel) fn of(&self, lane: usize) -> Option<Fault> {
        self.first[lane].filter(|_| self.lanes.has(lane))
    }
}

impl Fault {
    /// What is wrong, in words.
    pub fn describe(&self, scenario: &Scenario) -> String {
        let processes = &scenario.processes;
        let whose = |attached: u32| {
            let Some(one) = scenario.behaviours.attached.get(attached as usize) else { return String::new() };
            let agent = scenario.agents.get(one.agent.0 as usize).map_or("", |agent| agent.name.as_str());
            let name =
                scenario.behaviours.declared.get(one.behaviour.0 as usize).map_or("", |b| b.name.as_str());
            format!("`{name}` of {agent}")
        };
        let name = |process: u32| processes.list.get(process as usize).map_or("", |p| p.name.as_str());
        match *self {
            Self::Ambiguous { process, commands: (a, b) } => format!(
                "commands {} and {} of `{}` are both enabled, and the process has no `choose`",
                a + 1,
                b + 1,
                name(process)
            ),
            Self::Weights { process, command } => format!(
                "the probabilities of command {} of `{}` are negative or do not sum to 1",
                command + 1,
                name(process)
            ),
            Self::Rate { process, command, value } => format!(
                "the rate of command {} of `{}` must be finite and not negative (got {value} /s)",
                command + 1,
                name(process)
            ),
            Self::Stuck { process } => {
                format!("more than 100000 jumps at one time, the last one of `{}`", name(process))
            }
            Self::Branches { attached } => {
                format!(
                    "the probabilities of a transition of {} are negative or do not sum to 1",
                    whose(attached)
                )
            }
            Self::Change { attached, parameter, value } => {
                format!("{} sets `{}` to {value}, which is invalid", whose(attached), parameter.name())
            }
            Self::Unrepeated => {
                "the program gave another trace when it ran again with the same words".to_owned()
            }
            Self::Unsteady { agent } => {
                let name = scenario.agents.get(agent.0 as usize).map_or("", |agent| agent.name.as_str());
                format!("the driver of `{name}` gave another answer when the trial ran again")
            }
            Self::Unstarted { why } => {
                let call = processes.outside.as_ref().map_or(String::new(), |outside| outside.told());
                let program = call.split(' ').next().unwrap_or_default();
                format!("`{program}` cannot be started: {why}")
            }
            Self::Range { variable, value } => {
                let Some(variable) = processes.variables.get(variable as usize) else { return String::new() };
                let range = match variable.domain {
                    Domain::Whole { low, high } => format!("whole numbers from {low} to {high}"),
                    Domain::Truth => "truth values".to_owned(),
                    Domain::Real => "finite numbers".to_owned(),
                };
                format!("`{}` would become {value}, but its values are {range}", variable.name)
            }
        }
    }

    /// Values of variables, in words: `die.s = 1, die.d = 0`.
    pub fn state(processes: &Processes, value: impl Fn(usize) -> f64) -> String {
        /// As many as one can read.
        const SHOWN: usize = 12;
        let mut words: Vec<String> = processes
            .variables
            .iter()
            .enumerate()
            .take(SHOWN)
            .map(|(k, variable)| match variable.domain {
                Domain::Truth => format!("{} = {}", variable.name, value(k) != 0.0),
                _ => format!("{} = {}", variable.name, value(k)),
            })
            .collect();
        if processes.variables.len() > SHOWN {
            words.push("…".to_owned());
        }
        words.join(", ")
    }
}
