//! A process as a table: for each combination of the values it reads, what may happen at each of its events.
//!
//! The table is made by the same code that runs processes without a table, so both take the same branch for the same
//! number.

use super::super::code::{Code, Readings};
use super::super::state::State;
use super::commands::{Commands, Event, Way};
use super::draws::Draws;
use super::keys::Keys;
use crate::base::lanes::{LANES, Lanes, Mask};
use crate::kernel::fault::{Fault, Faults};
use crate::model::{Domain, Scenario};
use std::collections::BTreeSet;

/// Most rows of a table.
pub(super) const MOST_ROWS: u64 = 1 << 14;
/// Most ways of all rows.
const MOST_ENTRIES: usize = 1 << 18;

/// The ends of so many ways are looked at together.
const BLOCK: usize = 4;

/// Ways of one event in one row.
#[derive(Clone, Copy, Debug, Default)]
struct Ways {
    /// The first one.
    first: u32,
    /// The first block of ends, and how many blocks; none where there is no way. At a step none where there is one.
    block: u32,
    blocks: u32,
}

/// A new value of a variable, as bits: those of the old one that stay, and those that are set.
#[derive(Clone, Copy, Debug)]
struct Change {
    stay: u64,
    set: u64,
}

impl Change {
    const NONE: Self = Self { stay: u64::MAX, set: 0 };

    #[inline(always)]
    fn of(self, old: f64) -> f64 {
        f64::from_bits(old.to_bits() & self.stay | self.set)
    }
}

/// A process as a table.
#[derive(Clone, Debug)]
pub(super) struct Table {
    pub(super) keys: Keys,
    /// What happens by itself in each row: a step alone, or a race and the delays of commands.
    events: Vec<Event>,
    /// Rate of the race in each row, and 1 over it; NaN where one is wrong.
    totals: Vec<(f64, f64)>,
    /// What is wrong there.
    wrong: Vec<(usize, Fault)>,
    /// Row by row, the ways of each event.
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

/// What may happen in a row: where the share of each way ends in (0, 1], and the new values.
pub(super) type Outcomes = Vec<(f64, Vec<(u32, f64)>)>;

impl Table {
    /// The table of a process, if it reads few values and nothing but variables, and no event leaves to chance which command
    /// is taken beside which branch.
    pub(super) fn of(
        scenario: &Scenario,
        number: usize,
        domains: &[Domain],
        events: &[Event],
        most: u64,
    ) -> Option<Self> {
        let process = &scenario.processes.list[number];
        let mut read = BTreeSet::new();
        if !process.reads(&mut read) {
            return None;
        }
        let keys = Keys::of(&read, domains, most)?;
        let (mut atoms, mut signals) = (Vec::new(), Vec::new());
        let commands = Commands::of(number, process, domains, &mut atoms, &mut signals);
        let code = Code::compile(scenario, &atoms, &signals);
        let mut table = Self {
            keys: keys.clone(),
            events: events.to_vec(),
            totals: Vec::new(),
            wrong: Vec::new(),
            ways: Vec::new(),
            ends: Vec::new(),
            written: commands.written().into_iter().collect(),
            values: Vec::new(),
            faults: Vec::new(),
            faulty: false,
        };
        keys.each_row(&code, domains.len(), |readings, lane| table.enter(&commands, readings, lane))?;
        Some(table)
    }

    /// Adds a row; `None` where chance picks the command too, or the table grows too large.
    fn enter(&mut self, commands: &Commands, readings: &Readings, lane: usize) -> Option<()> {
        match commands.total(readings, lane) {
            Ok(total) => self.totals.push((total, 1.0 / total)),
            Err(fault) => {
                self.wrong.push((self.totals.len(), fault));
                self.totals.push((f64::NAN, f64::NAN));
            }
        }
        for event in self.events.clone() {
            let mut found: Vec<(Way, f64)> = Vec::new();
            let runs = match event {
                Event::Step if commands.must_choose(readings, lane) => return None,
                Event::Delay(command) => commands.enabled(command, readings, lane),
                Event::Step | Event::Race => true,
            };
            if runs {
                commands.ways(event, readings, lane, |way, end| {
                    found.push((way, end));
                    true
                });
            }
            let (first, block) = (self.faults.len() as u32, self.ends.len() as u32);
            let is_sure = event == Event::Step && found.len() <= 1;
            if !is_sure {
                self.add_ends(&found);
            }
            self.ways.push(Ways { first, block, blocks: self.ends.len() as u32 - block });
            for &(way, _) in &found {
                self.add_way(way.and_then(|way| commands.values(way, readings, lane)));
            }
            // A step at which nothing is enabled leads on too.
            if is_sure && found.is_empty() {
                self.add_way(Ok(Vec::new()));
            }
        }
        (self.faults.len() <= MOST_ENTRIES).then_some(())
    }

