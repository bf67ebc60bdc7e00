//! What was found in the worlds of a call: each place says the same thing once.

use crate::compile::context::dependence::UNKNOWN;
use crate::compile::query::compiler::Compiler;
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::{Diagnostic, Severity};
use std::collections::BTreeMap;

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

/// The errors of all worlds. One error at one place is reported once, with the values of the parameters on which
/// it depends, as far as is known. Similar errors with other values are counted.
pub(crate) fn findings(compiler: &Compiler<'_>) -> Vec<Diagnostic> {
    let mut found: Vec<Finding> = Vec::new();
    let mut places: BTreeMap<_, Vec<usize>> = BTreeMap::new();
    for (world, site) in compiler.sites.iter().enumerate() {
        for diagnostic in &site.context.sink.diagnostics {
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
    let mut told: Vec<Diagnostic> = found.into_iter().map(|finding| told(compiler, finding)).collect();
    told.sort_by_key(|d| d.place.as_ref().map(|place| place.span));
    told
}

/// A finding with its worlds, if it depends on them: if it is missing in one of the call, or, where it is found in
/// none of these, in one that queries set.
fn told(compiler: &Compiler<'_>, finding: Finding) -> Diagnostic {
    let Finding { mut diagnostic, worlds, others } = finding;
    if diagnostic.severity != Severity::Error && diagnostic.code != Code::W0501 {
        return diagnostic;
    }
    // An error that depends on no value occurs in all worlds.
    if others == 0 && compiler.sites[worlds[0]].context.names.is_sure(&diagnostic) {
        return diagnostic;
    }
    let is_base = |world: &usize| compiler.bases.contains(world);
    let is_set = |world: &usize| !compiler.sites[*world].settings.is_empty();
    if worlds == [PLAIN] && !is_base(&PLAIN) {
        diagnostic.title.push_str(" (with the defaults)");
        return diagnostic;
    }
    // What is so where nothing is set is so.
    if !worlds.iter().all(is_set) {
        return diagnostic;
    }
    let of_call = worlds.iter().any(is_base);
    let all = 0..compiler.sites.len();
    let asked: Vec<usize> =
        all.filter(|world| if of_call { is_base(world) } else { is_set(world) && !is_base(world) }).collect();
    let everywhere = asked.iter().all(|world| worlds.binary_search(world).is_ok());
    if everywhere && of_call && asked.len() > 1 || UNKNOWN.contains(&diagnostic.code) {
        return diagnostic;
    }
    let mut shown: Vec<String> =
        worlds.iter().take(MOST_WORLDS).map(|world| values(compiler, *world)).collect();
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
fn values(compiler: &Compiler<'_>, world: usize) -> String {
    let settings = &compiler.sites[world].settings;
    let names: Vec<&str> = settings.keys().map(String::as_str).collect();
    let values = compiler.described(world, settings, &names);
    let values: Vec<String> = values.iter().map(|(name, value)| format!("{name} = {value}")).collect();
    values.join(", ")
}
