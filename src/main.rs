//! The command line; it only dispatches.

use std::process::ExitCode;

fn main() -> ExitCode {
    smc::cli::run()
}
