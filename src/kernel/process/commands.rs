//! The commands of one process as places in compiled code: what may happen in a lane, and one step of them in all lanes.
//!
//! All commands with rates of a process are one race: its rate is the sum of theirs, and when it is over one number
//! in (0, 1) decides which command has won, and with which of its branches.

use super::super::code::Readings;
use super::draws::Draws;
use crate::base::lanes::{LANES, Lanes, Mask};
use crate::kernel::fault::{Fault, Faults};
use crate::model::{Bool, Domain, Num, Process, Timing, process::are_weights};
use std::collections::BTreeSet;

/// A new value: the variable, its domain, and the signal that holds the value.
#[derive(Clone, Copy, Debug)]
struct Update {
    variable: u32,
    domain: Domain,
    signal: usize,
}

impl Update {
    #[inline(always)]
    fn value(&self, readings: &Readings, lane: usize) -> Result<f64, Fault> {
        let value = readings.signals[self.signal].0[lane];
        if self.domain.contains(value) {
            Ok(self.domain.kept(value))
        } else {
            Err(Fault::Range { variable: self.variable, value })
        }
    }
}

/// A branch: the signal of its probability, and the new values.
#[derive(Clone, Debug)]
struct Branch {
    weight: usize,
    updates: Vec<Update>,
}

#[derive(Clone, Debug)]
struct Command {
    /// The atom that is true where it is enabled.
    guard: usize,
    /// The signal of its rate; `None` where it has a delay, or is taken at steps.
    rate: Option<usize>,
    branches: Vec<Branch>,
}

/// What happens: a command and one of its branches, or an error.
pub(super) type Way = Result<(usize, usize), Fault>;

/// When a process does something.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Event {
    /// At a step.
    Step,
    /// When the race of its commands with rates is over.
    Race,
    /// When the delay of a command is over.
    Delay(usize),
}

/// The commands of one process.
#[derive(Clone, Debug)]
pub(super) struct Commands {
    process: u32,
    choose: bool,
    list: Vec<Command>,
}

