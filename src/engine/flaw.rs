//! What one trial shows to be wrong with a model: two commands at once, a variable that leaves its range.

use crate::compile::study::Origins;
use crate::kernel::process;
use crate::model::Scenario;
use crate::syntax::codes::Code;
use crate::syntax::source::Span;
use std::fmt;

/// What is wrong with a model, found while a trial ran.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Flaw {
    /// Stable code; the page of the same error at compile time.
    pub code: Code,
    /// Where the command, variable or behaviour at fault is written.
    pub place: Option<Span>,
    /// In which trial, and when: `trial 3 at 2 s`.
    pub moment: String,
    /// What is wrong, in words.
    pub what: String,
    /// Values of the variables just before; may be empty.
    pub state: String,
    /// What to do about it.
    pub hint: &'static str,
}

impl Flaw {
    /// Puts an error of the kernel into words.
    pub(super) fn of(
        fault: process::Fault,
        scenario: &Scenario,
        origins: &Origins,
        moment: String,
        value: impl Fn(usize) -> f64,
    ) -> Self {
        let command = |process: u32, command: u32| {
            origins.commands.get(process as usize)?.get(command as usize).copied()
        };
        let behaviour = |attached: u32| {
            let one = scenario.behaviours.attached.get(attached as usize)?;
            origins.behaviours.get(one.behaviour.0 as usize).copied()
        };
        let (code, place, hint) = match fault {
            process::Fault::Ambiguous { process, commands } => (
                Code::E0901,
                command(process, commands.1),
                "make the guards exclude each other, or add `choose`",
            ),
            process::Fault::Weights { process, command: one } => (
                Code::E0902,
                command(process, one),
                "the probabilities must be at least 0 and sum to 1 in every state",
            ),
            process::Fault::Branches { attached } => (
                Code::E0902,
                behaviour(attached),
                "the probabilities must be at least 0 and sum to 1 in every state",
            ),
            process::Fault::Range { variable, .. } => (
                Code::E0903,
                origins.variables.get(variable as usize).copied(),
                "add a guard, or widen the range",
            ),
            process::Fault::Rate { process, command: one, .. } => {
                (Code::E0904, command(process, one), "add a guard, or write `max(0 /s, …)`")
            }
            process::Fault::Stuck { process } => (
                Code::E0907,
                command(process, 0),
                "let the command change its own guard, or give it a positive delay",
            ),
            process::Fault::Unrepeated => (
                Code::E0915,
                origins.program,
                "draw all random numbers from `{seed}`, and read neither the clock nor what another trial wrote",
            ),
            process::Fault::Unsteady { .. } => (
                Code::E0915,
                None,
                "let answers depend on the situation alone, and draw random numbers from the generator that it has",
            ),
            process::Fault::Unstarted { .. } => {
                (Code::E0916, origins.program, "write the name of a program that can be run, or a path to it")
            }
            process::Fault::Change { attached, .. } => {
                (Code::E0914, behaviour(attached), "limit the value: `max(0.1 m/s, …)`")
            }
        };
        let is_outside = scenario.processes.outside.is_some();
        let state =
            if is_outside { String::new() } else { process::Fault::state(&scenario.processes, value) };
        Self { code, place, moment, what: fault.describe(scenario), state, hint }
    }
}

impl fmt::Display for Flaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.moment, self.what)?;
        if self.state.is_empty() { Ok(()) } else { write!(f, "; the state is {}", self.state) }
    }
}
