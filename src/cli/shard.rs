//! `smc shard`: runs a shard of a plan and writes its part.

use super::arguments::ShardCommand;
use super::parts::{self, read_plan, same_origin};
use super::terminal::Colors;
use super::values::threads;
use super::{complaint, inputs};
use crate::engine::Budget;
use crate::engine::shards::{Origin, Unit, run as run_shard};
use crate::gait;
use crate::library::{self, program::playing};
use crate::model::Scenario;
use crate::report::ExitCode as Exit;
use crate::route::Ways;
use crate::syntax::diagnostic::Diagnostic;
use std::sync::Arc;

/// Runs the command.
pub(super) fn run(arguments: &ShardCommand, colors: Colors) -> Exit {
    let Some((mut study, loaded)) = inputs::load_or_tell(&arguments.model, &arguments.properties, colors)
    else {
        return Exit::Wrong;
    };
    let mut work = || -> Result<Exit, Vec<Diagnostic>> {
        let plan = read_plan(&arguments.round)?;
        let seed = plan.origin.seed;
        same_origin(&arguments.round, &Origin::of(&study, seed), &plan.origin)?;
        let count = plan.shards.len();
        if arguments.index >= count {
            let title = format!("the plan has no shard {}", arguments.index);
            return Err(complaint::argument(title, format!("write an index below {count}")).into());
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
        let threads = threads(Some(arguments.threads))?;
        let budget_of_programs = Arc::clone(&budget);
        let programs = inputs::programs(&arguments.model, &study, move || budget_of_programs.is_late())?;
        let players = programs.clone();
        let drivers = move |scenario: &Scenario, seed: u64| {
            playing(gait::drivers(&ways, scenario, seed), players.as_ref())
        };
        let part = run_shard(&study, (&plan, arguments.index), &drivers, &threads, &budget);
        let part = part.map_err(|fault| library::refusals(&fault))?;
        let Some(part) = part else { return Ok(Exit::Interrupted) };
        parts::write(&arguments.output, (plan.round, arguments.index), &part)?;
        Ok(Exit::Success)
    };
    complaint::end(work(), &loaded.inputs.sources, colors)
}
