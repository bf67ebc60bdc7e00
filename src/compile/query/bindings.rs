//! The worlds that queries set up with `under`: their values, and these in words.

use crate::compile::context::{Locals, Lowered, Reported, number::Number, symbols::ScopeId};
use crate::compile::query::{
    compiler::{Compiler, Site},
    settings,
};
use crate::syntax::ast::Binding;
use crate::syntax::source::Span;
use std::collections::BTreeMap;

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
