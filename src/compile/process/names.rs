//! Names of processes, read from inside and from outside: `n`, `queue.n`, `sensor[2].works`.

use super::Inside;
use crate::compile::elaborator::{Elaborator, Locals, Lowered, Reported};
use crate::compile::symbols::{Meaning, unknown};
use crate::compile::typed::Typed;
use crate::compile::wording::{Frame, Use};
use crate::model::{Bool, Comparison, Domain, Function, Num};
use crate::syntax::ast::{Expr, ExprKind, Ident, LetDecl};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::About;
use crate::syntax::source::Span;
use std::sync::Arc;

impl<'a> Elaborator<'a> {
    /// A name inside a process, if it has it.
    pub(in crate::compile) fn lower_inside(
        &mut self,
        (at, copy): (u32, u32),
        name: &str,
        span: Span,
    ) -> Option<Lowered<Typed>> {
        let process = self.processes.get(at as usize)?;
        let inside = *process.names.get(name)?;
        Some(match inside {
            Inside::Lost => Err(Reported),
            Inside::Early => self.too_early((at, "a variable of"), span),
            Inside::Variable(place) => {
                let (dimension, domain) = process.variables[place];
                let value = Num::Variable(process.variable(copy, place));
                Ok(match domain {
                    Domain::Truth => Typed::truth(Bool::Compare(
                        Comparison::Equal,
                        Box::new(value),
                        Box::new(Num::Constant(1.0)),
                    )),
                    _ => Typed::Num(value, dimension),
                })
            }
            Inside::Let(decl) if !decl.arguments.is_empty() => self
                .report(error!(E0204, span, "`{name}` is a function of {} arguments", decl.arguments.len();
                    hint: "call it inside the process: `{name}(…)`")),
            Inside::Let(LetDecl { body, .. }) | Inside::Label(body) => {
                let path = format!("{}.{name}", process.decl.name.name);
                let frame = self.label((at, copy)).map(|label| Arc::new(Frame::inside(label)));
                let locals = Locals { process: Some((at, copy)), frame, ..Locals::of(0) };
                self.expand(0, &path, span, |this| this.lower(body, &locals))
            }
        })
    }

