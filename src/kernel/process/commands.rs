//! The commands of one process as places in compiled code, and one step of them in all lanes.

use super::super::code::Readings;
use super::draws::Draws;
use crate::base::lanes::{LANES, Lanes, Mask};
use crate::kernel::fault::{Fault, Faults};
use crate::model::{Bool, Domain, Num, Process, process::are_weights};

/// A new value: the variable, what it may hold, and the signal that holds the value.
#[derive(Clone, Copy, Debug)]
pub(super) struct Update {
    pub(super) variable: u32,
    domain: Domain,
    signal: usize,
}

/// What may happen: the signal of its probability, and the new values.
#[derive(Clone, Debug)]
pub(super) struct Branch {
    weight: usize,
    pub(super) updates: Vec<Update>,
}

/// A command.
#[derive(Clone, Debug)]
pub(super) struct Command {
    /// The atom that tells where it is enabled.
    guard: usize,
    pub(super) branches: Vec<Branch>,
}

/// The commands of one process.
#[derive(Clone, Debug)]
pub(super) struct Commands {
    process: u32,
    choose: bool,
    pub(super) list: Vec<Command>,
}

/// What a process does in one lane.
pub(super) enum Choice {
    /// Nothing.
    Stutter,
    /// One command, with the ends of the intervals of its branches in (0, 1].
    Fire {
        /// Which.
        command: usize,
        /// The branches with a positive probability, and where each ends.
        ends: Vec<(usize, f64)>,
    },
    /// Several commands are enabled; chance decides.
    Several,
}

impl Commands {
    /// Enters guards, probabilities and updates into lists that will be compiled.
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
        let list = process
            .commands
            .iter()
            .map(|command| {
                atoms.push(command.guard.clone());
                let branches = command
                    .branches
                    .iter()
                    .map(|branch| {
                        let weight = signal(&branch.weight);
                        let updates = branch
                            .updates
                            .iter()
                            .filter_map(|(id, value)| {
                                let domain = *domains.get(id.0 as usize)?;
                                Some(Update { variable: id.0, domain, signal: signal(value) })
                            })
                            .collect();
                        Branch { weight, updates }
                    })
                    .collect();
                Command { guard: atoms.len() - 1, branches }
            })
            .collect();
        Self { process: number as u32, choose: process.choose, list }
    }

    /// What it does in one lane, with the numbers that were read there.
    pub(super) fn choice(&self, readings: &Readings, lane: usize) -> Result<Choice, Fault> {
        let mut enabled = self.enabled(readings, lane);
        let Some(first) = enabled.next() else { return Ok(Choice::Stutter) };
        if let Some(second) = enabled.next() {
            if self.choose {
                return Ok(Choice::Several);
            }
            let commands = (first as u32, second as u32);
            return Err(Fault::Ambiguous { process: self.process, commands });
        }
        Ok(Choice::Fire { command: first, ends: self.ends(first, readings, lane)? })
    }

    fn enabled<'a>(&'a self, readings: &'a Readings, lane: usize) -> impl Iterator<Item = usize> + 'a {
        self.list
            .iter()
            .enumerate()
            .filter(move |(_, command)| readings.atoms[command.guard].has(lane))
            .map(|(k, _)| k)
    }

    /// Where the intervals of the branches of a command end.
    fn ends(&self, command: usize, readings: &Readings, lane: usize) -> Result<Vec<(usize, f64)>, Fault> {
        let branches = &self.list[command].branches;
        let weight = |branch: &Branch| readings.signals[branch.weight].0[lane];
        if !are_weights(branches.iter().map(weight)) {
            return Err(Fault::Weights { process: self.process, command: command as u32 });
        }
        let mut ends = Vec::with_capacity(branches.len());
        let mut sum = 0.0;
        for (k, branch) in branches.iter().enumerate() {
            if weight(branch) > 0.0 {
                sum += weight(branch);
                ends.push((k, sum));
            }
        }
        // Rounding leaves no gap at the end.
        if let Some(last) = ends.last_mut() {
            last.1 = 1.0;
        }
        Ok(ends)
    }

    /// The new values of a branch in one lane.
    pub(super) fn values(
        &self,
        command: usize,
        branch: usize,
        readings: &Readings,
        lane: usize,
    ) -> Result<Vec<(u32, f64)>, Fault> {
        self.list[command].branches[branch]
            .updates
            .iter()
            .map(|update| {
                let value = readings.signals[update.signal].0[lane];
                if update.domain.contains(value) {
                    Ok((update.variable, update.domain.kept(value)))
                } else {
                    Err(Fault::Range { variable: update.variable, value })
                }
            })
            .collect()
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
        let mut fault = |lane: usize, found: Fault| {
            faults.add(lane, found);
        };
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
            if !self.choose {
                if let Err(found) = self.choice(readings, lane) {
                    fault(lane, found);
                }
                continue;
            }
            let second = numbers.get_or_insert_with(|| draws.pair())[1][lane];
            let count = self.enabled(readings, lane).count();
            let place = ((second * count as f64) as usize).min(count - 1);
            picked[lane] = self.enabled(readings, lane).nth(place).unwrap_or(usize::MAX);
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
                let weights = branches.iter().map(|branch| readings.signals[branch.weight].0[lane]);
                if !are_weights(weights) {
                    fault(lane, Fault::Weights { process: self.process, command: k as u32 });
                    left &= !Mask::lane(lane);
                }
            }
            if let [only] = branches {
                write(only, left, readings, next, &mut fault);
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
                write(branch, here, readings, next, &mut fault);
            }
        }
    }
}

/// Writes the new values of a branch in the lanes that take it.
#[inline(always)]
fn write(
    branch: &Branch,
    lanes: Mask,
    readings: &Readings,
    next: &mut [Lanes],
    fault: &mut impl FnMut(usize, Fault),
) {
    if lanes.is_empty() {
        return;
    }
    for update in &branch.updates {
        let values = readings.signals[update.signal];
        for lane in lanes.iter() {
            let value = values.0[lane];
            if update.domain.contains(value) {
                next[update.variable as usize].0[lane] = update.domain.kept(value);
            } else {
                fault(lane, Fault::Range { variable: update.variable, value });
            }
        }
    }
}
