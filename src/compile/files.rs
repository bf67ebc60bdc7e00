//! Files that a scenario names. They are opened by the command line; here they are bytes.

use crate::compile::context::sighting::{Grouping, Seen, Site};
use crate::compile::drawings::Drawings;
use crate::compile::people::intended::{beside, destinations};
use crate::data::tracks::{Format, LineError, Reading, Recording, Velocity};
use crate::syntax::ast::{AgentsDecl, Expr, ExprKind, GroupDecl, Item, ScenarioFile, SceneItem, Text, Value};
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::source::Span;
use std::collections::BTreeMap;

/// A file that a scenario names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Request {
    /// As written.
    pub path: String,
    /// Where it is named.
    pub span: Span,
    /// Whether it is a learned gait.
    pub is_gait: bool,
}

/// All files that a scenario names.
pub fn requests(file: &ScenarioFile) -> Vec<Request> {
    let mut found = Vec::new();
    let data = |path: String, span| Request { path, span, is_gait: false };
    for item in &file.items {
        match item {
            Item::Tracks { name, file: Some((_, path)), .. } => {
                found.push(data(path.value.clone(), path.span));
                if asks_for_destinations(file, &name.name) {
                    found.push(data(beside(&path.value), path.span));
                }
            }
            Item::Scene(items) => {
                for item in items.iter().flat_map(SceneItem::on_all_levels) {
                    if let SceneItem::Import { path, .. } = item {
                        found.push(data(path.value.clone(), path.span));
                    }
                }
            }
            Item::Kind(kind) => {
                let files = kind.body.iter().filter_map(|field| match &field.value {
                    Value::Learned { file, .. } => Some(file),
                    _ => None,
                });
                let gait = |file: &Text| Request { is_gait: true, ..data(file.value.clone(), file.span) };
                found.extend(files.map(gait));
            }
            _ => {}
        }
    }
    found
}

/// Whether somebody goes to the destinations of tracks.
fn asks_for_destinations(file: &ScenarioFile, tracks: &str) -> bool {
    file.items.iter().any(|item| {
        let (Item::Agents(AgentsDecl { body, .. }) | Item::Group(GroupDecl { body, .. })) = item else {
            return false;
        };
        let is_named = |expr: &Expr| matches!(&expr.kind, ExprKind::Name(name) if name == tracks);
        body.iter().filter_map(destinations).any(|(_, arguments)| arguments.first().is_some_and(is_named))
    })
}

/// A file that could not be opened.
pub(crate) fn missing(span: Span, reason: &str) -> Diagnostic {
    error!(E0701, span, "{}", reason.to_owned();
        hint: "files are searched beside the scenario, then in each `--data DIR`")
}

/// Why there is no recording.
#[derive(Clone, Debug)]
pub enum Unread {
    /// No file, or files that do not fit together.
    Missing(String),
    /// Lines that cannot be read.
    Lines(Vec<LineError>),
}

/// Whether a path stands for several files.
pub fn is_series(path: &str) -> bool {
    path.contains('*')
}

/// Whether the name of a file is one of those that a pattern with `*` stands for.
pub fn matches(pattern: &str, name: &str) -> bool {
    let mut parts = pattern.split('*');
    let Some(rest) = parts.next().and_then(|first| name.strip_prefix(first)) else { return false };
    let parts: Vec<&str> = parts.collect();
    let Some((last, middle)) = parts.split_last() else { return rest.is_empty() };
    let mut rest = rest;
    for part in middle {
        let Some(at) = rest.find(part) else { return false };
        rest = &rest[at + part.len()..];
    }
    rest.ends_with(last)
}

/// The contents of the files that were asked for, or why there are none.
#[derive(Clone, Debug, Default)]
pub struct Files {
    contents: BTreeMap<String, Result<Vec<u8>, String>>,
    /// The files that a path with `*` stands for.
    series: BTreeMap<String, Vec<String>>,
    /// What is seen now, by the names of tracks, which then need no file.
    seen: BTreeMap<String, Seen>,
    /// Which velocities recordings have, whatever the scenario says.
    pub velocity: Option<Velocity>,
    /// Finds groups of people; without it everybody walks alone.
    pub grouping: Option<Grouping>,
    /// The laws of the site, where a calibration tells them.
    pub site: Option<Site>,
    /// The columns beside the positions of the recording that is shown, which `column(a, NAME)` reads; `None` where trials
    /// are simulated.
    pub columns: Option<Vec<String>>,
    /// Whether it is noted what each name stands for, as an editor shows it.
    pub noting: bool,
    /// The drawings that were read before, where somebody reads the same ones again and again.
    pub drawings: Option<Drawings>,
}

impl Files {
    /// No files yet; groups of people are found so.
    pub fn grouped_by(grouping: Grouping) -> Self {
        Self { grouping: Some(grouping), ..Self::default() }
    }

    /// Hands over the contents of a path, or a sentence why there are none.
    pub fn provide(&mut self, path: impl Into<String>, contents: Result<Vec<u8>, String>) {
        self.contents.insert(path.into(), contents);
    }

    /// Hands over which files a path with `*` stands for; their contents are handed over each by itself.
    pub fn series(&mut self, path: impl Into<String>, files: Vec<String>) {
        self.series.insert(path.into(), files);
    }

    /// The recording in a file, or in all files that a path with `*` stands for.
    ///
    /// # Errors
    /// Why there is none: a sentence, or the bad lines of the first file that has any.
    pub fn recording(&self, path: &str, format: &Format, reading: &Reading) -> Result<Recording, Unread> {
        let Some(files) = self.series.get(path) else {
            let bytes = self.get(path).map_err(Unread::Missing)?;
            return format.read(bytes, reading).map_err(Unread::Lines);
        };
        let mut parts = Vec::with_capacity(files.len());
        for file in files {
            let bytes = self.get(file).map_err(Unread::Missing)?;
            parts.push(format.read(bytes, reading).map_err(Unread::Lines)?);
        }
        Recording::joined(parts).map_err(Unread::Missing)
    }

    /// Hands over who is seen now, instead of what the tracks of this name contain.
    pub fn see(&mut self, tracks: impl Into<String>, seen: Seen) {
        self.seen.insert(tracks.into(), seen);
    }

    /// Who is seen now instead of what the tracks of this name contain.
    pub(crate) fn seen(&self, tracks: &str) -> Option<&Seen> {
        self.seen.get(tracks)
    }

    /// The contents of a path, without the mark of UTF-8 that some programs write first.
    pub fn get(&self, path: &str) -> Result<&[u8], String> {
        match self.contents.get(path) {
            Some(Ok(bytes)) => Ok(bytes.strip_prefix("\u{FEFF}".as_bytes()).unwrap_or(bytes)),
            Some(Err(reason)) => Err(reason.clone()),
            None => Err(format!("internal error: `{path}` was not opened")),
        }
    }
}
