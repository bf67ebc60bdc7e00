//! Faults of the engine as diagnostics: each with a code, a place if it has one, and a hint.

use crate::engine::{Fault, Flaw};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::Diagnostic;

/// The diagnostics of a fault of the engine.
pub fn refusals(fault: &Fault) -> Vec<Diagnostic> {
    match fault {
        Fault::Crowded(places) => places.iter().map(refusal).collect(),
        one => vec![refusal(one)],
    }
}

/// The diagnostic of a fault of the engine; the first of several.
pub fn refusal(fault: &Fault) -> Diagnostic {
    match fault {
        Fault::Placement { reason, place } => {
            let error = match place {
                Some(span) => error!(E0801, *span, "{}", reason.as_str()),
                None => Diagnostic::placeless(Code::E0801, reason.as_str()),
            };
            error.hint("use fewer agents, a larger shape to start in, or smaller radii")
        }
        Fault::Crowded(places) => match places.first() {
            Some(first) => refusal(first),
            None => Diagnostic::placeless(Code::E0801, fault.to_string()),
        },
        Fault::Procedure { place, reason } => error!(E0604, *place, "{}", reason.to_string();
            hint: "see `smc explain E0604` for the arguments of each procedure"),
        Fault::Memory { place, .. } => error!(E0923, *place, "{}", fault.to_string();
            hint: "one value is stored for each trial of each `E` and `Q`: write a smaller `--max-trials`, or select fewer queries with `--only`"),
        Fault::Model(flaw) => of_model(flaw),
        Fault::Statistics(reason) => Diagnostic::placeless(Code::E0604, reason.to_string())
            .hint("see `smc explain E0604` for the arguments of each procedure"),
        Fault::Logic(reason) => Diagnostic::placeless(Code::E0509, reason.to_string())
            .hint("use shorter bounds or a longer step, which need less memory"),
        Fault::Unsuitable => Diagnostic::placeless(Code::E0603, fault.to_string())
            .hint("see `smc explain E0603` for the procedures of each query"),
        Fault::Threads(_) => {
            Diagnostic::placeless(Code::E0705, fault.to_string()).hint("use fewer threads: `--threads 1`")
        }
    }
}

/// The diagnostic of an error of the model in a trial.
pub fn of_model(flaw: &Flaw) -> Diagnostic {
    let title = format!("{}: {}", flaw.moment, flaw.what);
    let error = match flaw.place {
        Some(span) => Diagnostic::error(flaw.code, span, title),
        None => Diagnostic::placeless(flaw.code, title),
    };
    let error = if flaw.state.is_empty() { error } else { error.label(format!("where {}", flaw.state)) };
    error.hint(flaw.hint)
}
