//! Parts that stay in memory: the outcomes of a call, for its certificate; and those of a certificate.

use super::Origin;
use super::part::{Body, Head, Part};
use super::table::Table;
use super::unit::{Trials, Unit};
use crate::engine::sampling::splitting::{RunRecord, SplitRun};
use crate::trials::cell::{Cell, Reading};
use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

/// The parts of a call as they come.
#[derive(Default)]
pub struct Kept(Mutex<Vec<Part>>);

/// Trials of one column: its world, the option that is followed, and its number there.
pub type Column = (usize, Option<(usize, usize)>, usize);

impl Kept {
    /// Keeps a part.
    pub fn keep(&self, part: &Part) {
        let mut part = part.clone();
        let Part { head, bodies } = &mut part;
        for (unit, body) in head.units.iter().zip(bodies) {
            if let (Unit::Trials(trials), Body::Trials(table)) = (unit, body) {
                // What was just made fits together.
                let _ = table.settle(trials.to - trials.from, trials.columns.len());
            }
        }
        self.0.lock().unwrap_or_else(PoisonError::into_inner).push(part);
    }

    /// The readings of the first so many trials of a column; fewer where some are not there.
    pub fn readings(&self, (world, advice, column): Column, count: u64) -> Vec<Reading> {
        let parts = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let units = parts.iter().flat_map(|part| part.head.units.iter().zip(&part.bodies));
        let mut pieces: Vec<_> = units
            .filter_map(|(unit, body)| {
                let (Unit::Trials(trials), Body::Trials(table)) = (unit, body) else { return None };
                let at = trials.columns.iter().position(|known| *known == column)?;
                (trials.world == world && trials.advice == advice).then_some((trials, table, at))
            })
            .collect();
        pieces.sort_by_key(|(trials, ..)| trials.from);
        let mut found = Vec::new();
        for (trials, table, at) in pieces {
            let known = found.len() as u64;
            if trials.from <= known {
                let row = |index: u64| table.cell((index - trials.from) as usize, at).reading;
                found.extend((known..trials.to.min(count)).map(row));
            }
        }
        found
    }

    /// The runs of splitting of a world, in the order of their numbers.
    pub fn runs(&self, world: usize) -> Vec<(SplitRun, RunRecord)> {
        let parts = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let units = parts.iter().flat_map(|part| part.head.units.iter().zip(&part.bodies));
        let runs = units.filter_map(|(unit, body)| match (unit, body) {
            (Unit::Run(run), Body::Run(Some(record))) if run.world == world => {
                Some((run.clone(), record.clone()))
            }
            _ => None,
        });
        runs.collect()
    }
}

impl Part {
    /// Readings and runs that somebody gives, as a part of no study. Columns of one world and option are of the same trials.
    pub fn given(readings: &[(Column, Vec<Reading>)], runs: &[(SplitRun, RunRecord)]) -> Self {
        let mut tables: BTreeMap<_, Vec<(usize, &[Reading])>> = BTreeMap::new();
        for ((world, advice, column), readings) in readings {
            let table = tables.entry((*world, *advice)).or_default();
            if table.iter().all(|(known, _)| known != column) {
                table.push((*column, readings));
            }
        }
        let cell = |reading| Cell { reading, steps: 0, triggered: u64::MAX, shrunk: false, no_way: false };
        let (mut units, mut bodies) = (Vec::new(), Vec::new());
        for ((world, advice), columns) in tables {
            let count = columns.iter().map(|(_, readings)| readings.len()).min().unwrap_or(0);
            let row = |k: usize| columns.iter().map(move |(_, readings)| cell(readings[k]));
            let cells: Vec<Cell> = (0..count).flat_map(row).collect();
            let mut table = Table::new(columns.len());
            table.push(&cells);
            let columns: Vec<usize> = columns.iter().map(|(column, _)| *column).collect();
            // What was just made fits together.
            let _ = table.settle(count as u64, columns.len());
            units.push(Unit::Trials(Trials { world, columns, advice, from: 0, to: count as u64 }));
            bodies.push(Body::Trials(table));
        }
        for (run, record) in runs {
            units.push(Unit::Run(run.clone()));
            bodies.push(Body::Run(Some(record.clone())));
        }
        let origin = Origin { version: String::new(), print: String::new(), seed: 0 };
        Self { head: Head { origin, seconds: 0.0, units }, bodies }
    }
}
