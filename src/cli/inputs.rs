//! Files of a call: where they are looked for, and their bytes.

use super::complaint;
use super::terminal::Colors;
use super::values::Model;
use crate::compile::{Study, matches};
pub(super) use crate::library::findings;
use crate::library::program::Programs;
use crate::library::{self, Folder, Inputs, Names, Parsed, load as compile, parse as read_all};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::{Diagnostic, Severity};
use crate::syntax::parse::parse_properties;
use crate::syntax::source::{Source, SourceId};
use std::ffi::OsString;
use std::fs::File;
use std::io::{BufRead, BufReader, ErrorKind, Read};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Most bytes of one input.
const MOST_BYTES: u64 = 256 << 20;

/// The file that standard input is read from, on systems that give it a name.
pub(super) const STDIN: &str = "/dev/stdin";

/// Bytes of a file, or of standard input for `-`.
pub(super) fn read(name: &str) -> Result<Vec<u8>, String> {
    if name == "-" {
        return whole(std::io::stdin().lock()).map_err(|error| format!("standard input {error}"));
    }
    read_file(Path::new(name)).map_err(|error| match error {
        Unread::Missing => format!("the file `{name}` does not exist{}", others(Path::new(name))),
        error => format!("`{name}` {error}"),
    })
}

/// The files beside one that is missing, with its extension; nothing if there are none or many.
fn others(missing: &Path) -> String {
    let folder = missing.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let names = entries.map(|entry| entry.path()).filter(|path| path.extension() == missing.extension());
    let mut names: Vec<String> =
        names.filter_map(|path| Some(path.file_name()?.to_str()?.to_owned())).collect();
    names.sort();
    let wanted = missing.file_name().and_then(|name| name.to_str()).unwrap_or_default();
    match (crate::compile::nearest::nearest(wanted, names.iter().map(String::as_str)), names.len()) {
        (Some(name), _) => format!("; did you mean `{name}`?"),
        (None, 1..=4) => format!("; the folder has {}", names.join(", ")),
        _ => String::new(),
    }
}

/// Why an input has no bytes, after its name.
#[derive(Debug, thiserror::Error)]
enum Unread {
    #[error("does not exist")]
    Missing,
    #[error("is not readable")]
    Forbidden,
    #[error("is a directory")]
    Directory,
    #[error("is larger than {} MB, the limit of an input", MOST_BYTES >> 20)]
    Large,
    #[error("cannot be read: {0}")]
    Other(std::io::Error),
}

impl From<std::io::Error> for Unread {
    fn from(error: std::io::Error) -> Self {
        match error.kind() {
            ErrorKind::NotFound => Self::Missing,
            ErrorKind::PermissionDenied => Self::Forbidden,
            _ => Self::Other(error),
        }
    }
}

#[allow(clippy::disallowed_methods, reason = "files are opened by the command line")]
fn read_file(path: &Path) -> Result<Vec<u8>, Unread> {
    if path.is_dir() {
        return Err(Unread::Directory);
    }
    whole(File::open(path)?)
}