    /// The name of a variable of real numbers from which a number is computed, if there is one and nothing rounds it.
    pub(in crate::compile) fn real_in(&self, num: &Num) -> Option<&'a str> {
        match num {
            Num::Variable(id) => self.processes.iter().find_map(|process| process.real(*id)),
            Num::Apply(Function::Floor | Function::Ceil | Function::Round | Function::ServiceLevel, _) => {
                None
            }
            Num::Apply(_, of) | Num::Fold(_, _, of) => self.real_in(of),
            Num::Combine(_, a, b) | Num::If(_, a, b) => self.real_in(a).or_else(|| self.real_in(b)),
            _ => None,
        }
    }

    /// A name of the process whose variables are being settled, if it has it: they start from nothing that it declares.
    pub(in crate::compile) fn lower_settling(
        &mut self,
        name: &str,
        span: Span,
        locals: &Locals,
    ) -> Option<Lowered<Typed>> {
        let at = locals.settling?;
        let process = self.processes.get(at as usize)?;
        let what = match process.names.get(name)? {
            Inside::Lost => return Some(Err(Reported)),
            Inside::Variable(_) | Inside::Early => "a variable of",
            Inside::Let(_) | Inside::Label(_) => "a name inside",
        };
        let label = format!("{what} `{}`, which has no value yet", process.decl.name.name);
        let error =
            error!(E0201, span, "unknown name `{name}`").label(label).about(About::Name(name.to_owned()));
        Some(self.report(error.hint("initial values cannot depend on the process")))
    }

    /// Notes that a name used inside a process is one of it.
    pub(in crate::compile) fn note_inside(&mut self, span: Span) {
        if self.temporal {
            self.uses.at.insert(span, Use::Inside);
        }
    }

    /// The name of a process or of a copy of it in texts.
    pub(in crate::compile) fn label(&self, (at, copy): (u32, u32)) -> Option<Arc<str>> {
        let process = self.processes.get(at as usize).filter(|_| self.temporal)?;
        let name = &process.decl.name.name;
        Some(if process.is_array() { format!("{name}[{}]", copy + 1).into() } else { name.as_str().into() })
    }

    fn too_early<T>(&mut self, (at, what): (u32, &str), span: Span) -> Lowered<T> {
        let name = self.processes.get(at as usize).map_or("", |process| process.decl.name.name.as_str());
        let label = format!("{what} `{name}`, which changes during a trial");
        self.report(error!(E0304, span, "the value must be known before a trial starts").label(label))
    }

    /// An error where the copies of an array of processes are not counted yet.
    pub(in crate::compile) fn counted(&mut self, process: u32, span: Span) -> Lowered<()> {
        let is_settled = self.processes.get(process as usize).is_none_or(|p| p.copies.is_some());
        if is_settled {
            return Ok(());
        }
        let text = format!("`{}` is not available here", self.text(span));
        self.report(
            error!(E0205, span, "{text}";
                hint: "numbers of copies and initial values cannot depend on processes")
            .about(About::Unsettled),
        )
    }

    /// The names of the process around the present place.
    pub(in crate::compile) fn names_inside(&self, locals: &Locals) -> Vec<String> {
        let process = locals.process.and_then(|(at, _)| self.processes.get(at as usize));
        process.into_iter().flat_map(|p| p.names.keys().map(|name| (*name).to_owned())).collect()
    }

    /// The path of a name that a process declares.
    pub(in crate::compile) fn inside_path(&self, at: u32, name: &str) -> Option<String> {
        let process = self.processes.get(at as usize)?;
        Some(format!("{}.{name}", process.decl.name.name))
    }

    /// Whether some process declares a name.
    pub(in crate::compile) fn is_of_processes(&self, name: &str) -> bool {
        self.processes.iter().any(|process| process.names.contains_key(name))
    }

    /// The name of a variable outside its process: with the process.
    pub(in crate::compile) fn paths_of(&self, name: &str) -> Vec<String> {
        let having = self.processes.iter().filter(|process| process.names.contains_key(name));
        let path = |process: &super::Declared<'_>| {
            let copy = if process.is_array() { "[1]" } else { "" };
            format!("`{}{copy}.{name}`", process.decl.name.name)
        };
        having.map(path).take(3).collect()
    }

    /// A function declared inside the process around the present place.
    pub(in crate::compile) fn function_inside(&self, name: &str, locals: &Locals) -> Option<&'a LetDecl> {
        let (at, _) = locals.process?;
        match self.processes.get(at as usize)?.names.get(name)? {
            Inside::Let(decl) if !decl.arguments.is_empty() => Some(decl),
            _ => None,
        }
    }

    /// `queue.n`, `sensor[2].works`, and the components of a vector.
    pub(in crate::compile) fn lower_member(
        &mut self,
        base: &Expr,
        member: &Ident,
        locals: &Locals,
    ) -> Lowered<Typed> {
        let lowered = self.lower(base, locals);
        let Ok(lowered) = lowered else {
            return self.member_of_anybody(base, member, locals);
        };
        let (at, copy) = match lowered {
            Typed::Process { process, copy } => (process, copy),
            Typed::Agent(who) => return self.lower_mode(who, base.span, member),
            Typed::Processes(_) => {
                return self
                    .report(error!(E0305, base.span, "expected a process, found an array of processes";
                    hint: "choose one: `{}[1].{}`", self.text(base.span), member.name));
            }
            Typed::Vector(x, y, dimension) if matches!(member.name.as_str(), "x" | "y") => {
                return Ok(Typed::Num(if member.name == "x" { x } else { y }, dimension));
            }
            Typed::Point(x, y) if matches!(member.name.as_str(), "x" | "y") => {
                return Ok(Typed::Number(if member.name == "x" { x } else { y }));
            }
            found => {
                let name = &member.name;
                let said = format!("expected a process before `.{name}`, found {}", found.noun());
                let is_behaviour = matches!(self.find(name, 0), Some((_, Meaning::Behaviour(_))));
                let hint = match (&found, is_behaviour) {
                    (Typed::Agents { .. }, true) => {
                        let people = self.text(base.span);
                        format!("choose one agent, or count: `count(a in {people}: a.{name} == …) > 0`")
                    }
                    _ => "the values of agents are functions: `speed(user)`".to_owned(),
                };
                return self.report(error!(E0305, base.span, "{said}"; hint: "{hint}"));
            }
        };
        match self.lower_inside((at, copy), &member.name, member.span) {
            Some(lowered) => lowered,
            None => {
                let known: Vec<&str> = self.processes[at as usize].names.keys().copied().collect();
                let what = format!("name of `{}`", self.processes[at as usize].decl.name.name);
                let error = unknown(&what, &member.name, member.span, Code::E0201, known.into_iter());
                self.report(error)
            }
        }
    }

    /// A member of an argument of a function: nothing is known about the argument except that a member of this name exists.
    fn member_of_anybody(&mut self, base: &Expr, member: &Ident, locals: &Locals) -> Lowered<Typed> {
        let ExprKind::Name(name) = &base.kind else { return Err(Reported) };
        let bound = locals.names.iter().rev().find(|(bound, _)| bound == name);
        if !matches!(bound, Some((_, None))) {
            return Err(Reported);
        }
        let of_processes = self.processes.iter().flat_map(|process| process.names.keys().copied());
        let of_people = self.behaviours.iter().map(|decl| decl.name.name.as_str());
        let known: Vec<&str> = of_processes.chain(of_people).chain(["x", "y"]).collect();
        if known.contains(&member.name.as_str()) {
            return Err(Reported);
        }
        let error = unknown("name", &member.name, member.span, Code::E0201, known.into_iter());
        self.report(match &error.hint {
            Some(_) => error,
            None => error.hint("the values of agents are functions: `speed(user)`"),
        })
    }

    /// All copies of an array of processes.
    pub(in crate::compile) fn copies(&self, process: u32) -> impl Iterator<Item = Typed> + use<> {
        let count = self.processes.get(process as usize).and_then(|p| p.copies).unwrap_or(1);
        (0..count).map(move |copy| Typed::Process { process, copy })
    }
}
