//! A process with rates and delays as a table: for each combination of the values it reads, its rate and what may
//! happen. It is made by the code that runs processes without a table, so both take the same way.

use super::super::code::{Code, Readings};
use super::super::state::{Layout, State};
use super::keys::Keys;
use super::race::{Race, Way};
use crate::base::lanes::{LANES, Lanes, Mask};
use crate::kernel::fault::Fault;
use crate::model::{Domain, Scenario};
use std::collections::BTreeSet;

/// Most ways of all rows.
const MOST_ENTRIES: usize = 1 << 18;

/// The ends of so many ways are looked at together.
const BLOCK: usize = 4;

/// Ways of one clock in one row. A clock without ways does not run.
#[derive(Clone, Copy, Debug)]
struct Ways {
    /// The first one.
    first: u32,
    /// The first block of ends, and how many blocks.
    block: u32,
    blocks: u32,
}

/// A new value of a variable, as bits: those of the old one that stay, and those that are set.
#[derive(Clone, Copy, Debug)]
struct Change {
    stay: u64,
    set: u64,
}

/// A process as a table.
#[derive(Clone, Debug)]
pub(super) struct Rates {
    pub(super) keys: Keys,
    /// Rate of the race in each row, and 1 over it; NaN where one is wrong.
    totals: Vec<(f64, f64)>,
    /// What is wrong there.
    wrong: Vec<(usize, Fault)>,
    /// Number of clocks: the race and each command with a delay.
    clocks: usize,
    /// Row by row, the ways of each clock.
    ways: Vec<Ways>,
    /// Where the share of each way ends in (0, 1]; blocks are filled up with 1.
    ends: Vec<[f64; BLOCK]>,
    /// The variables that it sets.
    written: Vec<u32>,
    /// New values, way by way.
    values: Vec<Change>,
    /// The error of each way, and whether there is any.
    faults: Vec<Option<Fault>>,
    faulty: bool,
}

impl Rates {
    /// The table of a process, if it reads few values and nothing but variables. `delayed` are its commands
    /// with delays.
    pub(super) fn of(
        scenario: &Scenario,
        number: usize,
        domains: &[Domain],
        delayed: &[usize],
        most: u64,
    ) -> Option<Self> {
        let process = &scenario.processes.list[number];
        let mut read = BTreeSet::new();
        if !process.reads(&mut read) {
            return None;
        }
        let keys = Keys::of(&read, domains, most)?;
        let (mut atoms, mut signals) = (Vec::new(), Vec::new());
        let race = Race::of(number, process, domains, &mut atoms, &mut signals);
        let code = Code::compile(scenario, &atoms, &signals);
        let mut table = Self {
            keys,
            totals: Vec::new(),
            wrong: Vec::new(),
            clocks: 1 + delayed.len(),
            ways: Vec::new(),
            ends: Vec::new(),
            written: race.written().into_iter().collect(),
            values: Vec::new(),
            faults: Vec::new(),
            faulty: false,
        };
        let mut state = State::new(Layout::Trials, 0);
        state.occupied = Mask::ALL;
        state.variables = vec![Lanes::ZERO; domains.len()];
        let mut readings = Readings::default();
        for start in (0..table.keys.rows()).step_by(LANES) {
            let here = LANES.min((table.keys.rows() - start) as usize);
            for lane in 0..here {
                table.keys.put(start + lane as u64, &mut state.variables, lane);
            }
            code.read(Layout::Trials, &state, &mut readings);
            for lane in 0..here {
                table.enter(&race, delayed, &readings, lane);
            }
            if table.faults.len() > MOST_ENTRIES {
                return None;
            }
        }
        Some(table)
    }

    /// Adds a row.
    fn enter(&mut self, race: &Race, delayed: &[usize], readings: &Readings, lane: usize) {
        match race.total(readings, lane) {
            Ok(total) => self.totals.push((total, 1.0 / total)),
            Err(fault) => {
                self.wrong.push((self.totals.len(), fault));
                self.totals.push((f64::NAN, f64::NAN));
            }
        }
        let mut found: Vec<(Way, f64)> = Vec::new();
        race.ends(readings, lane, |way, end| {
            found.push((way, end));
            true
        });
        self.clock(race, &found, readings, lane);
        for &command in delayed {
            found.clear();
            if race.enabled(command, readings, lane) {
                race.ends_of(command, readings, lane, |way, end| {
                    found.push((way, end));
                    true
                });
            }
            self.clock(race, &found, readings, lane);
        }
    }

