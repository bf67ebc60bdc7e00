//! Ranks: other processes of this program that run the trials of a round. The head leases pieces of it to them; what comes
//! back goes to the places of its trials, so that nobody can tell who ran what.
//!
//! Trials are pure functions of model, seed and index. So a lease that does not come back is leased again to another rank,
//! and one that comes back twice counts once. Where no rank is left, the head runs the rest itself. Nothing here knows of
//! processes: a rank is a connection on which one speaks and listens.

mod connection;
mod lease_queue;
mod message;
mod round;
mod serve;

pub use connection::Connection;
pub use serve::{ServeError, serve};

use super::budget::Budget;
use super::cell::Item;
use super::executor::{Cells, Executor, Job, Threads};
use super::fault::Fault;
use crate::compile::Study;
use crate::logic::Invalid;
use lease_queue::{LeaseQueue, RoundEnd};
use round::Round;
use std::sync::Mutex;

/// How many leases there were.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Traffic {
    /// All of them.
    pub leases: u64,
    /// Those of trials that had been leased before.
    pub again: u64,
}

/// Runs trials on ranks, and what is none (paths of splitting) on threads of its own.
pub struct Ranks {
    threads: Threads,
    queue: Mutex<LeaseQueue>,
}

impl Ranks {
    /// Greets some ranks and waits until they have compiled `inputs`, which their `prepare` makes the same study of; each
    /// uses so many threads. A rank that has not answered after half a minute, or when the budget ends, may come in later.
    ///
    /// # Errors
    /// If a rank runs another version or another model, or has reasons of its own not to take part.
    pub fn new(
        connections: Vec<Connection>,
        study: &Study,
        inputs: Vec<u8>,
        each: usize,
        threads: Threads,
        budget: &Budget,
    ) -> Result<Self, Fault> {
        let mut queue = LeaseQueue::new(connections, study, inputs, each)?;
        queue.welcome(budget)?;
        Ok(Self { threads, queue: Mutex::new(queue) })
    }

    /// What went wrong with ranks, in words. None of it changes a result.
    pub fn warnings(&self) -> Vec<String> {
        self.queue.lock().map(|queue| queue.warnings()).unwrap_or_default()
    }

    /// How many leases there were so far.
    pub fn traffic(&self) -> Traffic {
        self.queue.lock().map(|queue| queue.traffic).unwrap_or_default()
    }
}

impl Executor for Ranks {
    fn run(&self, job: &Job<'_>, items: &[Item], budget: &Budget) -> Result<Cells, Invalid> {
        let (Some(world), Ok(mut queue)) = (job.prepared.number, self.queue.lock()) else {
            return self.threads.run(job, items, budget);
        };
        let mut round = Round::new(world, job, items);
        let end = queue.run(&mut round, budget);
        drop(queue);
        if end == RoundEnd::Alone {
            let places = round.rest();
            let rest: Vec<Item> = places.iter().map(|&place| items[place]).collect();
            let cells = self.threads.run(job, &rest, budget)?;
            for (place, row) in places.iter().zip(cells.rows()) {
                if let Some(row) = row {
                    round.cells.put(*place, row);
                }
            }
            job.reuse(cells);
        }
        Ok(round.cells)
    }

    fn width(&self, job: &Job<'_>) -> usize {
        let threads = self.queue.lock().map_or(0, |queue| queue.width());
        if threads == 0 { self.threads.width(job) } else { threads * job.lanes() }
    }

    fn everywhere(&self, work: &(dyn Fn() + Sync)) {
        self.threads.everywhere(work);
    }
}
