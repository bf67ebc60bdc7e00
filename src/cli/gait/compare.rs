//! `smc gait compare`: are two sets of recorded or simulated walks alike?

use super::arguments::{CompareCommand, WalksFormat};
use crate::base::visible::visible;
use crate::cli::terminal::Colors;
use crate::cli::values::Model;
use crate::cli::{complaint, inputs, output};
use crate::data::tracks::LineError;
use crate::data::walks::{Walk, read_walks};
use crate::gait::compare::{Comparisons, compare, has_pairs};
use crate::model::Scenario;
use crate::report::ExitCode as Exit;
use crate::report::walks::{self, WalkSet};
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::parse::decode;
use crate::syntax::source::{Source, SourceId, Span};
use std::path::PathBuf;
use std::sync::Arc;

/// Errors of a file that are shown.
pub(super) const SHOWN: usize = 5;

/// What a table looks like.
const HINT: &str = "write a table with the columns `walk,t,x,y`, perhaps `leg`: seconds and metres, one row for each \
                    point, at least two walks";

/// Runs the command.
pub(super) fn run(arguments: &CompareCommand, colors: Colors) -> Exit {
    let mut sources = Vec::new();
    let done = answer(arguments, &mut sources, colors);
    complaint::end(done.map(|()| Exit::Success), &sources, colors)
}

fn answer(
    arguments: &CompareCommand,
    sources: &mut Vec<Source>,
    colors: Colors,
) -> Result<(), Vec<Diagnostic>> {
    let files: Vec<&String> = std::iter::once(&arguments.base).chain(&arguments.candidates).collect();
    if files.iter().filter(|file| **file == "-").count() > 1 {
        return Err(complaint::input("standard input can be read only once").into());
    }
    let paths = files.iter().map(|file| PathBuf::from(if *file == "-" { inputs::STDIN } else { file }));
    let paths: Vec<PathBuf> = paths.collect();
    for written in [&arguments.output, &arguments.points] {
        output::guard(written.as_deref(), &paths)?;
    }
    if arguments.points.is_some() && arguments.candidates.len() > 1 {
        let hint = "compare one candidate, or leave out `--points`";
        return Err(complaint::argument("`--points` takes one candidate", hint).into());
    }
    let read: Vec<_> = files.iter().map(|file| read(file, sources)).collect();
    if read.iter().any(Result::is_err) {
        return Err(read.into_iter().filter_map(Result::err).flatten().collect());
    }
    let all: Vec<Vec<Walk>> = read.into_iter().filter_map(Result::ok).collect();
    // The first walk shows whether a table has legs.
    let has_legs = |walks: &[Walk]| walks[0].leg.is_some();
    if let Some(without) = all.iter().position(|walks| !has_legs(walks))
        && all.iter().any(|walks| has_legs(walks))
    {
        let title = format!("`{}` has no column `leg`, but another table has", sources[without].name);
        let hint = "add the column, or remove it from the other tables";
        return Err(error!(E0708, header(&sources[without]), "{title}"; hint: "{hint}").into());
    }
    let (base, candidates) = (&all[0], &all[1..]);
    if arguments.paired && candidates.iter().any(|walks| !has_pairs(base, walks)) {
        let hint = "give walks that belong together one name in both tables, or remove `--paired`";
        let title = "`--paired` finds no walk with one name in both tables";
        return Err(complaint::argument(title, hint).into());
    }
    let sets: Vec<WalkSet<'_>> =
        files.iter().zip(&all).map(|(file, walks)| WalkSet { file: inputs::shown(file), walks }).collect();
    if arguments.format == WalksFormat::Svg {
        let scenario = scene(arguments, colors)?;
        let picture = walks::draw(scenario.as_deref(), &sets);
        return Ok(output::put(arguments.output.as_deref(), &arguments.print.svg(&picture))?);
    }
    let found: Vec<Comparisons> =
        candidates.iter().map(|walks| compare(base, walks, arguments.paired, arguments.seed)).collect();
    if let Some(path) = &arguments.points {
        output::write(path, |out| walks::write_points(out, &found[0].whole, [sets[0], sets[1]]))
            .map_err(|error| complaint::unwritten(path, &error))?;
    }
    let text = match arguments.format {
        WalksFormat::Json => walks::to_json(&found, &sets, arguments.seed),
        _ => visible(&walks::to_text(&found, &sets)).into_owned(),
    };
    Ok(output::put(arguments.output.as_deref(), &text)?)
}

/// The scenario whose barriers a picture shows.
fn scene(arguments: &CompareCommand, colors: Colors) -> Result<Option<Arc<Scenario>>, Vec<Diagnostic>> {
    let Some(scene) = &arguments.scene else { return Ok(None) };
    let model = Model { scenario: scene.clone(), ..Model::default() };
    let (study, _) = inputs::load_or_tell(&model, &[], colors).ok_or_else(Vec::new)?;
    Ok(study.worlds.get(study.base).map(|world| Arc::clone(&world.scenario)))
}

/// The walks of a file. Its text is kept for the places of errors.
fn read(file: &str, sources: &mut Vec<Source>) -> Result<Vec<Walk>, Vec<Diagnostic>> {
    let id = SourceId(sources.len() as u16);
    let name = inputs::shown(file);
    let bytes = inputs::read(file).map_err(complaint::input)?;
    let source = match decode(id, name, &bytes) {
        Ok(source) => source,
        Err(error) => {
            sources.push(Source::new(id, name, String::from_utf8_lossy(&bytes)));
            return Err(error.into());
        }
    };
    let walks = read_walks(&source.text).map_err(|errors| {
        let shown = errors
            .iter()
            .take(SHOWN)
            .map(|error| error!(E0708, span(&source, error), "{}", error.message.clone()).hint(HINT));
        shown.collect()
    });
    sources.push(source);
    walks
}

/// The cell or the line of an error. Cells end with a comma, or with a blank in lines without commas.
pub(super) fn span(source: &Source, error: &LineError) -> Span {
    let lines = source.text.split_inclusive('\n');
    let start: usize = lines.clone().take(error.line.saturating_sub(1)).map(str::len).sum();
    let line = lines.clone().nth(error.line.saturating_sub(1)).unwrap_or_default().trim_end();
    let line = if error.line == 0 { line.split(',').next().unwrap_or_default() } else { line };
    let Some(column) = error.column else { return Span::new(source.id, start, start + line.len()) };
    let before = line.char_indices().nth(column - 1).map_or(line.len(), |(at, _)| at);
    let ends: &[char] = if line.contains(',') { &[','] } else { &[' ', '\t'] };
    let cell = line[before..].split(ends).next().unwrap_or_default();
    Span::new(source.id, start + before, start + before + cell.len())
}

/// The line of a table that names its columns.
fn header(source: &Source) -> Span {
    let is_header = |line: &str| !line.trim().is_empty() && !line.starts_with('#');
    let line = source.text.lines().position(is_header).unwrap_or(0) + 1;
    span(source, &LineError::whole(line, ""))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_mark_their_cell_or_line() {
        let source = Source::new(SourceId(0), "a.csv", "# é\n\nwalk,t\r\né,no,1\n");
        let marked = |error: LineError| source.slice(span(&source, &error)).to_owned();
        assert_eq!(marked(LineError::at(4, 3, "")), "no");
        assert_eq!(marked(LineError::whole(4, "")), "é,no,1");
        assert_eq!(source.slice(header(&source)), "walk,t");
        assert_eq!(marked(LineError::at(9, 9, "")), "");
        assert_eq!(marked(LineError::of_file("")), "# é");
    }
}
