//! The front of every call: texts and files are read, decoded, parsed and compiled, and what is wrong with them is
//! filtered once, so that every user of the crate sees the same errors.

use super::models;
use super::refusal::refusal;
use crate::advise::groups;
use crate::base::digest::Digest;
use crate::compile::{
    Files, Input, Notes, Request, Setting, Starts, Study, examine, is_series, own_errors, requests,
};
use crate::data::tracks::Velocity;
use crate::engine::overfull_starts;
use crate::gait::model::{FIT_AGAIN, LearnedGait};
use crate::replay::calibrate::{Calibration, written};
use crate::syntax::ast::{Expr, Item, PropertyFile, PropertyItem, ScenarioFile, Values};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::{About, Diagnostic, Severity};
use crate::syntax::parse::{
    continues_name, decode, parse_properties, parse_properties_of, parse_scenario, parse_value, split_values,
};
use crate::syntax::source::{Source, SourceId, Span};
use std::collections::BTreeMap;

/// Code of a parameter that is set wrongly.
const SETTING: Code = Code::E0210;

/// Stack of a thread that compiles texts of strangers, bytes: deep formulas are walked recursively, up to a limit.
pub const STACK: usize = 256 << 20;

/// Most errors of one code that are shown.
const MOST_OF_A_KIND: usize = 100;

/// Where texts and files are read from.
pub trait Folder {
    /// The bytes of a scenario or a property file, by the name that the call gives it.
    ///
    /// # Errors
    /// A sentence that says why there are none.
    fn text(&mut self, name: &str) -> Result<Vec<u8>, String>;

    /// The bytes of a file that the scenario names.
    ///
    /// # Errors
    /// A sentence that says why there are none.
    fn file(&mut self, path: &str) -> Result<Vec<u8>, String>;

    /// The digest of the bytes of such a file.
    fn print(&mut self, _path: &str, bytes: &[u8]) -> Digest {
        Digest::of(bytes)
    }

    /// The paths of all files that a path with `*` in its last part stands for, in order; none where there are none.
    fn matching(&mut self, _pattern: &str) -> Vec<String> {
        Vec::new()
    }

    /// The name of a text for messages.
    fn shown<'n>(&self, name: &'n str) -> &'n str {
        name
    }
}

/// What a call names.
#[derive(Clone, Copy, Debug)]
pub struct Names<'a> {
    /// The scenario.
    pub scenario: &'a str,
    /// Property files.
    pub properties: &'a [String],
    /// Values of parameters: `density=0.8 /m^2`, or a sweep: `density=0.1..0.8 by 0.1`, `n=2,4,8`.
    pub settings: &'a [String],
    /// The place of an error in such a value, before the name of the parameter: `--set`.
    pub setting: &'static str,
    /// Which velocities recordings have, whatever the scenario says.
    pub velocity: Option<Velocity>,
    /// Presets of people under each of which all queries are asked; empty if the scenario alone says who walks.
    pub models: &'a [String],
    /// The file of a calibration.
    pub calibration: Option<&'a str>,
}

/// All that was read, and what was found wrong with it.
#[derive(Debug, Default)]
pub struct Inputs {
    /// Texts.
    pub sources: Vec<Source>,
    /// Errors and warnings; of each kind the first hundred, and the number of the others.
    pub diagnostics: Vec<Diagnostic>,
    /// The number of errors, including those that are only counted.
    pub errors: usize,
    /// Each file and the digest of its bytes.
    pub prints: Vec<(String, Digest)>,
    /// What compilation yields, if nothing is wrong.
    pub study: Option<Study>,
    /// How often the model was right about recorded people, where a file says so.
    pub calibration: Option<Calibration>,
    /// The meanings of names, if the files say that they are noted.
    pub notes: Notes,
}

/// What a call names, read and parsed but not compiled.
#[derive(Debug, Default)]
pub struct Parsed {
    /// Texts, what the parser says of them, and the digests of all files.
    pub inputs: Inputs,
    /// The scenario.
    pub scenario: ScenarioFile,
    /// Property files.
    pub properties: Vec<PropertyFile>,
    /// Values of parameters.
    pub settings: Vec<Setting>,
    /// Contents of the files that the scenario names.
    pub files: Files,
    /// How many of the texts are files; the others are parts of the call.
    in_files: usize,
    /// Whether the scenario has declarations.
    complete: bool,
}

