//! What was found in the worlds of a call: each place says the same thing once.

use super::consequences::{UNKNOWN, words};
use super::dimension;
use super::elaborator::Elaborator;
use super::queries::Compiler;
use super::symbols::Meaning;
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::{About, Diagnostic, Severity};
use crate::syntax::source::Span;
use std::collections::{BTreeMap, BTreeSet};

/// Codes of errors of queries that depend on no value, besides those of names, kinds and units.
const VALUELESS: [Code; 6] = [Code::E0204, Code::E0507, Code::E0508, Code::E0603, Code::E0606, Code::E0607];
/// Codes of errors about numbers that depend on no other value if they are written as literals.
const WRITTEN: [Code; 9] = [
    Code::E0402,
    Code::E0404,
    Code::E0405,
    Code::E0503,
    Code::E0601,
    Code::E0602,
    Code::E0604,
    Code::E0605,
    Code::E0710,
];
/// The world in which nothing is set.
const PLAIN: usize = 0;
/// Most worlds that an error names, and most words in which it is said.
const MOST_WORLDS: usize = 3;
/// Most calls that are shown of an error inside functions.
const MOST_CALLS: usize = 4;

/// An error and the worlds in which it was found with the same text.
struct Finding {
    /// As in the first world.
    diagnostic: Diagnostic,
    /// The worlds in which it is found, ascending.
    worlds: Vec<usize>,
    /// How many more worlds say the same of the place in other words.
    others: usize,
}

impl Finding {
    /// Shows the calls of another one at the same place, too.
    fn join(&mut self, other: &Diagnostic) {
        let shown = &mut self.diagnostic.related;
        for label in &other.related {
            if shown.len() < MOST_CALLS && !shown.contains(label) {
                shown.push(label.clone());
            }
        }
    }
}

impl Compiler<'_> {
    /// The errors of all worlds. One error at one place is reported once, with the values of the parameters on which
    /// it depends, as far as is known. Similar errors with other values are counted.
    pub(super) fn findings(&self) -> Vec<Diagnostic> {
        let mut found: Vec<Finding> = Vec::new();
        let mut places: BTreeMap<_, Vec<usize>> = BTreeMap::new();
        for (world, site) in self.sites.iter().enumerate() {
            for diagnostic in &site.elaborator.diagnostics {
                let place = diagnostic.place.as_ref().map(|place| place.span);
                let known = places.entry((diagnostic.code, place)).or_default();
                let same = known.iter().find(|at| found[**at].diagnostic.title == diagnostic.title);
                let latest = known.iter().max_by_key(|at| found[**at].worlds.last());
                match (same, latest) {
                    (Some(&same), _) => {
                        if found[same].worlds.last() == Some(&world) {
                            found[same].join(diagnostic);
                        } else {
                            found[same].worlds.push(world);
                        }
                    }
                    // One thing at a place is enough, in one world; where it is so in another call, that is shown.
                    (None, Some(&last)) if place.is_some() && found[last].worlds.last() == Some(&world) => {
                        found[last].join(diagnostic);
                    }
                    (None, Some(_)) if place.is_some() && known.len() == MOST_WORLDS => {
                        found[known[MOST_WORLDS - 1]].others += 1;
                    }
                    _ => {
                        known.push(found.len());
                        let diagnostic = diagnostic.clone();
                        found.push(Finding { diagnostic, worlds: vec![world], others: 0 });
                    }
                }
            }
        }
        let mut told: Vec<Diagnostic> = found.into_iter().map(|finding| self.told(finding)).collect();
        told.sort_by_key(|d| d.place.as_ref().map(|place| place.span));
        told
    }

    /// A finding with its worlds, if it depends on them: if it is missing in one of the call, or, where it is found in
    /// none of these, in one that queries set.
    fn told(&self, finding: Finding) -> Diagnostic {
        let Finding { mut diagnostic, worlds, others } = finding;
        if diagnostic.severity != Severity::Error && diagnostic.code != Code::W0501 {
            return diagnostic;
        }
        // An error that depends on no value occurs in all worlds.
        if others == 0 && self.sites[worlds[0]].elaborator.is_sure(&diagnostic) {
            return diagnostic;
        }
        let is_base = |world: &usize| self.bases.contains(world);
        let is_set = |world: &usize| !self.sites[*world].settings.is_empty();
        if worlds == [PLAIN] && !is_base(&PLAIN) {
            diagnostic.title.push_str(" (with the defaults)");
            return diagnostic;
        }
        // What is so where nothing is set is so.
        if !worlds.iter().all(is_set) {
            return diagnostic;
        }
        let of_call = worlds.iter().any(is_base);
        let all = 0..self.sites.len();
        let asked: Vec<usize> = all
            .filter(|world| if of_call { is_base(world) } else { is_set(world) && !is_base(world) })
            .collect();
        let everywhere = asked.iter().all(|world| worlds.binary_search(world).is_ok());
        if everywhere && of_call && asked.len() > 1 || UNKNOWN.contains(&diagnostic.code) {
            return diagnostic;
        }
        let mut shown: Vec<String> =
            worlds.iter().take(MOST_WORLDS).map(|world| self.values(*world)).collect();
        let more = worlds.len().saturating_sub(MOST_WORLDS);
        if more > 0 {
            shown.push(format!("and {more} more"));
        }
        if others > 0 {
            shown.push(format!("and {others} similar"));
        }
        diagnostic.title = format!("{} (with {})", diagnostic.title, shown.join("; "));
        diagnostic
    }

    /// The values that are set in a world.
    fn values(&self, world: usize) -> String {
        let settings = &self.sites[world].settings;
        let names: Vec<&str> = settings.keys().map(String::as_str).collect();
        let values = self.described(world, settings, &names);
        let values: Vec<String> = values.iter().map(|(name, value)| format!("{name} = {value}")).collect();
        values.join(", ")
    }
}

