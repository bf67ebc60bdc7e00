//! `smc advise`: advice for one user, a line for each batch of observations.

mod arguments;
mod replay;
mod stream;

pub(super) use arguments::AdviseCommand;

use super::complaint;
use super::inputs;
use super::output;
use super::page;
use super::terminal::{Colors, print_to_reader};
use super::values::threads;
use crate::advise::{Adviser, Advising, role};
use crate::data::tracks::{Batch, Velocity};
use crate::engine::budget::DEFAULT_TRIALS;
use crate::engine::{Budget, Threads};
use crate::library::Parsed;
use crate::model::Scene;
use crate::report::ExitCode as Exit;
use crate::report::advice;
use crate::report::advised::{Advised, to_page};
use crate::syntax::diagnostic::Diagnostic;
use std::time::{Duration, Instant};

/// What is kept of a deadline for writing the line.
const RESERVE: Duration = Duration::from_millis(2);

/// Runs the command.
pub(super) fn run(arguments: &AdviseCommand, colors: Colors) -> Exit {
    let Some((parsed, paths)) = inputs::parse_or_tell(&arguments.model, &arguments.properties, colors) else {
        return Exit::Wrong;
    };
    let done =
        output::guard(arguments.report.as_deref(), &paths).and_then(|()| advise(arguments, &parsed, colors));
    complaint::end(done, &parsed.inputs.sources, colors)
}

/// Answers all batches.
fn advise(arguments: &AdviseCommand, parsed: &Parsed, colors: Colors) -> Result<Exit, Diagnostic> {
    let role = role(&parsed.scenario)?;
    let threads = threads(arguments.threads)?;
    let replayed = arguments.replay.as_ref();
    let recording = replayed.map(|name| replay::batches(parsed, name, arguments)).transpose()?;
    let options = Advising {
        seed: arguments.seed,
        user: arguments.user,
        range: arguments.range,
        only: arguments.only.clone(),
    };
    let adviser = Adviser::new(parsed.input(), role, options);
    let mut caller = Caller { arguments, adviser, threads, shown: Advised::default() };
    let done = match recording {
        Some(recording) => replay::run(&mut caller, &recording),
        None => stream::run(&mut caller),
    };
    let exit = complaint::end(done.map(|()| Exit::Success), &parsed.inputs.sources, colors);
    let Some(path) = &arguments.report else { return Ok(exit) };
    let scenario = caller.adviser.scenario();
    let title = scenario.map(|scenario| scenario.title.clone()).filter(|title| !title.is_empty());
    let advised = Advised {
        title: title.unwrap_or_else(|| arguments.model.scenario.clone()),
        scene: scenario.map_or_else(Scene::default, |scenario| scenario.scene.clone()),
        seed: arguments.seed,
        user: caller.adviser.user(),
        ..caller.shown
    };
    Ok(exit.worse(page::write(path, to_page(advised, &parsed.inputs.sources), colors)))
}

/// What answers batches.
struct Caller<'a> {
    arguments: &'a AdviseCommand,
    adviser: Adviser<'a>,
    threads: Threads,
    /// What the page of the call shows; gathered only for one.
    shown: Advised,
}

impl Caller<'_> {
    /// Answers a complete cycle, with notes on what came before it; false where nobody reads any more.
    fn answer(&mut self, batches: &[Batch], notes: &mut Vec<String>) -> Result<bool, Vec<Diagnostic>> {
        #[allow(clippy::disallowed_methods, reason = "the command line keeps deadlines")]
        let started = Instant::now();
        let limit = self.arguments.deadline.map(|deadline| deadline.saturating_sub(RESERVE));
        let mut budget = Budget::new(DEFAULT_TRIALS, limit);
        budget.max_total = self.arguments.total_trials;
        let mut found = self.adviser.advise(batches, &self.threads, &budget)?;
        found.notes.splice(0..0, std::mem::take(notes));
        let line = advice::line(&found, self.arguments.velocity, started.elapsed().as_secs_f64() * 1e3);
        if self.arguments.report.is_some() {
            self.shown.cycles.push(found);
        }
        Ok(print_to_reader(&line)?)
    }

    /// Whether velocities are differences of positions.
    fn sees(&self) -> bool {
        self.arguments.velocity == Velocity::Seen
    }
}
