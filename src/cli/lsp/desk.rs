//! The texts on the desk: those that are open in the editor, as they are there, and those that belong to them on the disk.
//! A property file belongs to the scenario that its first line names (`for "corridor.scn"`), else to the one of its own name
//! beside it or in a folder beside its own, such as `models/`; else it is checked alone.

use super::place;
use crate::base::digest::Digest;
use crate::cli::inputs;
use crate::compile::Drawings;
use crate::library::{self, Folder, Inputs, Names as Call};
use crate::syntax::ast::{PropertyFile, ScenarioFile};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::names::Names;
use crate::syntax::parse::parse_properties;
use crate::syntax::source::{Source, SourceId, Span};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::SystemTime;

/// A text in the editor.
pub(super) struct Open {
    pub(super) text: Arc<str>,
    pub(super) version: i32,
    /// Whether it is a property file; else it is a scenario.
    pub(super) asks: bool,
}

/// Everything that is known of a scenario and its property files, or of a property file without a scenario.
pub(super) struct Checked {
    /// The addresses of the files, in the order of the sources.
    pub(super) uris: Vec<String>,
    pub(super) inputs: Inputs,
    pub(super) names: Names,
    pub(super) properties: Vec<PropertyFile>,
    /// Whether the first source is a scenario.
    pub(super) has_scenario: bool,
}

impl Checked {
    /// The source of an address.
    pub(super) fn source(&self, uri: &str) -> Option<&Source> {
        let at = self.uris.iter().position(|known| known == uri)?;
        self.inputs.sources.get(at)
    }

    /// The file in which a place lies, if it is one of the files.
    pub(super) fn file(&self, span: Span) -> Option<(&str, &Source)> {
        let at = usize::from(span.source.0);
        Some((self.uris.get(at)?, self.inputs.sources.get(at)?))
    }
}

/// The texts, and what is known of them.
#[derive(Default)]
pub(super) struct Desk {
    /// The texts in the editor, by their addresses.
    pub(super) open: BTreeMap<String, Open>,
    /// Folders for recordings and imports.
    pub(super) data: Vec<PathBuf>,
    checked: BTreeMap<String, Arc<Checked>>,
    /// Bytes of recordings and imports, with the time of the file and their digest: a plan of many megabytes is read once.
    read: BTreeMap<PathBuf, (Option<SystemTime>, Vec<u8>, Digest)>,
    drawings: Drawings,
}

impl Desk {
    /// Puts a text on the desk, or another state of it.
    pub(super) fn put(&mut self, uri: &str, open: Open) {
        self.open.insert(uri.to_owned(), open);
        self.forget(uri);
    }

    /// Takes a text from the desk.
    pub(super) fn take(&mut self, uri: &str) {
        self.forget(uri);
        self.open.remove(uri);
    }

    /// Forgets everything that was known of the files to which a text belongs.
    pub(super) fn forget(&mut self, uri: &str) {
        self.checked.retain(|key, checked| key != uri && !checked.uris.iter().any(|own| own == uri));
        let key = self.key(uri);
        self.checked.remove(&key);
    }

    /// Whether an address is that of a property file.
    pub(super) fn asks(&self, uri: &str) -> bool {
        self.open.get(uri).map_or_else(|| place::asks(uri), |open| open.asks)
    }

    /// A text: as it is in the editor, or as the file has it.
    pub(super) fn text(&self, uri: &str) -> Result<Arc<str>, String> {
        if let Some(open) = self.open.get(uri) {
            return Ok(Arc::clone(&open.text));
        }
        let path = place::path(uri).ok_or_else(|| format!("`{uri}` is no file"))?;
        let bytes = inputs::read(&path.to_string_lossy())?;
        String::from_utf8(bytes).map(Into::into).map_err(|_| format!("`{}` is not UTF-8", path.display()))
    }

