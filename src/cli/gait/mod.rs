//! `smc gait`: steps of motion capture, gaits that are learned from them, and walks beside walks.

mod arguments;
mod compare;
mod learn;
mod takes;

pub(super) use arguments::GaitCommand;

use super::complaint;
use super::inputs;
use super::output;
use super::terminal::{Colors, print};
use super::values::TextFormat;
use crate::base::visible::visible;
use crate::gait::model::{FIT_AGAIN, LearnedGait};
use crate::gait::steps::{report, write_drawn_steps, write_steps};
use crate::report::ExitCode as Exit;
use crate::report::gait as reports;
use crate::report::svg::steps::draw;
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::Diagnostic;
use arguments::{SampleCommand, ShowCommand, StepsCommand, StepsFormat};
use std::path::PathBuf;
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
        GaitCommand::Compare(command) => return compare::run(command, colors),
    };
    complaint::end(done.map(|()| Exit::Success), &[], colors)
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

fn steps(command: &StepsCommand, colors: Colors) -> Result<(), Stop> {
    let takes = Takes::read(&command.reading);
    told(&takes, colors)?;
    output::guard(command.output.as_deref(), &takes.paths)?;
    let text = match command.format {
        StepsFormat::Text => visible(&report(&takes.cuts)).into_owned(),
        StepsFormat::Csv => output::table(|out| write_steps(out, &takes.steps()))?,
        StepsFormat::Svg => command.print.svg(&draw(&takes.steps())),
    };
    Ok(output::put(command.output.as_deref(), &text)?)
}

/// A learned gait.
fn open(name: &str) -> Result<LearnedGait, Stop> {
    let bytes = inputs::read(name).map_err(complaint::input)?;
    let gait = LearnedGait::read(&bytes).map_err(|error| {
        let title = format!("`{}` is no gait: {error}", inputs::shown(name));
        Diagnostic::placeless(Code::E0723, title).hint(FIT_AGAIN)
    });
    Ok(gait?)
}

fn show(command: &ShowCommand) -> Result<(), Stop> {
    let summary = open(&command.gait)?.show();
    let text = match command.format {
        TextFormat::Text => visible(&reports::to_text(&summary)).into_owned(),
        TextFormat::Json => reports::to_json(&summary),
    };
    Ok(print(&text)?)
}

fn sample(command: &SampleCommand) -> Result<(), Stop> {
    output::guard(command.output.as_deref(), &[PathBuf::from(&command.gait)])?;
    let gait = Arc::new(open(&command.gait)?);
    let drawn = gait.sample(command.number as usize, command.seed);
    Ok(output::put(command.output.as_deref(), &output::table(|out| write_drawn_steps(out, drawn))?)?)
}
