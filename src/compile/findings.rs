//! What was found in the worlds of a call: each place says the same thing once.

use super::consequences::UNKNOWN;
use super::queries::Compiler;
use crate::syntax::diagnostic::{Diagnostic, Severity};
use std::collections::BTreeMap;

/// Most worlds that an error names.
const MOST_WORLDS: usize = 3;

impl Compiler<'_> {
    /// What was found in all worlds. The same place says the same thing once, with the values of the parameters of which
    /// that depends, as far as is known.
    pub(super) fn findings(&self) -> Vec<Diagnostic> {
        let mut told: Vec<(Diagnostic, Vec<Option<String>>)> = Vec::new();
        let mut places = BTreeMap::new();
        for (at, site) in self.sites.iter().enumerate() {
            let names: Vec<&str> = site.settings.keys().map(String::as_str).collect();
            let values = self.described(at, &site.settings, &names);
            let values: Vec<String> =
                values.iter().map(|(name, value)| format!("{name} = {value}")).collect();
            let values = Some(values.join(", ")).filter(|values| !values.is_empty());
            for diagnostic in &site.elaborator.diagnostics {
                let place = diagnostic.place.as_ref().map(|place| place.span);
                // Without a place and values, only the text tells one from another.
                let text = (place.is_none() && values.is_none()).then(|| diagnostic.title.clone());
                let known = *places.entry((diagnostic.code, place, text)).or_insert(told.len());
                match told.get_mut(known) {
                    Some((_, worlds)) if worlds.last() == Some(&values) => {}
                    Some((_, worlds)) => worlds.push(values.clone()),
                    None => told.push((diagnostic.clone(), vec![values.clone()])),
                }
            }
        }
        let all = self.sites.len();
        let mut told: Vec<Diagnostic> = told
            .into_iter()
            .map(|(mut diagnostic, worlds)| {
                let depends = worlds.len() < all || all == 1;
                let says = diagnostic.severity == Severity::Error || diagnostic.code == "W0501";
                if depends
                    && says
                    && !UNKNOWN.contains(&diagnostic.code)
                    && let Some(worlds) = worlds.into_iter().collect::<Option<Vec<String>>>()
                {
                    diagnostic.title = format!("{} (with {})", diagnostic.title, some(&worlds));
                }
                diagnostic
            })
            .collect();
        told.sort_by_key(|d| d.place.as_ref().map(|place| place.span));
        told
    }
}

/// The first of some worlds, and how many more there are.
fn some(worlds: &[String]) -> String {
    let more = worlds.len().saturating_sub(MOST_WORLDS);
    let shown = worlds[..worlds.len() - more].join("; ");
    if more == 0 { shown } else { format!("{shown}; and {more} more") }
}
