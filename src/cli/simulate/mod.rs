//! `smc simulate`: traces of trials as tables.

pub(super) mod choice;
pub(super) mod destination;
mod keep;
mod rows;

use super::arguments::Simulate;
use super::deadline::leave;
use super::page::Trials;
use super::terminal::{Colors, warn};
use super::values::threads;
use super::{complaint, inputs, output, page};
use crate::base::random::MOST_TRIALS;
use crate::base::tick::{Clock, Tick};
use crate::compile::Study;
use crate::compile::nearest::nearest;
use crate::data::table;
use crate::data::table::{Table, TraceFormat};
use crate::engine::{PreparedWorld, placeable, smaller};
use crate::kernel::Program;
use crate::library::program::playing;
use crate::model::Scenario;
use crate::report::ExitCode as Exit;
use crate::route::Ways;
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::source::Source;
use crate::trials::cell::Item;
use crate::{gait, library};
use destination::{Chosen, Destination};
use rows::Rows;
use std::io::{BufWriter, Write};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Runs the command.
pub(super) fn run(arguments: &Simulate, colors: Colors) -> Exit {
    let Some((study, inputs::Loaded { inputs, paths })) =
        inputs::load_or_tell(&arguments.model, &arguments.properties, colors)
    else {
        return Exit::Wrong;
    };
    let destination =
        Destination::new(arguments.format, arguments.output.as_deref(), arguments.report.as_deref(), &paths);
    let done = destination.and_then(|to| simulate(arguments, study, &to, &inputs.sources, colors));
    complaint::end(done, &inputs.sources, colors)
}

/// The last tick that is written.
fn last(scenario: &Scenario, until: Option<f64>) -> Result<Tick, Diagnostic> {
    let Some(until) = until else { return Ok(scenario.horizon) };
    if until.is_nan() || until < 0.0 {
        let title = format!("`--until` must be a time that is not negative (got {until})");
        return Err(complaint::argument(title, "write a number of seconds"));
    }
    let end = scenario.clock.seconds(scenario.horizon);
    if until > end * (1.0 + 1e-12) {
        let unit = if scenario.clock == Clock::Steps { "steps" } else { "s" };
        let hint = format!("the horizon of the scenario is {end} {unit}");
        return Err(complaint::argument(
            format!("`--until` must not exceed the horizon (got {until})"),
            hint,
        ));
    }
    // The longest time that is a whole number of ticks, in continuous time of very short ones.
    Ok(scenario.horizon.min(Tick(match scenario.clock {
        Clock::Jumps(tick) => (until / tick.to_f64()).floor() as u64,
        // In spite of rounding, and never beyond what was asked for.
        clock => (until / clock.step_seconds() * (1.0 + 1e-12)).floor() as u64,
    })))
}

fn simulate(
    arguments: &Simulate,
    mut study: Study,
    destination: &Destination,
    sources: &[Source],
    colors: Colors,
) -> Result<Exit, Diagnostic> {
    let (trials, every) = (arguments.trials.get(), arguments.every.get());
    if arguments.trial.saturating_add(trials) > MOST_TRIALS {
        let hint = format!("trials are numbered from 0 to {}", MOST_TRIALS - 1);
        return Err(complaint::argument("the trial number is out of range", hint));
    }
    let target = arguments.keep.as_ref().map(|keep| keep.target(&study)).transpose()?;
    if target.is_none() && study.worlds.len() > 2 {
        return Err(complaint::argument("a trace cannot be written for a sweep", "write `--set name=value`"));
    }
    let number = target.map_or(study.worlds.len().saturating_sub(1), |target| target.world);
    let Some(world) = study.worlds.get_mut(number) else { return Ok(Exit::Wrong) };
    let ways = Ways::default();
    if world.scenario.moves.iter().any(|moves| moves.paths.is_some()) {
        library::find_paths(Arc::make_mut(&mut world.scenario), arguments.seed, &ways);
    }
    let scenario = world.scenario.clone();
    let advice = arguments.advice.as_deref().map(|name| option(&scenario, name)).transpose()?;
    placeable(world).map_err(|fault| library::refusal(&fault))?;
    let last = last(&scenario, arguments.until)?;
    let interrupted = Arc::new(AtomicBool::new(false));
    let is_over = Arc::clone(&interrupted);
    let programs = inputs::programs(&arguments.model, &study, move || is_over.load(Ordering::Relaxed))?;
    let players = programs.clone();
    let drivers =
        move |scenario: &Scenario, seed: u64| playing(gait::drivers(&ways, scenario, seed), players.as_ref());
    let all = arguments.trial..arguments.trial + trials;
    let chosen = match (&arguments.keep, target) {
        (Some(keep), Some(target)) => {
            let Some(prepared) = PreparedWorld::of(&study, number, arguments.seed, &drivers) else {
                return Ok(Exit::Wrong);
            };
            let items = all.map(|index| Item { advice, index });
            let (kept, unresolved) = keep.judge(&prepared, target.column, arguments.seed, items)?;
            if !arguments.quiet {
                warn(&keep.told(trials, kept.len(), unresolved));
            }
            Chosen::Kept(kept)
        }
        _ => Chosen::All(all),
    };
    let program = Program::driven(scenario.clone(), drivers(&scenario, arguments.seed));
    let mut exit = Exit::Success;
    if let Some(path) = &arguments.report {
        let Simulate { seed, trial, .. } = *arguments;
        let option = arguments.advice.as_ref().map_or(String::new(), |name| format!(" --move '{name}'"));
        let line = page::line(&arguments.model).simulate(&[], seed, trial);
        let page = Trials {
            program: &program,
            scenario: &arguments.model.scenario,
            sources,
            seed,
            list: &mut chosen.clone().trials().map(|index| (index, advice)),
            last,
            replay: format!("{line} -n {trials}{option}"),
        };
        exit = page.write(path, colors);
        if arguments.output.is_none() || exit != Exit::Success {
            return Ok(exit);
        }
    }
    let files = destination.files(&scenario, chosen)?;
    let mut rows = Rows::new(&program, (arguments.seed, every), advice, last);
    rows.interrupted = Arc::clone(&interrupted);
    if arguments.output.is_some() {
        // The file gets its name only when it is complete: the first signal ends the table, the second one the process.
        let _ = ctrlc::set_handler(move || {
            if interrupted.swap(true, Ordering::Relaxed) {
                leave(Exit::Interrupted);
            }
        });
    } else if programs.is_some() {
        let _ = ctrlc::set_handler(|| leave(Exit::Interrupted));
    }
    let table = rows::table(&scenario, arguments.seed, every);
    let helpers = if program.is_large() { Some(threads(None)?) } else { None };
    for part in files {
        if rows.is_interrupted() {
            break;
        }
        let written = part.and_then(|(file, chosen)| {
            let rows = rows.of(chosen.trials());
            let format = destination.format;
            let Some(threads) = &helpers else { return write(format, file.as_deref(), &table, rows) };
            rows.share(threads.count());
            threads.helped(|| write(format, file.as_deref(), &table, rows)).unwrap_or(Ok(()))
        });
        if let Err(error) = written {
            complaint::tell(&error, &[], colors);
            exit = Exit::Wrong;
            break;
        }
    }
    if let (shrunk, Some(first)) = rows.shrunk {
        warn(&format!("warning: {}\n", smaller(&program, first, shrunk)));
    }
    for note in &rows.notes {
        warn(&format!("warning: {note}\n"));
    }
    // As a check of the same trials would.
    Ok(exit.worse(match &rows {
        rows if rows.is_wrong => Exit::Wrong,
        rows if rows.is_interrupted() => Exit::Interrupted,
        _ => Exit::Success,
    }))
}

