//! Completions and man pages.

use super::arguments::Arguments;
use super::complaint;
use super::terminal::print;
use crate::syntax::diagnostic::Diagnostic;
use clap::CommandFactory;
use std::path::Path;

/// Completions of a shell, to standard output.
pub(super) fn completions(shell: clap_complete::Shell) -> Result<(), Diagnostic> {
    let mut bytes = Vec::new();
    clap_complete::generate(shell, &mut Arguments::command(), "smc", &mut bytes);
    print(&String::from_utf8_lossy(&bytes))
}

/// Man pages, into a directory.
pub(super) fn pages(directory: &Path) -> Result<(), Diagnostic> {
    let written = std::fs::create_dir_all(directory)
        .and_then(|()| clap_mangen::generate_to(Arguments::command(), directory));
    written.map_err(|error| {
        complaint::output(format!("man pages cannot be written to `{}`: {error}", directory.display()))
    })
}
