//! Shards: units of work that any machine can do, the files in which their outcomes come back, and an executor that answers
//! from these files.
//!
//! A trial is a pure function of model, seed and index, and so is a run of splitting. A plan deals units out to shards; the
//! outcomes of a shard are a part. Whoever has the parts runs the ordinary session over them: it reads outcomes in the order
//! of their indices, and requests what is not there, which makes the plan of the next round. Nothing here knows of files or
//! processes.

mod kept;
mod part;
mod plan;
mod recorder;
mod stored;
mod table;
mod unit;

use crate::base::fingerprint::Fingerprint;
use crate::compile::Study;
use crate::engine::fault::Fault;
use crate::engine::sampling::splitting;
pub use crate::engine::sampling::splitting::{RunRecord, SplitRun};
use crate::engine::trials::executor::{Executor, Job, Threads};
use crate::engine::trials::prepared::PreparedWorld;
use crate::kernel::driver::MakeDrivers;
use crate::trials::budget::Budget;
use crate::trials::cell::{Item, Reading};
pub use kept::{Column, Kept};
pub use part::{Body, Damaged, Head, Part};
pub use plan::{Attempts, Plan};
pub use recorder::Recorder;
use serde::{Deserialize, Serialize};
pub use stored::Stored;
use table::BLOCK;
pub use table::Table;
pub use unit::{Trials, Unit};

/// Worlds that the fingerprint of a study is made from, at most.
const PRINTED: usize = 32;

/// What outcomes are of: those of another origin are not comparable.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Origin {
    /// Version of the program.
    pub version: String,
    /// Fingerprint of what was compiled.
    pub print: String,
    /// Seed of all random numbers.
    pub seed: u64,
}

impl Origin {
    /// Of trials of a study. Of many worlds some stand for all.
    pub fn of(study: &Study, seed: u64) -> Self {
        let mut print = Fingerprint::default();
        let every = study.worlds.len().div_ceil(PRINTED).max(1);
        for world in study.worlds.iter().step_by(every) {
            let (tree, columns) = (&world.tree, &world.columns);
            let text = format!("{:?}{:?}{:?}{tree:?}{columns:?}", world.scenario, world.atoms, world.signals);
            print.add(text.as_bytes());
        }
        let print = format!("{} worlds, {print}", study.worlds.len());
        Self { version: env!("CARGO_PKG_VERSION").to_owned(), print, seed }
    }

    /// How another origin differs from this one, in words.
    pub fn difference(&self, other: &Self) -> Option<String> {
        if self.version != other.version {
            Some(format!("version {} of smc instead of {}", other.version, self.version))
        } else if self.print != other.print {
            Some("another model, or other properties or settings".to_owned())
        } else {
            (self.seed != other.seed).then(|| format!("seed {} instead of {}", other.seed, self.seed))
        }
    }
}

// Runs the units of a shard.

/// Trials that are run before their outcomes are packed.
const ROUND: u64 = 16 * BLOCK as u64;

/// Runs a shard of a plan; `None` where it was interrupted.
///
/// # Errors
/// If the plan has no such shard, or one that does not fit the study.
pub fn run(
    study: &Study,
    (plan, index): (&Plan, usize),
    drivers: &MakeDrivers,
    threads: &Threads,
    budget: &Budget,
) -> Result<Option<Part>, Fault> {
    let units = plan.shards.get(index).ok_or(Fault::Unsuitable)?;
    let mut bodies = Vec::with_capacity(units.len());
    let mut last: Option<PreparedWorld> = None;
    for unit in units {
        let (world, columns) = (unit.world(), unit.columns());
        let known = last.take().filter(|prepared| prepared.number == Some(world));
        let prepared = known
            .or_else(|| PreparedWorld::of(study, world, plan.origin.seed, drivers))
            .filter(|prepared| !columns.is_empty() && columns.iter().all(|at| *at < prepared.columns.len()))
            .ok_or(Fault::Unsuitable)?;
        let body = match unit {
            Unit::Trials(trials) => outcomes(trials, &prepared, plan.origin.seed, threads, budget)?,
            Unit::Run(run) => {
                Some(Body::Run(splitting::record(run, (&prepared, plan.origin.seed), threads, budget)?))
            }
        };
        let Some(body) = body.filter(|_| !budget.is_interrupted()) else { return Ok(None) };
        bodies.push(body);
        last = Some(prepared);
    }
    let head = Head { origin: plan.origin.clone(), seconds: budget.elapsed(), units: units.clone() };
    Ok(Some(Part { head, bodies }))
}

fn outcomes(
    trials: &Trials,
    prepared: &PreparedWorld,
    seed: u64,
    threads: &Threads,
    budget: &Budget,
) -> Result<Option<Body>, Fault> {
    let scenario = &prepared.program.scenario;
    if trials.advice.is_some_and(|advice| scenario.singles(advice).is_none()) {
        return Err(Fault::Unsuitable);
    }
    let job = Job::new(prepared, trials.columns.clone(), seed);
    let mut table = Table::new(trials.columns.len());
    let mut from = trials.from;
    while from < trials.to {
        let to = trials.to.min(from.saturating_add(ROUND));
        let items: Vec<Item> = (from..to).map(|index| Item { advice: trials.advice, index }).collect();
        let cells = threads.run(&job, &items, budget)?;
        if cells.ready() < items.len() {
            return Ok(None);
        }
        table.push(cells.whole());
        job.reuse(cells);
        from = to;
    }
    Ok(Some(Body::Trials(table)))
}

/// What a column comes to in some trials, which are run again.
///
/// # Errors
/// If the study has no such column, or a trial cannot be run.
pub fn again(
    (study, drivers): (&Study, &MakeDrivers),
    (world, advice, column): Column,
    (seed, trials): (u64, &[u64]),
    threads: &Threads,
) -> Result<Vec<Reading>, Fault> {
    if trials.is_empty() {
        return Ok(Vec::new());
    }
    let prepared = PreparedWorld::of(study, world, seed, drivers).ok_or(Fault::Unsuitable)?;
    let is_unknown = advice.is_some_and(|advice| prepared.program.scenario.singles(advice).is_none());
    if is_unknown || column >= prepared.columns.len() {
        return Err(Fault::Unsuitable);
    }
    let job = Job::new(&prepared, vec![column], seed);
    let items: Vec<Item> = trials.iter().map(|index| Item { advice, index: *index }).collect();
    let cells = threads.run(&job, &items, &Budget::new(u64::MAX, None))?;
    Ok(cells.column(0).map(|cell| cell.reading).collect())
}
