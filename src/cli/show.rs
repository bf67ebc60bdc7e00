//! `smc show`: how a scenario and property files were understood, in units.

use super::arguments::{Show, ShowFormat};
use super::complaint;
use super::inputs;
use super::output;
use super::terminal::{Colors, print};
use crate::base::visible::visible;
use crate::report::ExitCode as Exit;
use crate::report::model;
use crate::report::svg::plan;

/// Runs the command.
pub(super) fn run(arguments: &Show, colors: Colors) -> Exit {
    let inputs = inputs::load(&arguments.model, &arguments.properties).inputs;
    complaint::diagnose(&inputs, colors);
    let Some(study) = &inputs.study else { return Exit::Wrong };
    let text = match (arguments.format, study.worlds.last()) {
        (ShowFormat::Svg, Some(world)) => plan::draw(&world.scenario),
        _ => visible(&model::describe(study)).into_owned(),
    };
    let written = match &arguments.output {
        Some(path) => output::write(path, |out| out.write_all(text.as_bytes()))
            .map_err(|error| format!("`{}` cannot be written: {error}", path.display())),
        None => print(&text),
    };
    match written {
        Ok(()) => Exit::Success,
        Err(reason) => {
            complaint::tell(&complaint::output(reason), &[], colors);
            Exit::Wrong
        }
    }
}
