//! Errors and warnings with the texts that they quote.

use crate::syntax::diagnostic::{Diagnostic, Severity};
use crate::syntax::render::render;
use crate::syntax::source::Source;
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
