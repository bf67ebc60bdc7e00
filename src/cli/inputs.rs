//! Files of a call: read, decoded, parsed, compiled.

use super::arguments::Model;
use super::complaint;
use super::shelf::Shelf;
use crate::base::fingerprint::Fingerprint;
use crate::compile::{Files, Input, Setting, SettingValue, Starts, Study, examine, own_errors, requests};
use crate::engine::outcome::{Finding, Spot};
use crate::engine::overfull_starts;
use crate::syntax::ast::{Item, PropertyItem, ScenarioFile};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::{Diagnostic, Severity};
use crate::syntax::parse::{continues_name, decode, parse_properties, parse_scenario, parse_value};
use crate::syntax::source::{Source, SourceId, Span};
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{ErrorKind, Read};
use std::path::{Path, PathBuf};

/// Code of a parameter that is set wrongly.
const SETTING: Code = Code::E0210;

/// Most errors of one code that are shown.
const MOST_OF_A_KIND: usize = 100;

/// Most bytes of one input.
const MOST_BYTES: u64 = 256 << 20;

/// The file that standard input is read from, on systems that give it a name.
pub(super) const STDIN: &str = "/dev/stdin";

/// All that was read, and what was found wrong with it.
pub(super) struct Inputs {
    /// Texts.
    pub(super) sources: Vec<Source>,
    /// Errors and warnings.
    pub(super) diagnostics: Vec<Diagnostic>,
    /// How many errors there are, those included that are only counted.
    pub(super) errors: usize,
    /// Each file and the fingerprint of its bytes.
    pub(super) prints: Vec<(String, Fingerprint)>,
    /// The result of compilation, if there is no error.
    pub(super) study: Option<Study>,
    /// The opened files, for other processes that compile the same.
    pub(super) shelf: Shelf,
    /// The files that were opened, where they were found.
    pub(super) paths: Vec<PathBuf>,
}

/// Errors and warnings as reports quote them.
pub(super) fn findings(diagnostics: &[Diagnostic], sources: &[Source]) -> Vec<Finding> {
    let spot = |span: Span| {
        let source = sources.iter().find(|source| source.id == span.source)?;
        let (start, end) = (source.line_column(span.start), source.line_column(span.end));
        Some(Spot { file: source.name.clone(), start, end })
    };
    let one = |diagnostic: &Diagnostic| Finding {
        error: diagnostic.severity == Severity::Error,
        code: diagnostic.code.to_string(),
        spot: diagnostic.place.as_ref().and_then(|label| spot(label.span)),
        message: diagnostic.title.clone(),
        label: diagnostic.place.as_ref().map_or(String::new(), |label| label.text.clone()),
        hint: diagnostic.hint.clone(),
    };
    diagnostics.iter().map(one).collect()
}

