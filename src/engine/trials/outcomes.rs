//! An executor over outcomes that exist already: a trial is a row of numbers, one for each variable of a world in which
//! nothing changes. Rows are read when they are asked for, so a stream is read no farther than a query needs it.

use crate::base::lanes::Mask;
use crate::base::random::TrialKey;
use crate::engine::trials::executor::{Cells, Executor, Job, Threads};
use crate::kernel::Run;
use crate::logic::Invalid;
use crate::model::VariableId;
use crate::trials::batch::Monitors;
use crate::trials::budget::Budget;
use crate::trials::cell::{Item, Reading};
use crate::trials::columns::StepColumns;
use std::collections::BTreeSet;
use std::ops::Range;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Reads the values of the next trial, NaN for those that it lacks; `None` after the last one.
pub type Source<'a> = dyn FnMut() -> Result<Option<Vec<f64>>, String> + Send + 'a;

/// Trials whose outcomes are there.
pub struct Outcomes<'a> {
    threads: &'a Threads,
    /// Trials that are asked for at a time.
    width: usize,
    known: Mutex<Known<'a>>,
}

/// Rows that were read.
struct Known<'a> {
    source: Box<Source<'a>>,
    rows: Vec<Vec<f64>>,
    is_over: bool,
    error: Option<String>,
}

impl Known<'_> {
    /// Reads up to so many rows, as far as there are any.
    fn read_to(&mut self, count: usize) {
        while self.rows.len() < count && !self.is_over {
            match (self.source)() {
                Ok(Some(row)) => self.rows.push(row),
                Ok(None) => self.is_over = true,
                Err(error) => (self.is_over, self.error) = (true, Some(error)),
            }
        }
    }
}

impl<'a> Outcomes<'a> {
    /// Of a source of rows, of which `width` are asked for at a time.
    pub fn new(source: Box<Source<'a>>, width: usize, threads: &'a Threads) -> Self {
        let known = Known { source, rows: Vec::new(), is_over: false, error: None };
        Self { threads, width, known: Mutex::new(known) }
    }

    fn known(&self) -> MutexGuard<'_, Known<'a>> {
        self.known.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Why reading ended before the last row, if it did.
    pub fn error(&self) -> Option<String> {
        self.known().error.clone()
    }
}

impl Executor for Outcomes<'_> {
    fn run(&self, job: &Job<'_>, items: &[Item], _: &Budget) -> Result<Cells, Invalid> {
        let mut cells = job.cells(items.len(), false);
        let mut known = self.known();
        known.read_to(items.iter().map(|item| item.index as usize + 1).max().unwrap_or(0));
        let prepared = job.prepared;
        let Ok(mut run) = Run::given(&prepared.program, TrialKey::default()) else { return Ok(cells) };
        let mut monitors = StepColumns::new(prepared, &job.columns)?;
        let there = items.iter().take_while(|item| (item.index as usize) < known.rows.len()).count();
        for (place, item) in items[..there].iter().enumerate() {
            run.put(&known.rows[item.index as usize]);
            monitors.start(0, false);
            for tick in 0..=prepared.horizon.0 {
                run.show(tick, |_| None);
                if monitors.observe(&run, Mask::lane(0)).has(0) {
                    break;
                }
            }
            monitors.finish(place, 0, &run);
        }
        let read: Vec<BTreeSet<VariableId>> =
            job.columns.iter().map(|column| prepared.variables(*column)).collect();
        let width = job.columns.len();
        let mut found = monitors.take().cells;
        for (place, (row, item)) in found.chunks_exact_mut(width.max(1)).zip(items).enumerate() {
            for (cell, read) in row.iter_mut().zip(&read) {
                let values = &known.rows[item.index as usize];
                if read.iter().any(|variable| values[variable.0 as usize].is_nan()) {
                    cell.reading = Reading::Unresolved;
                }
            }
            cells.put(place, row);
        }
        Ok(cells)
    }

    fn width(&self, _: &Job<'_>) -> usize {
        self.width
    }

    fn everywhere(&self, work: &(dyn Fn() + Sync)) {
        self.threads.everywhere(work);
    }

    fn is_stored(&self) -> bool {
        true
    }

    fn request(&self, _: &Job<'_>, _: Option<(usize, usize)>, trials: Range<u64>) -> bool {
        let mut known = self.known();
        known.read_to(trials.start as usize + 1);
        known.rows.len() as u64 <= trials.start
    }
}
