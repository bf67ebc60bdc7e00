//! The ways of agents and the laws of recorded ones before the first trial: what is wrong with them, as diagnostics.

use super::{laws, paths};
use crate::compile::Study;
use crate::compile::study::World;
use crate::route::{Doubt, DoubtKind, Ways};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::{Diagnostic, Severity};
use std::collections::BTreeSet;

/// The errors and warnings about the ways and laws in the worlds that some queries ask about; all queries where none is named. Rankings of
/// paths get their options, which depend on the roadmap that a seed gives.
pub fn survey(study: &mut Study, only: &[usize], seed: u64, ways: &Ways) -> Vec<Diagnostic> {
    let asked = study.queries.iter().filter(|query| only.is_empty() || only.contains(&query.index));
    let worlds: BTreeSet<usize> = asked.flat_map(|query| query.ask.worlds()).collect();
    let mut found: Vec<Diagnostic> = Vec::new();
    for world in worlds.into_iter().filter_map(|world| study.worlds.get(world)) {
        for one in ways.doubts(&world.scenario, seed).iter().map(|doubt| diagnostic(world, doubt)) {
            // Worlds may be alike.
            let place = |one: &Diagnostic| one.place.as_ref().map(|place| place.span);
            if !found.iter().any(|known| known.code == one.code && place(known) == place(&one)) {
                found.push(one);
            }
        }
    }
    found.extend(laws::missing(study, only));
    if !is_refused(&found) {
        found.extend(paths::settle(study, seed, ways));
    }
    found
}

/// Whether one of them is an error.
pub fn is_refused(found: &[Diagnostic]) -> bool {
    found.iter().any(|one| one.severity == Severity::Error)
}

fn diagnostic(world: &World, doubt: &Doubt) -> Diagnostic {
    let place = world.place_of(doubt.agent);
    let code = match doubt.kind {
        DoubtKind::Never => Code::E0803,
        DoubtKind::Sometimes => Code::W0802,
        DoubtKind::Around => Code::W0803,
    };
    if doubt.kind == DoubtKind::Never {
        let error = match place {
            Some(span) => Diagnostic::error(code, span, doubt.said.as_str()),
            None => Diagnostic::placeless(code, doubt.said.as_str()),
        };
        let imports = doubt.between.and_then(|barrier| {
            world.origins.imports.iter().find(|(range, _)| range.contains(&barrier)).map(|(_, span)| *span)
        });
        let error = match imports {
            Some(span) if place.is_some() => error.related(span, "an outline of this file is in between"),
            _ => error,
        };
        return error.hint(doubt.hint.as_str());
    }
    let warning = match place {
        Some(span) => Diagnostic::warning(code, span, doubt.said.as_str()),
        None => {
            Diagnostic { severity: Severity::Warning, ..Diagnostic::placeless(code, doubt.said.as_str()) }
        }
    };
    warning.hint(doubt.hint.as_str())
}
