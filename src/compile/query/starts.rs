//! Who starts where in the worlds that are surely asked about, known even where something else is wrong.

use crate::compile::context::roster::Starts;
use crate::compile::query::compiler::Compiler;
use crate::compile::study::Ask;
use crate::syntax::ast::{Query, QueryKind};
use std::collections::BTreeSet;
use std::sync::Arc;

/// Words that start a query of the world of the call, unless it sets values of its own.
const ASKING: [&str; 4] = ["check", "estimate", "rank", "pareto"];

/// The starts of the worlds that are surely asked about.
pub(crate) fn starts(compiler: &Compiler<'_>) -> Vec<Starts> {
    let mut worlds: BTreeSet<usize> = BTreeSet::new();
    for query in &compiler.queries {
        if matches!(query.ask, Ask::Compare { .. } | Ask::Rank { .. }) {
            worlds.extend(query.ask.worlds());
        }
    }
    worlds.extend(compiler.asked.iter().map(|(_, world)| *world));
    if asks_though_lost(compiler) {
        worlds.extend(&compiler.bases);
    }
    let starts = |world: &usize| {
        let site = compiler.sites.get(*world)?;
        match &site.scenario {
            Some(scenario) => {
                let places = site.context.roster.places.clone();
                Some(Starts { scenario: Arc::clone(scenario), places })
            }
            None => site.context.roster.starts.clone(),
        }
    };
    worlds.iter().filter_map(starts).collect()
}

/// Whether a query that could not be read surely sets no values of its own.
fn asks_though_lost(compiler: &Compiler<'_>) -> bool {
    compiler.input.properties.iter().flat_map(|file| &file.broken).any(|item| {
        let has = |word: &str| item.words.iter().any(|own| own == word);
        let asks = item.words.first().is_some_and(|first| ASKING.contains(&first.as_str()));
        asks && (!has("rank") && !has("pareto") || has("moves")) && !has("under")
    })
}

/// Notes which world a query asks about; a comparison, and a ranking of values, has some of its own.
pub(crate) fn note_asked(compiler: &mut Compiler<'_>, query: &Query, world: usize) {
    let has_own = matches!(&query.kind, QueryKind::Compare { .. })
        || matches!(&query.kind, QueryKind::Rank { of, .. } | QueryKind::Pareto { of, .. } if !of.values.is_empty());
    if !has_own {
        compiler.asked.push((query.span, world));
    }
}
