//! Rows of tables of traces: of several trials, with names of agents instead of ids.

use super::line::LineError;
use super::recording::Recording;
use super::timed::{self, TimedRow};
use std::collections::{BTreeMap, BTreeSet};

/// Trials that a message names.
const NAMED: usize = 8;

/// The rows of a table. Until they are numbered, the id of an agent that has a name is the place of this name.
#[derive(Debug, Default)]
pub(super) struct Traces {
    rows: Vec<(Option<u64>, TimedRow)>,
    names: Vec<String>,
    known: BTreeMap<String, u32>,
}

impl Traces {
    /// The place of a name, which stands for its id.
    pub(super) fn place(&mut self, name: &str) -> u32 {
        if let Some(place) = self.known.get(name) {
            return *place;
        }
        let place = self.names.len() as u32;
        self.names.push(name.to_owned());
        self.known.insert(name.to_owned(), place);
        place
    }

    /// The next row, with its trial where the table has trials.
    pub(super) fn push(&mut self, trial: Option<u64>, row: TimedRow) {
        self.rows.push((trial, row));
    }

    /// The rows of a trial, or of the only one. Names that are all whole numbers are the ids; else the agents are 1, 2, …
    /// in the order in which they come.
    ///
    /// # Errors
    /// Where several trials could be meant, or the one that is wanted is not there.
    pub(super) fn of_trial(self, wanted: Option<u64>) -> Result<Vec<TimedRow>, LineError> {
        let Self { rows, names, .. } = self;
        let trials: BTreeSet<u64> = rows.iter().filter_map(|(trial, _)| *trial).collect();
        let listed = || {
            let shown: Vec<String> = trials.iter().take(NAMED).map(u64::to_string).collect();
            format!("{}{}", shown.join(", "), if trials.len() > NAMED { ", …" } else { "" })
        };
        let fault = match wanted {
            Some(_) if rows.is_empty() => None,
            Some(_) if trials.is_empty() => Some("the table has no column `trial`".to_owned()),
            Some(trial) if !trials.contains(&trial) => {
                Some(format!("the table has no trial {trial}; its trials are {}", listed()))
            }
            None if trials.len() > 1 => {
                Some(format!("the table has the trials {}: choose one with `trial`", listed()))
            }
            _ => None,
        };
        if let Some(fault) = fault {
            return Err(LineError::of_file(fault));
        }
        let chosen = rows.into_iter().filter(|(trial, _)| wanted.is_none() || *trial == wanted);
        let mut rows: Vec<TimedRow> = chosen.map(|(_, row)| row).collect();
        if names.is_empty() {
            return Ok(rows);
        }
        let whole = |name: &String| name.parse::<u32>().ok().filter(|id| id.to_string() == *name);
        let ids: Option<Vec<u32>> = names.iter().map(whole).collect();
        let mut numbers = BTreeMap::<u32, u32>::new();
        for row in &mut rows {
            let next = numbers.len() as u32 + 1;
            row.id = match &ids {
                Some(ids) => ids[row.id as usize],
                None => *numbers.entry(row.id).or_insert(next),
            };
        }
        Ok(rows)
    }

    /// The recording of a trial.
    ///
    /// # Errors
    /// The errors found so far, those of [`Traces::of_trial`], and as for a table with times.
    pub(super) fn recording(
        self,
        mut errors: Vec<LineError>,
        wanted: Option<u64>,
    ) -> Result<Recording, Vec<LineError>> {
        match self.of_trial(wanted) {
            Ok(rows) => timed::recording(&rows, errors),
            Err(error) => {
                errors.insert(0, error);
                Err(errors)
            }
        }
    }
}
