//! Completions and man pages.

use super::arguments::Arguments;
use super::complaint;
use super::terminal::{Colors, print};
use crate::report::ExitCode as Exit;
use clap::CommandFactory;
use std::path::Path;

/// Completions of a shell, to standard output.
pub(super) fn completions(shell: clap_complete::Shell, colors: Colors) -> Exit {
    let mut bytes = Vec::new();
    clap_complete::generate(shell, &mut Arguments::command(), "smc", &mut bytes);
    match print(&String::from_utf8_lossy(&bytes)) {
        Ok(()) => Exit::Success,
        Err(reason) => {
            complaint::tell(&complaint::output(reason), &[], colors);
            Exit::Wrong
        }
    }
}

/// Man pages, into a directory.
pub(super) fn pages(directory: &Path, colors: Colors) -> Exit {
    let written = std::fs::create_dir_all(directory)
        .and_then(|()| clap_mangen::generate_to(Arguments::command(), directory));
    match written {
        Ok(()) => Exit::Success,
        Err(error) => {
            let error = format!("man pages cannot be written to `{}`: {error}", directory.display());
            complaint::tell(&complaint::output(error), &[], colors);
            Exit::Wrong
        }
    }
}
