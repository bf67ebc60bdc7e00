//! A process as a table: for each combination of the values it reads, what may happen.
//!
//! The table is made by the same code that runs processes without a table, eight rows at a time, so both
//! take the same branch for the same number.

use super::super::code::{Code, Readings};
use super::super::state::{Layout, State};
use super::commands::{Choice, Commands};
use super::draws::Draws;
use crate::base::lanes::{LANES, Lanes, Mask};
use crate::kernel::fault::{Fault, Faults};
use crate::model::{Domain, Scenario, Timing};
use std::collections::BTreeSet;

/// Most rows of a table.
pub(super) const MOST_ROWS: u64 = 1 << 14;
/// Most branches of all rows.
const MOST_ENTRIES: usize = 1 << 18;

/// What happens for one combination of values.
#[derive(Clone, Copy, Debug)]
struct Row {
    /// Its first entry.
    first: u32,
    /// Number of entries, at least one.
    count: u32,
    /// Whether some entry is an error.
    faulty: bool,
}

/// A process as a table.
#[derive(Clone, Debug)]
pub(super) struct Table {
    /// The variables that it reads, and what one more is worth in the number of the row.
    keys: Vec<(u32, f64)>,
    /// Number of the row in which all read variables are 0; perhaps negative.
    origin: f64,
    rows: Vec<Row>,
    /// Where each entry ends in (0, 1].
    ends: Vec<f64>,
    /// The variables that it writes.
    written: Vec<u32>,
    /// New values, entry by entry; NaN where a variable stays.
    values: Vec<f64>,
    /// The error of each entry.
    faults: Vec<Option<Fault>>,
}

impl Table {
    /// The table of a process, if it reads few values and nothing but variables.
    pub(super) fn of(scenario: &Scenario, number: usize, domains: &[Domain], most: u64) -> Option<Self> {
        let process = &scenario.processes.list[number];
        let mut read = BTreeSet::new();
        let mut closed = true;
        for command in &process.commands {
            closed &= command.timing == Timing::Step && command.guard.reads(&mut read);
            for branch in &command.branches {
                closed &= branch.weight.reads(&mut read);
                closed &= branch.updates.iter().fold(true, |so_far, (_, v)| so_far & v.reads(&mut read));
            }
        }
        if !closed {
            return None;
        }
        let mut rows = 1u64;
        let mut lows = Vec::new();
        let mut keys = Vec::new();
        for id in read {
            let (low, count) = domains.get(id.0 as usize)?.values()?;
            keys.push((id.0, rows as f64));
            lows.push((low, count));
            rows = rows.checked_mul(count).filter(|&rows| rows <= most)?;
        }
        if rows > most {
            return None;
        }
        let origin = -keys.iter().zip(&lows).map(|((_, stride), (low, _))| stride * low).sum::<f64>();
        let (mut atoms, mut signals) = (Vec::new(), Vec::new());
        let commands = Commands::of(number, process, domains, &mut atoms, &mut signals);
        let code = Code::compile(scenario, &atoms, &signals);
        let written: BTreeSet<u32> = commands
            .list
            .iter()
            .flat_map(|command| &command.branches)
            .flat_map(|branch| branch.updates.iter().map(|update| update.variable))
            .collect();
        let mut table = Self {
            keys,
            origin,
            rows: Vec::with_capacity(rows as usize),
            ends: Vec::new(),
            written: written.into_iter().collect(),
            values: Vec::new(),
            faults: Vec::new(),
        };
        let mut state = State::new(Layout::Trials, 0);
        state.occupied = Mask::ALL;
        state.variables = vec![Lanes::ZERO; domains.len()];
        let mut readings = Readings::default();
        for start in (0..rows).step_by(LANES) {
            let here = LANES.min((rows - start) as usize);
            for lane in 0..here {
                let mut rest = start + lane as u64;
                for ((variable, _), (low, count)) in table.keys.iter().zip(&lows) {
                    state.variables[*variable as usize].0[lane] = low + (rest % count) as f64;
                    rest /= count;
                }
            }
            code.read(Layout::Trials, &state, &mut readings);
            for lane in 0..here {
                table.enter(&commands, &readings, lane)?;
            }
        }
        Some(table)
    }

