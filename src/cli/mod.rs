//! Floor 8: the command line. It alone opens files, reads the environment and writes to the terminal.

mod arguments;
mod check;
mod complaint;
mod drift;
mod explain;
mod format;
mod inputs;
mod manual;
mod progress;
mod ranks;
mod shelf;
mod show;
mod simulate;
mod terminal;

use crate::report::ExitCode as Exit;
use crate::syntax::render::render;
use arguments::{Arguments, Command};
use clap::Parser;
use std::process;
use terminal::{Colors, say};

/// Stack of the thread that does the work: deep formulas are walked recursively, up to a limit.
const STACK: usize = 256 << 20;

/// Runs the program.
pub fn run() -> process::ExitCode {
    if std::env::args_os().skip(1).eq([ranks::WORD]) {
        return process::ExitCode::from(rank().code());
    }
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) => {
            let fine = !error.use_stderr();
            let _ = error.print();
            return process::ExitCode::from(if fine { 0 } else { Exit::Wrong.code() });
        }
    };
    let asked = if let Command::Check(check) = &arguments.command {
        Some((check.format, check.model.scenario.clone(), check.seed))
    } else {
        None
    };
    let worker = std::thread::Builder::new().stack_size(STACK).spawn(move || dispatch(&arguments));
    let exit = match worker.map(std::thread::JoinHandle::join) {
        Ok(Ok(exit)) => exit,
        Ok(Err(_)) => {
            say("this is a bug in smc; please report it with the files of this call\n");
            if let Some((format, scenario, seed)) = asked {
                check::fallen(format, scenario, seed);
            }
            Exit::Bug
        }
        Err(error) => {
            let error = complaint::argument(format!("no thread can be started: {error}"), "is memory short?");
            complaint::tell(&error, &[], Colors { out: false, err: false });
            Exit::Wrong
        }
    };
    process::ExitCode::from(exit.code())
}

/// Runs the program as a rank of another one, which hears of it if that fails.
fn rank() -> Exit {
    let worker = std::thread::Builder::new().stack_size(STACK).spawn(ranks::run);
    match worker.map(std::thread::JoinHandle::join) {
        Ok(Ok(exit)) => exit,
        Ok(Err(_)) => Exit::Bug,
        Err(_) => Exit::Wrong,
    }
}

fn dispatch(arguments: &Arguments) -> Exit {
    let colors = Colors::chosen(arguments.color);
    match &arguments.command {
        Command::Check(command) => check::run(command, colors),
        Command::Simulate(command) => simulate::run(command, colors),
        Command::Drift(command) => drift::run(command, colors),
        Command::Show(command) => show::run(command, colors),
        Command::Fmt(command) => format::run(command, colors),
        Command::Explain(command) => explain::run(command, colors),
        Command::Completions { shell } => manual::completions(*shell, colors),
        Command::Man { directory } => manual::pages(directory, colors),
    }
}

/// Writes errors and warnings to standard error.
fn diagnose(inputs: &inputs::Inputs, colors: Colors) {
    if !inputs.diagnostics.is_empty() {
        say(&render(&inputs.diagnostics, &inputs.sources, colors.err));
    }
}
