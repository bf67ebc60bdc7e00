//! `smc plot`: a figure of results as SVG.

use super::values::Print;
use super::{complaint, inputs, output};
use crate::report::figure::{Figure, draw};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::Diagnostic;
use clap::Args;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// Runs the command.
pub(super) fn run(command: &PlotCommand) -> Result<(), Diagnostic> {
    let name = inputs::shown(&command.results);
    let read = Path::new(if command.results == "-" { inputs::STDIN } else { &command.results }).to_path_buf();
    output::guard(command.output.as_deref(), &[read])?;
    let bytes = inputs::read(&command.results).map_err(complaint::input)?;
    let wrong = |message: String, hint: String| {
        Diagnostic::placeless(Code::E0714, format!("`{name}` cannot be drawn: {message}")).hint(hint)
    };
    let file: Value = serde_json::from_slice(&bytes).map_err(|error| {
        let hint = "make the file with `smc check … --format json=results.json`";
        wrong(format!("it is no JSON ({error})"), hint.to_owned())
    })?;
    let picture = draw(command.figure, &file, command.only.as_deref())
        .map_err(|flaw| wrong(flaw.message, flaw.hint))?;
    output::put(command.output.as_deref(), &command.print.svg(&picture))
}

// The arguments of `smc plot`.

/// `smc plot`
#[derive(Args, Debug)]
pub(in crate::cli) struct PlotCommand {
    /// Results of `smc check --format json`, or `-` for standard input; for `calibration` those of `smc evaluate`.
    results: String,
    /// What is drawn.
    #[arg(long, value_enum)]
    figure: Figure,
    /// Of several queries that could be drawn this one: the name of its property, or its number in writing order.
    #[arg(long, value_name = "NAME")]
    only: Option<String>,
    /// How wide it is.
    #[command(flatten)]
    print: Print,
    /// The figure; standard output by default.
    #[arg(short, long, value_name = "FILE.svg")]
    output: Option<PathBuf>,
}