/// Bytes of a file, or of standard input for `-`.
pub(super) fn read(name: &str) -> Result<Vec<u8>, String> {
    if name == "-" {
        return whole(std::io::stdin().lock()).map_err(|error| format!("standard input {error}"));
    }
    read_file(Path::new(name)).map_err(|error| match error {
        Unread::Missing => format!("the file `{name}` does not exist"),
        error => format!("`{name}` {error}"),
    })
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

/// Name of a source for people.
pub(super) fn shown(name: &str) -> &str {
    if name == "-" { "<stdin>" } else { name }
}

struct Reader {
    shelf: Shelf,
    sources: Vec<Source>,
    prints: Vec<(String, Fingerprint)>,
    diagnostics: Vec<Diagnostic>,
    paths: Vec<PathBuf>,
}

impl Reader {
    fn source(&mut self, name: &str) -> Option<Source> {
        self.paths.push(PathBuf::from(if name == "-" { STDIN } else { name }));
        let id = SourceId(self.sources.len() as u16);
        let bytes = match self.shelf.open(name, || read(name)) {
            Ok(bytes) => bytes,
            Err(reason) => {
                self.diagnostics.push(Diagnostic::placeless(Code::E0701, reason));
                return None;
            }
        };
        self.prints.push((shown(name).to_owned(), Fingerprint::of(&bytes)));
        match decode(id, shown(name), &bytes) {
            Ok(source) => {
                self.sources.push(source.clone());
                Some(source)
            }
            Err(diagnostic) => {
                self.sources.push(Source::new(id, shown(name), String::from_utf8_lossy(&bytes)));
                self.diagnostics.push(diagnostic);
                None
            }
        }
    }

    /// A part of the command line as a source of its own.
    fn text(&mut self, name: &str, text: &str) -> Source {
        let id = SourceId(self.sources.len() as u16);
        let source = Source::new(id, name, text);
        self.sources.push(source.clone());
        source
    }

    fn expression(&mut self, name: &str, text: &str) -> Option<crate::syntax::ast::Expr> {
        let source = self.text(name, text.trim());
        match parse_value(&source) {
            Ok(expr) => Some(expr),
            Err(diagnostics) => {
                self.diagnostics.extend(diagnostics);
                None
            }
        }
    }

    /// `name=value` or `name=from..to by step`
    fn setting(&mut self, text: &str) -> Option<Setting> {
        let named = text.split_once('=').filter(|(name, _)| !name.trim().is_empty());
        let Some((name, value)) = named else {
            let error = Diagnostic::placeless(Code::E0210, format!("`--set {text}` has no value"))
                .hint("write `--set name=value` or `--set name=from..to by step`");
            self.diagnostics.push(error);
            return None;
        };
        let (name, value) = (name.trim(), value.trim());
        let label = format!("--set {name}");
        let value = match value.split_once("..") {
            None => SettingValue::One(self.expression(&label, value)?),
            Some((from, rest)) => {
                let Some((to, by)) = rest.split_once(" by ") else {
                    let error =
                        Diagnostic::placeless(Code::E0210, format!("the sweep `{value}` has no step"))
                            .hint("write `--set name=0.1..0.8 by 0.1`");
                    self.diagnostics.push(error);
                    return None;
                };
                let parts =
                    (self.expression(&label, from), self.expression(&label, to), self.expression(&label, by));
                SettingValue::Sweep(parts.0?, parts.1?, parts.2?)
            }
        };
        let span = match &value {
            SettingValue::One(expr) => expr.span,
            SettingValue::Sweep(from, ..) => from.span,
        };
        Some(Setting { name: name.to_owned(), span, value })
    }
}

/// Looks for a file beside the scenario, then under each data directory.
fn find(path: &str, scenario: &str, data: &[PathBuf]) -> Result<PathBuf, String> {
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
    Err(format!(
        "the file `{path}` does not exist in {}",
        if looked.is_empty() { "any --data directory".to_owned() } else { looked.join(", ") }
    ))
}

/// The errors of a file. If it is a file of the other language, only that is reported.
fn misplaced(
    mut diagnostics: Vec<Diagnostic>,
    source: &Source,
    is_other: impl Fn(&Source) -> bool,
    hint: &str,
) -> Vec<Diagnostic> {
    if let Some(first) = diagnostics.iter().position(is_error)
        && is_other(source)
    {
        return vec![diagnostics.swap_remove(first).hint(hint)];
    }
    diagnostics
}

fn is_error(diagnostic: &Diagnostic) -> bool {
    diagnostic.severity == Severity::Error
}

/// The first errors or warnings of each kind, and the number of the others.
fn first_of_each_kind(mut diagnostics: Vec<Diagnostic>) -> Vec<Diagnostic> {
    let mut found: BTreeMap<(Severity, Code), usize> = BTreeMap::new();
    diagnostics.retain(|one| {
        let count = found.entry((one.severity, one.code)).or_default();
        *count += 1;
        *count <= MOST_OF_A_KIND
    });
    for ((severity, code), count) in found {
        if let Some(more) = count.checked_sub(MOST_OF_A_KIND).filter(|more| *more > 0) {
            let title = if more == 1 {
                "1 more of this kind".to_owned()
            } else {
                format!("{more} more of this kind")
            };
            diagnostics.push(Diagnostic { severity, ..Diagnostic::placeless(code, title) });
        }
    }
    diagnostics
}

/// Places at which more agents start than fit, except those with other errors.
fn crowded(starts: &[Starts], known: &[Diagnostic]) -> Vec<Diagnostic> {
    let place = |one: &Diagnostic| one.place.as_ref().map(|place| place.span);
    let is_known = |span: Span| {
        let meets =
            |other: Span| other.source == span.source && other.start < span.end && span.start < other.end;
        known.iter().filter(|one| is_error(one)).filter_map(place).any(meets)
    };
    let found = overfull_starts(starts);
    found.iter().map(complaint::refusal).filter(|one| !place(one).is_some_and(is_known)).collect()
}

/// Whether any number of people may be another than the files say. What is wrong with a value that the call sets tells
/// nothing of the value that was meant; and where parameters decide anything, what could not be read of the properties may
/// have set them. The first sources are those of files.
fn is_any_world(found: &[Diagnostic], said: &[Diagnostic], input: &Input<'_>, files: usize) -> bool {
    let source = |one: &Diagnostic| one.place.as_ref().map(|place| usize::from(place.span.source.0));
    let of_setting = |one: &Diagnostic| source(one).map_or(one.code == SETTING, |source| source >= files);
    let of_query = |one: &Diagnostic| source(one).is_none_or(|source| (1..files).contains(&source));
    let is_lost = || input.properties.iter().any(|file| !file.lost.is_empty() || !file.cut.is_empty());
    found.iter().chain(said).filter(|one| is_error(one)).any(of_setting)
        || (is_lost() || said.iter().filter(|one| is_error(one)).any(of_query)) && has_used_parameter(input)
}

/// Whether the scenario names some parameter again where it is not declared.
fn has_used_parameter(input: &Input<'_>) -> bool {
    let mut params: BTreeMap<&str, usize> = BTreeMap::new();
    for item in &input.scenario.items {
        if let Item::Param { name, .. } = item {
            params.insert(&name.name, 0);
        }
    }
    let text = input.sources.first().map_or("", |source| source.text.as_ref());
    for word in text.split(|c: char| !continues_name(c)) {
        if let Some(count) = params.get_mut(word) {
            *count += 1;
        }
    }
    params.values().any(|count| *count > 1)
}

/// Whether a text is a scenario, with something in it that only scenarios have.
fn is_scenario(source: &Source) -> bool {
    let (file, said) = parse_scenario(source);
    let shared = |item: &Item| matches!(item, Item::Const { .. } | Item::Let(_));
    !said.iter().any(is_error) && !file.items.iter().all(shared)
}

/// Whether a text is one of properties, with something in it that only these have.
fn is_of_properties(source: &Source) -> bool {
    let (file, said) = parse_properties(source);
    let shared = |item: &PropertyItem| matches!(item, PropertyItem::Const { .. } | PropertyItem::Let(_));
    !said.iter().any(is_error) && !file.items.iter().all(shared)
}

/// Reads, parses and compiles what a call names.
pub(super) fn load(model: &Model, properties: &[String]) -> Inputs {
    load_from(Shelf::Files, model, properties)
}

/// The same, with files from a shelf.
pub(super) fn load_from(shelf: Shelf, model: &Model, properties: &[String]) -> Inputs {
    let mut reader =
        Reader { shelf, sources: Vec::new(), prints: Vec::new(), diagnostics: Vec::new(), paths: Vec::new() };
    let twice = std::iter::once(&model.scenario).chain(properties).filter(|name| *name == "-").count() > 1;
    if twice {
        reader.diagnostics.push(Diagnostic::placeless(Code::E0701, "standard input can be read only once"));
    }
    let mut scenario = ScenarioFile::default();
    let mut parsed = Vec::new();
    let mut complete = !twice;
    if !twice {
        match reader.source(&model.scenario) {
            Some(source) => {
                let (file, diagnostics) = parse_scenario(&source);
                scenario = file;
                if scenario.items.is_empty() && diagnostics.is_empty() {
                    // Nothing but comments: as an empty file.
                    complete = false;
                    let title = format!("{} has no declarations", source.name);
                    reader.diagnostics.push(Diagnostic::placeless(Code::E0108, title));
                }
                let hint = "this is a property file; write the scenario first and property files after it";
                reader.diagnostics.extend(misplaced(diagnostics, &source, is_of_properties, hint));
            }
            None => complete = false,
        }
        for name in properties {
            // One that cannot be read was reported; the others are looked at without it.
            let Some(source) = reader.source(name) else { continue };
            let (file, diagnostics) = parse_properties(&source);
            parsed.push(file);
            let hint = "this is a scenario; write it first and property files after it";
            reader.diagnostics.extend(misplaced(diagnostics, &source, is_scenario, hint));
        }
    }
    for directory in model.data.iter().filter(|directory| !directory.is_dir()) {
        let what = if directory.exists() { "is not a directory" } else { "does not exist" };
        let error = Diagnostic::placeless(Code::E0701, format!("`--data {}` {what}", directory.display()));
        reader.diagnostics.push(error.hint("write a folder that contains recordings or imports"));
    }
    let in_files = reader.sources.len();
    let settings: Vec<Setting> = model.set.iter().filter_map(|text| reader.setting(text)).collect();
    let mut files = Files::default();
    for request in requests(&scenario) {
        let contents = reader.shelf.open(&request.path, || {
            find(&request.path, &model.scenario, &model.data).and_then(|path| {
                let bytes = read_file(&path).map_err(|error| format!("`{}` {error}", request.path));
                reader.paths.push(path);
                bytes
            })
        });
        if let Ok(bytes) = &contents {
            reader.prints.push((request.path.clone(), Fingerprint::of(bytes)));
        }
        files.insert(request.path, contents);
    }
    let Reader { shelf, sources, prints, mut diagnostics, paths } = reader;
    let mut study = None;
    if complete {
        let input = Input {
            sources: &sources,
            scenario: &scenario,
            properties: &parsed,
            files: &files,
            settings: &settings,
        };
        let examined = examine(&input);
        let is_any = is_any_world(&examined.found, &diagnostics, &input, in_files);
        let found = own_errors(examined.found, &diagnostics, &input);
        let said = diagnostics.clone();
        diagnostics.extend(found);
        if diagnostics.iter().any(is_error) && !is_any {
            // Of files that are right the engine tells it, of the queries that were chosen.
            let more = own_errors(crowded(&examined.starts, &diagnostics), &said, &input);
            diagnostics.extend(more);
        }
        study = examined.study;
    }
    if diagnostics.iter().any(|d| d.severity == Severity::Error) {
        study = None;
    } else if study.is_none() {
        // Nothing is refused without a word.
        let title = "internal error: compilation failed without a diagnostic";
        diagnostics.push(Diagnostic::placeless(Code::E0305, title));
    }
    if let (Some(study), Some(last)) = (&study, properties.last())
        && study.queries.is_empty()
        && let Some(source) = sources.iter().rfind(|source| source.name == shown(last))
    {
        let warning = Diagnostic::warning(
            Code::W0602,
            Span::new(source.id, 0, 0),
            "the property files contain no query",
        );
        diagnostics.push(warning.hint("add a query such as `check P(safe) >= 0.9` or `estimate P(safe)`"));
    }
    let errors = diagnostics.iter().filter(|one| is_error(one)).count();
    let diagnostics = first_of_each_kind(diagnostics);
    Inputs { sources, diagnostics, errors, prints, study, shelf, paths }
}
