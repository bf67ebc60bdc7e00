//! The commands of one process with rates and delays as places in compiled code.
//!
//! All commands with rates of a process are one race: its rate is the sum of theirs, and when it is over one number
//! in (0, 1) tells which command has won, and with which of its branches.

use super::super::code::Readings;
use crate::base::lanes::Lanes;
use crate::kernel::fault::Fault;
use crate::model::process::are_weights;
use crate::model::{Bool, Domain, Num, Process, Timing};
use std::collections::BTreeSet;

/// A new value: the variable, what it may hold, and the signal that holds the value.
#[derive(Clone, Copy, Debug)]
struct Update {
    variable: u32,
    domain: Domain,
    signal: usize,
}

#[derive(Clone, Debug)]
struct Branch {
    weight: usize,
    updates: Vec<Update>,
}

#[derive(Clone, Debug)]
struct Command {
    guard: usize,
    /// The signal of its rate; `None` where it has a delay.
    rate: Option<usize>,
    branches: Vec<Branch>,
}

/// What happens when a clock rings: a command and one of its branches, or an error.
pub(super) type Way = Result<(usize, usize), Fault>;

/// The commands of one process.
#[derive(Clone, Debug)]
pub(super) struct Race {
    process: u32,
    commands: Vec<Command>,
}

impl Race {
    /// Enters guards, rates, probabilities and updates into lists that will be compiled.
    pub(super) fn of(
        number: usize,
        process: &Process,
        domains: &[Domain],
        atoms: &mut Vec<Bool>,
        signals: &mut Vec<Num>,
    ) -> Self {
        let mut signal = |num: &Num| {
            signals.push(num.clone());
            signals.len() - 1
        };
        let mut commands = Vec::with_capacity(process.commands.len());
        for command in &process.commands {
            atoms.push(command.guard.clone());
            let rate = match &command.timing {
                Timing::Rate(rate) => Some(signal(rate)),
                Timing::Delay(..) | Timing::Step => None,
            };
            let mut branches = Vec::with_capacity(command.branches.len());
            for branch in &command.branches {
                let weight = signal(&branch.weight);
                let mut updates = Vec::with_capacity(branch.updates.len());
                for (id, value) in &branch.updates {
                    if let Some(&domain) = domains.get(id.0 as usize) {
                        updates.push(Update { variable: id.0, domain, signal: signal(value) });
                    }
                }
                branches.push(Branch { weight, updates });
            }
            commands.push(Command { guard: atoms.len() - 1, rate, branches });
        }
        Self { process: number as u32, commands }
    }

    /// The variables that it sets.
    pub(super) fn written(&self) -> BTreeSet<u32> {
        let branches = self.commands.iter().flat_map(|command| &command.branches);
        branches.flat_map(|branch| branch.updates.iter().map(|update| update.variable)).collect()
    }

    /// Whether a command is enabled in a lane.
    #[inline]
    pub(super) fn enabled(&self, command: usize, readings: &Readings, lane: usize) -> bool {
        readings.atoms[self.commands[command].guard].has(lane)
    }

    /// The rate of the race in a lane, 1/s.
    pub(super) fn total(&self, readings: &Readings, lane: usize) -> Result<f64, Fault> {
        let mut sum = 0.0;
        for (k, command) in self.commands.iter().enumerate() {
            let Some(rate) = command.rate else { continue };
            if readings.atoms[command.guard].has(lane) {
                let value = readings.signals[rate].0[lane];
                sum += value;
                if !(value >= 0.0 && sum.is_finite()) {
                    return Err(Fault::Rate { process: self.process, command: k as u32, value });
                }
            }
        }
        Ok(sum)
    }

    /// Calls `each` with every way in which the race can end and the end of its share of (0, 1], until that
    /// says stop.
    pub(super) fn ends(&self, readings: &Readings, lane: usize, mut each: impl FnMut(Way, f64) -> bool) {
        let Ok(total) = self.total(readings, lane) else { return };
        let mut sum = 0.0;
        for (k, command) in self.commands.iter().enumerate() {
            let Some(rate) = command.rate else { continue };
            let rate = readings.signals[rate].0[lane];
            if !readings.atoms[command.guard].has(lane) || rate == 0.0 {
                continue;
            }
            if !self.branches(k, readings, lane, |way, weight| {
                sum += rate * weight;
                each(way, sum / total)
            }) {
                return;
            }
        }
    }

    /// The same for the branches of one command with a delay.
    pub(super) fn ends_of(
        &self,
        command: usize,
        readings: &Readings,
        lane: usize,
        mut each: impl FnMut(Way, f64) -> bool,
    ) {
        let mut sum = 0.0;
        self.branches(command, readings, lane, |way, weight| {
            sum += weight;
            each(way, sum)
        });
    }

    /// Calls `each` with every branch that can be taken and its probability; false once that says stop.
    fn branches(
        &self,
        command: usize,
        readings: &Readings,
        lane: usize,
        mut each: impl FnMut(Way, f64) -> bool,
    ) -> bool {
        let branches = &self.commands[command].branches;
        let weight = |branch: &Branch| readings.signals[branch.weight].0[lane];
        if !are_weights(branches.iter().map(weight)) {
            return each(Err(Fault::Weights { process: self.process, command: command as u32 }), 1.0);
        }
        for (b, branch) in branches.iter().enumerate() {
            let weight = weight(branch);
            if weight > 0.0 && !each(Ok((command, b)), weight) {
                return false;
            }
        }
        true
    }

    /// The way that belongs to a number in (0, 1): of the race, or of a command with a delay. Rounding leaves
    /// no gap after the last one.
    pub(super) fn way(
        &self,
        delayed: Option<usize>,
        readings: &Readings,
        lane: usize,
        u: f64,
    ) -> Option<Way> {
        let mut found = None;
        let each = |way: Way, end: f64| {
            found = Some(way);
            u >= end
        };
        match delayed {
            None => self.ends(readings, lane, each),
            Some(command) => self.ends_of(command, readings, lane, each),
        }
        found
    }

    /// The new values of a branch in a lane.
    pub(super) fn values(
        &self,
        (command, branch): (usize, usize),
        readings: &Readings,
        lane: usize,
    ) -> Result<Vec<(u32, f64)>, Fault> {
        let updates = &self.commands[command].branches[branch].updates;
        let mut values = Vec::with_capacity(updates.len());
        for update in updates {
            let value = readings.signals[update.signal].0[lane];
            if !update.domain.contains(value) {
                return Err(Fault::Range { variable: update.variable, value });
            }
            values.push((update.variable, update.domain.kept(value)));
        }
        Ok(values)
    }

    /// Writes the new values of a branch, all of them or none.
    pub(super) fn fire(
        &self,
        (command, branch): (usize, usize),
        readings: &Readings,
        lane: usize,
        variables: &mut [Lanes],
    ) -> Result<(), Fault> {
        let updates = &self.commands[command].branches[branch].updates;
        for update in updates {
            let value = readings.signals[update.signal].0[lane];
            if !update.domain.contains(value) {
                return Err(Fault::Range { variable: update.variable, value });
            }
        }
        for update in updates {
            let value = readings.signals[update.signal].0[lane];
            variables[update.variable as usize].0[lane] = update.domain.kept(value);
        }
        Ok(())
    }
}