impl Commands {
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
        let mut list = Vec::with_capacity(process.commands.len());
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
            list.push(Command { guard: atoms.len() - 1, rate, branches });
        }
        Self { process: number as u32, choose: process.choose, list }
    }

    /// The variables that it sets.
    pub(super) fn written(&self) -> BTreeSet<u32> {
        let branches = self.list.iter().flat_map(|command| &command.branches);
        branches.flat_map(|branch| branch.updates.iter().map(|update| update.variable)).collect()
    }

    /// Whether a command is enabled in a lane.
    #[inline]
    pub(super) fn enabled(&self, command: usize, readings: &Readings, lane: usize) -> bool {
        readings.atoms[self.list[command].guard].has(lane)
    }

    /// The rate of the race in a lane, 1/s.
    pub(super) fn total(&self, readings: &Readings, lane: usize) -> Result<f64, Fault> {
        let mut sum = 0.0;
        for (k, command) in self.list.iter().enumerate() {
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

    /// All commands that are enabled in a lane.
    fn all_enabled<'a>(&'a self, readings: &'a Readings, lane: usize) -> impl Iterator<Item = usize> + 'a {
        (0..self.list.len()).filter(move |&command| self.enabled(command, readings, lane))
    }

    /// The error of several enabled commands, if one should choose among them and nothing does.
    fn ambiguous(&self, readings: &Readings, lane: usize) -> Option<Fault> {
        let mut enabled = self.all_enabled(readings, lane);
        let commands = (enabled.next()? as u32, enabled.next()? as u32);
        (!self.choose).then_some(Fault::Ambiguous { process: self.process, commands })
    }

    /// Whether chance decides in a lane which command is taken at a step.
    pub(super) fn must_choose(&self, readings: &Readings, lane: usize) -> bool {
        self.choose && self.all_enabled(readings, lane).nth(1).is_some()
    }

    /// Calls `each` with everything that may happen at an event in a lane and the end of its share of (0, 1], until that
    /// says stop. At a step one command at most is enabled.
    pub(super) fn ways(
        &self,
        event: Event,
        readings: &Readings,
        lane: usize,
        mut each: impl FnMut(Way, f64) -> bool,
    ) {
        let mut sum = 0.0;
        let command = match event {
            Event::Delay(command) => Some(command),
            Event::Step => match self.ambiguous(readings, lane) {
                Some(fault) => {
                    each(Err(fault), 1.0);
                    return;
                }
                None => self.all_enabled(readings, lane).next(),
            },
            Event::Race => {
                let Ok(total) = self.total(readings, lane) else { return };
                for (k, command) in self.list.iter().enumerate() {
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
                None
            }
        };
        if let Some(command) = command {
            self.branches(command, readings, lane, |way, weight| {
                sum += weight;
                each(way, sum)
            });
        }
    }

    /// Calls `each` with every branch that can be taken and its probability; false once that says stop.
    fn branches(
        &self,
        command: usize,
        readings: &Readings,
        lane: usize,
        mut each: impl FnMut(Way, f64) -> bool,
    ) -> bool {
        let branches = &self.list[command].branches;
        if let Err(fault) = self.check_weights(command, readings, lane) {
            return each(Err(fault), 1.0);
        }
        for (b, branch) in branches.iter().enumerate() {
            let weight = readings.signals[branch.weight].0[lane];
            if weight > 0.0 && !each(Ok((command, b)), weight) {
                return false;
            }
        }
        true
    }

    fn check_weights(&self, command: usize, readings: &Readings, lane: usize) -> Result<(), Fault> {
        let branches = self.list[command].branches.iter();
        if are_weights(branches.map(|branch| readings.signals[branch.weight].0[lane])) {
            Ok(())
        } else {
            Err(Fault::Weights { process: self.process, command: command as u32 })
        }
    }

    /// What a number in (0, 1) decides at an event. Rounding leaves no gap after the last way.
    pub(super) fn way(&self, event: Event, readings: &Readings, lane: usize, u: f64) -> Option<Way> {
        let mut found = None;
        self.ways(event, readings, lane, |way, end| {
            found = Some(way);
            u >= end
        });
        found
    }

    /// The new values of a branch in a lane.
    pub(super) fn values(
        &self,
        (command, branch): (usize, usize),
        readings: &Readings,
        lane: usize,
    ) -> Result<Vec<(u32, f64)>, Fault> {
        let updates = self.list[command].branches[branch].updates.iter();
        updates.map(|update| Ok((update.variable, update.value(readings, lane)?))).collect()
    }

    /// Writes the new values of a branch, all of them or none.
    pub(super) fn fire(
        &self,
        (command, branch): (usize, usize),
        readings: &Readings,
        lane: usize,
        variables: &mut [Lanes],
    ) -> Result<(), Fault> {
        let updates = &self.list[command].branches[branch].updates;
        for update in updates {
            update.value(readings, lane)?;
        }
        for update in updates {
            variables[update.variable as usize].0[lane] = update.value(readings, lane)?;
        }
        Ok(())
    }

    /// One step: new values go to `next`.
    pub(super) fn step(
        &self,
        lanes: Mask,
        readings: &Readings,
        draws: &Draws<'_>,
        next: &mut [Lanes],
        faults: &mut Faults,
    ) {
        let mut numbers = None;
        // Where one command is enabled, and where several are.
        let (mut once, mut twice) = (Mask::NONE, Mask::NONE);
        for command in &self.list {
            let enabled = readings.atoms[command.guard] & lanes;
            twice |= once & enabled;
            once |= enabled;
        }
        let mut picked = [usize::MAX; LANES];
        for lane in twice.iter() {
            if let Some(fault) = self.ambiguous(readings, lane) {
                faults.add(lane, fault);
                continue;
            }
            let second = numbers.get_or_insert_with(|| draws.pair())[1][lane];
            let count = self.all_enabled(readings, lane).count();
            let place = ((second * count as f64) as usize).min(count - 1);
            picked[lane] = self.all_enabled(readings, lane).nth(place).unwrap_or(usize::MAX);
        }
        for (k, command) in self.list.iter().enumerate() {
            let mut firing = readings.atoms[command.guard] & lanes & !twice;
            for lane in twice.iter().filter(|&lane| picked[lane] == k) {
                firing |= Mask::lane(lane);
            }
            if firing.is_empty() {
                continue;
            }
            let branches = command.branches.as_slice();
            let mut left = firing;
            for lane in firing.iter() {
                if let Err(fault) = self.check_weights(k, readings, lane) {
                    faults.add(lane, fault);
                    left &= !Mask::lane(lane);
                }
            }
            if let [only] = branches {
                only.write(left, readings, next, faults);
                continue;
            }
            let first = Lanes(numbers.get_or_insert_with(|| draws.pair())[0]);
            let mut end = Lanes::ZERO;
            for (b, branch) in branches.iter().enumerate() {
                let weight = readings.signals[branch.weight];
                end = end.zip(weight, |sum, weight| sum + weight);
                let rest = branches[b + 1..].iter().fold(Mask::NONE, |rest, later| {
                    rest | readings.signals[later.weight].compare(Lanes::ZERO, |w, zero| w > zero)
                });
                // Rounding leaves no gap after the last branch with a positive probability.
                let here = (first.compare(end, |u, end| u < end) | !rest)
                    & weight.compare(Lanes::ZERO, |w, zero| w > zero)
                    & left;
                left &= !here;
                branch.write(here, readings, next, faults);
            }
        }
    }
}

impl Branch {
    /// Writes the new values in the lanes that take it.
    #[inline(always)]
    fn write(&self, lanes: Mask, readings: &Readings, next: &mut [Lanes], faults: &mut Faults) {
        for update in &self.updates {
            for lane in lanes.iter() {
                match update.value(readings, lane) {
                    Ok(value) => next[update.variable as usize].0[lane] = value,
                    Err(fault) => faults.add(lane, fault),
                }
            }
        }
    }
}
