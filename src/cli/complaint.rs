//! What is said of a call that is wrong in a way that no file shows, and of what the engine refuses: each with a code
//! and with what to do.

use super::terminal::{Colors, say};
use crate::engine::{Fault, Flaw};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::render::render;
use crate::syntax::source::Source;

/// An argument of the call is wrong.
pub(super) fn argument(title: impl Into<String>, hint: impl Into<String>) -> Diagnostic {
    Diagnostic::placeless(Code::E0705, title).hint(hint)
}

/// A file, or standard output, cannot be written.
pub(super) fn output(title: impl Into<String>) -> Diagnostic {
    Diagnostic::placeless(Code::E0706, title)
        .hint("check that the folder exists, is writable and is not full")
}

/// A file, or standard input, cannot be read.
pub(super) fn input(title: impl Into<String>) -> Diagnostic {
    Diagnostic::placeless(Code::E0701, title)
        .hint("file names are relative to the current folder; `-` is standard input")
}

/// The time limit ended the call before the first trial.
pub(super) fn late() -> Diagnostic {
    Diagnostic::placeless(Code::E0921, "the time limit ended the call before the first trial")
        .hint("write a longer `--timeout`, or make the scenario smaller")
}

/// The call was interrupted before the first trial.
pub(super) fn interrupted() -> Diagnostic {
    Diagnostic::placeless(Code::E0922, "the call was interrupted before the first trial")
}

/// The diagnostics of a fault of the engine.
pub(super) fn refusals(fault: &Fault) -> Vec<Diagnostic> {
    match fault {
        Fault::Crowded(places) => places.iter().map(refusal).collect(),
        one => vec![refusal(one)],
    }
}

/// The diagnostic of a fault of the engine; the first of several.
pub(super) fn refusal(fault: &Fault) -> Diagnostic {
    match fault {
        Fault::Placement { reason, place } => {
            let error = match place {
                Some(span) => Diagnostic::error(Code::E0801, *span, reason.as_str()),
                None => Diagnostic::placeless(Code::E0801, reason.as_str()),
            };
            error.hint("use fewer agents, a larger shape to start in, or smaller radii")
        }
        Fault::Crowded(places) => match places.first() {
            Some(first) => refusal(first),
            None => Diagnostic::placeless(Code::E0801, fault.to_string()),
        },
        Fault::Procedure { place, reason } => Diagnostic::error(Code::E0604, *place, reason.to_string())
            .hint("see `smc explain E0604` for the arguments of each procedure"),
        Fault::Memory { place, .. } => Diagnostic::error(Code::E0923, *place, fault.to_string())
            .hint("one value is stored for each trial of each `E` and `Q`: write a smaller `--max-trials`, or select fewer queries with `--only`"),
        Fault::Model(flaw) => of_model(flaw),
        Fault::Statistics(reason) => Diagnostic::placeless(Code::E0604, reason.to_string())
            .hint("see `smc explain E0604` for the arguments of each procedure"),
        Fault::Logic(reason) => Diagnostic::placeless(Code::E0509, reason.to_string())
            .hint("use shorter bounds or a longer step, which need less memory"),
        Fault::Unsuitable => Diagnostic::placeless(Code::E0603, fault.to_string())
            .hint("see `smc explain E0603` for the procedures of each query"),
        Fault::Rank { .. } => argument(fault.to_string(), "all processes of a call must run the same program"),
        Fault::Threads(_) => argument(fault.to_string(), "use fewer threads: `--threads 1`"),
    }
}

/// The diagnostic of an error of the model in a trial.
pub(super) fn of_model(flaw: &Flaw) -> Diagnostic {
    let title = format!("{}: {}", flaw.moment, flaw.what);
    let error = match flaw.place {
        Some(span) => Diagnostic::error(flaw.code, span, title),
        None => Diagnostic::placeless(flaw.code, title),
    };
    let error = if flaw.state.is_empty() { error } else { error.label(format!("where {}", flaw.state)) };
    error.hint(flaw.hint)
}

/// Writes it to standard error.
pub(super) fn tell(error: &Diagnostic, sources: &[Source], colors: Colors) {
    tell_all(std::slice::from_ref(error), sources, colors);
}

/// Says them on standard error.
pub(super) fn tell_all(errors: &[Diagnostic], sources: &[Source], colors: Colors) {
    say(&render(errors, sources, colors.err));
}
