//! Floor 10: the command line. It alone opens files, reads the environment and writes to the terminal.

mod advise;
mod arguments;
mod check;
mod complaint;
mod deadline;
mod drift;
mod end;
mod format;
mod gait;
mod infer;
mod inputs;
mod launch;
mod lsp;
mod manual;
mod measure;
mod merge;
mod misuse;
mod outcomes;
mod output;
mod page;
mod parts;
mod path;
mod plot;
mod progress;
mod recording;
mod replay;
mod shard;
mod show;
mod simulate;
mod terminal;
mod values;
mod verify;
mod walk;

use crate::engine::outcome::Failure;
use crate::library::STACK;
use crate::report::ExitCode as Exit;
use crate::syntax::diagnostic::Diagnostic;
use arguments::Verb;
use check::Way;
use std::ffi::OsString;
use std::process;
use terminal::{Colors, say};

/// Runs the program.
pub fn run() -> process::ExitCode {
    process::ExitCode::from(run_as(std::env::args_os().collect()))
}

/// Runs the program with these words, of which the first one is its own name; its exit code.
pub fn run_as(words: Vec<OsString>) -> u8 {
    let mut arguments = match misuse::parse(words) {
        Ok(arguments) => arguments,
        Err(error) => {
            let exit = if error.use_stderr() { Exit::Wrong } else { Exit::Success };
            return exit.code();
        }
    };
    if let Verb::Merge(command) = &mut arguments.verb {
        // Options may stand anywhere, so the folder is whatever comes last.
        command.folder = command.questions.properties.pop().unwrap_or_default().into();
    }
    if let Verb::Check(command) = &mut arguments.verb
        && let Some(table) = &command.outcomes
    {
        // The table stands in the place of the scenario, and the first property file where that would.
        let first = std::mem::replace(&mut command.questions.model.scenario, table.clone());
        command.questions.properties.insert(0, first);
    }
    let asked = match &arguments.verb {
        Verb::Check(check) => Some(&check.questions),
        Verb::Merge(merge) => Some(&merge.questions),
        _ => None,
    };
    let asked = asked.map(|asked| (check::screen(asked), asked.model.scenario.clone(), asked.seed));
    let work = move || dispatch(&arguments.verb, Colors::chosen(arguments.color));
    let worker = std::thread::Builder::new().stack_size(STACK).spawn(work);
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
    exit.code()
}

fn dispatch(verb: &Verb, colors: Colors) -> Exit {
    let ended = |done: Result<(), Diagnostic>| complaint::end(done.map(|()| Exit::Success), &[], colors);
    let within = |limit| deadline::limit(limit, colors);
    match verb {
        Verb::Check(command) => check::run(&command.questions, &Way::Check(command), colors),
        Verb::Show(command) => {
            within(command.limit);
            show::run(command, colors)
        }
        Verb::Verify(command) => verify::run(command, colors),
        Verb::Plot(command) => ended(plot::run(command)),
        Verb::Simulate(command) => {
            within(command.limit);
            simulate::run(command, colors)
        }
        Verb::Path(command) => {
            within(command.limit);
            path::run(command, colors)
        }
        Verb::Walk(command) => {
            within(command.limit);
            walk::run(command, colors)
        }
        Verb::Infer(command) => infer::run(command, colors),
        Verb::Measure(command) => measure::run(command, colors),
        Verb::Monitor(command) => replay::monitor(command, colors),
        Verb::Evaluate(command) => replay::evaluate(command, colors),
        Verb::Calibrate(command) => replay::calibrate(command, colors),
        Verb::Fit(command) => replay::fit(command, colors),
        Verb::Advise(command) => advise::run(command, colors),
        Verb::Drift(command) => drift::run(command, colors),
        Verb::Gait(command) => gait::run(command, colors),
        Verb::Shard(command) => shard::run(command, colors),
        Verb::Merge(command) => check::run(&command.questions, &Way::Merge(&command.folder), colors),
        Verb::Fmt(command) => format::run(command, colors),
        Verb::Explain(command) => ended(manual::explain(command)),
        Verb::Lsp => ended(lsp::run()),
        Verb::Completions(command) => ended(manual::completions(command)),
        Verb::Man(command) => ended(manual::pages(command)),
    }
}
