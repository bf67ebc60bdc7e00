//! `smc measure`: numbers of a recording.

mod arguments;

pub(super) use arguments::MeasureCommand;

use super::complaint;
use super::inputs;
use super::output;
use super::page;
use super::recording::{bad_lines, empty};
use super::terminal::Colors;
use super::values::Model;
use crate::base::visible::visible;
use crate::compile::is_series;
use crate::data::table::{self, TraceFormat};
use crate::data::tracks::Recording;
use crate::replay::measure::{Ground, Measuring, measure};
use crate::report::ExitCode as Exit;
use crate::report::measure::{rows, table, to_json, to_page, to_text};
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::source::Source;
use arguments::MeasureFormat;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Runs the command.
pub(super) fn run(arguments: &MeasureCommand, colors: Colors) -> Exit {
    let mut sources: Vec<Source> = Vec::new();
    let done = answer(arguments, colors, &mut sources);
    complaint::end(done, &sources, colors)
}

fn answer(
    arguments: &MeasureCommand,
    colors: Colors,
    sources: &mut Vec<Source>,
) -> Result<Exit, Vec<Diagnostic>> {
    let (mut ground, mut paths) = ground(arguments, colors)?;
    paths.push(PathBuf::from(&arguments.tracks));
    output::guard_all(&[arguments.output.as_deref(), arguments.report.as_deref()], &paths)?;
    let recording = recording(arguments)?;
    let options = Measuring {
        numbers: arguments.number.clone(),
        window: arguments.window,
        radius: arguments.radius,
        brake: arguments.brake,
        between: (arguments.from, arguments.to),
    };
    let measured = measure(&recording, &mut ground, &options);
    sources.clone_from(&ground.sources);
    let measured = measured?;
    let file = inputs::shown(&arguments.tracks);
    let output = arguments.output.as_deref();
    match (arguments.format, output) {
        (MeasureFormat::Text, _) => output::put(output, &visible(&to_text(file, &measured)))?,
        (MeasureFormat::Json, _) => output::put(output, &to_json(file, &measured))?,
        (MeasureFormat::Parquet, None) => {
            return Err(complaint::argument("`--format parquet` needs a file", "name it with `-o`").into());
        }
        (other, output) => {
            let (format, wanted) = (format(other)?, table(file, &measured));
            let fill = |out: &mut dyn Write| table::write(format, out, &wanted, rows(&measured)).map(drop);
            match output {
                Some(path) => output::write(path, fill).map_err(|error| {
                    complaint::input(format!("cannot write `{}`: {error}", path.display()))
                })?,
                None => output::put(None, &output::table(|out| fill(out))?)?,
            }
        }
    }
    let Some(path) = &arguments.report else { return Ok(Exit::Success) };
    Ok(page::write(path, to_page(file, &recording, &measured, sources), colors))
}

fn format(wanted: MeasureFormat) -> Result<&'static TraceFormat, Diagnostic> {
    let name = match wanted {
        MeasureFormat::Jsonl => "jsonl",
        MeasureFormat::Parquet => "parquet",
        _ => "csv",
    };
    let found = table::FORMATS.iter().find(|format| format.name == name && format.open.is_some());
    found.ok_or_else(|| {
        let said = format!("`--format {name}` is not in this build");
        complaint::argument(said, format!("build with `--features {name}`"))
    })
}

/// The scene of the model, if one is given.
fn ground(arguments: &MeasureCommand, colors: Colors) -> Result<(Ground, Vec<PathBuf>), Vec<Diagnostic>> {
    let Some(scenario) = &arguments.scenario else { return Ok(Default::default()) };
    let ending = |name: &str| Path::new(name).extension().map(ToOwned::to_owned);
    if ending(scenario).is_some_and(|own| own != "scn" && ending(&arguments.tracks) == Some(own)) {
        let said = format!("the model `{scenario}` is a recording as well");
        let hint = "several recordings are one in quotes: `smc measure 'run-*.csv' hall.scn`";
        return Err(complaint::argument(said, hint).into());
    }
    let model = Model {
        scenario: scenario.clone(),
        set: arguments.set.clone(),
        data: arguments.data.clone(),
        ..Model::default()
    };
    let (parsed, paths) = inputs::parse_or_tell(&model, &[], colors).ok_or_else(Vec::new)?;
    let ground = Ground {
        sources: parsed.inputs.sources,
        scenario: parsed.scenario,
        files: parsed.files,
        settings: parsed.settings,
    };
    Ok((ground, paths))
}

/// The recording of the call.
fn recording(arguments: &MeasureCommand) -> Result<Recording, Vec<Diagnostic>> {
    if !is_series(&arguments.tracks) {
        return one(arguments, &arguments.tracks);
    }
    let files = inputs::matching(Path::new(""), &arguments.tracks);
    let parts = files.iter().map(|file| one(arguments, file)).collect::<Result<Vec<_>, _>>()?;
    Recording::joined(parts)
        .map_err(|reason| complaint::input(format!("`{}`: {reason}", arguments.tracks)).into())
}

/// The recording in a file.
fn one(arguments: &MeasureCommand, file: &str) -> Result<Recording, Vec<Diagnostic>> {
    let (bytes, format, reading) = arguments.recorded.open(file)?;
    let recording = format.read(&bytes, &reading).map_err(|errors| bad_lines(file, &errors))?;
    if recording.people().is_empty() {
        return Err(empty(file).into());
    }
    Ok(recording.with(arguments.recorded.velocity))
}
