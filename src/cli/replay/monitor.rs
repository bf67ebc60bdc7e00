//! `smc monitor`: formulas on a recording itself.

use super::arguments::{MonitorCommand, MonitorFormat};
use super::{Call, Exit};
use crate::cli::output;
use crate::cli::terminal::Colors;
use crate::data::tracks::Velocity;
use crate::replay::{Whose, monitor, numbers};
use crate::report::monitor::{
    InstantVerdict, Monitored, MonitoredInstant, MonitoredNumber, MonitoredProperty, to_json, to_text,
    write_csv,
};
use crate::syntax::diagnostic::Diagnostic;

/// Runs the command.
pub(in crate::cli) fn run(arguments: &MonitorCommand, colors: Colors) -> Exit {
    let whose = arguments.user.unwrap_or(Whose::Written);
    let work = |call: &Call| text(arguments, call);
    super::run(&arguments.replayed, (Velocity::Recorded, whose), colors, work)
}

fn text(arguments: &MonitorCommand, call: &Call) -> Result<String, Vec<Diagnostic>> {
    let Call { replay, threads, instants, every } = call;
    let beyond = arguments.beyond;
    let judged = monitor(replay, instants, beyond, threads)?;
    let verdict = |truth: &Option<bool>| match truth {
        Some(true) => InstantVerdict::True,
        Some(false) => InstantVerdict::False,
        None => InstantVerdict::Unresolved("a track ends before it is decided"),
    };
    let instants: Vec<MonitoredInstant> = (judged.iter())
        .map(|one| MonitoredInstant {
            time: one.instant.time,
            person: one.instant.person,
            verdicts: one.truths.iter().map(verdict).collect(),
        })
        .collect();
    let confidence = arguments.replayed.span.confidence;
    let names = replay.formulas.names.iter().enumerate();
    let asked = numbers(replay, &call.instants);
    let is_alone = replay.only().is_some();
    let numbers = asked.iter().enumerate();
    let numbers =
        numbers.map(|(k, asked)| MonitoredNumber::of(asked, k, &judged, is_alone, confidence)).collect();
    let monitored = Monitored {
        model: arguments.replayed.model.scenario.clone(),
        properties: arguments.replayed.properties.clone(),
        recording: replay.tracks.clone(),
        velocity: replay.recording.velocity(),
        user: replay.only(),
        every: *every,
        beyond,
        confidence,
        numbers,
        results: names.map(|(k, name)| MonitoredProperty::of(name, k, &instants, confidence)).collect(),
        instants,
    };
    match arguments.format {
        MonitorFormat::Text => Ok(to_text(&monitored)),
        MonitorFormat::Json => Ok(to_json(&monitored)),
        MonitorFormat::Csv => Ok(output::table(|out| write_csv(out, &monitored))?),
    }
}