impl Parsed {
    /// What compilation takes.
    pub fn input(&self) -> Input<'_> {
        Input {
            sources: &self.inputs.sources,
            scenario: &self.scenario,
            properties: &self.properties,
            files: &self.files,
            settings: &self.settings,
        }
    }
}

/// Reads and parses what a call names.
pub fn parse(names: Names<'_>, folder: &mut dyn Folder) -> Parsed {
    let mut reader = Reader { folder, setting: names.setting, inputs: Inputs::default() };
    let mut complete = true;
    let mut scenario = ScenarioFile::default();
    let mut properties = Vec::new();
    let mut counts_steps = false;
    match reader.source(names.scenario) {
        Some(source) => {
            let (file, diagnostics) = parse_scenario(&source);
            scenario = file;
            counts_steps = has_steps(&scenario, &source);
            if scenario.items.is_empty() && diagnostics.is_empty() {
                // Nothing but comments: as an empty file.
                complete = false;
                let title = format!("{} has no declarations", source.name);
                reader.report(Diagnostic::placeless(Code::E0108, title));
            }
            let hint = "this is a property file; write the scenario first and property files after it";
            reader.inputs.diagnostics.extend(misplaced(diagnostics, &source, is_of_properties, hint));
        }
        None => complete = false,
    }
    for name in names.properties {
        // One that cannot be read was reported; the others are examined without it.
        let Some(source) = reader.source(name) else { continue };
        let (file, diagnostics) = parse_properties_of(&source, counts_steps);
        properties.push(file);
        let hint = "this is a scenario; write it first and property files after it";
        reader.inputs.diagnostics.extend(misplaced(diagnostics, &source, is_scenario, hint));
    }
    let in_files = reader.inputs.sources.len();
    let mut settings: Vec<Setting> = names.settings.iter().filter_map(|text| reader.setting(text)).collect();
    if !names.models.is_empty() && complete {
        let text = names.models.join(",");
        let source = Source::new(reader.next_id(), "--models", &text);
        let span = Span::new(source.id, 0, text.len());
        reader.inputs.sources.push(source);
        match models::under((names.models, span), &mut scenario, &mut properties) {
            Ok(sweep) if settings.iter().all(|set| set.name != sweep.name) => settings.push(sweep),
            Ok(_) => {}
            Err(error) => reader.report(error),
        }
    }
    let mut files = Files::grouped_by(groups);
    files.velocity = names.velocity;
    if let Some(name) = names.calibration {
        reader.calibration(name);
        // Without it nothing more can be said of what asks for the laws of the site.
        complete &= reader.inputs.calibration.is_some();
        files.site = reader.inputs.calibration.as_ref().and_then(Calibration::site);
    }
    let mut asked = requests(&scenario);
    for series in asked.extract_if(.., |request| is_series(&request.path)).collect::<Vec<_>>() {
        let paths = reader.folder.matching(&series.path);
        asked.extend(paths.iter().map(|path| Request { path: path.clone(), ..series.clone() }));
        if paths.is_empty() {
            files.provide(series.path.clone(), Err(format!("no file matches `{}`", series.path)));
        } else {
            files.series(series.path, paths);
        }
    }
    for request in asked {
        let contents = reader.folder.file(&request.path);
        if let Ok(bytes) = &contents {
            let print = reader.folder.print(&request.path, bytes);
            reader.inputs.prints.push((request.path.clone(), print));
            // Here and not where steps are drawn: every command reads its files here.
            if request.is_gait
                && let Err(error) = LearnedGait::read(bytes)
            {
                let title = format!("`{}` is no gait: {error}", request.path);
                reader.report(error!(E0723, request.span, "{title}").hint(FIT_AGAIN));
            }
        }
        files.provide(request.path, contents);
    }
    Parsed { inputs: reader.inputs, scenario, properties, settings, files, in_files, complete }
}

