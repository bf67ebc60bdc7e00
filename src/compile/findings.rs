//! What was found in the worlds of a call: each place says the same thing once.

use super::consequences::UNKNOWN;
use super::queries::Compiler;
use crate::syntax::diagnostic::{Diagnostic, Severity};
use std::collections::BTreeMap;

/// Most worlds that an error names.
const MOST_WORLDS: usize = 3;

/// What was found at a place.
struct Finding {
    /// As in the first world.
    diagnostic: Diagnostic,
    /// The values of parameters in the worlds in which it is found; none where nothing is set.
    worlds: Vec<Option<String>>,
    /// Whether it says the same in all of them.
    alike: bool,
}

impl Finding {
    /// With the worlds, of so many in which something is set, if it depends on them.
    fn told(self, set: usize) -> Diagnostic {
        let Self { mut diagnostic, worlds, alike } = self;
        let depends = worlds.len() < set || set == 1 || !alike;
        let says = diagnostic.severity == Severity::Error || diagnostic.code == "W0501";
        if depends
            && says
            && !UNKNOWN.contains(&diagnostic.code)
            && let Some(worlds) = worlds.into_iter().collect::<Option<Vec<String>>>()
        {
            diagnostic.title = format!("{} (with {})", diagnostic.title, some(&worlds));
        }
        diagnostic
    }
}

impl Compiler<'_> {
    /// What was found in all worlds. The same place says the same thing once, with the values of the parameters of which
    /// that depends, as far as is known.
    pub(super) fn findings(&self) -> Vec<Diagnostic> {
        let mut found: Vec<Finding> = Vec::new();
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
                let known = *places.entry((diagnostic.code, place, text)).or_insert(found.len());
                match found.get_mut(known) {
                    Some(finding) if finding.worlds.last() == Some(&values) => {}
                    Some(finding) => {
                        finding.worlds.push(values.clone());
                        finding.alike &= finding.diagnostic.title == diagnostic.title;
                    }
                    None => found.push(Finding {
                        diagnostic: diagnostic.clone(),
                        worlds: vec![values.clone()],
                        alike: true,
                    }),
                }
            }
        }
        let set = self.sites.iter().filter(|site| !site.settings.is_empty()).count();
        let mut told: Vec<Diagnostic> = found.into_iter().map(|finding| finding.told(set)).collect();
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
