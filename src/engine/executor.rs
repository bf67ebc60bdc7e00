//! Executors: they run the items of a round and hand back their cells in the order of the items.
//!
//! Which thread runs which trial, and in which lane, leaves no trace: outcomes are put in the order of their
//! items before anybody looks at them.

use super::budget::Budget;
use super::cell::{Cell, Item};
use super::runner::Runner;
use super::subject::Subject;
use super::worker::Finished;
use crate::logic::Invalid;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};

/// Cells of a round, by place of the item.
#[derive(Clone, Debug, Default)]
pub struct Cells {
    /// Number of columns.
    width: usize,
    list: Vec<Cell>,
    /// Which trials were finished in time.
    finished: Vec<bool>,
}

impl Cells {
    /// Room for a round.
    pub fn new(items: usize, width: usize) -> Self {
        Self { width, list: vec![Cell::BLANK; items * width], finished: vec![false; items] }
    }

    /// The trial at a place is finished. A place beyond the round, or a row of another width, is ignored.
    pub fn put(&mut self, place: usize, row: &[Cell]) {
        if let Some(finished) = self.finished.get_mut(place)
            && row.len() == self.width
        {
            *finished = true;
            self.list[place * self.width..][..self.width].copy_from_slice(row);
        }
    }

    /// The cells of a trial, one a column; `None` if it was not finished in time.
    pub fn row(&self, place: usize) -> Option<&[Cell]> {
        (*self.finished.get(place)?).then(|| &self.list[place * self.width..][..self.width])
    }

    /// The rows in order.
    pub fn rows(&self) -> impl Iterator<Item = Option<&[Cell]>> {
        (0..self.finished.len()).map(|place| self.row(place))
    }
}

/// Runs rounds of trials.
pub trait Executor: Sync {
    /// Runs the items of a round for some columns of a subject.
    fn run(&self, job: &Job<'_>, items: &[Item], budget: &Budget) -> Result<Cells, Invalid>;

    /// How many trials run side by side.
    fn width(&self, job: &Job<'_>) -> usize;

    /// Calls `work` once on each thread, and returns when all have returned.
    fn everywhere(&self, work: &(dyn Fn() + Sync));
}

/// A subject, the columns that are observed, and the workers that are warm.
pub struct Job<'s> {
    /// The subject.
    pub subject: &'s Subject,
    /// The columns.
    pub columns: Vec<usize>,
    /// Seed of all random numbers.
    pub seed: u64,
    workers: Mutex<Vec<Runner>>,
    /// Steps made so far, of all trials, consumed or not.
    pub steps: AtomicU64,
}

impl<'s> Job<'s> {
    /// A job without workers yet.
    pub fn new(subject: &'s Subject, columns: Vec<usize>, seed: u64) -> Self {
        Self { subject, columns, seed, workers: Mutex::new(Vec::new()), steps: AtomicU64::new(0) }
    }

    /// Goes on with fewer columns.
    pub fn narrow(&mut self, columns: Vec<usize>) {
        if self.columns != columns {
            self.columns = columns;
            self.workers = Mutex::new(Vec::new());
        }
    }

    fn worker(&self) -> Result<Runner, Invalid> {
        let warm = self.workers.lock().ok().and_then(|mut list| list.pop());
        match warm {
            Some(worker) if worker.serves(&self.columns) => Ok(worker),
            _ => Runner::new(self.subject, &self.columns),
        }
    }

    fn keep(&self, mut worker: Runner) {
        self.steps.fetch_add(worker.take_steps(), Ordering::Relaxed);
        if let Ok(mut list) = self.workers.lock() {
            list.push(worker);
        }
    }
}

/// The threads of this machine.
pub struct Threads {
    pool: rayon::ThreadPool,
}

impl Threads {
    /// A pool of `threads` threads; all cores for `None`.
    pub fn new(threads: Option<usize>) -> Result<Self, rayon::ThreadPoolBuildError> {
        let mut builder = rayon::ThreadPoolBuilder::new();
        if let Some(threads) = threads {
            builder = builder.num_threads(threads.max(1));
        }
        Ok(Self { pool: builder.build()? })
    }
}

impl Executor for Threads {
    fn everywhere(&self, work: &(dyn Fn() + Sync)) {
        if self.pool.current_num_threads() == 1 {
            work();
        } else {
            self.pool.broadcast(|_| work());
        }
    }

    fn width(&self, job: &Job<'_>) -> usize {
        let lanes = match job.subject.program.layout {
            crate::kernel::Layout::Trials => crate::base::lanes::LANES,
            crate::kernel::Layout::Agents => 1,
        };
        self.pool.current_num_threads() * lanes
    }

    fn run(&self, job: &Job<'_>, items: &[Item], budget: &Budget) -> Result<Cells, Invalid> {
        let next = AtomicUsize::new(0);
        let threads = self.pool.current_num_threads();
        let lanes = (self.width(job) / threads).max(1);
        // No more workers than there is work for.
        let workers = threads.min(items.len().div_ceil(lanes)).max(1);
        let work = || -> Result<Finished, Invalid> {
            let mut worker = job.worker()?;
            let mut take = || {
                let place = next.fetch_add(1, Ordering::Relaxed);
                items.get(place).map(|item| (place, *item))
            };
            let finished = worker.run(job.subject, job.seed, &mut take, budget);
            job.keep(worker);
            Ok(finished)
        };
        let results: Vec<Result<Finished, Invalid>> = if workers == 1 {
            vec![work()]
        } else {
            self.pool
                .broadcast(|context| if context.index() < workers { work() } else { Ok(Finished::default()) })
        };
        let width = job.columns.len();
        let mut cells = Cells::new(items.len(), width);
        for result in results {
            let finished = result?;
            for (k, place) in finished.places.iter().enumerate() {
                cells.put(*place, &finished.cells[k * width..][..width]);
            }
        }
        Ok(cells)
    }
}
