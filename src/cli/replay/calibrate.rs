//! `smc calibrate`: how often verdicts about recorded people were true.

use super::arguments::CalibrateCommand;
use super::{Call, Exit, Replayed};
use crate::cli::output;
use crate::cli::terminal::Colors;
use crate::cli::values::TextFormat;
use crate::data::tracks::Velocity;
use crate::gait;
use crate::library::Parsed;
use crate::model::Scenario;
use crate::replay::Whose;
use crate::replay::calibrate::{Calibrating, written};
use crate::report::calibration::{page, text};
use crate::report::html;
use crate::route::Ways;
use crate::syntax::diagnostic::Diagnostic;

/// Runs the command.
pub(in crate::cli) fn run(arguments: &CalibrateCommand, colors: Colors) -> Exit {
    let replayed = Replayed {
        model: arguments.model.clone(),
        properties: arguments.properties.clone(),
        tracks: arguments.tracks.clone(),
        every: None,
        // The text of the calibration goes to standard output, its file elsewhere.
        span: super::arguments::Span { output: None, ..arguments.span.clone() },
    };
    let calibrating = Calibrating {
        site: arguments.site.clone().unwrap_or_else(|| arguments.tracks.clone()),
        date: arguments.date.clone(),
        persons: arguments.persons as usize,
        speed: arguments.speed,
        trials: u64::from(arguments.trials),
        seed: arguments.span.seed,
        formulas: Vec::new(),
    };
    let of = |parsed: &Parsed| Calibrating {
        formulas: written(&parsed.properties, &parsed.inputs.sources),
        ..calibrating.clone()
    };
    let work = |call: &Call, calibrating: &Calibrating| measured(arguments, call, calibrating);
    let outputs = [arguments.span.output.as_deref(), arguments.report.as_deref()];
    let whose = (Velocity::Seen, Whose::Everybody);
    super::run_at_site(&replayed, whose, (outputs, colors), of, Calibrating::site_of, work)
}

fn measured(
    arguments: &CalibrateCommand,
    call: &Call,
    calibrating: &Calibrating,
) -> Result<String, Vec<Diagnostic>> {
    let ways = Ways::default();
    let drivers = move |scenario: &Scenario, seed: u64| gait::drivers(&ways, scenario, seed);
    let found = calibrating.measure(&call.replay, (&call.threads, &drivers))?;
    if let Some(path) = &arguments.span.output {
        output::save(path, found.to_json().as_bytes())?;
    }
    if let Some(path) = &arguments.report {
        output::save(path, html::page(page(&found)).as_bytes())?;
    }
    Ok(match arguments.format {
        TextFormat::Text => text(&found),
        TextFormat::Json => found.to_json(),
    })
}