impl Elaborator<'_> {
    /// Keeps only some errors, from a given one on, of a world that replaces one that could not be set up: those that do not
    /// depend on values: names, kinds and units, and literal numbers.
    pub(super) fn keep_sure(&mut self, from: usize) {
        let found = self.diagnostics.split_off(from.min(self.diagnostics.len()));
        let sure: Vec<Diagnostic> = found.into_iter().filter(|one| self.is_sure(one)).collect();
        self.diagnostics.extend(sure);
    }

    pub(super) fn is_sure(&self, one: &Diagnostic) -> bool {
        if one.hangs_on.iter().any(|value| self.hangs_on_parameters(*value)) {
            return false;
        }
        if one.is_formal {
            return true;
        }
        let is_circle = one.code == Code::E0205 && one.about == About::Circle;
        if is_circle || UNKNOWN.contains(&one.code) || one.code.is_of("E03") || VALUELESS.contains(&one.code)
        {
            return true;
        }
        WRITTEN.contains(&one.code) && one.place.as_ref().is_some_and(|place| self.is_literal(place.span))
    }

    /// Whether the expression at a place depends on a parameter, directly or by names.
    pub(super) fn hangs_on_parameters(&self, place: Span) -> bool {
        let (mut left, mut seen) = (vec![place], BTreeSet::new());
        while let Some(place) = left.pop() {
            if !seen.insert(place) {
                continue;
            }
            let text = self.text(place);
            let names: BTreeSet<&str> = words(&text).collect();
            for entry in self.scopes.iter().flat_map(|scope| names.iter().filter_map(|name| scope.get(name)))
            {
                match &entry.meaning {
                    Meaning::Param { .. } => return true,
                    Meaning::Constant(value) | Meaning::Property(value) | Meaning::Point(value) => {
                        left.push(value.span);
                    }
                    Meaning::Let(decl) => left.push(decl.body.span),
                    Meaning::Region(_, shape) => left.push(super::laws::shape_span(shape)),
                    _ => {}
                }
            }
        }
        false
    }

    /// Whether what is written somewhere is numbers and their units, which are the same in every world.
    pub(super) fn is_literal(&self, place: Span) -> bool {
        let text = self.text(place);
        let mut names = words(&text).filter(|word| !word.starts_with(|c: char| c.is_ascii_digit()));
        // A name may be called as a unit is.
        let is_declared = |name: &str| self.scopes.iter().any(|scope| scope.get(name).is_some());
        names.all(|name| dimension::unit(name).is_some() && !is_declared(name))
    }
}
