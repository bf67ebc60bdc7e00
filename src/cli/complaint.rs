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
        .hint("is the place there, may it be written, and is it not full?")
}

/// A file, or standard input, cannot be read.
pub(super) fn input(title: impl Into<String>) -> Diagnostic {
    Diagnostic::placeless(Code::E0701, title)
        .hint("names are relative to the folder of the call; `-` is standard input")
}

/// Time was up before the first trial.
pub(super) fn late() -> Diagnostic {
    Diagnostic::placeless(Code::E0921, "time was up before the first trial")
        .hint("give more time with `--timeout`, or make the scenario smaller")
}

/// The call was interrupted before the first trial.
pub(super) fn interrupted() -> Diagnostic {
    Diagnostic::placeless(Code::E0922, "interrupted before the first trial")
}

/// What the engine refuses, each of it.
pub(super) fn refusals(fault: &Fault) -> Vec<Diagnostic> {
    match fault {
        Fault::Crowded(places) => places.iter().map(refusal).collect(),
        one => vec![refusal(one)],
    }
}

/// What the engine refuses; of several the first.
pub(super) fn refusal(fault: &Fault) -> Diagnostic {
    match fault {
        Fault::Placement { reason, place } => {
            let error = match place {
                Some(span) => Diagnostic::error(Code::E0801, *span, reason.as_str()),
                None => Diagnostic::placeless(Code::E0801, reason.as_str()),
            };
            error.hint("fewer people, a larger shape to start from, or smaller radii")
        }
        Fault::Crowded(places) => match places.first() {
            Some(first) => refusal(first),
            None => Diagnostic::placeless(Code::E0801, fault.to_string()),
        },
        Fault::Procedure { place, reason } => Diagnostic::error(Code::E0604, *place, reason.to_string())
            .hint("`smc explain E0604` says what each procedure takes"),
        Fault::Memory { place, .. } => Diagnostic::error(Code::E0923, *place, fault.to_string())
            .hint("one value is kept for each trial of each `E` and `Q`: set a smaller `--max-trials`, or ask fewer of them at once with `--only`"),
        Fault::Model(flaw) => of_model(flaw),
        Fault::Statistics(reason) => Diagnostic::placeless(Code::E0604, reason.to_string())
            .hint("`smc explain E0604` says what each procedure takes"),
        Fault::Logic(reason) => Diagnostic::placeless(Code::E0509, reason.to_string())
            .hint("shorter bounds or a longer step need less memory"),
        Fault::Unsuitable => Diagnostic::placeless(Code::E0603, fault.to_string())
            .hint("`smc explain E0603` says which procedure goes with what"),
        Fault::Rank { .. } => argument(fault.to_string(), "all processes of a call must be the same program"),
        Fault::Threads(_) => argument(fault.to_string(), "ask for fewer: `--threads 1`"),
    }
}

/// What a trial shows to be wrong with the model.
pub(super) fn of_model(flaw: &Flaw) -> Diagnostic {
    let title = format!("{}: {}", flaw.moment, flaw.what);
    let error = match flaw.place {
        Some(span) => Diagnostic::error(flaw.code, span, title),
        None => Diagnostic::placeless(flaw.code, title),
    };
    let error = if flaw.state.is_empty() { error } else { error.label(format!("where {}", flaw.state)) };
    error.hint(flaw.hint)
}

/// Says it on standard error.
pub(super) fn tell(error: &Diagnostic, sources: &[Source], colors: Colors) {
    tell_all(std::slice::from_ref(error), sources, colors);
}

/// Says them on standard error.
pub(super) fn tell_all(errors: &[Diagnostic], sources: &[Source], colors: Colors) {
    say(&render(errors, sources, colors.err));
}
