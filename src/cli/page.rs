//! The pages of `--report`: written as a whole or not at all.

use super::end::early_end;
use super::terminal::{Colors, warn};
use super::values::Model;
use super::{complaint, output};
use crate::base::random::TrialKey;
use crate::base::tick::Tick;
use crate::engine::outcome::CallResult;
use crate::engine::traces::{Traces, simulated};
use crate::engine::{CommandLine, no_start};
use crate::kernel::{Address, End, Program, State};
use crate::report::ExitCode as Exit;
use crate::report::html::{self, MOST_NUMBERS, Page};
use crate::syntax::source::Source;
use std::path::Path;

/// Writes a page.
pub(super) fn write(path: &Path, page: Page<'_>, colors: Colors) -> Exit {
    let saved = output::save(path, html::page(page).as_bytes());
    complaint::end(saved.map(|()| Exit::Success), &[], colors)
}

/// The files and settings of a call without properties.
pub(super) fn line(model: &Model) -> CommandLine {
    CommandLine {
        scenario: relative(&model.scenario),
        settings: model.set.clone(),
        data: model.data.iter().map(|data| data.display().to_string()).collect(),
        velocity: model.velocity.map(|velocity| velocity.name().to_owned()),
        models: model.models.clone(),
        allow_run: model.allow_run,
        ..CommandLine::default()
    }
}

/// A path below the current folder without the path of that folder, so that a command can be repeated elsewhere.
pub(super) fn relative(path: &str) -> String {
    #[expect(
        clippy::disallowed_methods,
        reason = "commands on a page name files as from the folder of the call"
    )]
    let folder = std::env::current_dir();
    let below = folder.ok().and_then(|folder| {
        let rest = Path::new(path).strip_prefix(folder).ok()?;
        Some(rest.display().to_string())
    });
    below.filter(|rest| !rest.is_empty()).unwrap_or_else(|| path.to_owned())
}

/// Trials that a page plays without results.
pub(super) struct Trials<'a> {
    pub(super) program: &'a Program,
    /// The file of the scenario.
    pub(super) scenario: &'a str,
    pub(super) sources: &'a [Source],
    pub(super) seed: u64,
    /// The trials, and the option of moves that is followed in each.
    pub(super) list: &'a mut dyn Iterator<Item = (u64, Option<(usize, usize)>)>,
    /// The last tick.
    pub(super) last: Tick,
    /// Command that gives the trials again.
    pub(super) replay: String,
}

impl Trials<'_> {
    /// Runs as many as there is room for and writes the page.
    pub(super) fn write(self, path: &Path, colors: Colors) -> Exit {
        let Self { program, scenario, sources, seed, list, last, replay } = self;
        let (mut traces, mut numbers, mut exit) = (Traces::default(), 0, Exit::Success);
        for (index, advice) in list {
            if numbers > MOST_NUMBERS {
                traces.left_out += 1;
                continue;
            }
            let key = TrialKey { seed, index, branch: 0 };
            let ended = |state: &State, end: End| {
                // As a check of the same trial would.
                exit = if matches!(end, End::Faulty(_)) { Exit::Wrong } else { exit };
                if let Some(reason) = early_end(program, state, end) {
                    warn(&format!("warning: trial {index} {reason}\n"));
                }
            };
            match simulated(program, Address { advice, ..key.into() }, last, ended) {
                Ok(trace) => {
                    numbers += trace.least();
                    traces.list.push(trace);
                }
                Err(fault) => {
                    let why = no_start(&program.scenario, fault);
                    warn(&format!("warning: trial {index} cannot start: {why}\n"));
                }
            }
        }
        let title = &program.scenario.title;
        let title = if title.is_empty() { scenario } else { title };
        let run = CallResult { replay, ..CallResult::of(title, seed) };
        exit.worse(write(path, Page { run, sources, traces, ..Page::default() }, colors))
    }
}
