//! The side of a rank: it compiles what the head hands to it, and runs the trials that are leased to it.

use super::message::{Answer, Lease, Order, Reply, print, receive};
use crate::base::bytes::Malformed;
use crate::compile::Study;
use crate::engine::budget::Budget;
use crate::engine::executor::{Executor, Job, Threads};
use crate::engine::prepared::PreparedWorld;
use crate::route::drivers;
use std::cell::OnceCell;
use std::io::{self, Read, Write};
use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex, Weak, mpsc};
use std::time::{Duration, Instant};
use thiserror::Error;

/// Jobs whose workers are kept warm: a ranking of values has one for each option.
const WARM: usize = 16;

/// Why a rank ended early.
#[derive(Debug, Error)]
pub enum ServeError {
    /// Its connection broke.
    #[error("the connection to the head broke: {0}")]
    Connection(#[from] io::Error),
    /// The head said what means nothing.
    #[error("the message of the main process is invalid: {0}")]
    Malformed(#[from] Malformed),
    /// It cannot take part; the head knows why.
    #[error("{0}")]
    Refused(String),
}

/// What comes over the connection, in its order.
enum Task {
    Order(Order),
    /// A lease, and what may end it early.
    Lease(Lease, Arc<Budget>),
    ServeError(ServeError),
}

/// Leases that are not answered yet.
#[derive(Clone, Default)]
struct Open(Arc<Mutex<Vec<Weak<Budget>>>>);

impl Open {
    fn add(&self, budget: &Arc<Budget>) {
        if let Ok(mut list) = self.0.lock() {
            list.retain(|one| one.strong_count() > 0);
            list.push(Arc::downgrade(budget));
        }
    }

    fn stop(&self) {
        if let Ok(list) = self.0.lock() {
            list.iter().filter_map(Weak::upgrade).for_each(|budget| budget.interrupt());
        }
    }
}

/// Serves a head until it closes its connection: trials of the study that `prepare` makes of what the head hands over. Nothing
/// that is running outlives the connection.
pub fn serve(
    from: Box<dyn Read + Send>,
    to: &mut dyn Write,
    prepare: &dyn Fn(&[u8]) -> Result<Study, String>,
) -> Result<(), ServeError> {
    let (sender, inbox) = mpsc::channel();
    std::thread::Builder::new().spawn(move || listen(from, &sender))?;
    let mut say = |reply: &Reply| to.write_all(&reply.bytes()).and_then(|()| to.flush());
    let refuse = |reason: String| (Reply::Refused(reason.clone()), ServeError::Refused(reason));
    let greeting = match inbox.recv() {
        Ok(Task::Order(Order::Greeting(greeting))) => greeting,
        Ok(Task::ServeError(ServeError::Malformed(reason))) => {
            let (reply, broken) = refuse(reason.to_string());
            say(&reply)?;
            return Err(broken);
        }
        Ok(Task::ServeError(broken)) => return Err(broken),
        Ok(Task::Order(Order::Lease(_) | Order::Stop) | Task::Lease(..)) => {
            return Err(Malformed("the main process did not send its inputs").into());
        }
        Err(_) => return Ok(()),
    };
    let version = env!("CARGO_PKG_VERSION").to_owned();
    let prepared = if greeting.version == version {
        prepare(&greeting.inputs)
    } else {
        Err(format!("its version is smc {version}, that of the main process is smc {}", greeting.version))
    };
    let ready = prepared.and_then(|study| {
        let own = print(&study);
        if own != greeting.print {
            return Err(format!("its model differs: {own} instead of {}", greeting.print));
        }
        let threads = Threads::new(Some(greeting.threads)).map_err(|error| error.to_string())?;
        Ok((study, own, threads))
    });
    let (study, own, threads) = match ready {
        Ok(ready) => ready,
        Err(reason) => {
            let (reply, broken) = refuse(reason);
            say(&reply)?;
            return Err(broken);
        }
    };
    drop(greeting);
    say(&Reply::Ready { version, print: own })?;
    let worlds: Vec<OnceCell<PreparedWorld>> = study.worlds.iter().map(|_| OnceCell::new()).collect();
    let mut worker = Worker { study: &study, worlds: &worlds, jobs: Vec::new(), threads };
    for task in inbox {
        match task {
            Task::Lease(lease, budget) => say(&worker.run(&lease, &budget)?)?,
            Task::Order(Order::Stop) => {}
            Task::Order(_) => return Err(Malformed("the main process sent two greetings").into()),
            Task::ServeError(broken) => return Err(broken),
        }
    }
    Ok(())
}

/// Reads the connection until it is closed. What is running then ends at once, and so it does when the head says so.
fn listen(mut from: Box<dyn Read + Send>, tasks: &mpsc::Sender<Task>) {
    let open = Open::default();
    loop {
        let task = match receive(&mut *from) {
            Ok(Some(bytes)) => match Order::read(&bytes) {
                Ok(Order::Lease(lease)) => {
                    let left = lease.seconds.map(Duration::from_secs_f64);
                    let budget = Arc::new(Budget::new(u64::MAX, left));
                    open.add(&budget);
                    Task::Lease(lease, budget)
                }
                Ok(Order::Stop) => {
                    open.stop();
                    Task::Order(Order::Stop)
                }
                Ok(order) => Task::Order(order),
                Err(reason) => Task::ServeError(reason.into()),
            },
            Ok(None) => break,
            Err(error) => Task::ServeError(error.into()),
        };
        let last = matches!(task, Task::ServeError(_));
        if tasks.send(task).is_err() || last {
            break;
        }
    }
    open.stop();
}

/// Jobs at hand.
struct Worker<'s> {
    study: &'s Study,
    worlds: &'s [OnceCell<PreparedWorld>],
    /// Those used last, the latest at the end.
    jobs: Vec<Job<'s>>,
    threads: Threads,
}

impl<'s> Worker<'s> {
    /// Runs the trials of a lease.
    #[allow(clippy::disallowed_methods, reason = "how long a lease takes decides how large the next one is")]
    fn run(&mut self, lease: &Lease, budget: &Budget) -> Result<Reply, Malformed> {
        let job = self.job(lease)?;
        let started = Instant::now();
        let Ok(cells) = self.threads.run(&job, &lease.items, budget) else {
            return Ok(Reply::Failed(lease.number));
        };
        let mut answer = Answer {
            number: lease.number,
            seconds: started.elapsed().as_secs_f64(),
            steps: job.steps.swap(0, Ordering::Relaxed),
            finished: Vec::with_capacity(lease.items.len()),
            cells: Vec::with_capacity(lease.items.len() * lease.columns.len()),
        };
        for row in cells.rows() {
            answer.finished.push(row.is_some());
            answer.cells.extend_from_slice(row.unwrap_or_default());
        }
        job.reuse(cells);
        if self.jobs.len() == WARM {
            self.jobs.remove(0);
        }
        self.jobs.push(job);
        Ok(Reply::Answer(answer))
    }

