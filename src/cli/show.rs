//! `smc show`: how a scenario and property files were understood, in units.

use super::arguments::Show;
use super::complaint;
use super::inputs;
use super::terminal::{Colors, print};
use crate::base::visible::visible;
use crate::report::ExitCode as Exit;
use crate::report::model;

/// Runs the command.
pub(super) fn run(arguments: &Show, colors: Colors) -> Exit {
    let inputs = inputs::load(&arguments.model, &arguments.properties).inputs;
    super::diagnose(&inputs, colors);
    let Some(study) = &inputs.study else { return Exit::Wrong };
    match print(&visible(&model::describe(study))) {
        Ok(()) => Exit::Success,
        Err(reason) => {
            complaint::tell(&complaint::output(reason), &[], colors);
            Exit::Wrong
        }
    }
}
