//! Whether outcomes of trials depend on each other, as the number of runs of equal ones in a row tells (Wald, Wolfowitz 1940).
//! Trials of the kernel are independent by construction; those of other programs need not be.

use crate::compile::Study;
use crate::engine::trials::executor::{Cells, Executor, Job, Threads};
use crate::logic::Invalid;
use crate::trials::budget::Budget;
use crate::trials::cell::{Cell, Item, Reading};
use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

/// Fewer outcomes show no dependence, and such a distance from what independent ones have, in standard deviations, does:
/// by chance it comes in one of 16 000 columns.
const FEWEST: u64 = 40;
const FAR: f64 = 4.0;

/// Runs of equal truth values in the trials of each column of each world, as far as they were looked at.
#[derive(Debug, Default)]
pub struct Dependence(Mutex<BTreeMap<(usize, usize), Runs>>);

/// Runs of equal truth values.
#[derive(Clone, Copy, Debug, Default)]
struct Runs {
    /// Trials that were looked at.
    next: u64,
    last: Option<bool>,
    counts: [u64; 2],
    /// How many runs they make.
    found: u64,
}

impl Runs {
    fn see(&mut self, truth: bool) {
        self.found += u64::from(self.last != Some(truth));
        self.counts[usize::from(truth)] += 1;
        self.last = Some(truth);
    }

    /// Mean number of runs under independence.
    fn mean(&self) -> f64 {
        let [a, b] = self.counts.map(|count| count as f64);
        2.0 * a * b / (a + b) + 1.0
    }

    /// How far the number of runs is from its mean under independence, in standard deviations.
    fn distance(&self) -> f64 {
        let n = (self.counts[0] + self.counts[1]) as f64;
        let mean = self.mean();
        let variance = (mean - 1.0) * (mean - 2.0) / (n - 1.0);
        if n >= FEWEST as f64 && variance > 1.0 { (self.found as f64 - mean) / variance.sqrt() } else { 0.0 }
    }
}

impl Dependence {
    /// Looks at the cells of a trial of a job.
    pub(super) fn see(&self, job: &Job<'_>, item: Item, row: &[Cell]) {
        if item.advice.is_some() {
            return;
        }
        let mut all = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        for (cell, column) in row.iter().zip(&job.columns) {
            let runs = all.entry((job.prepared.number.unwrap_or(0), *column)).or_default();
            if runs.next == item.index {
                runs.next += 1;
                cell.reading.truth().into_iter().for_each(|truth| runs.see(truth));
            }
        }
    }

    /// A warning for each column whose outcomes are not independent.
    pub fn warnings(&self, study: &Study) -> Vec<String> {
        let all = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let far = all.iter().filter(|(_, runs)| runs.distance().abs() > FAR);
        far.map(|((world, column), runs)| {
            let column = study.worlds.get(*world).and_then(|world| world.columns.get(*column));
            format!(
                "outcomes of `{}` depend on each other: {} of them have {} runs of equal ones, independent ones about {:.0}; \
                 errors of the results may be larger than stated",
                column.map_or("", |column| column.text.as_str()),
                runs.counts[0] + runs.counts[1],
                runs.found,
                runs.mean()
            )
        })
        .collect()
    }
}

/// One trial of so many runs twice where drivers are not those of the kernel.
const TWICE: u64 = 100;

/// Threads whose outcomes are looked at.
pub struct Watched<'a> {
    threads: &'a Threads,
    /// What the outcomes tell.
    pub dependence: Dependence,
    is_twice: bool,
}

impl<'a> Watched<'a> {
    /// Of these threads.
    pub fn new(threads: &'a Threads) -> Self {
        Self { threads, dependence: Dependence::default(), is_twice: false }
    }

    /// One trial in a hundred runs twice: a driver that answers otherwise the second time says so itself, as a fault.
    #[must_use]
    pub fn twice(self, is_twice: bool) -> Self {
        Self { is_twice, ..self }
    }
}

impl Executor for Watched<'_> {
    fn run(&self, job: &Job<'_>, items: &[Item], budget: &Budget) -> Result<Cells, Invalid> {
        let is_checked = |place: &usize| self.is_twice && items[*place].index.is_multiple_of(TWICE);
        let checked: Vec<usize> = (0..items.len()).filter(is_checked).collect();
        // Beside the others, so that they fill lanes instead of batches of their own.
        let again: Vec<Item> = checked.iter().map(|place| items[*place]).collect();
        let mut cells = self.threads.run(job, &[items, &again].concat(), budget)?;
        for (row, place) in (items.len()..).zip(checked) {
            let row = cells.row(row).filter(|row| row.iter().any(|cell| cell.reading == Reading::Faulty));
            if let Some(row) = row.map(<[Cell]>::to_vec) {
                cells.put(place, &row);
            }
        }
        cells.truncate(items.len());
        for (item, row) in items.iter().zip(cells.rows()) {
            if let Some(row) = row {
                self.dependence.see(job, *item, row);
            }
        }
        Ok(cells)
    }

    fn width(&self, job: &Job<'_>) -> usize {
        self.threads.width(job)
    }

    fn everywhere(&self, work: &(dyn Fn() + Sync)) {
        self.threads.everywhere(work);
    }
}