    /// The scenario of a property file.
    pub(super) fn scenario_of(&self, uri: &str) -> Option<String> {
        let path = place::path(uri)?;
        let folder = path.parent()?;
        let text = self.text(uri).ok()?;
        if let Some(named) = inputs::written_for(&text) {
            return Some(place::uri(&place::plain(&folder.join(named))));
        }
        let own = PathBuf::from(path.with_extension("scn").file_name()?);
        let is_there = |path: &PathBuf| self.open.contains_key(&place::uri(path)) || path.is_file();
        let beside = Some(folder.join(&own)).filter(is_there);
        let mut further =
            inputs::folders(folder.parent()?).into_iter().map(|other| other.join(&own)).filter(is_there);
        let found = beside.or_else(|| further.next().filter(|_| further.next().is_none()))?;
        Some(place::uri(&found))
    }

    /// The address under which everything that a text belongs to is known: that of the scenario, if it has one.
    pub(super) fn key(&self, uri: &str) -> String {
        let scenario = if self.asks(uri) { self.scenario_of(uri) } else { None };
        scenario.unwrap_or_else(|| uri.to_owned())
    }

    /// The property files of a scenario: those that are open, and, if all are wanted, those in folders around it.
    fn properties_of(&self, scenario: &str, all: bool) -> Vec<String> {
        let mut found: Vec<String> = self.open.keys().filter(|uri| self.asks(uri)).cloned().collect();
        if let Some(folder) = place::path(scenario).filter(|_| all).as_deref().and_then(Path::parent) {
            let around = folder.parent().map(inputs::folders).unwrap_or_default();
            for folder in std::iter::once(folder.to_path_buf()).chain(around) {
                found.extend(
                    inputs::matching(&folder, "*.bltl").iter().map(|name| place::uri(&folder.join(name))),
                );
            }
        }
        // Nothing is wrong with a file in which nothing is written yet.
        let is_written = |uri: &String| self.text(uri).is_ok_and(|text| !text.trim().is_empty());
        found.retain(|uri| self.scenario_of(uri).as_deref() == Some(scenario) && is_written(uri));
        found.sort();
        found.dedup();
        found
    }

    /// Everything that is known of what a text belongs to.
    pub(super) fn checked(&mut self, uri: &str) -> Arc<Checked> {
        let key = self.key(uri);
        if let Some(known) = self.checked.get(&key) {
            return Arc::clone(known);
        }
        let checked = Arc::new(self.check(&key, false));
        self.checked.insert(key, Arc::clone(&checked));
        checked
    }

    /// The same with all property files of the scenario, be they open or not.
    pub(super) fn whole(&mut self, uri: &str) -> Checked {
        let key = self.key(uri);
        self.check(&key, true)
    }

    /// The same as if one of the texts were another one.
    pub(super) fn with_text<R>(&mut self, uri: &str, text: &str, look: impl FnOnce(&Checked) -> R) -> R {
        let (version, asks) =
            self.open.get(uri).map_or((0, self.asks(uri)), |open| (open.version, open.asks));
        let before = self.open.insert(uri.to_owned(), Open { text: text.into(), version, asks });
        let key = self.key(uri);
        let found = look(&self.check(&key, false));
        match before {
            Some(before) => self.open.insert(uri.to_owned(), before),
            None => self.open.remove(uri),
        };
        found
    }

