//! `smc advise`: advice for one user, a line for each batch of observations.

mod arguments;
mod replay;
mod stream;

pub(super) use arguments::AdviseCommand;

use super::complaint;
use super::inputs;
use super::output;
use super::page;
use super::terminal::{Colors, print_to_reader, say};
use crate::advise::{Adviser, Advising, role};
use crate::data::tracks::{Batch, Velocity};
use crate::engine::budget::DEFAULT_TRIALS;
use crate::engine::{Budget, Fault, Threads};
use crate::library;
use crate::model::Scene;
use crate::report::ExitCode as Exit;
use crate::report::advice;
use crate::report::advised::{Advised, to_page};
use crate::syntax::diagnostic::{Diagnostic, Severity};
use std::time::{Duration, Instant};

/// What is kept of a deadline for writing the line.
const RESERVE: Duration = Duration::from_millis(2);

/// Runs the command.
pub(super) fn run(arguments: &AdviseCommand, colors: Colors) -> Exit {
    let (parsed, paths) = inputs::parse(&arguments.model, &arguments.properties);
    let refuse = |errors: &[Diagnostic]| {
        complaint::tell_all(errors, &parsed.inputs.sources, colors);
        Exit::Wrong
    };
    complaint::diagnose(&parsed.inputs, colors);
    if parsed.inputs.diagnostics.iter().any(|one| one.severity == Severity::Error) {
        return Exit::Wrong;
    }
    if let Err(error) = output::guard(arguments.report.as_deref(), &paths) {
        return refuse(&[error]);
    }
    let role = match role(&parsed.scenario) {
        Ok(role) => role,
        Err(error) => return refuse(&[error]),
    };
    let threads = match Threads::new(arguments.threads) {
        Ok(threads) => threads,
        Err(error) => return refuse(&[library::refusal(&Fault::Threads(error.to_string()))]),
    };
    let recording = match &arguments.replay {
        Some(name) => match replay::batches(&parsed, name, arguments) {
            Ok(batches) => Some(batches),
            Err(error) => return refuse(&[error]),
        },
        None => None,
    };
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
    let exit = match done {
        Ok(()) => Exit::Success,
        Err(errors) => refuse(&errors),
    };
    let Some(path) = &arguments.report else { return exit };
    let scenario = caller.adviser.scenario();
    let title = scenario.map(|scenario| scenario.title.clone()).filter(|title| !title.is_empty());
    let advised = Advised {
        title: title.unwrap_or_else(|| arguments.model.scenario.clone()),
        scene: scenario.map_or_else(Scene::default, |scenario| scenario.scene.clone()),
        seed: arguments.seed,
        user: caller.adviser.user(),
        ..caller.shown
    };
    exit.worse(page::write(path, to_page(advised, &parsed.inputs.sources), colors))
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
        print_to_reader(&line).map_err(|reason| vec![complaint::output(reason)])
    }

    /// Whether velocities are differences of positions.
    fn sees(&self) -> bool {
        self.arguments.velocity == Velocity::Seen
    }
}

/// Says that a line is left out.
fn skipped(reason: &str) {
    say(&format!("warning: {}\n", crate::base::visible::visible(reason)));
}