/// Reads, parses and compiles what a call names.
pub fn load(names: Names<'_>, folder: &mut dyn Folder) -> Inputs {
    let parsed = parse(names, folder);
    let last = names.properties.last().map(|name| folder.shown(name).to_owned());
    conclude(parsed, last.as_deref())
}

/// Compiles what was parsed. A warning says it if there is no query, at the last property file of the call.
pub fn conclude(parsed: Parsed, last: Option<&str>) -> Inputs {
    let compiled =
        parsed.complete.then(|| examined(&parsed.input(), &parsed.inputs.diagnostics, parsed.in_files));
    let formulas = written(&parsed.properties, &parsed.inputs.sources);
    let mut inputs = parsed.inputs;
    if let Some((study, found, notes)) = compiled {
        inputs.diagnostics.extend(found);
        (inputs.study, inputs.notes) = (study, notes);
    }
    if let (Some(calibration), Some(study)) = (&inputs.calibration, &inputs.study) {
        inputs.diagnostics.extend(calibration.fits(study, &formulas).err());
    }
    if inputs.diagnostics.iter().any(is_error) {
        inputs.study = None;
    } else if inputs.study.is_none() {
        // Nothing is refused without a word.
        let title = "internal error: compilation failed without a diagnostic";
        inputs.diagnostics.push(Diagnostic::placeless(Code::E0305, title));
    }
    if let (Some(study), Some(last)) = (&inputs.study, last)
        && study.queries.is_empty()
        && let Some(source) = inputs.sources.iter().rfind(|source| source.name == last)
    {
        let warning = Diagnostic::warning(
            Code::W0602,
            Span::new(source.id, 0, 0),
            "the property files contain no query",
        );
        let hint = "add a query such as `check P(safe) >= 0.9` or `estimate P(safe)`";
        inputs.diagnostics.push(warning.hint(hint));
    }
    inputs.errors = inputs.diagnostics.iter().filter(|one| is_error(one)).count();
    inputs.diagnostics = first_of_each_kind(inputs.diagnostics);
    inputs
}

/// What compilation yields, and what is wrong beside what the parser said.
fn examined(input: &Input<'_>, said: &[Diagnostic], files: usize) -> (Option<Study>, Vec<Diagnostic>, Notes) {
    let examined = examine(input);
    let is_any = is_any_world(&examined.found, said, input, files);
    let mut found = own_errors(examined.found, said, input);
    if found.iter().chain(said).any(is_error) && !is_any {
        // Of files that are right the engine reports it, for the queries that were chosen.
        let known: Vec<Diagnostic> = said.iter().chain(&found).cloned().collect();
        found.extend(own_errors(crowded(&examined.starts, &known), said, input));
    }
    (examined.study, found, examined.notes)
}

struct Reader<'f> {
    folder: &'f mut dyn Folder,
    setting: &'static str,
    inputs: Inputs,
}