/// Writes rows to a file as a whole or not at all, or to standard output.
fn write(
    format: &TraceFormat,
    file: Option<&Path>,
    table: &Table,
    rows: &mut Rows<'_>,
) -> Result<(), Diagnostic> {
    let written = match file {
        Some(path) => output::write(path, |out| table::write(format, out, table, rows)),
        None => {
            let mut out = BufWriter::new(std::io::stdout().lock());
            table::write(format, &mut out, table, rows).and_then(|rows| out.flush().map(|()| rows))
        }
    };
    match written {
        Ok(_) => Ok(()),
        Err(error) if error.kind() == std::io::ErrorKind::BrokenPipe => Ok(()),
        Err(error) => Err(match file {
            Some(path) => complaint::unwritten(path, &error),
            None => complaint::output(error.to_string()),
        }),
    }
}

// `--move`: the option of moves that is followed in a trial.

/// The option of a name, with whose it is where several people have one of that name: `stop`, `user: stop`.
///
/// # Errors
/// Where there is no such option, or several have the name.
fn option(scenario: &Scenario, name: &str) -> Result<(usize, usize), Diagnostic> {
    let wanted = name.trim();
    let all = || {
        let declarations = scenario.moves.iter().enumerate();
        declarations
            .flat_map(|(declaration, moves)| (0..moves.options.len()).map(move |at| (declaration, at)))
    };
    // A path is known by its number, too: its length depends on the roadmap.
    let is_meant = |name: &str| {
        name == wanted
            || name.strip_prefix(wanted).is_some_and(|rest| wanted.contains("path") && rest.starts_with(" ("))
    };
    if let Some(found) = all().find(|of| scenario.move_name(*of).is_some_and(|name| is_meant(&name))) {
        return Ok(found);
    }
    // `a: stop and b: own way`: the moves of several agents at once.
    if wanted.contains(" and ") {
        let single = |wanted: &str| {
            all().find(|(declaration, at)| {
                let moves = &scenario.moves[*declaration];
                moves
                    .owner(&scenario.agents)
                    .is_some_and(|owner| wanted == format!("{owner}: {}", moves.options[*at].0))
            })
        };
        let singles: Option<Vec<(usize, usize)>> = wanted.split(" and ").map(single).collect();
        return singles.and_then(|singles| scenario.together(&singles)).ok_or_else(|| {
            let hint = "write the moves of several agents, such as `robot: stop and cart: own way`";
            complaint::argument(format!("unknown moves `{wanted}`"), hint)
        });
    }
    let label = |(declaration, at): (usize, usize)| scenario.moves[declaration].options[at].0.as_str();
    let same: Vec<String> = all()
        .filter(|of| is_meant(label(*of)))
        .filter_map(|of| Some(format!("`{}`", scenario.move_name(of)?)))
        .collect();
    if !same.is_empty() {
        return Err(complaint::argument(
            format!("several agents have a move `{wanted}`"),
            format!("write one of {}", same.join(", ")),
        ));
    }
    let labels: Vec<String> = all().filter_map(|of| scenario.move_name(of)).collect();
    let hint = match nearest(wanted, labels.iter().map(String::as_str)) {
        _ if labels.is_empty() => "the scenario declares no moves".to_owned(),
        // Of numbers that differ, none is meant more than another.
        Some(near) if !wanted.contains(|c: char| c.is_ascii_digit()) => format!("did you mean `{near}`?"),
        _ => format!("the moves are {}", labels.join(", ")),
    };
    Err(complaint::argument(format!("unknown move `{wanted}`"), hint))
}