/// All bytes of an input that is not too large. What a file says of its size is not trusted: a device says 0.
fn whole(from: impl Read) -> Result<Vec<u8>, Unread> {
    let mut bytes = Vec::new();
    from.take(MOST_BYTES + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > MOST_BYTES { Err(Unread::Large) } else { Ok(bytes) }
}

/// Most bytes of one line: a device that has no lines must not fill the memory.
const LONGEST: u64 = 1 << 20;

/// The lines of a file. A stream may be longer than any file: of its lines only one is kept.
#[allow(clippy::disallowed_methods, reason = "the command line opens files")]
pub(super) fn lines(
    name: &str,
) -> Result<impl Iterator<Item = std::io::Result<Vec<u8>>> + Send + use<>, String> {
    let mut from: Box<dyn BufRead + Send> = if name == "-" {
        Box::new(BufReader::new(std::io::stdin()))
    } else {
        Box::new(BufReader::new(
            File::open(name).map_err(|error| format!("`{name}` cannot be opened: {error}"))?,
        ))
    };
    Ok(std::iter::from_fn(move || {
        let mut line = Vec::new();
        match from.by_ref().take(LONGEST + 1).read_until(b'\n', &mut line) {
            Ok(0) => None,
            Ok(_) if line.len() as u64 > LONGEST => {
                Some(Err(std::io::Error::other("a line is longer than 1 MB")))
            }
            Ok(_) => {
                line.pop_if(|last| *last == b'\n');
                Some(Ok(line))
            }
            Err(error) => Some(Err(error)),
        }
    }))
}

/// Name of a source for people.
pub(super) fn shown(name: &str) -> &str {
    if name == "-" { "<stdin>" } else { name }
}

/// The files of a folder that a path with `*` in its last part stands for, in order.
#[allow(clippy::disallowed_methods, reason = "files are opened by the command line")]
pub(super) fn matching(folder: &Path, pattern: &str) -> Vec<String> {
    let (inner, last) = pattern.rsplit_once('/').map_or(("", pattern), |(inner, last)| (inner, last));
    let place = match folder.join(inner) {
        place if place.as_os_str().is_empty() => PathBuf::from("."),
        place => place,
    };
    let entries = std::fs::read_dir(place).into_iter().flatten().flatten();
    let names = entries.filter_map(|entry| entry.file_name().into_string().ok());
    let mut found: Vec<String> = names.filter(|name| matches(last, name)).collect();
    found.sort();
    if !inner.is_empty() {
        for name in &mut found {
            *name = format!("{inner}/{name}");
        }
    }
    found
}

/// The folders in a folder, in order.
#[allow(clippy::disallowed_methods, reason = "files are opened by the command line")]
pub(super) fn folders(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut found: Vec<PathBuf> = entries.map(|entry| entry.path()).filter(|path| path.is_dir()).collect();
    found.sort();
    found
}

/// The scenario that the first line of a property file names: `for "corridor.scn"`.
pub(super) fn written_for(text: &str) -> Option<String> {
    let first = text.lines().map(str::trim).find(|line| !line.is_empty() && !line.starts_with("//"))?;
    let is_it = first.strip_prefix("for").is_some_and(|rest| rest.trim_start().starts_with('"'));
    let file = || parse_properties(&Source::new(SourceId(0), "", first)).0;
    if is_it { file().scenario().map(|path| path.value.clone()) } else { None }
}

/// The words of a call with the scenario that the first property file names, if no scenario is among them.
pub(super) fn with_scenario(mut call: Vec<OsString>) -> Vec<OsString> {
    let is = |word: &OsString, ending: &str| Path::new(word).extension().is_some_and(|end| end == ending);
    let takes_one = call.get(1).is_some_and(|verb| ["check", "show", "shard"].iter().any(|one| verb == one));
    let has_one = call.iter().any(|word| is(word, "scn") || word == "-" || word == "--outcomes");
    let Some(at) = call.iter().position(|word| is(word, "bltl")).filter(|_| takes_one && !has_one) else {
        return call;
    };
    let file = Path::new(&call[at]);
    let text = file.to_str().and_then(|name| read(name).ok()).and_then(|bytes| String::from_utf8(bytes).ok());
    if let Some(named) = text.as_deref().and_then(written_for) {
        let scenario = file.parent().unwrap_or(Path::new("")).join(named);
        call.insert(at, scenario.into_os_string());
    }
    call
}

/// Looks for a file beside the scenario, then under each data directory.
pub(super) fn find(path: &str, scenario: &str, data: &[PathBuf]) -> Result<PathBuf, String> {
    let beside = if scenario == "-" { None } else { Path::new(scenario).parent() };
    let mut places: Vec<PathBuf> = beside.into_iter().map(Path::to_path_buf).collect();
    places.extend(data.iter().cloned());
    if Path::new(path).is_absolute() {
        return Ok(PathBuf::from(path));
    }
    for place in &places {
        let candidate = place.join(path);
        if candidate.is_file() {
            return Ok(candidate);
        }
    }
    let looked: Vec<String> = places
        .iter()
        .map(|p| if p.as_os_str().is_empty() { ".".to_owned() } else { p.display().to_string() })
        .collect();
    // The folder of a link is searched, not that of the file that it leads to.
    let target = std::fs::read_link(scenario)
        .ok()
        .and_then(|target| Some(beside?.join(target).parent()?.to_path_buf()));
    let linked = target.filter(|folder| folder.join(path).is_file()).map_or(String::new(), |folder| {
        format!("; it exists in `{0}`, to which `{scenario}` is a link: add `--data {0}`", folder.display())
    });
    Err(format!(
        "the file `{path}` does not exist in {}{linked}",
        if looked.is_empty() { "any --data directory".to_owned() } else { looked.join(", ") }
    ))
}

/// The files of a call on the disk.
struct Disk<'m> {
    model: &'m Model,
    /// The text of the scenario, where it is not that of a file.
    written: Option<String>,
    /// The files that were opened, where they were found.
    paths: Vec<PathBuf>,
}

