//! The side of a rank: it compiles what the head hands to it, and runs the trials that are leased to it.

use super::message::{Answer, Lease, Order, Reply, print, receive};
use crate::base::bytes::Malformed;
use crate::compile::Study;
use crate::engine::budget::Budget;
use crate::engine::executor::{Executor, Job, Threads};
use crate::engine::subject::Subject;
use crate::kernel::driver::straight;
use std::cell::OnceCell;
use std::io::{self, Read, Write};
use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex, Weak, mpsc};
use std::time::{Duration, Instant};
use thiserror::Error;

/// Jobs whose workers are kept warm.
const WARM: usize = 4;

/// Why a rank ended early.
#[derive(Debug, Error)]
pub enum Broken {
    /// Its line broke.
    #[error("the line to the head broke: {0}")]
    Line(#[from] io::Error),
    /// The head said what means nothing.
    #[error("the head is not understood: {0}")]
    Malformed(#[from] Malformed),
    /// It cannot take part; the head knows why.
    #[error("{0}")]
    Refused(String),
}

/// What comes over the line, in its order.
enum Task {
    Order(Order),
    /// A lease, and what may end it early.
    Lease(Lease, Arc<Budget>),
    Broken(Broken),
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

/// Serves a head until it closes its line: trials of the study that `prepare` makes of what the head hands over. Nothing
/// that is running outlives the line.
pub fn serve(
    from: Box<dyn Read + Send>,
    to: &mut dyn Write,
    prepare: &dyn Fn(&[u8]) -> Result<Study, String>,
) -> Result<(), Broken> {
    let (sender, inbox) = mpsc::channel();
    std::thread::Builder::new().spawn(move || listen(from, &sender))?;
    let mut say = |reply: &Reply| to.write_all(&reply.bytes()).and_then(|()| to.flush());
    let refuse = |reason: String| (Reply::Refused(reason.clone()), Broken::Refused(reason));
    let greeting = match inbox.recv() {
        Ok(Task::Order(Order::Greeting(greeting))) => greeting,
        Ok(Task::Broken(Broken::Malformed(reason))) => {
            let (reply, broken) = refuse(reason.to_string());
            say(&reply)?;
            return Err(broken);
        }
        Ok(Task::Broken(broken)) => return Err(broken),
        Ok(Task::Order(Order::Lease(_) | Order::Stop) | Task::Lease(..)) => {
            return Err(Malformed("the head does not say what it runs").into());
        }
        Err(_) => return Ok(()),
    };
    let version = env!("CARGO_PKG_VERSION").to_owned();
    let prepared = if greeting.version == version {
        prepare(&greeting.inputs)
    } else {
        Err(format!("it is smc {version}, the head is smc {}", greeting.version))
    };
    let ready = prepared.and_then(|study| {
        let own = print(&study);
        if own != greeting.print {
            return Err(format!("it has another model: {own} instead of {}", greeting.print));
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
    let subjects: Vec<OnceCell<Subject>> = study.worlds.iter().map(|_| OnceCell::new()).collect();
    let mut bench = Bench { study: &study, subjects: &subjects, jobs: Vec::new(), threads };
    for task in inbox {
        match task {
            Task::Lease(lease, budget) => say(&bench.run(&lease, &budget)?)?,
            Task::Order(Order::Stop) => {}
            Task::Order(_) => return Err(Malformed("the head greets twice").into()),
            Task::Broken(broken) => return Err(broken),
        }
    }
    Ok(())
}

/// Reads the line until it is closed. What is running then ends at once, and so it does when the head says so.
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
                Err(reason) => Task::Broken(reason.into()),
            },
            Ok(None) => break,
            Err(error) => Task::Broken(error.into()),
        };
        let last = matches!(task, Task::Broken(_));
        if tasks.send(task).is_err() || last {
            break;
        }
    }
    open.stop();
}

/// Jobs at hand.
struct Bench<'s> {
    study: &'s Study,
    subjects: &'s [OnceCell<Subject>],
    /// Those used last, the latest at the end.
    jobs: Vec<Job<'s>>,
    threads: Threads,
}

impl<'s> Bench<'s> {
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

    /// The job of a lease, taken from the bench.
    fn job(&mut self, lease: &Lease) -> Result<Job<'s>, Malformed> {
        let world = self.study.worlds.get(lease.world).ok_or(Malformed("there is no such world"))?;
        if lease.columns.is_empty() || lease.columns.iter().any(|&column| column >= world.columns.len()) {
            return Err(Malformed("there is no such column"));
        }
        let there = |(moves, option): (usize, usize)| {
            world.scenario.moves.get(moves).is_some_and(|moves| option < moves.options.len())
        };
        if !lease.items.iter().all(|item| item.advice.is_none_or(there)) {
            return Err(Malformed("there is no such advice"));
        }
        let warm = self.jobs.iter().position(|job| {
            let same = job.subject.number == Some(lease.world) && job.seed == lease.seed;
            same && job.columns == lease.columns
        });
        if let Some(warm) = warm {
            return Ok(self.jobs.remove(warm));
        }
        let subject = match self.subjects[lease.world].get() {
            Some(subject) => subject,
            None => {
                let subject = Subject::of(self.study, lease.world, lease.seed, &straight)
                    .ok_or(Malformed("there is no such world"))?;
                self.subjects[lease.world].get_or_init(|| subject)
            }
        };
        Ok(Job::new(subject, lease.columns.clone(), lease.seed))
    }
}