    /// The job of a lease, taken from the worker.
    fn job(&mut self, lease: &Lease) -> Result<Job<'s>, Malformed> {
        let world = self.study.worlds.get(lease.world).ok_or(Malformed("unknown world"))?;
        if lease.columns.is_empty() || lease.columns.iter().any(|&column| column >= world.columns.len()) {
            return Err(Malformed("unknown column"));
        }
        let there = |(moves, option): (usize, usize)| {
            world.scenario.moves.get(moves).is_some_and(|moves| option < moves.options.len())
        };
        if !lease.items.iter().all(|item| item.advice.is_none_or(there)) {
            return Err(Malformed("unknown advice"));
        }
        let warm = self.jobs.iter().position(|job| {
            let same = job.prepared.number == Some(lease.world) && job.series == lease.seed.into();
            same && job.columns == lease.columns
        });
        if let Some(warm) = warm {
            return Ok(self.jobs.remove(warm));
        }
        let prepared = match self.worlds[lease.world].get() {
            Some(prepared) => prepared,
            None => {
                let prepared = PreparedWorld::of(self.study, lease.world, lease.seed, &drivers)
                    .ok_or(Malformed("unknown world"))?;
                self.worlds[lease.world].get_or_init(|| prepared)
            }
        };
        Ok(Job::new(prepared, lease.columns.clone(), lease.seed))
    }
}
