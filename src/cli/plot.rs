//! `smc plot`: a figure of results as SVG.

use super::terminal::{Colors, print};
use super::{complaint, inputs, output};
use crate::report::ExitCode as Exit;
use crate::report::figure::{Figure, draw};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::Diagnostic;
use clap::{Args, ValueEnum};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// `smc plot`
#[derive(Args, Debug)]
pub(super) struct PlotCommand {
    /// Results of `smc check --format json`, or `-` for standard input; for `calibration` those of `smc evaluate`.
    results: String,
    /// What is drawn.
    #[arg(long, value_enum)]
    figure: FigureName,
    /// Of several queries that could be drawn this one: the name of its property, or its number in writing order.
    #[arg(long, value_name = "NAME")]
    only: Option<String>,
    /// The figure; standard output by default.
    #[arg(short, long, value_name = "FILE.svg")]
    output: Option<PathBuf>,
}

/// Names of figures.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum FigureName {
    /// Results over a swept parameter.
    Sweep,
    /// Options of a ranking with their intervals.
    Ranking,
    /// The distribution function of a metric with its band.
    Distribution,
    /// How the evidence grew over the trials.
    Evidence,
    /// Predicted probabilities against what happened.
    Calibration,
}

impl FigureName {
    const fn of(self) -> Figure {
        match self {
            Self::Sweep => Figure::Sweep,
            Self::Ranking => Figure::Ranking,
            Self::Distribution => Figure::Distribution,
            Self::Evidence => Figure::Evidence,
            Self::Calibration => Figure::Calibration,
        }
    }
}

/// Runs the command.
pub(super) fn run(command: &PlotCommand, colors: Colors) -> Exit {
    match plot(command) {
        Ok(()) => Exit::Success,
        Err(error) => {
            complaint::tell(&error, &[], colors);
            Exit::Wrong
        }
    }
}

fn plot(command: &PlotCommand) -> Result<(), Diagnostic> {
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
    let svg = draw(command.figure.of(), &file, command.only.as_deref())
        .map_err(|flaw| wrong(flaw.message, flaw.hint))?;
    match &command.output {
        Some(path) => output::write(path, |out| out.write_all(svg.as_bytes()))
            .map_err(|error| complaint::unwritten(path, &error)),
        None => print(&svg).map_err(complaint::output),
    }
}
