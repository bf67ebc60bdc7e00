//! Errors and warnings with the texts that they quote.

use crate::engine::outcome::{Finding, Spot};
use crate::syntax::diagnostic::{Diagnostic, Severity};
use crate::syntax::render::render;
use crate::syntax::source::{Source, Span};
use std::fmt;

/// Errors and warnings about texts. Displayed as the command line shows them, with the lines that they mark.
#[derive(Clone, Default)]
pub struct Diagnostics {
    found: Vec<Diagnostic>,
    sources: Vec<Source>,
}

impl Diagnostics {
    /// What was found in these sources.
    pub(super) fn new(found: Vec<Diagnostic>, sources: Vec<Source>) -> Self {
        Self { found, sources }
    }

    /// Each of them, errors and warnings, in the order of the texts.
    pub fn iter(&self) -> impl Iterator<Item = &Diagnostic> {
        self.found.iter()
    }

    /// The texts.
    pub(super) fn sources(&self) -> &[Source] {
        &self.sources
    }

    /// The same as reports quote them.
    pub fn findings(&self) -> Vec<Finding> {
        findings(&self.found, &self.sources)
    }

    /// Whether nothing was found.
    pub fn is_empty(&self) -> bool {
        self.found.is_empty()
    }

    /// Whether one of them is an error.
    pub fn has_error(&self) -> bool {
        self.found.iter().any(|one| one.severity == Severity::Error)
    }
}

impl fmt::Display for Diagnostics {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&render(&self.found, &self.sources, false))
    }
}

impl fmt::Debug for Diagnostics {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

impl std::error::Error for Diagnostics {}

/// Errors and warnings as reports quote them.
pub fn findings(diagnostics: &[Diagnostic], sources: &[Source]) -> Vec<Finding> {
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
