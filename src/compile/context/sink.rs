//! The errors and warnings of a world: one for a code and a place, never taken for another.

use crate::compile::context::clock::Told;
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::{Diagnostic, Severity};
use crate::syntax::source::{SourceId, Span};
use std::collections::BTreeSet;

/// After so many errors, no similar name is searched for an unknown name.
const MOST_LOOKED_FOR: usize = 100;

/// The errors and warnings found so far.
#[derive(Default)]
pub(crate) struct Sink {
    /// In the order in which they were found.
    pub(crate) diagnostics: Vec<Diagnostic>,
    /// Codes and places of all that was ever noted: only an error that stands here can be among the diagnostics.
    noted: BTreeSet<(Code, Option<Span>)>,
    /// The places of values that could not be read: nothing more is said of them.
    pub(crate) unread: BTreeSet<(SourceId, u32)>,
    /// How much of the clock is known: errors about times that need more are not reported.
    pub(crate) told: Told,
    /// Whether a parameter has a value outside of its range here.
    pub(crate) is_astray: bool,
}

impl Sink {
    /// Notes an error or warning, each place once.
    pub(crate) fn note(&mut self, diagnostic: Diagnostic) {
        if self.told < Told::needed(diagnostic.code) {
            return;
        }
        let span = diagnostic.place.as_ref().map(|place| place.span);
        if span.is_some_and(|span| self.unread.contains(&(span.source, span.start))) {
            return;
        }
        if self.noted.insert((diagnostic.code, span)) || !self.diagnostics.contains(&diagnostic) {
            self.diagnostics.push(diagnostic);
        }
    }

    /// Whether an error of some code was found at a place: said once, it need not be looked for again.
    pub(crate) fn is_said(&self, code: Code, place: Span) -> bool {
        let at = |one: &Diagnostic| one.place.as_ref().is_some_and(|label| label.span == place);
        self.noted.contains(&(code, Some(place)))
            && self.diagnostics.iter().any(|one| one.code == code && at(one))
    }

    /// Whether an error was found.
    pub(crate) fn failed(&self) -> bool {
        self.diagnostics.iter().any(|one| one.severity == Severity::Error)
    }

    /// Whether a known name is looked for that an unknown one may mean: after many errors that only takes time.
    pub(crate) fn looks_for_names(&self) -> bool {
        let mut errors = self.diagnostics.iter().filter(|one| one.severity == Severity::Error);
        errors.nth(MOST_LOOKED_FOR - 1).is_none()
    }
}