impl Reader<'_> {
    fn report(&mut self, diagnostic: Diagnostic) {
        self.inputs.diagnostics.push(diagnostic);
    }

    fn next_id(&self) -> SourceId {
        SourceId(self.inputs.sources.len() as u16)
    }

    fn calibration(&mut self, name: &str) {
        let read = self.folder.text(name).map_err(|reason| Diagnostic::placeless(Code::E0701, reason));
        match read.and_then(|bytes| Ok((Digest::of(&bytes), Calibration::read(name, &bytes)?))) {
            Ok((print, found)) => {
                self.inputs.prints.push((self.folder.shown(name).to_owned(), print));
                self.inputs.calibration = Some(found);
            }
            Err(error) => self.report(error),
        }
    }

    fn source(&mut self, name: &str) -> Option<Source> {
        let id = self.next_id();
        let bytes = match self.folder.text(name) {
            Ok(bytes) => bytes,
            Err(reason) => {
                self.report(Diagnostic::placeless(Code::E0701, reason));
                return None;
            }
        };
        let shown = self.folder.shown(name);
        self.inputs.prints.push((shown.to_owned(), Digest::of(&bytes)));
        match decode(id, shown, &bytes) {
            Ok(source) => {
                self.inputs.sources.push(source.clone());
                Some(source)
            }
            Err(diagnostic) => {
                self.inputs.sources.push(Source::new(id, shown, String::from_utf8_lossy(&bytes)));
                self.report(diagnostic);
                None
            }
        }
    }

    fn expression(&mut self, name: &str, text: &str) -> Option<Expr> {
        // A part of the call is a source of its own.
        let source = Source::new(self.next_id(), name, text.trim());
        self.inputs.sources.push(source.clone());
        match parse_value(&source) {
            Ok(expr) => Some(expr),
            Err(diagnostics) => {
                self.inputs.diagnostics.extend(diagnostics);
                None
            }
        }
    }

    /// `name=value`, `name=2,4,8`, `name=from..to by step` or `name=0.1..10 by log 3`
    fn setting(&mut self, text: &str) -> Option<Setting> {
        let named = text.split_once('=').filter(|(name, _)| !name.trim().is_empty());
        let Some((name, value)) = named else {
            let error = Diagnostic::placeless(Code::E0210, format!("`--set {text}` has no value"))
                .hint("write `--set name=value` or `--set name=from..to by step`");
            self.report(error);
            return None;
        };
        let (name, value) = (name.trim(), value.trim());
        let label = format!("{} {name}", self.setting);
        let value = match value.split_once("..") {
            None => {
                let parts = split_values(value).into_iter().map(|part| self.expression(&label, part));
                Values::List(parts.collect::<Vec<_>>().into_iter().collect::<Option<_>>()?)
            }
            Some((from, rest)) => {
                let Some((to, by)) = rest.split_once(" by ") else {
                    let error =
                        Diagnostic::placeless(Code::E0210, format!("the sweep `{value}` has no step"))
                            .hint("write `--set name=0.1..0.8 by 0.1`");
                    self.report(error);
                    return None;
                };
                let by = by.trim();
                let decades = by.strip_prefix("log").filter(|rest| !rest.starts_with(continues_name));
                let step = decades.unwrap_or(by);
                let parts = (
                    self.expression(&label, from),
                    self.expression(&label, to),
                    self.expression(&label, step),
                );
                Values::Range { from: parts.0?, to: parts.1?, by: parts.2?, log: decades.is_some() }
            }
        };
        let (span, _) = value.ends();
        Some(Setting { name: name.to_owned(), span, values: value })
    }
}

/// What is wrong with a file. Where it is a file of the other language, that is all there is to say.
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

/// Of each kind of error or warning the first ones, and how many more there are.
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

/// Where more people are to start than fit, but for what is known to be wrong there.
fn crowded(starts: &[Starts], known: &[Diagnostic]) -> Vec<Diagnostic> {
    let place = |one: &Diagnostic| one.place.as_ref().map(|place| place.span);
    let is_known = |span: Span| {
        let meets =
            |other: Span| other.source == span.source && other.start < span.end && span.start < other.end;
        known.iter().filter(|one| is_error(one)).filter_map(place).any(meets)
    };
    let found = overfull_starts(starts);
    found
        .iter()
        .map(|one| refusal(one).about(About::Crowd))
        .filter(|one| !place(one).is_some_and(is_known))
        .collect()
}

/// Whether any number of people may be another than the files say. What is wrong with a value that the call sets tells
/// nothing of the value that was meant; and where parameters decide anything, what could not be read of the properties may
/// have set them. The first sources are those of files.
fn is_any_world(found: &[Diagnostic], said: &[Diagnostic], input: &Input<'_>, files: usize) -> bool {
    let source = |one: &Diagnostic| one.place.as_ref().map(|place| usize::from(place.span.source.0));
    let of_setting = |one: &Diagnostic| source(one).map_or(one.code == SETTING, |source| source >= files);
    let of_query = |one: &Diagnostic| source(one).is_none_or(|source| (1..files).contains(&source));
    let is_lost = || input.properties.iter().any(|file| !file.broken.is_empty());
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

/// Whether the horizon of a scenario is a number of steps.
fn has_steps(scenario: &ScenarioFile, source: &Source) -> bool {
    let text = |span: Span| &source.text[span.start as usize..span.end as usize];
    scenario.items.iter().any(|item| match item {
        Item::Setting { name, value } => name.name == "horizon" && text(value.span).contains("step"),
        _ => false,
    })
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
