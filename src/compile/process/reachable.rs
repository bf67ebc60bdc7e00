//! Errors that some trial could run into, found before any does.
//!
//! Where processes depend on nothing but themselves and have few states, all states that a trial can reach
//! are walked through, breadth first, as far as the horizon. Where there are too many, or agents or delays come in,
//! errors show while running.

use super::super::elaborator::Elaborator;
use crate::model::process::wrong_weights;
use crate::model::{Command, Domain, Process, Processes, Timing, Variable};
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::source::Span;
use std::collections::BTreeSet;

/// Most states that are looked at.
const MOST_STATES: usize = 4096;
/// Most successors that are computed.
const MOST_SUCCESSORS: usize = 1 << 17;
/// Most values of variables that are kept at a time, of known states or of the successors of one.
const MOST_VALUES: usize = 1 << 22;
/// Most values of variables of all successors.
const MOST_WRITTEN: usize = 1 << 24;

/// What is wrong, and where it is written.
struct Wrong {
    code: &'static str,
    span: Span,
    what: String,
    hint: Option<&'static str>,
}

/// Why a walk ended early.
enum End {
    /// Too many states, or they depend on more than variables.
    Unknown,
    /// An error.
    Wrong(Wrong),
}

impl Elaborator<'_> {
    /// Reports what goes wrong in some state that can be reached.
    pub(super) fn check_reachable(&mut self, processes: &Processes, spans: &[Vec<Span>]) {
        if processes.variables.iter().any(|v| v.domain.values().is_none()) {
            return;
        }
        let commands = || processes.list.iter().flat_map(|process| &process.commands);
        let jumps = self.clock.is_jumps();
        // Which of several delays ends first is not known here, nor how jumps and steps meet.
        if commands().any(|c| matches!(c.timing, Timing::Delay(_)) || (!jumps && c.timing != Timing::Step)) {
            return;
        }
        let initial: Vec<i64> = processes.variables.iter().map(|v| v.initial as i64).collect();
        let mut known = BTreeSet::from([initial.clone()]);
        let mut front = vec![initial];
        let mut made = 0;
        for _ in 0..self.horizon.0 {
            let mut next_front = Vec::new();
            for state in std::mem::take(&mut front) {
                let found = if jumps {
                    jumped(processes, spans, &state)
                } else {
                    successors(processes, spans, &state)
                };
                let successors = match found {
                    Ok(successors) => successors,
                    Err(End::Unknown) => return,
                    Err(End::Wrong(wrong)) => {
                        return self.note(wrong.diagnostic(&processes.variables, &state));
                    }
                };
                made += successors.len();
                for next in successors {
                    if !known.contains(&next) {
                        known.insert(next.clone());
                        next_front.push(next);
                    }
                }
                let values = |states: usize| states.saturating_mul(processes.variables.len());
                let many = known.len() > MOST_STATES || made > MOST_SUCCESSORS;
                if many || values(known.len()) > MOST_VALUES || values(made) > MOST_WRITTEN {
                    return;
                }
            }
            if next_front.is_empty() {
                return;
            }
            front = next_front;
        }
    }
}

impl Wrong {
    fn diagnostic(self, variables: &[Variable], state: &[i64]) -> Diagnostic {
        let error = Diagnostic::error(self.code, self.span, self.what)
            .label(format!("where {}", shown(variables, state)));
        match self.hint {
            Some(hint) => error.hint(hint),
            None => error,
        }
    }
}

fn shown(variables: &[Variable], state: &[i64]) -> String {
    let words: Vec<String> = variables
        .iter()
        .zip(state)
        .take(8)
        .map(|(variable, value)| match variable.domain {
            Domain::Truth => format!("{} = {}", variable.name, *value != 0),
            _ => format!("{} = {value}", variable.name),
        })
        .collect();
    words.join(", ")
}

/// Changed variables of one way that a process can take.
type Change = Vec<(usize, i64)>;

