//! `smc infer`: traces and groups of a recording, or of a table of observations.

mod arguments;
mod motion;

pub(super) use arguments::InferCommand;

use super::complaint;
use super::inputs;
use super::output;
use super::page;
use super::recording::{bad_lines, empty};
use super::terminal::Colors;
use crate::base::random::TrialKey;
use crate::base::visible::visible;
use crate::data::tracks::{Batch, Velocity, read_groups};
use crate::perception::{Clustering, Inferring, Tracking, infer};
use crate::report::ExitCode as Exit;
use crate::report::infer::{InferredFile, to_csv, to_json, to_page, to_svg, to_text};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::{Diagnostic, Severity};
use arguments::InferFormat;
use motion::ChosenMotion;
use std::collections::BTreeSet;
use std::path::PathBuf;

/// Runs the command.
pub(super) fn run(arguments: &InferCommand, colors: Colors) -> Exit {
    complaint::end(answer(arguments, colors), &[], colors)
}

fn answer(arguments: &InferCommand, colors: Colors) -> Result<Exit, Vec<Diagnostic>> {
    if !(arguments.projection > 0.0 && arguments.projection.is_finite()) {
        return Err(complaint::argument("`--projection` must be positive", "write a time, such as 2s").into());
    }
    let named = [Some(&arguments.tracks), arguments.annotated.as_ref(), arguments.scene.as_ref()];
    if named.into_iter().flatten().filter(|name| *name == "-").count() > 1 {
        return Err(complaint::input("standard input can be read only once").into());
    }
    let ChosenMotion { mut motion, kind, scene, sources, paths } = motion::chosen(arguments, colors)?;
    let files: Vec<PathBuf> = named.into_iter().flatten().map(PathBuf::from).chain(paths).collect();
    output::guard_all(&[arguments.output.as_deref(), arguments.report.as_deref()], &files)?;
    let (bytes, format, reading) = arguments.recorded.open(&arguments.tracks)?;
    let mut batches = format
        .read_batches(&bytes, &reading, arguments.recorded.velocity)
        .map_err(|errors| bad_lines(&arguments.tracks, &errors))?;
    if let Some(doubt) = format.doubt(&bytes, &reading, arguments.recorded.velocity) {
        let said = format!("`{}`: {}", inputs::shown(&arguments.tracks), doubt.said);
        let warning = Diagnostic::placeless(Code::W0705, said).hint(doubt.cure);
        complaint::tell(&Diagnostic { severity: Severity::Warning, ..warning }, &[], colors);
    }
    if batches.is_empty() {
        return Err(empty(&arguments.tracks).into());
    }
    cut(&mut batches, arguments)?;
    // A file without velocities leaves only the seen ones.
    let has_velocities = batches.iter().flat_map(|batch| &batch.seen).any(|one| one.velocity.is_some());
    let velocity = if has_velocities { arguments.recorded.velocity } else { Velocity::Seen };
    let annotated = match &arguments.annotated {
        Some(name) => Some(annotated(name, &batches)?),
        None => None,
    };
    let options = Inferring {
        tracking: Tracking {
            threshold: arguments.threshold,
            longest: arguments.projection,
            padding: arguments.padding,
            ..Tracking::default()
        },
        clustering: Clustering {
            threshold: arguments.cohesion,
            position_discount: arguments.discount[0],
            velocity_discount: arguments.discount[1],
        },
        key: TrialKey { seed: arguments.seed, ..TrialKey::default() },
        is_anonymous: arguments.anonymous,
        longest_gap: None,
        annotated,
    };
    let inference = infer(&batches, &options, motion.as_mut())
        .map_err(|error| Diagnostic::placeless(Code::E0702, error.to_string()))?;
    let report = InferredFile {
        file: inputs::shown(&arguments.tracks),
        velocity,
        motion: motion.name(),
        kind: kind.as_deref(),
        scene: arguments.scene.as_deref().map(inputs::shown),
        options: &options,
        inference: &inference,
    };
    let text = match arguments.format {
        InferFormat::Json => to_json(&report),
        InferFormat::Csv => to_csv(&inference),
        InferFormat::Text => visible(&to_text(&report)).into_owned(),
        InferFormat::Svg => arguments.print.svg(&to_svg(&report)),
    };
    output::put(arguments.output.as_deref(), &text)?;
    let Some(path) = &arguments.report else { return Ok(Exit::Success) };
    Ok(page::write(path, to_page(&report, scene, &sources), colors))
}

/// Leaves the batches between two times.
fn cut(batches: &mut Vec<Batch>, arguments: &InferCommand) -> Result<(), Vec<Diagnostic>> {
    // Times are sums of steps.
    let (from, to) = (arguments.from.map(|from| from - 1e-6), arguments.to.map(|to| to + 1e-6));
    let first = batches.first().map_or(0.0, |batch| batch.time);
    let last = batches.last().map_or(0.0, |batch| batch.time);
    batches
        .retain(|batch| from.is_none_or(|from| batch.time >= from) && to.is_none_or(|to| batch.time <= to));
    if batches.is_empty() {
        let said = "there is no observation between `--from` and `--to`";
        return Err(complaint::argument(said, format!("the file lasts from {first} s to {last} s")).into());
    }
    Ok(())
}

/// Annotated groups; every id must be in the recording.
fn annotated(name: &str, batches: &[Batch]) -> Result<Vec<Vec<u32>>, Vec<Diagnostic>> {
    let bytes = inputs::read(name).map_err(complaint::input)?;
    let shown = inputs::shown(name);
    let text = String::from_utf8(bytes)
        .map_err(|_| Diagnostic::placeless(Code::E0702, format!("`{shown}` is not UTF-8 text")))?;
    let groups = read_groups(&text).map_err(|errors| bad_lines(name, &errors))?;
    let known: BTreeSet<u32> =
        batches.iter().flat_map(|batch| &batch.seen).filter_map(|one| one.id).collect();
    if known.is_empty() || groups.iter().flatten().any(|id| known.contains(id)) {
        return Ok(groups);
    }
    let said = format!("`{shown}` names nobody who is in the recording");
    let hint = "write the ids of the recording, a group on each line";
    Err(Diagnostic::placeless(Code::E0703, said).hint(hint).into())
}
