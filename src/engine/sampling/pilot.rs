//! The first trials of a query, run before the others: they tell how long a trial takes and roughly what it
//! yields, so that a forecast stands before the sampling. They are the trials that sampling begins with, and
//! are not run twice unless they were too slow to finish in the pilot.

use crate::engine::fault::Fault;
use crate::engine::sampling::watch::Forecast;
use crate::engine::trials::executor::{Cells, Executor, Job};
use crate::trials::budget::Budget;
use crate::trials::cell::{Cell, Item};
use std::sync::atomic::Ordering;

/// Trials that a forecast looks at: as many on every machine, so that it is the same on every machine.
const SEEN: usize = 16;
/// Longest pilot of one job, s.
const LONGEST: f64 = 0.5;

/// Part of a first run is the making of workers, which matters where it is shorter than this, s.
const COLD: f64 = 0.1;
/// A run that is shorter than this times no trials, s.
const SHORT: f64 = 0.01;
/// Most trials of such a run.
const MOST_TIMED: u64 = 8192;

/// Seconds a trial takes once workers are made, where a first run of so many was short.
pub(super) fn timed(
    job: &Job<'_>,
    (mut count, each): (u64, f64),
    executor: &dyn Executor,
    budget: &Budget,
) -> Result<f64, Fault> {
    if each * count as f64 > COLD {
        return Ok(each);
    }
    loop {
        let before = budget.elapsed();
        executor.run(job, &Item::run(0, count), &budget.ahead(LONGEST))?;
        let taken = budget.elapsed() - before;
        if taken > SHORT || count >= MOST_TIMED {
            return Ok(taken / count as f64);
        }
        count *= 8;
    }
}

/// Queries that are sampled together and begin with a pilot.
pub(in crate::engine) trait Piloted {
    /// Runs the first trials, and forecasts from them what each query is likely to take.
    fn pilot(&mut self, executor: &dyn Executor, budget: &Budget) -> Result<Vec<Forecast>, Fault>;

    /// Whether no trial was read yet.
    fn is_unread(&self) -> bool;

    /// Whether it gets its share of the time at once, because it cannot go on later.
    fn is_whole(&self) -> bool {
        false
    }
}

/// The first trials of a job.
pub(in crate::engine) struct Pilot {
    /// Which trials.
    pub(in crate::engine) items: Vec<Item>,
    /// What they yielded.
    pub(in crate::engine) cells: Cells,
    /// How long they took, s.
    pub(in crate::engine) seconds: f64,
    /// Steps made.
    steps: u64,
}

impl Pilot {
    /// How many trials a pilot has, where so many run side by side.
    pub(in crate::engine) const fn size(width: u64) -> u64 {
        if width < SEEN as u64 { SEEN as u64 } else { width }
    }

    /// Runs the items, for half a second at most.
    pub(super) fn run(
        job: &Job<'_>,
        items: Vec<Item>,
        executor: &dyn Executor,
        budget: &Budget,
    ) -> Result<Self, Fault> {
        let steps = || job.steps.load(Ordering::Relaxed);
        Self::of(items, &steps, budget, |items, ahead| Ok(executor.run(job, items, ahead)?))
    }

    /// The same of items that `run` runs; `steps` tells how many steps were made so far.
    pub(super) fn of(
        items: Vec<Item>,
        steps: &dyn Fn() -> u64,
        budget: &Budget,
        run: impl FnOnce(&[Item], &Budget) -> Result<Cells, Fault>,
    ) -> Result<Self, Fault> {
        let before = (budget.elapsed(), steps());
        let cells = run(&items, &budget.ahead(LONGEST))?;
        let seconds = budget.elapsed() - before.0;
        Ok(Self { items, cells, seconds, steps: steps() - before.1 })
    }

    /// Whether all of them finished.
    pub(super) fn is_complete(&self) -> bool {
        self.cells.rows().all(|row| row.is_some())
    }

    /// The rows that a forecast is made from: the first 16 trials, or where these did not finish in time, the first 8, 4, 2
    /// or 1. What the clock lets through beyond these leaves no trace in the number of trials.
    pub(super) fn seen(&self) -> impl Iterator<Item = &[Cell]> {
        let whole = self.cells.rows().take_while(Option::is_some).count();
        let whole = whole.min(self.items.len());
        let seen = if whole == self.items.len() || whole >= SEEN {
            whole.min(SEEN)
        } else {
            whole.checked_ilog2().map_or(0, |power| 1 << power)
        };
        self.cells.rows().take(seen).flatten()
    }

    /// The finished rows.
    fn rows(&self) -> impl Iterator<Item = &[Cell]> {
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
