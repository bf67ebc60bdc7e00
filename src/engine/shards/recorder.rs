//! The executor that runs what is not stored on the threads of this machine, and records it. It needs no plan and no rounds:
//! a call over it simulates what an ordinary call does, and can be killed.

use super::Origin;
use super::part::{Body, Head, Part};
use super::stored::Stored;
use super::table::{BLOCK, Table};
use super::unit::{Trials, Unit};
use crate::engine::sampling::splitting::{RunRecord, SplitRun};
use crate::engine::trials::executor::{Cells, Executor, Job, Threads, slices};
use crate::logic::Invalid;
use crate::trials::budget::Budget;
use crate::trials::cell::{Cell, Item};
use std::collections::BTreeMap;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// A part has what came in so many seconds, or in such a share of the time of the call: more would be lost by a kill, and
/// shorter times would make many files.
const LEAST: f64 = 1.0;
const SHARE: f64 = 1.0 / 64.0;

/// World, columns, and option if one is followed.
type Key = (usize, Vec<usize>, Option<(usize, usize)>);

/// Trials in a row that are not in a part yet.
struct Open {
    from: u64,
    to: u64,
    table: Table,
    /// What does not fill a block.
    rest: Vec<Cell>,
}

/// What is not in a part yet.
#[derive(Default)]
struct Fresh {
    tables: BTreeMap<Key, Open>,
    over: Vec<(Unit, Body)>,
    /// When the last part was made, in seconds of the call.
    since: f64,
}

/// Answers from parts, and makes parts of what is not there.
pub struct Recorder<'r> {
    stored: Stored<'r>,
    threads: &'r Threads,
    origin: Origin,
    keep: &'r (dyn Fn(&Part) + Sync),
    fresh: Mutex<Fresh>,
}

impl Open {
    /// Appends trials from an index on, without those that it has; they follow these.
    fn push(&mut self, from: u64, cells: &[Cell], width: usize) {
        let known = usize::try_from(self.to - from).unwrap_or(usize::MAX).saturating_mul(width);
        let Some(mut cells) = cells.get(known..) else { return };
        self.to += (cells.len() / width) as u64;
        let block = BLOCK * width;
        if !self.rest.is_empty() {
            let (first, others) = cells.split_at(cells.len().min(block - self.rest.len()));
            self.rest.extend_from_slice(first);
            cells = others;
            if self.rest.len() < block {
                return;
            }
            self.table.push(&self.rest);
            self.rest.clear();
        }
        let (whole, rest) = cells.split_at(cells.len() / block * block);
        self.table.push(whole);
        self.rest.extend_from_slice(rest);
    }

    /// What it has as a unit, if anything; it goes on at a trial.
    fn end(&mut self, (world, columns, advice): &Key, at: u64) -> Option<(Unit, Body)> {
        let (from, to) = (self.from, self.to);
        (self.from, self.to) = (at, at);
        (from < to).then(|| {
            let mut table = std::mem::replace(&mut self.table, Table::new(columns.len()));
            table.push(&std::mem::take(&mut self.rest));
            let trials = Trials { world: *world, columns: columns.clone(), advice: *advice, from, to };
            (Unit::Trials(trials), Body::Trials(table))
        })
    }
}

impl<'r> Recorder<'r> {
    /// Over what is stored; `keep` hears each part of what is not.
    pub fn new(
        stored: Stored<'r>,
        threads: &'r Threads,
        origin: Origin,
        keep: &'r (dyn Fn(&Part) + Sync),
    ) -> Self {
        Self { stored, threads, origin, keep, fresh: Mutex::default() }
    }

    /// Makes a part of what is not in one yet, at a time of the call.
    pub fn flush(&self, now: f64) {
        let Fresh { tables, over, since } = &mut *self.fresh();
        for (key, open) in tables {
            over.extend(open.end(key, open.to));
        }
        let (units, bodies): (Vec<Unit>, Vec<Body>) = over.drain(..).unzip();
        if !units.is_empty() {
            let head = Head { origin: self.origin.clone(), seconds: now - *since, units };
            (self.keep)(&Part { head, bodies });
        }
        *since = now;
    }

    fn fresh(&self) -> MutexGuard<'_, Fresh> {
        self.fresh.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Notes the trials of a round.
    fn note(&self, job: &Job<'_>, items: &[Item], cells: &Cells) {
        let (Some(world), width) = (job.prepared.number, job.columns.len()) else { return };
        let Fresh { tables, over, .. } = &mut *self.fresh();
        let mut cells = cells.whole();
        let follows = |one: &Item, next: &Item| one.advice == next.advice && one.index + 1 == next.index;
        for row in items[..cells.len() / width].chunk_by(follows) {
            let (own, others) = cells.split_at(row.len() * width);
            let (key, from) = ((world, job.columns.clone(), row[0].advice), row[0].index);
            let new = || Open { from, to: from, table: Table::new(width), rest: Vec::new() };
            let open = tables.entry(key.clone()).or_insert_with(new);
            if open.to < from {
                over.extend(open.end(&key, from));
            }
            open.push(from, own, width);
            cells = others;
        }
    }

    fn run_parts(&self, parts: &[(&Job<'_>, &[Item])], budget: &Budget) -> Result<Vec<Cells>, Invalid> {
        let stored = parts.iter().map(|(job, items)| self.stored.run(job, items, budget));
        let mut all = stored.collect::<Result<Vec<_>, _>>()?;
        let left = parts.iter().zip(&all).map(|((job, items), cells)| (*job, &items[cells.ready()..]));
        let left: Vec<(&Job<'_>, &[Item])> = left.collect();
        if left.iter().all(|(_, items)| items.is_empty()) {
            return Ok(all);
        }
        for ((mut made, (job, items)), cells) in
            self.threads.run_parts(&left, budget)?.into_iter().zip(left).zip(&mut all)
        {
            self.note(job, items, &made);
            match cells.ready() {
                0 => std::mem::swap(cells, &mut made),
                ready => (ready..).zip(made.rows()).for_each(|(place, row)| {
                    row.inspect(|row| cells.put(place, row));
                }),
            }
            job.reuse(made);
        }
        let (now, since) = (budget.elapsed(), self.fresh().since);
        if now - since > LEAST.max(SHARE * now) {
            self.flush(now);
        }
        Ok(all)
    }
}

impl Executor for Recorder<'_> {
    fn run(&self, job: &Job<'_>, items: &[Item], budget: &Budget) -> Result<Cells, Invalid> {
        Ok(self.run_parts(&[(job, items)], budget)?.pop().unwrap_or_default())
    }

    fn run_all(&self, parts: &[(&Job<'_>, Vec<Item>)], budget: &Budget) -> Result<Vec<Cells>, Invalid> {
        self.run_parts(&slices(parts), budget)
    }

    fn width(&self, job: &Job<'_>) -> usize {
        self.threads.width(job)
    }

    fn everywhere(&self, work: &(dyn Fn() + Sync)) {
        self.threads.everywhere(work);
    }

    fn record(&self, run: &SplitRun) -> Option<Option<RunRecord>> {
        self.stored.record(run)
    }

    fn made(&self, run: &SplitRun, record: &RunRecord) {
        if self.stored.record(run).is_none() {
            self.fresh().over.push((Unit::Run(run.clone()), Body::Run(Some(record.clone()))));
        }
    }
}
