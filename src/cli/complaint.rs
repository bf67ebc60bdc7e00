//! What is reported of a call that is wrong in a way that no file shows: each with a code and with what to do.

use super::terminal::{Colors, say};
use crate::compile::nearest::nearest;
use crate::library::Inputs;
use crate::report::ExitCode as Exit;
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::render::render;
use crate::syntax::source::Source;
use std::path::Path;

/// An argument of the call is wrong.
pub(super) fn argument(title: impl Into<String>, hint: impl Into<String>) -> Diagnostic {
    Diagnostic::placeless(Code::E0705, title).hint(hint)
}

/// A file, or standard output, cannot be written.
pub(super) fn output(title: impl Into<String>) -> Diagnostic {
    Diagnostic::placeless(Code::E0706, title)
        .hint("check that the folder exists, is writable and is not full")
}

/// A file cannot be written.
pub(super) fn unwritten(file: &Path, error: &std::io::Error) -> Diagnostic {
    let missing = file.parent().filter(|folder| !folder.as_os_str().is_empty() && !folder.exists());
    let file = file.display();
    match missing {
        Some(folder) => {
            output(format!("`{file}` cannot be written: the folder `{}` does not exist", folder.display()))
        }
        None => output(format!("`{file}` cannot be written: {error}")),
    }
}

/// A file, or standard input, cannot be read.
pub(super) fn input(title: impl Into<String>) -> Diagnostic {
    Diagnostic::placeless(Code::E0701, title)
        .hint("file names are relative to the current folder; `-` is standard input")
}

/// A certificate cannot be read, or is one of other inputs.
pub(super) fn certificate(title: impl Into<String>) -> Diagnostic {
    Diagnostic::placeless(Code::E0730, title).hint(
        "`smc check … --certificate FILE` writes one; verify it beside the files and folders of that call",
    )
}

/// The time limit ended the call; `when` begins with a blank.
pub(super) fn late(when: &str) -> Diagnostic {
    Diagnostic::placeless(Code::E0921, format!("the time limit ended the call{when}"))
        .hint("write a longer `--timeout`, or make the scenario smaller")
}

/// The call was interrupted before the first trial.
pub(super) fn interrupted() -> Diagnostic {
    Diagnostic::placeless(Code::E0922, "the call was interrupted before the first trial")
}

/// Writes it to standard error.
pub(super) fn tell(error: &Diagnostic, sources: &[Source], colors: Colors) {
    tell_all(std::slice::from_ref(error), sources, colors);
}

/// Writes them to standard error.
pub(super) fn tell_all(errors: &[Diagnostic], sources: &[Source], colors: Colors) {
    say(&render(errors, sources, colors.err));
}

/// How a call ends: what stops it is written to standard error.
pub(super) fn end(
    done: Result<Exit, impl Into<Vec<Diagnostic>>>,
    sources: &[Source],
    colors: Colors,
) -> Exit {
    done.unwrap_or_else(|errors| {
        tell_all(&errors.into(), sources, colors);
        Exit::Wrong
    })
}

/// A hint at a name: the nearest one that is known, or all, after what they are.
pub(super) fn meant(name: &str, known: &[&str], all: &str) -> String {
    nearest(name, known.iter().copied())
        .map_or_else(|| format!("{all} {}", known.join(", ")), |near| format!("did you mean `{near}`?"))
}

/// Writes errors and warnings about the inputs to standard error.
pub(super) fn diagnose(inputs: &Inputs, colors: Colors) {
    if !inputs.diagnostics.is_empty() {
        tell_all(&inputs.diagnostics, &inputs.sources, colors);
    }
}
