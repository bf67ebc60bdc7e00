//! `smc monitor`, `smc evaluate` and `smc fit`: models beside recordings.

mod arguments;
mod evaluate;
mod fit;
mod monitor;

pub(super) use arguments::{EvaluateCommand, FitCommand, MonitorCommand};
pub(super) use evaluate::run as evaluate;
pub(super) use fit::run as fit;
pub(super) use monitor::run as monitor;

use super::complaint;
use super::inputs;
use super::output;
use super::terminal::{Colors, print};
use crate::base::visible::visible;
use crate::data::tracks::Velocity;
use crate::engine::{Fault, Threads};
use crate::library;
use crate::replay::{Instant, Replay, Whose};
use crate::report::ExitCode as Exit;
use crate::syntax::diagnostic::{Diagnostic, Severity};
use crate::syntax::source::Source;
use arguments::Replayed;

/// What a call is about.
struct Call {
    replay: Replay,
    threads: Threads,
    instants: Vec<Instant>,
    /// Time between two instants, s.
    every: f64,
}

/// Reads what a call names and does the work.
fn run(
    replayed: &Replayed,
    (velocity, whose): (Velocity, Whose),
    colors: Colors,
    work: impl FnOnce(&Call) -> Result<String, Vec<Diagnostic>>,
) -> Exit {
    let refuse = |errors: &[Diagnostic], sources: &[Source]| {
        complaint::tell_all(errors, sources, colors);
        Exit::Wrong
    };
    let (parsed, paths) = inputs::parse(&replayed.model, &replayed.properties);
    complaint::diagnose(&parsed.inputs, colors);
    if parsed.inputs.diagnostics.iter().any(|one| one.severity == Severity::Error) {
        return Exit::Wrong;
    }
    let sources = &parsed.inputs.sources;
    if let Err(error) = output::guard(replayed.output.as_deref(), &paths) {
        return refuse(&[error], sources);
    }
    let threads = match Threads::new(replayed.threads) {
        Ok(threads) => threads,
        Err(error) => return refuse(&[library::refusal(&Fault::Threads(error.to_string()))], sources),
    };
    let replay = match Replay::new(&parsed.input(), &replayed.replay, velocity, whose) {
        Ok(replay) => replay,
        Err(errors) => return refuse(&errors, sources),
    };
    let every = replayed.every.map_or(replay.recording.step(), |every| every.as_secs_f64());
    let instants = replay.instants(every, replayed.between());
    if instants.is_empty() {
        let said =
            format!("the recording `{}` has no instant of this user between these times", replay.tracks);
        let hint = format!("it lasts until {} s", replay.recording.duration());
        return refuse(&[complaint::argument(said, hint)], sources);
    }
    let call = Call { replay, threads, instants, every };
    let text = match work(&call) {
        Ok(text) => text,
        Err(errors) => return refuse(&errors, &call.replay.sources),
    };
    let written = match &replayed.output {
        Some(path) => output::write(path, |out| out.write_all(text.as_bytes()))
            .map_err(|error| format!("`{}` cannot be written: {error}", path.display())),
        None => print(&visible(&text)),
    };
    match written {
        Ok(()) => Exit::Success,
        Err(reason) => refuse(&[complaint::output(reason)], sources),
    }
}
