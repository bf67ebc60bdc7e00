//! Floor 10: the command line. It alone opens files, reads the environment and writes to the terminal.

mod advise;
mod arguments;
mod check;
mod compare_walks;
mod complaint;
mod deadline;
mod drift;
mod end;
mod format;
mod gait;
mod infer;
mod inputs;
mod launch;
mod manual;
mod merge;
mod misuse;
mod output;
mod page;
mod parts;
mod path;
mod plot;
mod progress;
mod replay;
mod shard;
mod show;
mod simulate;
mod terminal;
mod values;
mod walk;

use crate::base::visible::visible;
use crate::engine::outcome::Failure;
use crate::report::ExitCode as Exit;
use crate::syntax::diagnostic::Diagnostic;
use arguments::{Arguments, Command};
use check::Way;
use std::borrow::Cow;
use std::process;
use terminal::{Colors, say};
use values::Destination;

/// Stack of the thread that does the work: deep formulas are walked recursively, up to a limit.
const STACK: usize = 256 << 20;

/// Runs the program.
pub fn run() -> process::ExitCode {
    let mut arguments = match misuse::parse(std::env::args_os().collect()) {
        Ok(arguments) => arguments,
        Err(error) if !error.use_stderr() => {
            let _ = error.print();
            return process::ExitCode::from(Exit::Success.code());
        }
        Err(error) => {
            misused(&error);
            return process::ExitCode::from(Exit::Wrong.code());
        }
    };
    match &mut arguments.command {
        Command::Check(command) => command.questions.model.velocity = command.questions.velocity,
        Command::Merge(command) => {
            let questions = &mut command.questions;
            questions.model.velocity = questions.velocity;
            // Options may stand anywhere, so the folder is whatever comes last.
            command.folder = questions.properties.pop().unwrap_or_default().into();
        }
        Command::Shard(command) => command.model.velocity = command.velocity,
        Command::Simulate(command) => command.model.velocity = command.velocity,
        _ => {}
    }
    let asked = match &arguments.command {
        Command::Check(check) => Some(&check.questions),
        Command::Merge(merge) => Some(&merge.questions),
        _ => None,
    };
    let asked = asked.map(|asked| (check::screen(asked), asked.model.scenario.clone(), asked.seed));
    let worker = std::thread::Builder::new().stack_size(STACK).spawn(move || dispatch(&arguments));
    let exit = match worker.map(std::thread::JoinHandle::join) {
        Ok(Ok(exit)) => exit,
        Ok(Err(_)) => {
            say("this is a bug in smc; please report it with the files of this call\n");
            if let Some((format, scenario, seed)) = asked {
                let bug = Failure::Bug("smc has a bug; see standard error for details".to_owned());
                check::without_results(format, scenario, seed, bug);
            }
            Exit::Bug
        }
        Err(error) => {
            let error = complaint::argument(
                format!("no thread can be started: {error}"),
                "check that enough memory is available",
            );
            complaint::tell(&error, &[], Colors { out: false, err: false });
            Exit::Wrong
        }
    };
    process::ExitCode::from(exit.code())
}

/// Reports that the command line cannot be understood, in the format that it asks for as far as it can be.
fn misused(error: &clap::Error) {
    let text = error.to_string();
    match visible(&text) {
        Cow::Borrowed(_) => _ = error.print(),
        Cow::Owned(shown) => say(&shown),
    }
    let words: Vec<String> =
        std::env::args_os().skip(1).map(|word| word.to_string_lossy().into_owned()).collect();
    // Usage and tips follow after an empty line.
    let message = text.split("\n\n").next().unwrap_or_default();
    let message = message.strip_prefix("error: ").unwrap_or(message);
    let message = &message.split_whitespace().collect::<Vec<_>>().join(" ");
    let format = format_of(&words);
    if words.iter().any(|word| word == "check" || word == "merge")
        && let Some(destination) = format.and_then(|text| text.parse::<Destination>().ok())
    {
        check::misused(destination.format, message);
    } else if words.iter().any(|word| word == "drift") && format == Some("json") {
        let _ = drift::print_error(message);
    }
}

/// The last format for standard output that words ask for.
fn format_of(words: &[String]) -> Option<&str> {
    let inline = words.iter().filter_map(|word| word.strip_prefix("--format="));
    let apart = words.windows(2).filter(|pair| pair[0] == "--format").map(|pair| pair[1].as_str());
    inline.chain(apart).rfind(|format| !format.contains('='))
}

fn dispatch(arguments: &Arguments) -> Exit {
    let colors = Colors::chosen(arguments.color);
    let ended = |done: Result<(), Diagnostic>| complaint::end(done.map(|()| Exit::Success), &[], colors);
    let limit = match &arguments.command {
        Command::Simulate(command) => Some(command.limit),
        Command::Path(command) => Some(command.limit),
        Command::Walk(command) => Some(command.limit),
        Command::Show(command) => Some(command.limit),
        _ => None,
    };
    if let Some(limit) = limit {
        deadline::limit(limit, colors);
    }
    match &arguments.command {
        Command::Check(command) => check::run(&command.questions, &Way::Check(command), colors),
        Command::Merge(command) => check::run(&command.questions, &Way::Merge(&command.folder), colors),
        Command::Shard(command) => shard::run(command, colors),
        Command::Simulate(command) => simulate::run(command, colors),
        Command::Path(command) => path::run(command, colors),
        Command::Advise(command) => advise::run(command, colors),
        Command::Monitor(command) => replay::monitor(command, colors),
        Command::Evaluate(command) => replay::evaluate(command, colors),
        Command::Fit(command) => replay::fit(command, colors),
        Command::Infer(command) => infer::run(command, colors),
        Command::Gait(command) => gait::run(command, colors),
        Command::Walk(command) => walk::run(command, colors),
        Command::Plot(command) => ended(plot::run(command)),
        Command::CompareWalks(command) => compare_walks::run(command, colors),
        Command::Drift(command) => drift::run(command, colors),
        Command::Show(command) => show::run(command, colors),
        Command::Fmt(command) => format::run(command, colors),
        Command::Explain(command) => ended(manual::explain(command)),
        Command::Completions { shell } => ended(manual::completions(*shell)),
        Command::Man { directory } => ended(manual::pages(directory)),
    }
}
