//! `smc shard`: runs a shard of a plan and writes its part.

use super::arguments::ShardCommand;
use super::parts::{self, read_plan, same_origin};
use super::terminal::Colors;
use super::{complaint, inputs};
use crate::engine::shards::{Origin, Unit, run as run_shard};
use crate::engine::{Budget, Fault, Threads};
use crate::gait;
use crate::library;
use crate::model::Scenario;
use crate::report::ExitCode as Exit;
use crate::route::Ways;
use crate::syntax::diagnostic::Diagnostic;
use std::sync::Arc;

/// Runs the command.
pub(super) fn run(arguments: &ShardCommand, colors: Colors) -> Exit {
    let mut inputs = inputs::load(&arguments.model, &arguments.properties).inputs;
    complaint::diagnose(&inputs, colors);
    let Some(mut study) = inputs.study.take() else { return Exit::Wrong };
    let mut work = || -> Result<Exit, Vec<Diagnostic>> {
        let one = |error: Diagnostic| vec![error];
        let refusals = |fault: Fault| library::refusals(&fault);
        let plan = read_plan(&arguments.round).map_err(one)?;
        let seed = plan.origin.seed;
        same_origin(&arguments.round, &Origin::of(&study, seed), &plan.origin).map_err(one)?;
        let count = plan.shards.len();
        if arguments.index >= count {
            let title = format!("the plan has no shard {}", arguments.index);
            return Err(one(complaint::argument(title, format!("write an index below {count}"))));
        }
        let ways = Ways::default();
        // Only what is asked must be right.
        let worlds: Vec<usize> = plan.shards[arguments.index].iter().map(Unit::world).collect();
        let asked =
            study.queries.iter().filter(|query| query.ask.worlds().iter().any(|at| worlds.contains(at)));
        let only: Vec<usize> = asked.map(|query| query.index).collect();
        let doubts = library::survey(&mut study, &only, seed, &ways);
        if library::is_refused(&doubts) {
            return Err(doubts);
        }
        let budget = Arc::new(Budget::new(plan.max_trials, None));
        let signalled = Arc::clone(&budget);
        let _ = ctrlc::set_handler(move || signalled.interrupt());
        let threads = Threads::new(Some(arguments.threads.max(1)))
            .map_err(|error| refusals(Fault::Threads(error.to_string())))?;
        let drivers = move |scenario: &Scenario, seed: u64| gait::drivers(&ways, scenario, seed);
        let part = run_shard(&study, (&plan, arguments.index), &drivers, &threads, &budget);
        let Some(part) = part.map_err(refusals)? else { return Ok(Exit::Interrupted) };
        parts::write(&arguments.output, (plan.round, arguments.index), &part).map_err(one)?;
        Ok(Exit::Success)
    };
    work().unwrap_or_else(|errors| {
        complaint::tell_all(&errors, &inputs.sources, colors);
        Exit::Wrong
    })
}
