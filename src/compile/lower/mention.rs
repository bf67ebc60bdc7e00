//! Whether an expression looks at more than one state, before it is lowered.

use crate::compile::context::{
    Context, Locals,
    symbols::{Meaning, ScopeId},
    typed::Typed,
};
use crate::syntax::ast::{Expr, ExprKind, Ident};
use std::collections::BTreeSet;

/// How deep expressions are looked into; what nests deeper is refused when it is lowered.
const DEEPEST: u32 = 1000;

/// Whether the body of a quantifier looks at more than one state. Names are followed to what they stand for.
pub(crate) fn mentions_time(context: &Context<'_>, body: &Expr, locals: &Locals, variable: &Ident) -> bool {
    let hidden = vec![variable.name.as_str()];
    Search { context, followed: BTreeSet::new(), depth: 0 }
        .expr(body, &Names { locals: Some(locals), hidden, scope: locals.scope })
}

/// The names that can be said at some place.
struct Names<'n> {
    /// Those bound around the quantifier; none inside a name that was followed.
    locals: Option<&'n Locals>,
    /// Arguments and agents bound since: they never stand for a formula that is not looked at where it is given.
    hidden: Vec<&'n str>,
    scope: ScopeId,
}

struct Search<'e, 'a> {
    context: &'e Context<'a>,
    /// Names that were followed; where one of them mentions time the search is over.
    followed: BTreeSet<(ScopeId, String)>,
    depth: u32,
}

impl Search<'_, '_> {
    fn expr(&mut self, expr: &Expr, names: &Names<'_>) -> bool {
        if self.depth > DEEPEST {
            return false;
        }
        self.depth += 1;
        let found = self.kind(&expr.kind, names);
        self.depth -= 1;
        found
    }

    fn kind(&mut self, kind: &ExprKind, names: &Names<'_>) -> bool {
        match kind {
            ExprKind::Temporal(..) | ExprKind::TemporalPair(..) | ExprKind::Window(..) | ExprKind::At(..) => {
                true
            }
            ExprKind::Quantity(_)
            | ExprKind::Infinity
            | ExprKind::Broken
            | ExprKind::Bool(_)
            | ExprKind::Text(_) => false,
            ExprKind::Name(name) => self.named(name, names),
            ExprKind::Call { function, arguments } => {
                let known = self.context.look_up(&function.name, names.scope).is_some();
                (function.name == "time_until" && !known)
                    || arguments.iter().any(|argument| self.expr(argument, names))
                    || self.follow(&function.name, names.scope)
            }
            ExprKind::Member(a, _) | ExprKind::Unary(_, a) => self.expr(a, names),
            ExprKind::Index(a, b) | ExprKind::Binary(_, a, b) => self.expr(a, names) || self.expr(b, names),
            ExprKind::Point { x, y, .. } => self.expr(x, names) || self.expr(y, names),
            ExprKind::Quantified { variable, set, body, .. } => {
                let mut hidden = names.hidden.clone();
                hidden.push(&variable.name);
                self.expr(set, names) || self.expr(body, &Names { hidden, ..*names })
            }
        }
    }

    fn named(&mut self, name: &str, names: &Names<'_>) -> bool {
        if names.hidden.contains(&name) {
            return false;
        }
        let bound = names.locals.and_then(|l| l.names.iter().rev().find(|(bound, _)| bound == name));
        match bound {
            Some((_, typed)) => {
                matches!(typed.as_deref(), Some(Typed::Formula(_) | Typed::Term(..) | Typed::Tally(_)))
            }
            None => self.follow(name, names.scope),
        }
    }

    /// What a declared name stands for, with its arguments hidden.
    fn follow(&mut self, name: &str, scope: ScopeId) -> bool {
        let (scope, body, arguments) = match self.context.look_up(name, scope) {
            Some((scope, Meaning::Let(decl))) => (scope, &decl.body, decl.arguments.as_slice()),
            Some((scope, Meaning::Property(body))) => (scope, body, &[][..]),
            _ => return false,
        };
        if !self.followed.insert((scope, name.to_owned())) {
            return false;
        }
        let hidden = arguments.iter().map(|argument| argument.name.as_str()).collect();
        self.expr(body, &Names { locals: None, hidden, scope })
    }
}