    fn add_ends(&mut self, found: &[(Way, f64)]) {
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
    }

    fn add_way(&mut self, values: Result<Vec<(u32, f64)>, Fault>) {
        self.faulty |= values.is_err();
        self.faults.push(values.as_ref().err().copied());
        let values = values.unwrap_or_default();
        for variable in &self.written {
            let new = values.iter().find(|(v, _)| v == variable);
            self.values.push(new.map_or(Change::NONE, |(_, value)| Change { stay: 0, set: value.to_bits() }));
        }
    }

    /// The variables that it writes.
    pub(super) fn written(&self) -> &[u32] {
        &self.written
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
        self.events.len() > 1
    }

    /// What may happen at the first event, the step or the race, in a row; `None` if there is an error among that.
    pub(super) fn outcomes(&self, row: usize) -> Option<Outcomes> {
        let place = row * self.events.len();
        let ways = self.ways.get(place)?;
        let blocks = &self.ends[ways.block as usize..(ways.block + ways.blocks) as usize];
        let ends = blocks.as_flattened().iter().chain(std::iter::repeat(&1.0));
        let last = self.ways.get(place + 1).map_or(self.faults.len(), |next| next.first as usize);
        let width = self.written.len();
        let way = |(entry, &end): (usize, &f64)| {
            let changes = self.written.iter().zip(&self.values[entry * width..][..width]);
            let new = changes.filter(|(_, change)| change.stay == 0);
            let new = new.map(|(&variable, change)| (variable, f64::from_bits(change.set))).collect();
            self.faults[entry].is_none().then_some((end, new))
        };
        (ways.first as usize..last).zip(ends).map(way).collect()
    }

    /// Whether an event comes in a row.
    #[inline(always)]
    pub(super) fn runs(&self, row: usize, event: usize) -> bool {
        self.ways[row * self.events.len() + event].blocks > 0
    }

    /// An event comes in a lane: what belongs to a number in (0, 1) happens.
    #[inline(always)]
    pub(super) fn fire(
        &self,
        row: usize,
        event: usize,
        u: f64,
        lane: usize,
        variables: &mut [Lanes],
    ) -> Result<(), Fault> {
        let ways = self.ways[row * self.events.len() + event];
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
            *value = change.of(*value);
        }
        Ok(())
    }

    /// One step of all lanes: new values go to `next`.
    #[inline]
    pub(super) fn step(
        &self,
        lanes: Mask,
        state: &State,
        draws: &Draws<'_>,
        next: &mut [Lanes],
        faults: &mut Faults,
    ) {
        // Lanes without a trial may hold anything, and go anywhere.
        let rows = self.keys.rows_in_lanes(&state.variables);
        let ways = rows.map(|row| self.ways.get(row).copied().unwrap_or_default());
        let mut entries = ways.map(|ways| ways.first as usize);
        let most = ways.iter().fold(0, |most, ways| most.max(ways.blocks));
        if most > 0 {
            let [numbers, _] = draws.pair();
            for block in 0..most {
                for lane in 0..LANES {
                    if block < ways[lane].blocks {
                        let ends = &self.ends[(ways[lane].block + block) as usize];
                        let passed: usize = ends.iter().map(|&end| usize::from(numbers[lane] >= end)).sum();
                        entries[lane] += passed;
                    }
                }
            }
        }
        if self.faulty {
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
                values[lane] = self.values[entries[lane] * width + k].of(values[lane]);
            }
        }
    }
}