    fn check(&mut self, key: &str, all: bool) -> Checked {
        if self.asks(key) {
            return self.alone(key);
        }
        let properties = self.properties_of(key, all);
        let shown = |uri: &String| place::path(uri).map_or(uri.clone(), |path| path.display().to_string());
        let names: Vec<String> = properties.iter().map(shown).collect();
        let scenario = shown(&key.to_owned());
        let uris: Vec<String> = std::iter::once(key.to_owned()).chain(properties).collect();
        let call = Call {
            scenario: &scenario,
            properties: &names,
            settings: &[],
            setting: "--set",
            velocity: None,
            models: &[],
            calibration: None,
        };
        let texts = [&scenario].into_iter().chain(&names).cloned().zip(uris.iter().cloned()).collect();
        let mut parsed = library::parse(call, &mut Drawer { desk: self, texts, scenario: &scenario });
        parsed.files.noting = true;
        self.drawings.prints = parsed.inputs.prints.iter().cloned().collect();
        parsed.files.drawings = Some(self.drawings.clone());
        let names = Names::of(&parsed.scenario, &parsed.properties);
        let properties = parsed.properties.clone();
        let mut inputs = library::conclude(parsed, None);
        // A file that cannot be read has no source, and those behind it would be taken for others.
        let uris: Vec<String> = uris.into_iter().filter(|uri| self.text(uri).is_ok()).collect();
        let is_missing = self.text(key).is_err();
        if is_missing {
            self.blame_for(&mut inputs, &uris);
        }
        Checked { uris, inputs, names, properties, has_scenario: !is_missing }
    }

    /// A property file without a scenario: only its own words can be checked.
    fn alone(&self, uri: &str) -> Checked {
        let text = self.text(uri).unwrap_or_default();
        let source = Source::new(SourceId(0), uri, &*text);
        let (file, diagnostics) = parse_properties(&source);
        let properties = vec![file];
        let names = Names::of(&ScenarioFile::default(), &properties);
        let inputs = Inputs { sources: vec![source], diagnostics, ..Inputs::default() };
        Checked { uris: vec![uri.to_owned()], inputs, names, properties, has_scenario: false }
    }

    /// Where property files name a scenario that cannot be read, they are what is wrong.
    fn blame_for(&self, inputs: &mut Inputs, uris: &[String]) {
        for (source, uri) in inputs.sources.iter().zip(uris) {
            if let Some(path) = parse_properties(source).0.scenario() {
                let reason = self.text(&self.key(uri)).err().unwrap_or_default();
                inputs.diagnostics.push(Diagnostic::error(Code::E0701, path.span, reason));
            }
        }
        inputs.diagnostics.retain(|one| one.place.is_some());
    }

    /// The bytes of a file that a scenario names, and their digest; read again only if the file changed.
    fn file(&mut self, path: &str, scenario: &str) -> Result<&(Option<SystemTime>, Vec<u8>, Digest), String> {
        let found = inputs::find(path, scenario, &self.data)?;
        let time = found.metadata().and_then(|about| about.modified()).ok();
        if self.read.get(&found).is_none_or(|(known, ..)| time.is_none() || *known != time) {
            let bytes = inputs::read(&found.to_string_lossy())?;
            let print = Digest::of(&bytes);
            self.read.insert(found.clone(), (time, bytes, print));
        }
        self.read.get(&found).ok_or_else(|| format!("`{path}` is not there"))
    }
}

/// The files of a check.
struct Drawer<'d> {
    desk: &'d mut Desk,
    /// The address of each name.
    texts: BTreeMap<String, String>,
    scenario: &'d str,
}

impl Folder for Drawer<'_> {
    fn text(&mut self, name: &str) -> Result<Vec<u8>, String> {
        let uri = self.texts.get(name).map_or(name, String::as_str);
        self.desk.text(uri).map(|text| text.as_bytes().to_vec())
    }

    fn file(&mut self, path: &str) -> Result<Vec<u8>, String> {
        self.desk.file(path, self.scenario).map(|(_, bytes, _)| bytes.clone())
    }

    fn print(&mut self, path: &str, bytes: &[u8]) -> Digest {
        self.desk.file(path, self.scenario).map_or_else(|_| Digest::of(bytes), |(.., print)| *print)
    }

    fn matching(&mut self, pattern: &str) -> Vec<String> {
        let beside = Path::new(self.scenario).parent().map(Path::to_path_buf);
        let folders = beside.into_iter().chain(self.desk.data.iter().cloned());
        folders
            .map(|folder| inputs::matching(&folder, pattern))
            .find(|found| !found.is_empty())
            .unwrap_or_default()
    }
}
