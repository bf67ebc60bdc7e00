//! `smc fit`: parameters from a recording.

use super::arguments::{FitCommand, FitFormat};
use super::{Call, Exit};
use crate::cli::complaint;
use crate::cli::inputs;
use crate::cli::terminal::{Colors, warn};
use crate::cli::values::Model;
use crate::data::tracks::Velocity;
use crate::gait;
use crate::kernel::driver::MakeDrivers;
use crate::model::{Kind, Scenario};
use crate::replay::fit::{Cases, Comparison, Counting, FEWEST, Fitted, Found, Searching, search};
use crate::replay::{PREDICTED, Replay, Whose, eligible, first_tracks, user_kind};
use crate::report::fit::{FittedModel, generation};
use crate::route::Ways;
use crate::stats::bootstrap::DRAWS;
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::{Diagnostic, Severity};
use std::sync::atomic::{AtomicBool, Ordering};

/// Whether the first signal has come.
static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// Runs the command.
pub(in crate::cli) fn run(arguments: &FitCommand, colors: Colors) -> Exit {
    let work = |call: &Call| text(arguments, call);
    let exit = super::run(&arguments.replayed(), (Velocity::Seen, Whose::Everybody), colors, work);
    let is_early = exit == Exit::Success && INTERRUPTED.load(Ordering::Relaxed);
    if is_early { Exit::Interrupted } else { exit }
}

fn counting(arguments: &FitCommand) -> Counting {
    let by_properties = !arguments.by.is_empty();
    Counting { trials: arguments.trials.into(), seed: arguments.span.seed, by_properties }
}

fn text(arguments: &FitCommand, call: &Call) -> Result<String, Vec<Diagnostic>> {
    let Call { replay, threads, every, .. } = call;
    let fitted = parameters(&arguments.parameters)?;
    let kind = arguments.kind.clone().or_else(|| user_kind(replay)).unwrap_or_default();
    let base = replay.base_of(&kind);
    let own = replay.with_kind(&kind)?;
    let counting = counting(arguments);
    let instants = eligible(&own, call.instants.clone(), arguments.speed, PREDICTED);
    let cases = Cases::new(&own, &instants, counting, threads)?;
    if cases.persons.len() < FEWEST {
        return Err(few(&own, cases.persons.len()).into());
    }
    let options = Searching {
        generations: arguments.generations,
        population: arguments.population,
        held_out: arguments.held_out,
        seed: arguments.span.seed,
        draws: DRAWS,
        confidence: arguments.span.confidence,
    };
    let ways = Ways::default();
    let drivers = move |scenario: &Scenario, seed: u64| gait::drivers(&ways, scenario, seed);
    let names: Vec<&str> = fitted.iter().map(|one| one.name()).collect();
    let mut log = |one: &_| {
        if !arguments.quiet {
            warn(&generation(one, &names, counting.by_properties));
        }
    };
    // The first signal ends the search, and the best parameters so far are printed; the second one ends the process.
    let _ = ctrlc::set_handler(|| {
        if INTERRUPTED.swap(true, Ordering::Relaxed) {
            std::process::exit(i32::from(Exit::Interrupted.code()));
        }
    });
    let found =
        search(&cases, &fitted, options, (threads, &drivers), (&mut log, &INTERRUPTED)).map_err(|k| {
            let said = format!("`--parameters {}`: nothing in this model uses `{}`", names[k], names[k]);
            let hint =
                "another value changes no prediction: remove it, or write what needs it into the model";
            of_tracks(&own, said).hint(hint)
        })?;
    let test = match &arguments.test {
        Some(model) if !INTERRUPTED.load(Ordering::Relaxed) => {
            let compared = tested(arguments, model, &found, options, (call, &drivers))?;
            Some((model.clone(), compared))
        }
        _ => None,
    };
    let report = FittedModel {
        model: arguments.model.scenario.clone(),
        recording: own.tracks.clone(),
        velocity: own.recording.velocity().name(),
        properties: arguments.by.clone(),
        kind,
        base,
        trials: arguments.trials.into(),
        seed: arguments.span.seed,
        every: *every,
        instants: instants.len() as u64,
        confidence: arguments.span.confidence,
        found,
        test,
    };
    Ok(match arguments.format {
        FitFormat::Text => report.to_text(),
        FitFormat::Json => report.to_json(),
    })
}

/// The parameters of some names, each once.
fn parameters(names: &[String]) -> Result<Vec<Fitted>, Diagnostic> {
    let known: Vec<Fitted> = Fitted::of_kind(Kind::Sfm).collect();
    let mut all: Vec<Fitted> = Vec::new();
    for name in names {
        let Some(one) = known.iter().find(|one| one.name() == name) else {
            let names: Vec<&str> = known.iter().map(|one| one.name()).collect();
            return Err(complaint::argument(
                format!("`--parameters {name}`: there is no parameter `{name}` that can be fitted"),
                format!("choose from {}", names.join(", ")),
            ));
        };
        if !all.contains(one) {
            all.push(*one);
        }
    }
    Ok(all)
}

fn few(replay: &Replay, count: usize) -> Diagnostic {
    let said = format!("a fit needs {FEWEST} tracks of people who move for {PREDICTED} s (got {count})");
    let hint = "choose a longer recording, other times, a shorter `--every` or a smaller `--speed`";
    of_tracks(replay, said).hint(hint)
}

/// An error of the tracks.
fn of_tracks(replay: &Replay, said: String) -> Diagnostic {
    match replay.place_of_tracks() {
        Some(place) => error!(E0713, place, "{said}"),
        None => Diagnostic::placeless(Code::E0713, said),
    }
}

/// The fitted parameters in another model with its recording.
fn tested(
    arguments: &FitCommand,
    scenario: &str,
    found: &Found,
    options: Searching,
    (call, drivers): (&Call, &MakeDrivers),
) -> Result<Option<Comparison>, Vec<Diagnostic>> {
    let model = Model { scenario: scenario.to_owned(), ..arguments.model.clone() };
    let (parsed, _) = inputs::parse(&model, &arguments.by);
    let errors = parsed.inputs.diagnostics.iter().filter(|one| one.severity == Severity::Error);
    if errors.count() > 0 {
        let said = format!("`--test {scenario}` has errors");
        return Err(complaint::argument(said, format!("`smc show {scenario}` lists them")).into());
    }
    let input = parsed.input();
    let tracks = first_tracks(input.scenario).unwrap_or_default();
    let placeless = |errors: Vec<Diagnostic>| {
        // Their places are in files that this call does not show.
        let one =
            |error: Diagnostic| Diagnostic::placeless(error.code, format!("{scenario}: {}", error.title));
        errors.into_iter().map(one).collect::<Vec<_>>()
    };
    let velocity = arguments.model.velocity.unwrap_or(Velocity::Seen);
    let replay = Replay::new(&input, &tracks, velocity, Whose::Everybody).map_err(placeless)?;
    let replay = match &arguments.kind {
        Some(kind) => replay.with_kind(kind).map_err(placeless)?,
        None => replay,
    };
    let everything = replay.instants(call.every, (f64::NEG_INFINITY, f64::INFINITY));
    let counting = counting(arguments);
    let instants = eligible(&replay, everything, arguments.speed, PREDICTED);
    let cases = Cases::new(&replay, &instants, counting, &call.threads).map_err(placeless)?;
    Ok(Comparison::of(&cases, found, options, (&call.threads, drivers)))
}
