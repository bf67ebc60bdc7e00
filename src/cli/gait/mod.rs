//! `smc gait`: steps of motion capture, and gaits that are learned from them.

mod arguments;
mod learn;
mod takes;

pub(super) use arguments::GaitCommand;

use super::complaint;
use super::inputs;
use super::output;
use super::terminal::{Colors, print};
use crate::base::visible::visible;
use crate::gait::model::LearnedGait;
use crate::gait::steps::{report, write_drawn_steps, write_steps};
use crate::report::ExitCode as Exit;
use crate::report::gait as reports;
use crate::report::svg::steps::draw;
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::Diagnostic;
use arguments::{SampleCommand, ShowCommand, StepsCommand, StepsFormat, TextFormat};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use takes::Takes;

/// Runs the command.
pub(super) fn run(command: &GaitCommand, colors: Colors) -> Exit {
    let done = match command {
        GaitCommand::Steps(command) => steps(command, colors),
        GaitCommand::Fit(command) => learn::fit(command, colors),
        GaitCommand::Show(command) => show(command),
        GaitCommand::Sample(command) => sample(command),
        GaitCommand::Score(command) => learn::score(command, colors),
    };
    match done {
        Ok(()) => Exit::Success,
        Err(errors) => {
            complaint::tell_all(&errors, &[], colors);
            Exit::Wrong
        }
    }
}

/// What stops a command; nothing if it was reported already.
type Stop = Vec<Diagnostic>;

/// Reports what was found in the files; stops if it is an error.
fn told(takes: &Takes, colors: Colors) -> Result<(), Stop> {
    if !takes.found.is_empty() {
        complaint::tell_all(&takes.found, &takes.sources, colors);
    }
    if takes.are_wrong() { Err(Stop::new()) } else { Ok(()) }
}

fn write(path: Option<&Path>, text: &str) -> Result<(), Stop> {
    let written = match path {
        Some(path) => output::write(path, |out| out.write_all(text.as_bytes()))
            .map_err(|error| format!("`{}` cannot be written: {error}", path.display())),
        None => print(text),
    };
    written.map_err(|reason| vec![complaint::output(reason)])
}

fn steps(command: &StepsCommand, colors: Colors) -> Result<(), Stop> {
    let takes = Takes::read(&command.reading);
    told(&takes, colors)?;
    let guarded = output::guard(command.output.as_deref(), &takes.paths);
    guarded.map_err(|error| vec![error])?;
    let text = match command.format {
        StepsFormat::Text => visible(&report(&takes.cuts)).into_owned(),
        StepsFormat::Csv => table(|out| write_steps(out, &takes.steps()))?,
        StepsFormat::Svg => draw(&takes.steps()),
    };
    write(command.output.as_deref(), &text)
}

fn table(fill: impl FnOnce(&mut Vec<u8>) -> std::io::Result<()>) -> Result<String, Stop> {
    let mut bytes = Vec::new();
    fill(&mut bytes).map_err(|error| vec![complaint::output(error.to_string())])?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

/// A learned gait.
fn open(name: &str) -> Result<LearnedGait, Stop> {
    let bytes = inputs::read(name).map_err(|reason| vec![complaint::input(reason)])?;
    LearnedGait::from_json(&String::from_utf8_lossy(&bytes)).map_err(|error| {
        let title = format!("`{}` is no gait: {error}", inputs::shown(name));
        vec![
            Diagnostic::placeless(Code::E0723, title)
                .hint("make the file again: `smc gait fit DATA -o FILE.gait`"),
        ]
    })
}

fn show(command: &ShowCommand) -> Result<(), Stop> {
    let summary = open(&command.gait)?.show();
    let text = match command.format {
        TextFormat::Text => visible(&reports::to_text(&summary)).into_owned(),
        TextFormat::Json => reports::to_json(&summary),
    };
    write(None, &text)
}

fn sample(command: &SampleCommand) -> Result<(), Stop> {
    let guarded = output::guard(command.output.as_deref(), &[PathBuf::from(&command.gait)]);
    guarded.map_err(|error| vec![error])?;
    let gait = Arc::new(open(&command.gait)?);
    let drawn = gait.sample(command.number as usize, command.seed);
    write(command.output.as_deref(), &table(|out| write_drawn_steps(out, drawn))?)
}
