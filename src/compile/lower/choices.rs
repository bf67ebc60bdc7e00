//! Parameters that choose from a list of names: `param people = smc1 in smc1, cfs2`. The value of one is the place of a name
//! in its list.

use crate::compile::context::symbols::{Meaning, Param};
use crate::compile::context::{Context, Lowered, number::Number};
use crate::compile::nearest::nearest;
use crate::syntax::ast::{Expr, ExprKind, Ident};
use crate::syntax::source::Span;

/// Checks the list of a choice and its default.
pub(crate) fn check(context: &mut Context<'_>, name: &Ident, default: &Expr, choices: &[Ident]) {
    let name = &name.name;
    for (k, choice) in choices.iter().enumerate() {
        if let Some(first) = choices[..k].iter().find(|first| first.name == choice.name) {
            let error =
                error!(E0213, choice.span, "`{}` is listed twice", choice.name; hint: "remove one of them");
            context.note(error.related(first.span, "first listed here"));
        }
    }
    if let [only] = choices {
        context.note(error!(E0213, only.span, "a choice from one name is none";
            hint: "list two names at least: `param {name} = {0} in {0}, …`", only.name));
    } else {
        // That it is in the list is said where it is not.
        let _ = place(context, name, default, choices);
    }
}

/// The value of a choice that is set to a name.
pub(crate) fn place(
    context: &mut Context<'_>,
    name: &str,
    value: &Expr,
    choices: &[Ident],
) -> Lowered<Number> {
    let names = || choices.iter().map(|choice| choice.name.as_str());
    let chosen = if let ExprKind::Name(chosen) = &value.kind { Some(chosen.as_str()) } else { None };
    if let Some(at) = chosen.and_then(|chosen| names().position(|known| known == chosen)) {
        return Ok(Number::whole(at as i64));
    }
    let list: Vec<String> = names().map(|known| format!("`{known}`")).collect();
    let error = error!(E0213, value.span, "`{name}` is one of {}", list.join(", ")).formal().knowing(names());
    context.report(match chosen.and_then(|chosen| nearest(chosen, names())) {
        Some(near) => error.hint(format!("did you mean `{near}`?")),
        None => error,
    })
}

/// The name that a choice has in this world, if the parameter of this name is a choice: that of the list.
pub(crate) fn chosen<'a>(context: &mut Context<'a>, name: &Ident) -> Option<(&'a Ident, &'a [Ident])> {
    let (_, Meaning::Param(Param { value, choices, .. })) = context.look_up(&name.name, 0)? else {
        return None;
    };
    let set = context.names.settings.get(&name.name).and_then(|number| number.as_whole());
    let default = || match &value.kind {
        ExprKind::Name(default) => choices.iter().position(|choice| choice.name == *default),
        _ => None,
    };
    let at = set.and_then(|at| usize::try_from(at).ok()).or_else(default).unwrap_or(0);
    Some((choices.get(at)?, choices))
}

/// An error for each choice that nothing uses; `used` holds the names of parameters that kinds choose by.
pub(crate) fn check_used(context: &mut Context<'_>, declared: &[(&Ident, Span)], used: &[String]) {
    for (name, at) in declared {
        if !used.contains(&name.name) {
            let said = format!("nothing uses the choice `{}`", name.name);
            context.note(error!(E0213, *at, "{said}";
                hint: "use it in a kind: `kind adult: preset {}`", name.name));
        }
    }
}
