//! Whether outcomes of trials depend on each other, as the number of runs of equal ones in a row tells (Wald, Wolfowitz 1940).
//! Trials of the kernel are independent by construction; those of other programs need not be.

use crate::compile::Study;
use crate::engine::sampling::splitting::{RunRecord, SplitRun};
use crate::engine::trials::executor::{Cells, Executor, Job};
use crate::logic::Invalid;
use crate::trials::budget::Budget;
use crate::trials::cell::{Cell, Item, Reading};
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::{Mutex, PoisonError};

/// Fewer outcomes show no dependence, and such a distance from what independent ones have, in standard deviations, does:
/// by chance it comes in one of 16 000 columns.
const FEWEST: u64 = 40;
const FAR: f64 = 4.0;

/// Runs of equal truth values in the trials of each column of each world, as far as they were looked at.
#[derive(Default)]
pub struct Dependence(Mutex<BTreeMap<(usize, usize, Advice), Runs>>);

/// The option of a ranking of moves that an item follows.
type Advice = Option<(usize, usize)>;

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
    fn see(&self, job: &Job<'_>, item: Item, row: &[Cell]) {
        let mut all = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        for (cell, column) in row.iter().zip(&job.columns) {
            let runs = all.entry((job.prepared.number.unwrap_or(0), *column, item.advice)).or_default();
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
        far.map(|((world, column, _), runs)| {
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

/// An executor whose trials the kernel does not make: its outcomes are looked at.
pub struct Untrusted<'a> {
    own: &'a dyn Executor,
    /// What the outcomes tell.
    pub dependence: Dependence,
    /// Whether one trial in a hundred runs twice: a driver that answers otherwise the second time says so itself, as a fault.
    is_twice: bool,
}

impl<'a> Untrusted<'a> {
    /// Of this executor.
    pub fn new(own: &'a dyn Executor, is_twice: bool) -> Self {
        Self { own, dependence: Dependence::default(), is_twice }
    }

    /// The places of the items that run twice.
    fn checked<'i>(&self, items: &'i [Item]) -> impl Iterator<Item = usize> + use<'i> {
        let is_twice = self.is_twice;
        (0..items.len()).filter(move |place| is_twice && items[*place].index.is_multiple_of(TWICE))
    }
}

impl Executor for Untrusted<'_> {
    fn run(&self, job: &Job<'_>, items: &[Item], budget: &Budget) -> Result<Cells, Invalid> {
        Ok(self.run_all(&[(job, items.to_vec())], budget)?.pop().unwrap_or_default())
    }

    fn run_all(&self, parts: &[(&Job<'_>, Vec<Item>)], budget: &Budget) -> Result<Vec<Cells>, Invalid> {
        // Beside the others, so that they fill lanes instead of batches of their own.
        let again = |items: &[Item]| -> Vec<Item> {
            items.iter().copied().chain(self.checked(items).map(|place| items[place])).collect()
        };
        let both: Vec<_> = parts.iter().map(|(job, items)| (*job, again(items))).collect();
        let mut all = self.own.run_all(&both, budget)?;
        for ((job, items), cells) in parts.iter().zip(&mut all) {
            for (row, place) in (items.len()..).zip(self.checked(items)) {
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
        }
        Ok(all)
    }

    fn width(&self, job: &Job<'_>) -> usize {
        self.own.width(job)
    }

    fn everywhere(&self, work: &(dyn Fn() + Sync)) {
        self.own.everywhere(work);
    }

    fn is_stored(&self) -> bool {
        self.own.is_stored()
    }

    fn request(&self, job: &Job<'_>, advice: Option<(usize, usize)>, trials: Range<u64>) -> bool {
        self.own.request(job, advice, trials)
    }

    fn record(&self, run: &SplitRun) -> Option<Option<RunRecord>> {
        self.own.record(run)
    }

    fn made(&self, run: &SplitRun, record: &RunRecord) {
        self.own.made(run, record);
    }
}