/// The states that can follow.
fn successors(processes: &Processes, spans: &[Vec<Span>], state: &[i64]) -> Result<Vec<Vec<i64>>, End> {
    let values: Vec<f64> = state.iter().map(|value| *value as f64).collect();
    let mut joint: Vec<Vec<i64>> = vec![state.to_vec()];
    for (process, spans) in processes.list.iter().zip(spans) {
        let changes = changes(process, spans, &processes.variables, &values)?;
        if let [only] = changes.as_slice() {
            for after in &mut joint {
                for &(variable, value) in only {
                    after[variable] = value;
                }
            }
            continue;
        }
        let ways = joint.len().saturating_mul(changes.len());
        if ways > MOST_SUCCESSORS || ways.saturating_mul(state.len()) > MOST_VALUES {
            return Err(End::Unknown);
        }
        joint = joint
            .iter()
            .flat_map(|before| {
                changes.iter().map(|change| {
                    let mut after = before.clone();
                    for &(variable, value) in change {
                        after[variable] = value;
                    }
                    after
                })
            })
            .collect();
    }
    Ok(joint)
}

/// The states that can follow where processes jump one at a time.
fn jumped(processes: &Processes, spans: &[Vec<Span>], state: &[i64]) -> Result<Vec<Vec<i64>>, End> {
    let values: Vec<f64> = state.iter().map(|value| *value as f64).collect();
    let mut changes = Vec::new();
    for (process, spans) in processes.list.iter().zip(spans) {
        for (command, span) in process.commands.iter().zip(spans) {
            let Timing::Rate(rate) = &command.timing else { continue };
            if !command.guard.evaluate(&values).ok_or(End::Unknown)? {
                continue;
            }
            let rate = rate.evaluate(&values).ok_or(End::Unknown)?;
            if !(rate >= 0.0 && rate.is_finite()) {
                return Err(End::Wrong(Wrong {
                    code: "E0904",
                    span: *span,
                    what: format!("the rate of this command would be {rate} /s"),
                    hint: Some("a rate is a finite number, not negative; 0 disables the command"),
                }));
            }
            if rate > 0.0 {
                branches(command, *span, &processes.variables, &values, &mut changes)?;
            }
        }
    }
    if changes.len().saturating_mul(state.len()) > MOST_VALUES {
        return Err(End::Unknown);
    }
    let after = changes.iter().map(|change| {
        let mut after = state.to_vec();
        for &(variable, value) in change {
            after[variable] = value;
        }
        after
    });
    Ok(after.collect())
}

/// What one process can do at a step.
fn changes(
    process: &Process,
    spans: &[Span],
    variables: &[Variable],
    values: &[f64],
) -> Result<Vec<Change>, End> {
    let mut enabled = Vec::new();
    for (command, span) in process.commands.iter().zip(spans) {
        if command.guard.evaluate(values).ok_or(End::Unknown)? {
            enabled.push((command, *span));
        }
    }
    if let [_, (_, second), ..] = enabled.as_slice()
        && !process.choose
    {
        return Err(End::Wrong(Wrong {
            code: "E0901",
            span: *second,
            what: format!("another command of `{}` is enabled together with this one", process.name),
            hint: Some("`choose` in the process makes each of them equally likely"),
        }));
    }
    if enabled.is_empty() {
        return Ok(vec![Vec::new()]);
    }
    let mut all = Vec::new();
    for (command, span) in enabled {
        branches(command, span, variables, values, &mut all)?;
    }
    Ok(all)
}

fn branches(
    command: &Command,
    span: Span,
    variables: &[Variable],
    values: &[f64],
    all: &mut Vec<Change>,
) -> Result<(), End> {
    let weights: Option<Vec<f64>> = command.branches.iter().map(|b| b.weight.evaluate(values)).collect();
    let weights = weights.ok_or(End::Unknown)?;
    if let Some(what) = wrong_weights(&weights) {
        return Err(End::Wrong(Wrong { code: "E0902", span, what, hint: None }));
    }
    for (branch, weight) in command.branches.iter().zip(weights) {
        if weight == 0.0 {
            continue;
        }
        let mut change = Vec::with_capacity(branch.updates.len());
        for (id, value) in &branch.updates {
            let value = value.evaluate(values).ok_or(End::Unknown)?;
            let variable = &variables[id.0 as usize];
            if !variable.domain.contains(value) {
                return Err(End::Wrong(Wrong {
                    code: "E0903",
                    span,
                    what: format!("`{}` would become {value}, outside its range", variable.name),
                    hint: Some("a guard can keep it inside"),
                }));
            }
            change.push((id.0 as usize, value as i64));
        }
        all.push(change);
    }
    Ok(())
}
