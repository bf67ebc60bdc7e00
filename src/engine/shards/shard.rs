//! Runs the units of a shard.

use super::Plan;
use super::part::{Body, Head, Part};
use super::table::{BLOCK, Table};
use super::unit::{Trials, Unit};
use crate::compile::Study;
use crate::engine::budget::Budget;
use crate::engine::cell::Item;
use crate::engine::executor::{Executor, Job, Threads};
use crate::engine::fault::Fault;
use crate::engine::prepared::PreparedWorld;
use crate::engine::splitting;
use crate::kernel::driver::MakeDrivers;

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
    let moves = &prepared.program.scenario.moves;
    if trials.advice.is_some_and(|(at, option)| moves.get(at).is_none_or(|all| option >= all.options.len())) {
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
