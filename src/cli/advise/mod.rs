//! `smc advise`: advice for one user, a line for each batch of observations.

mod arguments;
mod replay;
mod stream;

pub(super) use arguments::AdviseCommand;

use super::complaint;
use super::inputs;
use super::terminal::{Colors, print_to_reader, say};
use crate::advise::{Adviser, Advising, role};
use crate::data::tracks::{Batch, Velocity};
use crate::engine::budget::DEFAULT_TRIALS;
use crate::engine::{Budget, Fault, Threads};
use crate::library;
use crate::report::ExitCode as Exit;
use crate::report::advice;
use crate::syntax::diagnostic::{Diagnostic, Severity};
use std::time::{Duration, Instant};

/// What is kept of a deadline for writing the line.
const RESERVE: Duration = Duration::from_millis(2);

/// Runs the command.
pub(super) fn run(arguments: &AdviseCommand, colors: Colors) -> Exit {
    let parsed = inputs::parse(&arguments.model, &arguments.properties);
    let refuse = |errors: &[Diagnostic]| {
        complaint::tell_all(errors, &parsed.inputs.sources, colors);
        Exit::Wrong
    };
    complaint::diagnose(&parsed.inputs, colors);
    if parsed.inputs.diagnostics.iter().any(|one| one.severity == Severity::Error) {
        return Exit::Wrong;
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
    let mut caller = Caller { arguments, adviser, threads };
    let done = match recording {
        Some(recording) => replay::run(&mut caller, &recording),
        None => stream::run(&mut caller),
    };
    match done {
        Ok(()) => Exit::Success,
        Err(errors) => refuse(&errors),
    }
}

/// What answers batches.
struct Caller<'a> {
    arguments: &'a AdviseCommand,
    adviser: Adviser<'a>,
    threads: Threads,
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