    /// Adds a row; `None` where chance picks the command too, or the table grows too large.
    fn enter(&mut self, commands: &Commands, readings: &Readings, lane: usize) -> Option<()> {
        let first = self.ends.len() as u32;
        let mut faulty = false;
        match commands.choice(readings, lane) {
            Ok(Choice::Several) => return None,
            Ok(Choice::Stutter) => self.entry(1.0, Ok(Vec::new())),
            Ok(Choice::Fire { command, ends }) => {
                for (branch, end) in ends {
                    let values = commands.values(command, branch, readings, lane);
                    faulty |= values.is_err();
                    self.entry(end, values);
                }
            }
            Err(fault) => {
                faulty = true;
                self.entry(1.0, Err(fault));
            }
        }
        self.rows.push(Row { first, count: self.ends.len() as u32 - first, faulty });
        (self.ends.len() <= MOST_ENTRIES).then_some(())
    }

    fn entry(&mut self, end: f64, values: Result<Vec<(u32, f64)>, Fault>) {
        self.ends.push(end);
        self.faults.push(values.as_ref().err().copied());
        let values = values.unwrap_or_default();
        for variable in &self.written {
            let new = values.iter().find(|(v, _)| v == variable);
            self.values.push(new.map_or(f64::NAN, |(_, value)| *value));
        }
    }

    /// The variables that it writes.
    pub(super) fn written(&self) -> &[u32] {
        &self.written
    }

    /// What may happen where the variables have these values: where each branch ends in (0, 1], and what it
    /// writes. `None` where a branch is an error.
    #[allow(clippy::type_complexity, reason = "said in the line above")]
    pub(super) fn outcomes(&self, variables: &[f64]) -> Option<Vec<(f64, Vec<(u32, f64)>)>> {
        let place =
            self.keys.iter().fold(self.origin, |sum, (id, stride)| sum + variables[*id as usize] * stride);
        let row = self.rows.get(place as usize).filter(|row| !row.faulty)?;
        let entries = row.first as usize..(row.first + row.count) as usize;
        let width = self.written.len();
        Some(
            entries
                .map(|entry| {
                    let new = self.written.iter().zip(&self.values[entry * width..]);
                    (self.ends[entry], new.filter(|(_, v)| !v.is_nan()).map(|(k, v)| (*k, *v)).collect())
                })
                .collect(),
        )
    }

    /// One step: new values go to `next`.
    #[inline]
    pub(super) fn step(
        &self,
        lanes: Mask,
        state: &State,
        draws: &Draws<'_>,
        next: &mut [Lanes],
        faults: &mut Faults,
    ) {
        let mut place = Lanes::splat(self.origin);
        for &(variable, stride) in &self.keys {
            place = place.zip(state.variables[variable as usize], |sum, value| sum + value * stride);
        }
        let mut first = [0usize; LANES];
        let mut branches = [1usize; LANES];
        let mut faulty = false;
        for lane in 0..LANES {
            if let Some(row) = self.rows.get(place.0[lane] as usize) {
                first[lane] = row.first as usize;
                branches[lane] = row.count as usize;
                faulty |= row.faulty;
            }
        }
        let mut entries = first;
        let most = branches.iter().copied().fold(1, usize::max);
        if most > 1 {
            let [numbers, _] = draws.pair();
            // Ends ascend, so the entry is the number of ends passed: no jump depends on chance.
            for k in 0..most - 1 {
                for lane in 0..LANES {
                    let end = self.ends.get(first[lane] + k).copied().unwrap_or(1.0);
                    let (more, passed) = (k + 1 < branches[lane], numbers[lane] >= end);
                    entries[lane] += usize::from(more) & usize::from(passed);
                }
            }
        }
        if faulty {
            for lane in lanes.iter() {
                if let Some(fault) = self.faults[entries[lane]] {
                    faults.add(lane, fault);
                }
            }
        }
        let width = self.written.len();
        for (k, &variable) in self.written.iter().enumerate() {
            let values = &mut next[variable as usize].0;
            for lane in 0..LANES {
                let (old, new) = (values[lane], self.values[entries[lane] * width + k]);
                // Lanes without a trial may hold what they like.
                values[lane] = if new.is_nan() { old } else { new };
            }
        }
    }
}
