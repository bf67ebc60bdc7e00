//! What the engine refuses, as diagnostics: each with a code, a place where it has one, and what to do.

use crate::engine::{Fault, Flaw};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::Diagnostic;

/// An argument of the call is wrong.
fn call(fault: &Fault, hint: &str) -> Diagnostic {
    Diagnostic::placeless(Code::E0705, fault.to_string()).hint(hint)
}

/// What the engine refuses, each of it.
pub fn refusals(fault: &Fault) -> Vec<Diagnostic> {
    match fault {
        Fault::Crowded(places) => places.iter().map(refusal).collect(),
        one => vec![refusal(one)],
    }
}

/// What the engine refuses; of several the first.
pub fn refusal(fault: &Fault) -> Diagnostic {
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
        Fault::Rank { .. } => call(fault, "all processes of a call must be the same program"),
        Fault::Threads(_) => call(fault, "ask for fewer: `--threads 1`"),
    }
}

/// What a trial shows to be wrong with the model.
pub fn of_model(flaw: &Flaw) -> Diagnostic {
    let title = format!("{}: {}", flaw.moment, flaw.what);
    let error = match flaw.place {
        Some(span) => Diagnostic::error(flaw.code, span, title),
        None => Diagnostic::placeless(flaw.code, title),
    };
    let error = if flaw.state.is_empty() { error } else { error.label(format!("where {}", flaw.state)) };
    error.hint(flaw.hint)
}
