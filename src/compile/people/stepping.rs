//! The fields of stepped kinds that are no parameters of a body: `gait` and `search`.

use crate::compile::context::{Context, Locals, Lowered, Reported, kind::Kind, symbols::unknown};
use crate::compile::dimension::Dimension;
use crate::compile::files::{self, Files};
use crate::compile::lower::call_arguments::{self, Argument, call, word};
use crate::model::{GaitRule, SearchRule};
use crate::syntax::ast::{Field, ScenarioFile, Value};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::Diagnostic;
use std::sync::Arc;

/// Ways of choosing steps.
const SEARCHES: [&str; 4] = ["guided", "hybrid_a_star", "grid_a_star", "as_published"];
/// Most steps that are tried after one.
const MOST: f64 = 1000.0;
/// As the file of a gait says that it was fitted as published.
const PUBLISHED: &str = "\"as_published\":true";
const GUIDED: [Argument; 1] = [Argument::count("candidates", 1.0, MOST)];
const HYBRID: [Argument; 3] = [
    Argument { name: "cell", dimension: Dimension::LENGTH, range: (0.02, 1.0), positive: true, whole: false },
    Argument::count("starters", 1.0, MOST),
    Argument::count("successors", 1.0, MOST),
];

/// Takes the files of learned gaits that kinds name.
pub(crate) fn settle_gaits(context: &mut Context<'_>, file: &ScenarioFile, files: &Files) {
    let fields = file.items.iter().filter_map(|item| match item {
        crate::syntax::ast::Item::Kind(kind) => Some(&kind.body),
        _ => None,
    });
    for field in fields.flatten() {
        let Value::Learned { file, .. } = &field.value else { continue };
        match files.get(&file.value) {
            Ok(bytes) => {
                context.tracks.gaits.insert(file.value.clone(), String::from_utf8_lossy(bytes).into());
            }
            Err(reason) => context.note(files::missing(file.span, &reason)),
        }
    }
}

/// Takes one of the fields into a kind.
pub(crate) fn stepping(
    context: &mut Context<'_>,
    field: &Field,
    kind: &mut Kind,
    locals: &Locals,
) -> Lowered<()> {
    if field.name.name == "search" {
        kind.search = search(context, &field.value, locals)?;
        warn_of_unused(context, field, kind);
        return Ok(());
    }
    kind.gait = match &field.value {
        Value::Learned { file, as_published, span } => {
            let text = Arc::clone(context.tracks.gaits.get(&file.value).ok_or(Reported)?);
            if *as_published {
                kind.search = SearchRule::AsPublished;
            }
            if *as_published && !text.contains(PUBLISHED) {
                let said = format!("`{}` was not fitted as published", file.value);
                let hint = "fit it anew: `smc gait fit takes.csv --as-published -o walkers.gait`";
                context.note(Diagnostic::warning(Code::W0723, *span, said).hint(hint));
            }
            GaitRule::Learned { file: file.value.clone(), text }
        }
        value if word(value) == Some("synthetic") => GaitRule::Synthetic,
        value => {
            let said = "`gait` must be `synthetic`, or `learned` or `as_published` with a file";
            let error = error!(E0305, value.span(), "{said}");
            return context
                .report(error.hint("write `gait = synthetic` or `gait = learned \"walkers.gait\"`"));
        }
    };
    warn_of_unused(context, field, kind);
    Ok(())
}

/// Of a gait whose steps no search draws.
fn warn_of_unused(context: &mut Context<'_>, field: &Field, kind: &Kind) {
    if let (GaitRule::Learned { file, .. }, SearchRule::GridAStar) = (&kind.gait, kind.search) {
        let said = format!("`grid_a_star` takes only the usual length and duration of steps from `{file}`");
        let warning = Diagnostic::warning(Code::W0723, field.value.span(), said);
        context.note(warning.hint("remove `gait`, or write `search = hybrid_a_star()`"));
    }
}

/// `guided(…)`, `hybrid_a_star(…)`, `grid_a_star()` or `as_published()`.
fn search(context: &mut Context<'_>, value: &Value, locals: &Locals) -> Lowered<SearchRule> {
    let Some((name, arguments)) = call(value) else {
        let said = "expected `guided(…)`, `hybrid_a_star(…)`, `grid_a_star()` or `as_published()`";
        return context.report(error!(E0305, value.span(), "{said}";
                hint: "write for example `search = guided(candidates = 24)`"));
    };
    match name.name.as_str() {
        "guided" => {
            let [candidates] = call_arguments::numbers_among(context, name, arguments, &GUIDED, &[], locals)?;
            Ok(candidates
                .map_or_else(SearchRule::default, |count| SearchRule::Guided { candidates: count as u32 }))
        }
        "hybrid_a_star" => {
            let [cell, starters, successors] =
                call_arguments::numbers_among(context, name, arguments, &HYBRID, &[], locals)?;
            Ok(SearchRule::HybridAStar {
                cell: cell.unwrap_or(0.08),
                starters: starters.unwrap_or(30.0) as u32,
                successors: successors.unwrap_or(10.0) as u32,
            })
        }
        "grid_a_star" | "as_published" => {
            let _: [_; 0] = call_arguments::numbers_among(context, name, arguments, &[], &[], locals)?;
            let is_grid = name.name == "grid_a_star";
            Ok(if is_grid { SearchRule::GridAStar } else { SearchRule::AsPublished })
        }
        _ => context.report(unknown("search", &name.name, name.span, Code::E0208, SEARCHES.into_iter())),
    }
}
