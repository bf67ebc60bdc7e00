//! `smc monitor`, `smc evaluate`, `smc calibrate` and `smc fit`: models beside recordings.

mod arguments;
mod calibrate;
mod evaluate;
mod fit;
mod monitor;

pub(super) use arguments::{CalibrateCommand, EvaluateCommand, FitCommand, MonitorCommand};
pub(super) use calibrate::run as calibrate;
pub(super) use evaluate::run as evaluate;
pub(super) use fit::run as fit;
pub(super) use monitor::run as monitor;

use super::complaint;
use super::inputs;
use super::output;
use super::terminal::Colors;
use super::values::threads;
use crate::base::visible::visible;
use crate::compile::Site;
use crate::data::tracks::Velocity;
use crate::engine::Threads;
use crate::library::Parsed;
use crate::replay::{Instant, Replay, Whose};
use crate::report::ExitCode as Exit;
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::source::Source;
use arguments::Replayed;
use std::path::{Path, PathBuf};

/// What a call is about.
struct Call {
    replay: Replay,
    threads: Threads,
    instants: Vec<Instant>,
    /// Time between two instants, s.
    every: f64,
}

/// As `run`, for a call that finds the laws of its site in the recording: `prepare` reads the texts, `site` the recording.
fn run_at_site<T>(
    replayed: &Replayed,
    of: (Velocity, Whose),
    (outputs, colors): ([Option<&Path>; 2], Colors),
    prepare: impl FnOnce(&Parsed) -> T,
    site: impl FnOnce(&T, &Replay) -> Result<Option<Site>, Diagnostic>,
    work: impl FnOnce(&Call, &T) -> Result<String, Vec<Diagnostic>>,
) -> Exit {
    let Some((parsed, paths)) = inputs::parse_or_tell(&replayed.model, &replayed.properties, colors) else {
        return Exit::Wrong;
    };
    if let Err(error) = output::guard_all(&outputs, &paths) {
        return complaint::end(Err(vec![error]), &parsed.inputs.sources, colors);
    }
    let prepared = prepare(&parsed);
    let mut sources = parsed.inputs.sources.clone();
    let site = |replay: &Replay| site(&prepared, replay);
    let work = |call: &Call| work(call, &prepared);
    let done = replay(&parsed, &paths, replayed, of, &mut sources, (site, work));
    complaint::end(done.map(|()| Exit::Success), &sources, colors)
}

/// Reads what a call names and does the work.
fn run(
    replayed: &Replayed,
    of: (Velocity, Whose),
    colors: Colors,
    work: impl FnOnce(&Call) -> Result<String, Vec<Diagnostic>>,
) -> Exit {
    run_at_site(replayed, of, ([None; 2], colors), |_| (), |(), _| Ok(None), |call, ()| work(call))
}

/// Does the work and writes what it gives; `sources` are the texts of errors.
fn replay(
    parsed: &Parsed,
    paths: &[PathBuf],
    replayed: &Replayed,
    (usual, whose): (Velocity, Whose),
    sources: &mut Vec<Source>,
    (site, work): (
        impl FnOnce(&Replay) -> Result<Option<Site>, Diagnostic>,
        impl FnOnce(&Call) -> Result<String, Vec<Diagnostic>>,
    ),
) -> Result<(), Vec<Diagnostic>> {
    output::guard(replayed.span.output.as_deref(), paths)?;
    let threads = threads(replayed.span.cores.threads)?;
    let velocity = replayed.model.velocity.unwrap_or(usual);
    let replay = Replay::at_site(&parsed.input(), &replayed.tracks, velocity, whose, site)?;
    let every = replayed.every.map_or(replay.recording.step(), |every| every.as_secs_f64());
    let instants = replay.instants(every, replayed.span.between());
    if instants.is_empty() {
        let said =
            format!("the recording `{}` has no instant of this user between these times", replay.tracks);
        let hint = format!("it lasts until {} s", replay.recording.duration());
        return Err(complaint::argument(said, hint).into());
    }
    let call = Call { replay, threads, instants, every };
    sources.clone_from(&call.replay.sources);
    let text = work(&call)?;
    let shown = if replayed.span.output.is_none() { visible(&text) } else { text.as_str().into() };
    Ok(output::put(replayed.span.output.as_deref(), &shown)?)
}
