//! The worlds that queries set up with `under`: their values, and these in words.

use crate::compile::context::{
    Context, Locals, Lowered, Reported,
    number::Number,
    symbols::{Param, ScopeId},
};
use crate::compile::query::{
    compiler::{Compiler, Site},
    settings,
};
use crate::syntax::ast::property::Every;
use crate::syntax::ast::{Binding, Expr, ExprKind, Query, QueryKind, Ranked, Values};
use crate::syntax::source::Span;
use std::collections::BTreeMap;

/// Most values of `under every`.
const MOST_VALUES: usize = 20;

/// The world in which some parameters take other values, and these in words.
pub(crate) fn under(
    compiler: &mut Compiler<'_>,
    bindings: &[Binding],
    scope: ScopeId,
    base: usize,
    point: &BTreeMap<String, Number>,
) -> Lowered<(usize, Vec<(String, String)>)> {
    let mut settings = point.clone();
    let mut failed = false;
    for binding in bindings {
        let context = &mut compiler.sites[base].context;
        if let Some(first) = bindings.iter().find(|b| b.name.name == binding.name.name)
            && first.name.span != binding.name.span
        {
            let text = format!("`{}` is set twice", binding.name.name);
            let error = error!(E0210, binding.name.span, "{text}");
            context.note(error.related(first.name.span, "first set here"));
            failed = true;
            continue;
        }
        if settings::param(context, &binding.name.name, binding.name.span).is_err() {
            let _ = context.number(&binding.value, &Locals::of(scope));
            failed = true;
            continue;
        }
        match settings::setting(context, &binding.name.name, &binding.value, &Locals::of(scope)) {
            Ok(number) => {
                settings.insert(binding.name.name.clone(), number);
            }
            Err(_) => failed = true,
        }
    }
    if failed {
        return Err(Reported);
    }
    let names: Vec<&str> = bindings.iter().map(|b| b.name.name.as_str()).collect();
    let described = compiler.described(base, &settings, &names);
    let site = compiler.site(settings);
    // What was set elsewhere, too, has to lie in a range that is set here.
    let own = |name: &str| bindings.iter().find(|binding| binding.name.name == name).or(bindings.last());
    let settings = compiler.sites[site].settings.keys();
    let place = |name: &String| own(name).map(|binding| (binding.value.span, binding.value.span));
    let set: Vec<_> = settings.filter_map(|name| Some((name.clone(), place(name)?))).collect();
    check_ranges(compiler, site, set)?;
    Ok((site, described))
}

/// Whether the set values are in ranges that depend on other parameters. In a world where they are not, only that
/// and the errors of all worlds are reported.
pub(crate) fn check_ranges(
    compiler: &mut Compiler<'_>,
    site: usize,
    set: Vec<(String, (Span, Span))>,
) -> Lowered<()> {
    let Site { settings, context, .. } = &mut compiler.sites[site];
    // Errors of these values are reported at each place where they are set.
    let was_astray = std::mem::replace(&mut context.sink.is_astray, false);
    let before = context.sink.diagnostics.len();
    let mut result = Ok(());
    for (name, at) in set {
        let Some(number) = settings.get(&name) else { continue };
        result = result.and(settings::in_range(context, (&name, *number), at));
    }
    // Of a range that is wrong itself that is said where it is declared.
    let is_outside = context.sink.diagnostics.len() > before;
    if is_outside && !was_astray {
        let said = context.sink.diagnostics.split_off(before);
        context.keep_sure(0);
        context.sink.diagnostics.extend(said);
    }
    context.sink.is_astray = was_astray || is_outside;
    result
}

/// A world of a query, and what the query sets in it, in words.
type Asked = (usize, Vec<(String, String)>);

/// The worlds of a query: one, or one for each value of `under every`.
pub(crate) fn worlds(
    compiler: &mut Compiler<'_>,
    query: &Query,
    scope: ScopeId,
    base: usize,
    point: &BTreeMap<String, Number>,
) -> Lowered<Vec<Asked>> {
    let bindings = &query.clauses.under;
    let Some(every) = &query.clauses.every else {
        return under(compiler, bindings, scope, base, point).map(|world| vec![world]);
    };
    let context = &mut compiler.sites[base].context;
    let values = values_of(context, query, every)?;
    let each = values.into_iter().map(|value| {
        let own = Binding { name: every.name.clone(), value };
        let all: Vec<Binding> = bindings.iter().cloned().chain([own]).collect();
        under(compiler, &all, scope, base, point)
    });
    let each: Vec<_> = each.collect();
    each.into_iter().collect()
}

/// The values of `under every`: those that are written, or those from which the parameter chooses.
fn values_of(context: &mut Context<'_>, query: &Query, every: &Every) -> Lowered<Vec<Expr>> {
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
    if let QueryKind::Rank { of: Ranked::Values(list), .. } = &query.kind
        && list.iter().any(|(ranked, _)| ranked.name == *name)
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
            let values = Values::List(values.clone());
            settings::values(context, (name, every.name.span), &values, MOST_VALUES, &Locals::of(0))?;
            return Ok(match values {
                Values::List(list) => list,
                Values::Range { .. } => Vec::new(),
            });
        }
    };
    context.report(error)
}
