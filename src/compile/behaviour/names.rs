//! States of behaviours in expressions: `user.phone == looking`.

use super::{lets, states};
use crate::compile::elaborator::{Elaborator, Locals, Lowered, Reported};
use crate::compile::lower::counted_arguments;
use crate::compile::symbols::unknown;
use crate::compile::typed::Typed;
use crate::model::{BehaviourId, Bool, BuiltIn, Comparison, Field, Num, Who};
use crate::syntax::ast::process::BehaviourDecl;
use crate::syntax::ast::{Expr, ExprKind, Ident, LetDecl};
use crate::syntax::codes::Code;
use crate::syntax::source::Span;

impl<'a> Elaborator<'a> {
    /// A name or function that the behaviour around the present place declares, what it sees, and its path.
    fn inside_behaviour(&self, name: &str, locals: &Locals) -> Option<(&'a LetDecl, Locals, String)> {
        let (at, seen) = locals.behaviour?;
        let decl: &'a BehaviourDecl = self.behaviours.get(at as usize)?;
        let found = lets(decl).find(|found| found.name.name == name)?;
        let names = locals.names.get(..seen)?.to_vec();
        let inner = Locals { names, running: locals.running, behaviour: locals.behaviour, ..Locals::of(0) };
        Some((found, inner, format!("{}.{name}", decl.name.name)))
    }

    /// Whether the process or behaviour around the present place declares a name.
    pub(in crate::compile) fn is_inside(&self, name: &str, locals: &Locals) -> bool {
        self.names_inside(locals).iter().any(|inside| inside == name)
            || self.inside_behaviour(name, locals).is_some()
    }

    /// Whether what the process or behaviour around the present place declares by a name has no arguments.
    pub(in crate::compile) fn is_without_arguments(&self, name: &str, locals: &Locals) -> bool {
        match self.inside_behaviour(name, locals) {
            Some((decl, ..)) => decl.arguments.is_empty(),
            None => self.function_inside(name, locals).is_none(),
        }
    }

    /// A name inside a behaviour, if it has it.
    pub(in crate::compile) fn lower_inside_behaviour(
        &mut self,
        name: &str,
        span: Span,
        locals: &Locals,
    ) -> Option<Lowered<Typed>> {
        let (decl, inner, path) = self.inside_behaviour(name, locals)?;
        if !decl.arguments.is_empty() {
            let text = format!("`{name}` is a function of {}", counted_arguments(decl.arguments.len()));
            let error = error!(E0204, span, "{text}"; hint: "call it: `{name}(…)`");
            return Some(self.report(error));
        }
        Some(self.expand(0, &path, span, |this| this.lower(&decl.body, &inner)))
    }

    /// A call of a function inside a behaviour, if it has it.
    pub(in crate::compile) fn call_inside_behaviour(
        &mut self,
        function: &Ident,
        span: Span,
        arguments: &[Expr],
        locals: &Locals,
    ) -> Option<Lowered<Typed>> {
        let (decl, inner, path) = self.inside_behaviour(&function.name, locals)?;
        (!decl.arguments.is_empty())
            .then(|| self.lower_function(decl, (inner, path), span, arguments, locals))
    }

    /// `user.phone`: to be compared with a state.
    pub(in crate::compile) fn lower_mode(&mut self, who: Who, base: Span, member: &Ident) -> Lowered<Typed> {
        let Some(at) = self.behaviours.iter().position(|decl| decl.name.name == member.name) else {
            let known: Vec<&str> = self.behaviours.iter().map(|decl| decl.name.name.as_str()).collect();
            let error = unknown("behaviour", &member.name, member.span, Code::E0201, known.into_iter());
            let error = match &error.hint {
                Some(_) => error,
                None => {
                    let who = self.text(base);
                    error.hint(match member.name.as_str() {
                        name @ ("x" | "y") => format!("write `{name}(position({who}))`"),
                        name if BuiltIn::find(name).is_some() => format!("write `{name}({who})`"),
                        _ => "the values of agents are functions: `speed(user)`".to_owned(),
                    })
                }
            };
            return self.report(error);
        };
        let behaviour = BehaviourId(at as u32);
        if let Who::Agent(agent) = who
            && !self.has_behaviour(agent, behaviour)
        {
            // The behaviour that it has instead is unknown.
            if self.strayed.contains(&agent) {
                return Err(Reported);
            }
            let text = format!("`{}` has no behaviour `{}`", self.text(base), member.name);
            return self.report(error!(E0201, member.span, "{text}";
                hint: "attach it: `agent … : … with {}`", member.name));
        }
        Ok(Typed::Mode { behaviour, who })
    }

    /// `user.phone == looking`, `!=`; `None` where the left side is no behaviour.
    pub(in crate::compile) fn lower_mode_comparison(
        &mut self,
        comparison: Comparison,
        left: &Expr,
        right: &Expr,
        locals: &Locals,
    ) -> Option<Lowered<Typed>> {
        let ExprKind::Member(_, member) = &left.kind else { return None };
        let decl = self.behaviours.iter().find(|decl| decl.name.name == member.name).copied()?;
        let (behaviour, who) = match self.lower(left, locals) {
            Ok(Typed::Mode { behaviour, who }) => (behaviour, who),
            Ok(_) => return None,
            // Whoever has it, its states are known; but a process may have a variable of that name.
            Err(reported) => {
                if !self.is_of_processes(&member.name) {
                    let _ = self.state_of(decl, right);
                }
                return Some(Err(reported));
            }
        };
        let at = match self.state_of(decl, right) {
            Ok(at) => at,
            Err(reported) => return Some(Err(reported)),
        };
        let number = Box::new(Num::Of(Field::Mode(behaviour), who));
        Some(Ok(Typed::truth(Bool::Compare(comparison, number, Box::new(Num::Constant(at as f64))))))
    }

    /// Which state of a behaviour is named.
    fn state_of(&mut self, decl: &BehaviourDecl, named: &Expr) -> Lowered<usize> {
        let (behaviour, states) = (&decl.name.name, states(decl).map(|state| state.name.name.as_str()));
        let names: Vec<&str> = states.collect();
        let ExprKind::Name(wanted) = &named.kind else {
            return self.report(error!(E0305, named.span, "expected the name of a state";
                hint: "the states of `{behaviour}` are {}", names.join(", ")));
        };
        if let Some(at) = names.iter().position(|name| name == wanted) {
            return Ok(at);
        }
        let what = format!("state of `{behaviour}`");
        let error = unknown(&what, wanted, named.span, Code::E0201, names.iter().copied());
        self.report(match &error.hint {
            Some(_) => error,
            None => error.hint(format!("the states are {}", names.join(", "))),
        })
    }
}
