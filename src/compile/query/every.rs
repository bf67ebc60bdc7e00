//! `under every`: the worlds of a query, one for each value of a parameter, and the query in all of them.

use crate::compile::context::{
    Context, Locals, Lowered,
    number::Number,
    symbols::{Param, ScopeId},
};
use crate::compile::query::{bindings, compiler::Compiler, rankings, settings};
use crate::compile::study;
use crate::syntax::ast::property::Every;
use crate::syntax::ast::{self, Binding, Expr, ExprKind, QueryKind, Values};
use std::collections::BTreeMap;

/// Most values of `under every`.
const MOST_VALUES: usize = 20;

/// A world of a query, and what the query sets in it, in words.
type Asked = (usize, Vec<(String, String)>);

/// The worlds of a query: one, or one for each value of `under every`.
pub(crate) fn worlds(
    compiler: &mut Compiler<'_>,
    query: &ast::Query,
    scope: ScopeId,
    base: usize,
    point: &BTreeMap<String, Number>,
) -> Lowered<Vec<Asked>> {
    let own = &query.clauses.under;
    let Some(every) = &query.clauses.every else {
        return bindings::under(compiler, own, scope, base, point).map(|world| vec![world]);
    };
    let context = &mut compiler.sites[base].context;
    let values = values_of(context, query, every)?;
    let each = values.into_iter().map(|value| {
        let one = Binding { name: every.name.clone(), value };
        let all: Vec<Binding> = own.iter().cloned().chain([one]).collect();
        bindings::under(compiler, &all, scope, base, point)
    });
    let each: Vec<_> = each.collect();
    each.into_iter().collect()
}

/// The values of `under every`: those that are written, or those from which the parameter chooses.
fn values_of(context: &mut Context<'_>, query: &ast::Query, every: &Every) -> Lowered<Vec<Expr>> {
    let name = &every.name.name;
    if !matches!(query.kind, QueryKind::Check { .. } | QueryKind::Rank { .. }) {
        return context.report(error!(E0608, every.span, "`under every` belongs to `check` and `rank`";
            hint: "for the values of a query set `{name}` by `--set`, or ask one query for each"));
    }
    if let (QueryKind::Rank { .. }, Some(method)) = (&query.kind, &query.clauses.by) {
        return context
            .report(error!(E0608, method.span, "a ranking under every value has its own procedure";
            hint: "leave `by {}` out", method.name.name));
    }
    if let QueryKind::Rank { subject, .. } = &query.kind
        && let Some(first) = subject.first()
    {
        return context
            .report(error!(E0608, first.measure.span, "a ranking under every value has no constraints";
            hint: "ask one ranking for each value: `under {name} = …`"));
    }
    if let QueryKind::Rank { of, .. } = &query.kind
        && of.values.iter().any(|(ranked, _)| ranked.name == *name)
    {
        return context
            .report(error!(E0210, every.name.span, "`{name}` is set twice"; hint: "rank another parameter"));
    }
    let Param { choices, .. } = settings::param(context, name, every.name.span)?;
    let values = match &every.values {
        Some(values) => values.clone(),
        None if choices.is_empty() => {
            return context.report(error!(E0608, every.name.span, "`{name}` has no list of values";
                hint: "write the values: `under every {name} in …, …`"));
        }
        // Errors of a value are those of the clause.
        None => choices
            .iter()
            .map(|choice| Expr { kind: ExprKind::Name(choice.name.clone()), span: every.name.span })
            .collect(),
    };
    let error = match values.len() {
        0 | 1 => error!(E0608, every.span, "`under every` needs two values at least";
            hint: "for one value write `under {name} = …`"),
        n if n > MOST_VALUES => {
            error!(E0608, every.span, "`under every` takes at most {MOST_VALUES} values (got {n})";
                hint: "leave some out")
        }
        _ => {
            let list = Values::List(values.clone());
            settings::values(context, (name, every.name.span), &list, MOST_VALUES, &Locals::of(0))?;
            return Ok(values);
        }
    };
    context.report(error)
}

/// A query in each of its worlds: one, or those of `under every`.
pub(crate) fn ask<'a>(
    compiler: &mut Compiler<'a>,
    query: &'a ast::Query,
    scope: ScopeId,
    worlds: Vec<Asked>,
    settings: &[(String, String)],
    family: Option<f64>,
) -> Lowered<()> {
    let Some(every) = &query.clauses.every else {
        return worlds
            .into_iter()
            .try_for_each(|world| compiler.ask(query, scope, world, settings, (family, 1)));
    };
    let (index, claims) = (compiler.next_index, worlds.len());
    let value = |(_, own): &Asked| {
        own.iter().find(|(name, _)| *name == every.name.name).map(|(_, value)| value.clone())
    };
    let values: Vec<String> = worlds.iter().filter_map(value).collect();
    let is_ranking = matches!(query.kind, QueryKind::Rank { .. });
    // A ranking has one certificate, whose error its options share already.
    let claims = if is_ranking { 1 } else { claims };
    // A family counts the query as one claim.
    let family = family.map(|share| share / claims as f64);
    // Each part is asked, whatever another one asks.
    let known = std::mem::take(&mut compiler.queries);
    let (mut parts, mut asked) = (Vec::new(), Ok(()));
    for world in worlds {
        compiler.next_index = index;
        asked = compiler.ask(query, scope, world, settings, (family, claims)).and(asked);
        parts.append(&mut compiler.queries);
    }
    compiler.queries = known;
    asked?;
    for (place, part) in parts.iter_mut().enumerate() {
        part.every = Some(study::Every { name: every.name.name.clone(), values: values.clone(), place });
    }
    if is_ranking {
        parts = Vec::from_iter(rankings::joined(parts));
    }
    let is_known = |part: &study::Query| {
        compiler.queries.iter().any(|known| known.index == part.index && known.ask == part.ask)
    };
    if !parts.iter().all(is_known) {
        compiler.queries.extend(parts);
    }
    Ok(())
}
