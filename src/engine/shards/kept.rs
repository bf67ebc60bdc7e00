//! Parts that stay in memory: the outcomes of a call, for its certificate.

use super::part::{Body, Part};
use super::unit::Unit;
use crate::engine::sampling::splitting::{RunRecord, SplitRun};
use crate::trials::cell::Reading;
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
