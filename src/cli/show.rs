//! `smc show`: how a scenario and property files were understood, in units.

use super::arguments::{Show, ShowFormat};
use super::complaint;
use super::inputs;
use super::output;
use super::terminal::Colors;
use crate::base::visible::visible;
use crate::report::ExitCode as Exit;
use crate::report::model;
use crate::report::svg::plan;

/// Most agents of a picture.
const MOST_DRAWN: usize = 100_000;

/// Runs the command.
pub(super) fn run(arguments: &Show, colors: Colors) -> Exit {
    let inputs = inputs::load(&arguments.model, &arguments.properties).inputs;
    complaint::diagnose(&inputs, colors);
    let Some(study) = &inputs.study else { return Exit::Wrong };
    let agents = study.worlds.last().map_or(0, |world| world.scenario.agents.len());
    if arguments.format == ShowFormat::Svg && agents > MOST_DRAWN {
        let title = format!("a picture shows at most {MOST_DRAWN} agents (got {agents})");
        complaint::tell(&complaint::argument(title, "write a smaller number with `--set`"), &[], colors);
        return Exit::Wrong;
    }
    let text = match (arguments.format, study.worlds.last()) {
        (ShowFormat::Svg, Some(world)) => arguments.print.svg(&plan::draw(&world.scenario)),
        _ => visible(&model::describe(study)).into_owned(),
    };
    let written = output::put(arguments.output.as_deref(), &text);
    complaint::end(written.map(|()| Exit::Success), &[], colors)
}
