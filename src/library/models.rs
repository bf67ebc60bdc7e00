//! `--models smc1,cfs2`: the same files with people of each of several models.
//!
//! Every kind that starts from a preset takes its preset from a parameter instead. Each check and each ranking is asked
//! under every value of this parameter, and all other queries are swept over it.

use crate::compile::Setting;
use crate::compile::presets::PRESETS;
use crate::syntax::ast::property::Every;
use crate::syntax::ast::{
    Expr, ExprKind, Ident, Item, PropertyFile, PropertyItem, QueryKind, ScenarioFile, Values,
};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::source::Span;

/// The parameter, where the scenario has none that chooses a preset.
const PARAMETER: &str = "model";

/// Changes the files; returns the sweep, if the call sets nothing else.
///
/// # Errors
/// Where a name is no preset, fewer than two are there or one is there twice, or where no kind starts from a preset.
pub(super) fn under(
    (models, span): (&[String], Span),
    scenario: &mut ScenarioFile,
    properties: &mut [PropertyFile],
) -> Result<Setting, Diagnostic> {
    let error = |said: String| Diagnostic::error(Code::E0705, span, said);
    let presets: Vec<&str> = PRESETS.iter().map(|preset| preset.name).collect();
    if let Some(name) = models.iter().find(|name| !presets.contains(&name.as_str())) {
        let error = error(format!("there is no preset `{name}`"));
        return Err(error.hint(format!("the presets are {}", presets.join(", "))));
    }
    if let Some(name) = models.iter().find(|name| models.iter().filter(|other| other == name).count() > 1) {
        return Err(error(format!("`{name}` is listed twice")).hint("remove one of them"));
    }
    if models.len() < 2 {
        return Err(error("`--models` needs two presets at least".into()).hint("write `--models smc1,cfs2`"));
    }
    let ident = |name: &str| Ident { name: name.to_owned(), span };
    let value = |name: &str| Expr { kind: ExprKind::Name(name.to_owned()), span };
    let choices: Vec<Ident> = models.iter().map(|name| ident(name)).collect();
    let mut chosen = None;
    for item in &mut scenario.items {
        if let Item::Param { name, value: default, choices: own, .. } = item
            && !own.is_empty()
        {
            *default = value(&models[0]);
            own.clone_from(&choices);
            chosen = chosen.or_else(|| Some(name.name.clone()));
        }
    }
    let name = chosen.clone().unwrap_or_else(|| PARAMETER.to_owned());
    let mut is_used = chosen.is_some();
    for item in &mut scenario.items {
        let Item::Kind(kind) = item else { continue };
        kind.is_replaced = true;
        if let Some(preset) = kind.preset.as_mut().filter(|preset| presets.contains(&preset.name.as_str())) {
            preset.name.clone_from(&name);
            kind.base = None;
            is_used = true;
        }
    }
    if !is_used {
        return Err(error("no kind starts from a preset of people".into())
            .hint("start a kind from one: `kind adult: preset smc1`"));
    }
    if chosen.is_none() {
        let parameter = Item::Param { name: ident(&name), value: value(&models[0]), range: None, choices };
        scenario.items.insert(0, parameter);
    }
    for item in properties.iter_mut().flat_map(|file| &mut file.items) {
        let PropertyItem::Query(query) = item else { continue };
        let is_asked = match &query.kind {
            QueryKind::Check { .. } => true,
            // With a procedure that is named there is a choice for each.
            QueryKind::Rank { subject, .. } => query.clauses.by.is_none() && subject.is_empty(),
            QueryKind::Estimate(_)
            | QueryKind::Compare { .. }
            | QueryKind::Curve { .. }
            | QueryKind::Pareto { .. } => false,
        };
        if is_asked && query.clauses.every.is_none() && !query.sets(&name) {
            query.clauses.every = Some(Every { name: ident(&name), values: None, span });
        }
    }
    Ok(Setting { name, span, values: Values::List(models.iter().map(|name| value(name)).collect()) })
}
