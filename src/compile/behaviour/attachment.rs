//! Who has which behaviours: `with phone, heedful(0.8)`.

use crate::compile::context::{
    Context,
    conducts::With,
    symbols::{Meaning, unknown},
};
use crate::model::{AgentId, BehaviourId};
use crate::syntax::ast::{Expr, ExprKind, Ident};
use crate::syntax::codes::Code;

/// The behaviours that a declaration names after `with`. Errors are noted.
pub(crate) fn with<'a>(context: &mut Context<'a>, name: &Ident, with: &'a [Expr]) -> With<'a> {
    let mut behaviours: Vec<(BehaviourId, &'a [Expr], &'a Expr)> = Vec::new();
    let mut strays = false;
    for expr in with {
        let (called, arguments): (&str, &'a [Expr]) = match &expr.kind {
            ExprKind::Name(called) => (called, &[]),
            ExprKind::Call { function, arguments } => (&function.name, arguments),
            _ => {
                context.note(error!(E0305, expr.span, "expected a behaviour";
                        hint: "for example `with phone, heedful(0.8)`"));
                strays = true;
                continue;
            }
        };
        let id = match context.look_up(called, 0) {
            Some((_, Meaning::Behaviour(id))) => id,
            Some((_, other)) => {
                if !matches!(other, Meaning::Doubtful) {
                    let text = format!("expected a behaviour, but `{called}` is {}", other.noun());
                    context.note(error!(E0206, expr.span, "{text}"));
                }
                context.conducts.stray.push(arguments);
                strays = true;
                continue;
            }
            None => {
                let known: Vec<&str> =
                    context.conducts.behaviours.iter().map(|decl| decl.name.name.as_str()).collect();
                let error = unknown("behaviour", called, expr.span, Code::E0201, known.into_iter());
                context.note(error);
                context.conducts.stray.push(arguments);
                strays = true;
                continue;
            }
        };
        if let Some((.., first)) = behaviours.iter().find(|(known, ..)| *known == id) {
            let error = error!(E0912, expr.span, "`{}` already has the behaviour `{called}`", name.name)
                .related(first.span, "first attached here");
            context.note(error);
            context.conducts.stray.push(arguments);
            continue;
        }
        behaviours.push((id, arguments, expr));
    }
    With { behaviours, name: name.name.clone(), members: Vec::new(), strays, most: 0 }
}

/// Gives behaviours to the members of a declaration.
pub(crate) fn attach<'a>(context: &mut Context<'a>, mut with: With<'a>, members: &[AgentId]) {
    with.members = members.to_vec();
    if with.strays {
        context.conducts.strayed.extend(members);
    }
    for (behaviour, ..) in &with.behaviours {
        context.conducts.having.extend(members.iter().map(|member| (*member, *behaviour)));
    }
    context.conducts.withs.push(with);
}
