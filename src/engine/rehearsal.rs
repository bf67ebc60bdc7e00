//! The first trials of a query, run before the others: they tell how long a trial takes and roughly what it
//! yields, so that a forecast stands before the sampling. They are the trials that sampling begins with, and
//! are not run twice unless they were too slow to finish in the rehearsal.

use super::budget::Budget;
use super::cell::{Cell, Item};
use super::executor::{Cells, Executor, Job};
use super::fault::Fault;
use std::sync::atomic::Ordering;

/// Longest rehearsal of one job, s.
const LONGEST: f64 = 0.5;

/// The first trials of a job.
pub(super) struct Rehearsal {
    /// Which trials.
    pub(super) items: Vec<Item>,
    /// What they yielded.
    pub(super) cells: Cells,
    /// How long they took, s.
    seconds: f64,
    /// Steps made.
    steps: u64,
}

impl Rehearsal {
    /// Runs the items, for half a second at most.
    pub(super) fn run(
        job: &Job<'_>,
        items: Vec<Item>,
        executor: &dyn Executor,
        budget: &Budget,
    ) -> Result<Self, Fault> {
        let before = (budget.elapsed(), job.steps.load(Ordering::Relaxed));
        let cells = executor.run(job, &items, &budget.ahead(LONGEST))?;
        let seconds = budget.elapsed() - before.0;
        let steps = job.steps.load(Ordering::Relaxed) - before.1;
        Ok(Self { items, cells, seconds, steps })
    }

    /// Whether all of them finished.
    pub(super) fn is_complete(&self) -> bool {
        self.cells.rows().all(|row| row.is_some())
    }

    /// The finished rows.
    pub(super) fn rows(&self) -> impl Iterator<Item = &[Cell]> {
        self.cells.rows().flatten()
    }

    /// Seconds a trial takes, all threads at work. Where none finished, a trial takes all steps to the horizon; where
    /// that is not known, twice as many as were made so far.
    pub(super) fn seconds_per_trial(&self, horizon: Option<u64>) -> f64 {
        let finished = self.rows().count();
        if finished == self.items.len() {
            return self.seconds / finished.max(1) as f64;
        }
        let longest = |row: &[Cell]| row.iter().map(|cell| cell.steps).max().unwrap_or(0) as f64;
        let horizon = horizon.unwrap_or_else(|| 2 * self.steps / self.items.len().max(1) as u64);
        let steps = if finished == 0 {
            horizon.max(1) as f64
        } else {
            // The short trials finish first, so half of the way from their mean to the horizon is a fair guess.
            let mean = self.rows().map(longest).sum::<f64>() / finished as f64;
            0.5 * (mean + horizon as f64)
        };
        steps * self.seconds / self.steps.max(1) as f64
    }
}
