//! Executors: they run the items of a round and hand back their cells in the order of the items.
//!
//! Which thread runs which trial, and in which lane, leaves no trace: outcomes are put in the order of their
//! items before anybody looks at them.

use crate::base::lanes::LANES;
use crate::engine::sampling::splitting::{RunRecord, SplitRun};
use crate::engine::trials::prepared::PreparedWorld;
use crate::logic::Invalid;
use crate::trials::budget::Budget;
use crate::trials::cell::{Block, Cell, Item, Series};
use crate::trials::columns::Finished;
use crate::trials::runner::Runner;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};

/// Most trials of a block: enough that a few long ones among them cost little, few enough to stay near the core.
const LARGEST_BLOCK: usize = 1024;

/// Cells of a round, by place of the item.
#[derive(Clone, Debug, Default)]
pub struct Cells {
    /// Number of columns.
    width: usize,
    list: Vec<Cell>,
    /// Which trials were finished in time.
    finished: Vec<bool>,
    /// Whether the cells that are not decided are marked: with a deadline, after which those that are decided count though
    /// their trial is not finished.
    marked: bool,
}

impl Cells {
    /// Room for a round.
    pub fn new(items: usize, width: usize) -> Self {
        let mut cells = Self::default();
        cells.clear(items, width, false);
        cells
    }

    /// The same room for another round.
    fn clear(&mut self, items: usize, width: usize, marked: bool) {
        self.width = width;
        self.marked = marked;
        if marked {
            self.list.clear();
        }
        // Without marks rows that are not finished are not shown, so what they hold may stay.
        self.list.resize(items * width, Cell::OPEN);
        self.finished.clear();
        self.finished.resize(items, false);
    }