impl Folder for Disk<'_> {
    fn text(&mut self, name: &str) -> Result<Vec<u8>, String> {
        self.paths.push(PathBuf::from(if name == "-" { STDIN } else { name }));
        match &self.written {
            Some(text) if name == self.model.scenario => Ok(text.clone().into_bytes()),
            _ => read(name),
        }
    }

    fn file(&mut self, path: &str) -> Result<Vec<u8>, String> {
        let found = find(path, &self.model.scenario, &self.model.data)?;
        let bytes = read_file(&found).map_err(|error| format!("`{path}` {error}"));
        self.paths.push(found);
        bytes
    }

    fn matching(&mut self, pattern: &str) -> Vec<String> {
        let beside = if self.model.scenario == "-" { None } else { Path::new(&self.model.scenario).parent() };
        let folders = beside.into_iter().chain(self.model.data.iter().map(PathBuf::as_path));
        folders.map(|folder| matching(folder, pattern)).find(|found| !found.is_empty()).unwrap_or_default()
    }

    fn shown<'n>(&self, name: &'n str) -> &'n str {
        shown(name)
    }
}

/// What a call has read.
#[derive(Default)]
pub(super) struct Loaded {
    /// The texts, what is wrong with them, and what they mean.
    pub(super) inputs: Inputs,
    /// The files that were opened, where they were found.
    pub(super) paths: Vec<PathBuf>,
}

fn names<'a>(model: &'a Model, properties: &'a [String]) -> Names<'a> {
    Names {
        scenario: &model.scenario,
        properties,
        settings: &model.set,
        setting: "--set",
        velocity: model.velocity,
        models: &model.models,
        calibration: model.calibration.as_deref(),
    }
}

/// Reads and parses what a call names; also the files that were opened, where they were found.
pub(super) fn parse(model: &Model, properties: &[String]) -> (Parsed, Vec<PathBuf>) {
    let mut disk = Disk { model, written: None, paths: Vec::new() };
    // Of recordings that are replayed each is read by itself, with the velocities that the command asks for.
    (read_all(Names { velocity: None, ..names(model, properties) }, &mut disk), disk.paths)
}

/// The same, and says what is wrong; none with errors.
pub(super) fn parse_or_tell(
    model: &Model,
    properties: &[String],
    colors: Colors,
) -> Option<(Parsed, Vec<PathBuf>)> {
    let (parsed, paths) = parse(model, properties);
    complaint::diagnose(&parsed.inputs, colors);
    let is_wrong = parsed.inputs.diagnostics.iter().any(|one| one.severity == Severity::Error);
    (!is_wrong).then_some((parsed, paths))
}

/// Reads, parses and compiles what a call names.
pub(super) fn load(model: &Model, properties: &[String]) -> Loaded {
    load_with(model, properties, None)
}

/// The same where the text of the scenario may be written for the call.
pub(super) fn load_with(model: &Model, properties: &[String], written: Option<String>) -> Loaded {
    let mut disk = Disk { model, written, paths: Vec::new() };
    let twice = std::iter::once(&model.scenario).chain(properties).filter(|name| *name == "-").count() > 1;
    let mut inputs = if twice { Inputs::default() } else { compile(names(model, properties), &mut disk) };
    let mut errors = Vec::new();
    if twice {
        errors.push(Diagnostic::placeless(Code::E0701, "standard input can be read only once"));
    }
    for directory in model.data.iter().filter(|directory| !directory.is_dir()) {
        let what = if directory.exists() { "is not a directory" } else { "does not exist" };
        let error = Diagnostic::placeless(Code::E0701, format!("`--data {}` {what}", directory.display()));
        errors.push(error.hint("write a folder that contains recordings or imports"));
    }
    if !errors.is_empty() {
        inputs.study = None;
        inputs.errors += errors.len();
        inputs.diagnostics.extend(errors);
    }
    Loaded { inputs, paths: disk.paths }
}

/// The programs of a call, if it has one that may run; `is_over` says when those under way are given up.
pub(super) fn programs(
    model: &Model,
    study: &Study,
    is_over: impl Fn() -> bool + Send + Sync + 'static,
) -> Result<Option<Arc<Programs>>, Diagnostic> {
    match library::program::unallowed(study) {
        Some(error) if !model.allow_run => Err(error),
        Some(_) => {
            let folder = Path::new(&model.scenario).parent().unwrap_or(Path::new(""));
            Ok(Some(Arc::new(Programs::new(folder, is_over))))
        }
        None => Ok(None),
    }
}

/// The same, and says what is wrong; none where nothing can be run.
pub(super) fn load_or_tell(model: &Model, properties: &[String], colors: Colors) -> Option<(Study, Loaded)> {
    let mut loaded = load(model, properties);
    complaint::diagnose(&loaded.inputs, colors);
    Some((loaded.inputs.study.take()?, loaded))
}