    /// Adds the ways of a clock.
    fn clock(&mut self, race: &Race, found: &[(Way, f64)], readings: &Readings, lane: usize) {
        self.ways.push(Ways {
            first: self.faults.len() as u32,
            block: self.ends.len() as u32,
            blocks: found.len().div_ceil(BLOCK) as u32,
        });
        for ways in found.chunks(BLOCK) {
            let mut ends = [1.0; BLOCK];
            for (end, (_, found)) in ends.iter_mut().zip(ways) {
                *end = *found;
            }
            self.ends.push(ends);
        }
        // Rounding leaves no gap after the last one.
        if let (Some(ends), Some(last)) = (self.ends.last_mut(), found.len().checked_sub(1)) {
            ends[last % BLOCK] = 1.0;
        }
        for &(way, _) in found {
            let values = way.and_then(|way| race.values(way, readings, lane));
            self.faulty |= values.is_err();
            self.faults.push(values.as_ref().err().copied());
            let values = values.unwrap_or_default();
            for variable in &self.written {
                let new = values.iter().find(|(v, _)| v == variable);
                self.values.push(match new {
                    Some((_, value)) => Change { stay: 0, set: value.to_bits() },
                    None => Change { stay: u64::MAX, set: 0 },
                });
            }
        }
    }

    /// The rate of the race in a row, and 1 over it.
    #[inline(always)]
    pub(super) fn total(&self, row: usize) -> Result<(f64, f64), Fault> {
        let total = self.totals[row];
        if total.0.is_nan() {
            return Err(self.wrong_rate(row));
        }
        Ok(total)
    }

    #[cold]
    fn wrong_rate(&self, row: usize) -> Fault {
        let found = self.wrong.iter().find(|(wrong, _)| *wrong == row);
        found.map_or(Fault::Rate { process: 0, command: 0, value: f64::NAN }, |(_, fault)| *fault)
    }

    /// Whether there are commands with delays.
    pub(super) fn has_delays(&self) -> bool {
        self.clocks > 1
    }

    /// The ways of the race in a row: where the share of each ends in (0, 1], and the new values; `None` if there
    /// is an error among them.
    #[allow(clippy::type_complexity, reason = "the same as those of a table of steps")]
    pub(super) fn outcomes(&self, row: usize) -> Option<Vec<(f64, Vec<(u32, f64)>)>> {
        let ways = self.ways.get(row * self.clocks)?;
        let blocks = &self.ends[ways.block as usize..(ways.block + ways.blocks) as usize];
        let last = self.ways.get(row * self.clocks + 1).map_or(self.faults.len(), |next| next.first as usize);
        let width = self.written.len();
        let way = |(entry, &end): (usize, &f64)| {
            let changes = self.written.iter().zip(&self.values[entry * width..][..width]);
            let new = changes.filter(|(_, change)| change.stay == 0);
            let new = new.map(|(&variable, change)| (variable, f64::from_bits(change.set))).collect();
            self.faults[entry].is_none().then_some((end, new))
        };
        (ways.first as usize..last).zip(blocks.as_flattened()).map(way).collect()
    }

    /// Whether a clock runs in a row.
    #[inline(always)]
    pub(super) fn runs(&self, row: usize, clock: usize) -> bool {
        self.ways[row * self.clocks + clock].blocks > 0
    }

    /// A clock rings in a lane: what belongs to a number in (0, 1) happens.
    #[inline(always)]
    pub(super) fn fire(
        &self,
        row: usize,
        clock: usize,
        u: f64,
        lane: usize,
        variables: &mut [Lanes],
    ) -> Result<(), Fault> {
        let ways = self.ways[row * self.clocks + clock];
        let mut entry = ways.first as usize;
        // Ends ascend, so the way is the number of ends passed: no jump depends on chance.
        for ends in &self.ends[ways.block as usize..(ways.block + ways.blocks) as usize] {
            for &end in ends {
                entry += usize::from(u >= end);
            }
        }
        if self.faulty
            && let Some(fault) = self.faults[entry]
        {
            return Err(fault);
        }
        let width = self.written.len();
        for (&variable, change) in self.written.iter().zip(&self.values[entry * width..][..width]) {
            let value = &mut variables[variable as usize].0[lane];
            *value = f64::from_bits(value.to_bits() & change.stay | change.set);
        }
        Ok(())
    }
}