    /// The rows of a round in blocks, for those who fill them.
    fn blocks<'c>(&'c mut self, items: &'c [Item], size: usize) -> impl Iterator<Item = Block<'c>> {
        let cells = self.list.chunks_mut(size * self.width.max(1));
        let blocks = items.chunks(size).zip(cells).zip(self.finished.chunks_mut(size));
        blocks.map(|((items, cells), finished)| Block { items, cells, finished })
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

    /// Drops the rows from a place on.
    pub(in crate::engine) fn truncate(&mut self, items: usize) {
        self.list.truncate(items * self.width);
        self.finished.truncate(items);
    }

    /// The cells of a trial, one a column; `None` if it was not finished in time.
    pub fn row(&self, place: usize) -> Option<&[Cell]> {
        (*self.finished.get(place)?).then(|| &self.list[place * self.width..][..self.width])
    }

    /// How many trials in a row are finished, from the first on.
    pub fn ready(&self) -> usize {
        self.finished.iter().position(|finished| !finished).unwrap_or(self.finished.len())
    }

    /// The cells of these trials.
    pub(in crate::engine) fn whole(&self) -> &[Cell] {
        &self.list[..self.ready() * self.width]
    }

    /// A trial was cut: the cells that were decided before, and marks for the others.
    fn put_cut(&mut self, place: usize, row: &[Cell]) {
        if self.marked {
            self.list[place * self.width..][..self.width].copy_from_slice(row);
        }
    }

    /// In how many trials in a row a column is decided, from the first on; where that is not known, how many are finished.
    pub fn decided(&self, column: usize) -> usize {
        if !self.marked {
            return self.ready();
        }
        let open = |place: usize| !self.finished[place] && self.list[place * self.width + column].is_open();
        (0..self.finished.len()).position(open).unwrap_or(self.finished.len())
    }

    /// The cells of one column, trial by trial, finished or not.
    pub fn column(&self, place: usize) -> impl Iterator<Item = &Cell> + Clone {
        self.list.iter().skip(place).step_by(self.width.max(1))
    }

    /// The rows in order.
    pub fn rows(&self) -> impl Iterator<Item = Option<&[Cell]>> {
        (0..self.finished.len()).map(|place| self.row(place))
    }
}

/// Runs rounds of trials.
pub trait Executor: Sync {
    /// Runs the items of a round for some columns of a prepared world.
    fn run(&self, job: &Job<'_>, items: &[Item], budget: &Budget) -> Result<Cells, Invalid>;

    /// Runs rounds of several jobs, the first of them first.
    fn run_all(&self, parts: &[(&Job<'_>, Vec<Item>)], budget: &Budget) -> Result<Vec<Cells>, Invalid> {
        parts.iter().map(|(job, items)| self.run(job, items, budget)).collect()
    }

    /// How many trials run side by side.
    fn width(&self, job: &Job<'_>) -> usize;

    /// Calls `work` once on each thread, and returns when all have returned.
    fn everywhere(&self, work: &(dyn Fn() + Sync));

    /// Whether outcomes are stored: trials that are not among them are requested, not run.
    fn is_stored(&self) -> bool {
        false
    }

    /// Requests trials, of an option if one is named, where outcomes are stored; whether the first of them is lacking.
    fn request(&self, _job: &Job<'_>, _advice: Option<(usize, usize)>, _trials: Range<u64>) -> bool {
        false
    }

    /// A run of splitting where these are stored: requested if it is not there, and without a record where it has to be
    /// made again.
    fn record(&self, _run: &SplitRun) -> Option<Option<RunRecord>> {
        None
    }

    /// A run of splitting was made.
    fn made(&self, _run: &SplitRun, _record: &RunRecord) {}
}

/// A prepared world, the columns that are observed, and the workers that are warm.
pub struct Job<'s> {
    /// The prepared world.
    pub prepared: &'s PreparedWorld,
    /// The columns.
    pub columns: Vec<usize>,
    /// The series of its trials.
    pub series: Series,
    workers: Mutex<Vec<Runner<'s>>>,
    /// Room of rounds that were read.
    room: Mutex<Vec<Cells>>,
    /// Steps made so far, of all trials, consumed or not.
    pub steps: AtomicU64,
}

impl<'s> Job<'s> {
    /// A job without workers yet.
    pub fn new(prepared: &'s PreparedWorld, columns: Vec<usize>, series: impl Into<Series>) -> Self {
        let (workers, room) = (Mutex::default(), Mutex::default());
        Self { prepared, columns, series: series.into(), workers, room, steps: AtomicU64::new(0) }
    }

    /// Goes on with other columns.
    pub fn narrow(&mut self, columns: Vec<usize>) {
        if self.columns != columns {
            self.columns = columns;
            self.workers = Mutex::new(Vec::new());
        }
    }

    /// Takes the room of a round that was read: it serves for the next one, and the system need not find memory anew.
    pub fn reuse(&self, cells: Cells) {
        if let Ok(mut room) = self.room.lock() {
            room.push(cells);
        }
    }

    /// Room for a round; `marked` if what a cut trial has decided is to count.
    pub(in crate::engine) fn cells(&self, items: usize, marked: bool) -> Cells {
        let mut cells = self.room.lock().ok().and_then(|mut room| room.pop()).unwrap_or_default();
        cells.clear(items, self.columns.len(), marked);
        cells
    }

    /// How many trials a worker runs side by side.
    pub(in crate::engine) fn lanes(&self) -> usize {
        match self.prepared.program.layout {
            crate::kernel::Layout::Trials => LANES,
            crate::kernel::Layout::Agents => 1,
        }
    }

    fn worker(&self) -> Result<Runner<'s>, Invalid> {
        let warm = self.workers.lock().ok().and_then(|mut list| list.pop());
        match warm {
            Some(worker) if worker.serves(&self.columns) => Ok(worker),
            _ => Runner::new(self.prepared, &self.columns),
        }
    }

    fn keep(&self, mut worker: Runner<'s>) {
        self.steps.fetch_add(worker.take_steps(), Ordering::Relaxed);
        if let Ok(mut list) = self.workers.lock() {
            list.push(worker);
        }
    }
}

/// Runs some work on the thread that it is called on, after getting that ready for drivers from outside.
pub type Within = fn(&mut (dyn FnMut() + Send));

/// The threads of this machine.
pub struct Threads {
    pool: rayon::ThreadPool,
    within: Option<Within>,
}

impl Threads {
    /// A pool of `threads` threads; all cores for `None`. Without a number the pool would read the environment.
    pub fn new(threads: Option<usize>) -> Result<Self, rayon::ThreadPoolBuildError> {
        let cores = || std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
        let threads = threads.unwrap_or_else(cores).max(1);
        Ok(Self { pool: rayon::ThreadPoolBuilder::new().num_threads(threads).build()?, within: None })
    }

    /// The same threads, each of which runs its trials within something.
    #[must_use]
    pub fn within(self, within: Option<Within>) -> Self {
        Self { within, ..self }
    }

    /// Does some work on so many of them, while the others help: they take what those share, and wait for it awake, because
    /// a thread that sleeps wakes up later than the step of a crowd lasts.
    pub fn together<R: Send>(&self, workers: usize, work: impl Fn() -> R + Sync) -> Vec<R> {
        let at_work = AtomicUsize::new(workers);
        let results = self.pool.broadcast(|context| {
            if context.index() < workers {
                let _over = Over(&at_work);
                return Some(work());
            }
            while at_work.load(Ordering::Relaxed) > 0 {
                if rayon::yield_now() != Some(rayon::Yield::Executed) {
                    std::hint::spin_loop();
                }
            }
            None
        });
        results.into_iter().flatten().collect()
    }

    /// Does some work on one of them, while the others help.
    pub fn helped<R: Send>(&self, work: impl FnOnce() -> R + Send) -> Option<R> {
        let work = Mutex::new(Some(work));
        let take = || work.lock().ok().and_then(|mut work| work.take());
        self.together(1, || take().map(|work| work())).pop().flatten()
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.pool.current_num_threads()
    }

    /// What `work` makes of each item, in their order.
    pub fn map<T: Sync, R: Send>(&self, items: &[T], work: impl Fn(&T) -> R + Sync) -> Vec<R> {
        self.pool.install(|| items.par_iter().map(&work).collect())
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
        self.pool.current_num_threads() * job.lanes()
    }

    fn run(&self, job: &Job<'_>, items: &[Item], budget: &Budget) -> Result<Cells, Invalid> {
        Ok(self.run_parts(&[(job, items)], budget)?.pop().unwrap_or_default())
    }

    fn run_all(&self, parts: &[(&Job<'_>, Vec<Item>)], budget: &Budget) -> Result<Vec<Cells>, Invalid> {
        self.run_parts(&slices(parts), budget)
    }
}

impl Threads {
    /// Runs rounds of several jobs. A thread that finds nothing left of one goes on to the next.
    pub(in crate::engine) fn run_parts(
        &self,
        parts: &[(&Job<'_>, &[Item])],
        budget: &Budget,
    ) -> Result<Vec<Cells>, Invalid> {
        let mut rounds: Vec<Cells> =
            parts.iter().map(|(job, items)| job.cells(items.len(), budget.has_deadline())).collect();
        let threads = self.pool.current_num_threads();
        // No more workers than there is work for.
        let most = |job: &Job<'_>, items: &[Item]| items.len().div_ceil(job.lanes());
        let workers = parts.iter().map(|(job, items)| most(job, items)).sum::<usize>().clamp(1, threads);
        let tasks: Vec<Task<'_, '_, _>> = parts
            .iter()
            .zip(&mut rounds)
            .map(|(&(job, items), cells)| {
                let own = most(job, items).clamp(1, threads);
                let size = items.len().div_ceil(own).next_multiple_of(LANES).clamp(LANES, LARGEST_BLOCK);
                let blocks = Mutex::new(cells.blocks(items, size));
                Task { job, items, next: AtomicUsize::new(0), blocks, over: AtomicBool::new(false) }
            })
            .collect();
        // Threads without a trial of their own help those that have one, where the crowd is large.
        let helpers = threads / workers;
        let work = || -> Result<Vec<Finished>, Invalid> {
            let is_due = |k: usize| k == 0 || !budget.must_stop();
            let tasks = tasks.iter().enumerate();
            tasks
                .map(|(k, task)| if is_due(k) { task.work(budget, helpers) } else { Ok(Finished::default()) })
                .collect()
        };
        let work = || {
            let Some(within) = self.within else { return work() };
            let mut found = Ok(Vec::new());
            within(&mut || found = work());
            found
        };
        let results: Vec<Result<Vec<Finished>, Invalid>> =
            if helpers > 1 && parts.iter().any(|(job, _)| job.prepared.program.is_large()) {
                self.together(workers, work)
            } else if workers == 1 {
                vec![work()]
            } else {
                self.pool.broadcast(|context| if context.index() < workers { work() } else { Ok(Vec::new()) })
            };
        drop(tasks);
        for result in results {
            for ((cells, finished), (job, _)) in rounds.iter_mut().zip(result?).zip(parts) {
                let width = job.columns.len();
                for (k, place) in finished.places.iter().enumerate() {
                    cells.put(*place, &finished.cells[k * width..][..width]);
                }
                for (place, row) in &finished.cut {
                    cells.put_cut(*place, row);
                }
            }
        }
        Ok(rounds)
    }
}

/// Counts down when some work is over, though it be by a panic.
struct Over<'a>(&'a AtomicUsize);

impl Drop for Over<'_> {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::Relaxed);
    }
}

/// Rounds whose items belong to somebody else.
pub(in crate::engine) fn slices<'r, 's>(
    parts: &'r [(&'r Job<'s>, Vec<Item>)],
) -> Vec<(&'r Job<'s>, &'r [Item])> {
    parts.iter().map(|(job, items)| (*job, items.as_slice())).collect()
}

/// The round of a job on its way.
struct Task<'p, 's, B> {
    job: &'p Job<'s>,
    items: &'p [Item],
    next: AtomicUsize,
    blocks: Mutex<B>,
    /// Whether nothing of it is left to take.
    over: AtomicBool,
}

impl<'p, B: Iterator<Item = Block<'p>>> Task<'p, '_, B> {
    /// Runs what is left, on one thread.
    fn work(&self, budget: &Budget, threads: usize) -> Result<Finished, Invalid> {
        if self.over.load(Ordering::Relaxed) {
            return Ok(Finished::default());
        }
        let mut worker = self.job.worker()?;
        worker.share(threads);
        while worker.takes_blocks() {
            let Some(mut block) = self.blocks.lock().ok().and_then(|mut blocks| blocks.next()) else { break };
            worker.run_block(self.job.series, &mut block, budget);
        }
        let mut take = || {
            let place = self.next.fetch_add(1, Ordering::Relaxed);
            self.items.get(place).map(|item| (place, *item))
        };
        let finished = worker.run(self.job.series, &mut take, budget);
        self.job.keep(worker);
        self.over.store(true, Ordering::Relaxed);
        Ok(finished)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::trials::tests::prepared;
    use std::time::Duration;

    #[test]
    fn a_trial_that_is_cut_hands_over_what_it_has_decided() {
        let model =
            "horizon = 10 steps\nprocess c { var x = false\n  when !x -> 0.5: x = true | 0.5: { } }\n";
        let prepared = prepared(model, &["F<=#0 !c.x".to_owned(), "F c.x".to_owned()]);
        let job = Job::new(&prepared, vec![0, 1], 1);
        let threads = Threads::new(Some(1)).unwrap();
        let cut = |timeout| {
            let budget = Budget::new(u64::MAX, timeout);
            budget.interrupt();
            let cells = threads.run(&job, &Item::run(0, 16), &budget).unwrap();
            (cells.ready(), cells.decided(0), cells.decided(1))
        };
        // After the first state, which decides the first column of the trials that are on their way.
        assert_eq!(cut(Some(Duration::from_mins(10))), (0, LANES, 0));
        // Without a deadline nothing is handed over.
        assert_eq!(cut(None), (0, 0, 0));
    }
}
