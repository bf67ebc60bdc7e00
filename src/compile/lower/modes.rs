//! States of behaviours in expressions: `user.phone == looking`.

use crate::compile::context::{
    Context, Locals, Lowered, Reported,
    conducts::{lets, states},
    symbols::unknown,
    typed::Typed,
};
use crate::compile::lower::process_names;
use crate::model::{BehaviourId, Bool, BuiltIn, Comparison, Field, Num, Who};
use crate::syntax::ast::BinaryOp;
use crate::syntax::ast::process::BehaviourDecl;
use crate::syntax::ast::{Expr, ExprKind, Ident, LetDecl};
use crate::syntax::codes::Code;
use crate::syntax::source::Span;

/// A name or function that the behaviour around the present place declares, what it sees, and its path.
pub(crate) fn inside_behaviour<'a>(
    context: &Context<'a>,
    name: &str,
    locals: &Locals,
) -> Option<(&'a LetDecl, Locals, String)> {
    let (at, seen) = locals.behaviour?;
    let decl: &'a BehaviourDecl = context.conducts.behaviours.get(at as usize)?;
    let found = lets(decl).find(|found| found.name.name == name)?;
    let names = locals.names.get(..seen)?.to_vec();
    let inner = Locals { names, running: locals.running, behaviour: locals.behaviour, ..Locals::of(0) };
    Some((found, inner, format!("{}.{name}", decl.name.name)))
}

/// Whether the process or behaviour around the present place declares a name.
pub(crate) fn is_inside(context: &Context<'_>, name: &str, locals: &Locals) -> bool {
    process_names::names_inside(context, locals).iter().any(|inside| inside == name)
        || inside_behaviour(context, name, locals).is_some()
}

/// Whether what the process or behaviour around the present place declares by a name has no arguments.
pub(crate) fn is_without_arguments(context: &Context<'_>, name: &str, locals: &Locals) -> bool {
    match inside_behaviour(context, name, locals) {
        Some((decl, ..)) => decl.arguments.is_empty(),
        None => process_names::function_inside(context, name, locals).is_none(),
    }
}

/// `user.phone`: to be compared with a state.
pub(crate) fn lower_mode(context: &mut Context<'_>, who: Who, base: Span, member: &Ident) -> Lowered<Typed> {
    let Some(at) = context.conducts.behaviours.iter().position(|decl| decl.name.name == member.name) else {
        let known: Vec<&str> =
            context.conducts.behaviours.iter().map(|decl| decl.name.name.as_str()).collect();
        let error = unknown("behaviour", &member.name, member.span, Code::E0201, known.into_iter());
        let error = match &error.hint {
            Some(_) => error,
            None => {
                let who = context.text(base);
                error.hint(match member.name.as_str() {
                    name @ ("x" | "y") => format!("write `{name}(position({who}))`"),
                    name if BuiltIn::find(name).is_some() => format!("write `{name}({who})`"),
                    _ => "the values of agents are functions: `speed(user)`".to_owned(),
                })
            }
        };
        return context.report(error);
    };
    let behaviour = BehaviourId(at as u32);
    if let Who::Agent(agent) = who
        && !context.conducts.has(agent, behaviour)
    {
        // The behaviour that it has instead is unknown.
        if context.conducts.strayed.contains(&agent) {
            return Err(Reported);
        }
        let text = format!("`{}` has no behaviour `{}`", context.text(base), member.name);
        return context.report(error!(E0201, member.span, "{text}";
                hint: "attach it: `agent … : … with {}`", member.name));
    }
    Ok(Typed::Mode { behaviour, who })
}

/// The behaviour whose state is compared: `user.phone == looking`, `!=`.
pub(crate) fn compared<'a>(context: &Context<'a>, op: BinaryOp, left: &Expr) -> Option<&'a BehaviourDecl> {
    let ExprKind::Member(_, member) = &left.kind else { return None };
    let is_equality = matches!(op, BinaryOp::Equal | BinaryOp::Unequal);
    let mut all = context.conducts.behaviours.iter();
    all.find(|decl| decl.name.name == member.name).copied().filter(|_| is_equality)
}

/// Whether somebody's behaviour is in a state, or not; `None` where the left side turned out to be no behaviour.
pub(crate) fn is_in_state(
    context: &mut Context<'_>,
    op: BinaryOp,
    decl: &BehaviourDecl,
    left: &Lowered<Typed>,
    right: &Expr,
) -> Option<Lowered<Typed>> {
    let (behaviour, who) = match *left {
        Ok(Typed::Mode { behaviour, who }) => (behaviour, who),
        Ok(_) => return None,
        // Whoever has it, its states are known; but a process may have a variable of that name.
        Err(reported) => {
            if !process_names::is_of_processes(context, &decl.name.name) {
                let _ = state_of(context, decl, right);
            }
            return Some(Err(reported));
        }
    };
    let comparison = if op == BinaryOp::Equal { Comparison::Equal } else { Comparison::Unequal };
    let at = match state_of(context, decl, right) {
        Ok(at) => at,
        Err(reported) => return Some(Err(reported)),
    };
    let number = Box::new(Num::Of(Field::Mode(behaviour), who));
    Some(Ok(Typed::truth(Bool::Compare(comparison, number, Box::new(Num::Constant(at as f64))))))
}

/// Which state of a behaviour is named.
fn state_of(context: &mut Context<'_>, decl: &BehaviourDecl, named: &Expr) -> Lowered<usize> {
    let (behaviour, states) = (&decl.name.name, states(decl).map(|state| state.name.name.as_str()));
    let names: Vec<&str> = states.collect();
    let ExprKind::Name(wanted) = &named.kind else {
        return context.report(error!(E0305, named.span, "expected the name of a state";
                hint: "the states of `{behaviour}` are {}", names.join(", ")));
    };
    if let Some(at) = names.iter().position(|name| name == wanted) {
        return Ok(at);
    }
    let what = format!("state of `{behaviour}`");
    let error = unknown(&what, wanted, named.span, Code::E0201, names.iter().copied());
    context.report(match &error.hint {
        Some(_) => error,
        None => error.hint(format!("the states are {}", names.join(", "))),
    })
}
