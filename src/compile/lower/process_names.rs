//! Names of processes, read from inside and from outside: `n`, `queue.n`, `sensor[2].works`.

use crate::compile::context::{
    Context, Locals, Lowered, Reported,
    parts::Frame,
    processes::{Declared, Inside},
    symbols::{Meaning, unknown},
    typed::Typed,
    wording::Use,
};
use crate::compile::lower::modes;
use crate::model::{Bool, Comparison, Domain, Function, Num};
use crate::syntax::ast::{Expr, ExprKind, Ident, LetDecl};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::About;
use crate::syntax::source::Span;
use std::sync::Arc;

/// The meaning of a name inside a process or behaviour.
pub(crate) enum Found<'a> {
    /// A value.
    Value(Typed),
    /// What is written there, as it sees names, known by its path.
    Body { body: &'a Expr, locals: Locals, path: String },
}

/// A name inside a process, if it has it.
pub(crate) fn inside<'a>(
    context: &mut Context<'a>,
    (at, copy): (u32, u32),
    name: &str,
    span: Span,
) -> Option<Lowered<Found<'a>>> {
    let process = context.processes.get(at as usize)?;
    let inside = *process.names.get(name)?;
    Some(match inside {
        Inside::Lost => Err(Reported),
        Inside::Early => too_early(context, (at, "a variable of"), span),
        Inside::Variable(place) => {
            let (dimension, domain) = process.variables[place];
            let value = Num::Variable(process.variable(copy, place));
            Ok(Found::Value(match domain {
                Domain::Truth => Typed::truth(Bool::Compare(
                    Comparison::Equal,
                    Box::new(value),
                    Box::new(Num::Constant(1.0)),
                )),
                _ => Typed::Num(value, dimension),
            }))
        }
        Inside::Let(decl) if !decl.arguments.is_empty() => context
            .report(error!(E0204, span, "`{name}` is a function of {} arguments", decl.arguments.len();
                    hint: "call it inside the process: `{name}(…)`")),
        Inside::Let(LetDecl { body, .. }) | Inside::Label(body) => {
            let path = format!("{}.{name}", process.decl.name.name);
            let frame = copy_label(context, (at, copy)).map(|label| Arc::new(Frame::inside(label)));
            let locals = Locals { process: Some((at, copy)), frame, ..Locals::of(0) };
            Ok(Found::Body { body, locals, path })
        }
    })
}

/// The name of a variable of real numbers from which a number is computed, if there is one and nothing rounds it.
pub(crate) fn real_in<'a>(context: &Context<'a>, num: &Num) -> Option<&'a str> {
    match num {
        Num::Variable(id) => context.processes.iter().find_map(|process| process.real(*id)),
        Num::Apply(Function::Floor | Function::Ceil | Function::Round | Function::ServiceLevel, _) => None,
        Num::Apply(_, of) | Num::Fold(_, _, of) => real_in(context, of),
        Num::Combine(_, a, b) | Num::If(_, a, b) => real_in(context, a).or_else(|| real_in(context, b)),
        _ => None,
    }
}

/// A name of the process whose variables are being settled, if it has it: they start from nothing that it declares.
pub(crate) fn lower_settling(
    context: &mut Context<'_>,
    name: &str,
    span: Span,
    locals: &Locals,
) -> Option<Lowered<Typed>> {
    let at = locals.settling?;
    let process = context.processes.get(at as usize)?;
    let what = match process.names.get(name)? {
        Inside::Lost => return Some(Err(Reported)),
        Inside::Variable(_) | Inside::Early => "a variable of",
        Inside::Let(_) | Inside::Label(_) => "a name inside",
    };
    let label = format!("{what} `{}`, which has no value yet", process.decl.name.name);
    let error = error!(E0201, span, "unknown name `{name}`").label(label).about(About::Name(name.to_owned()));
    Some(context.report(error.hint("initial values cannot depend on the process")))
}

/// Notes that a name used inside a process is one of it.
pub(crate) fn note_inside(context: &mut Context<'_>, span: Span) {
    if context.temporal {
        context.words.uses.at.insert(span, Use::Inside);
    }
}

/// The name of a process or of a copy of it in texts.
pub(crate) fn copy_label(context: &Context<'_>, (at, copy): (u32, u32)) -> Option<Arc<str>> {
    let process = context.processes.get(at as usize).filter(|_| context.temporal)?;
    let name = &process.decl.name.name;
    Some(if process.is_array() { format!("{name}[{}]", copy + 1).into() } else { name.as_str().into() })
}

fn too_early<T>(context: &mut Context<'_>, (at, what): (u32, &str), span: Span) -> Lowered<T> {
    let name = context.processes.get(at as usize).map_or("", |process| process.decl.name.name.as_str());
    let label = format!("{what} `{name}`, which changes during a trial");
    context.report(error!(E0304, span, "the value must be known before a trial starts").label(label))
}

/// An error where the copies of an array of processes are not counted yet.
pub(crate) fn counted(context: &mut Context<'_>, process: u32, span: Span) -> Lowered<()> {
    let is_settled = context.processes.get(process as usize).is_none_or(|p| p.copies.is_some());
    if is_settled {
        return Ok(());
    }
    let text = format!("`{}` is not available here", context.text(span));
    context.report(
        error!(E0205, span, "{text}";
                hint: "numbers of copies and initial values cannot depend on processes")
        .about(About::Unsettled),
    )
}

/// The names of the process around the present place.
pub(crate) fn names_inside(context: &Context<'_>, locals: &Locals) -> Vec<String> {
    let process = locals.process.and_then(|(at, _)| context.processes.get(at as usize));
    process.into_iter().flat_map(|p| p.names.keys().map(|name| (*name).to_owned())).collect()
}

/// The path of a name that a process declares.
pub(crate) fn inside_path(context: &Context<'_>, at: u32, name: &str) -> Option<String> {
    let process = context.processes.get(at as usize)?;
    Some(format!("{}.{name}", process.decl.name.name))
}

/// Whether some process declares a name.
pub(crate) fn is_of_processes(context: &Context<'_>, name: &str) -> bool {
    context.processes.iter().any(|process| process.names.contains_key(name))
}

/// The name of a variable outside its process: with the process.
pub(crate) fn paths_of(context: &Context<'_>, name: &str) -> Vec<String> {
    let having = context.processes.iter().filter(|process| process.names.contains_key(name));
    let path = |process: &Declared<'_>| {
        let copy = if process.is_array() { "[1]" } else { "" };
        format!("`{}{copy}.{name}`", process.decl.name.name)
    };
    having.map(path).take(3).collect()
}

/// A function declared inside the process around the present place.
pub(crate) fn function_inside<'a>(context: &Context<'a>, name: &str, locals: &Locals) -> Option<&'a LetDecl> {
    let (at, _) = locals.process?;
    match context.processes.get(at as usize)?.names.get(name)? {
        Inside::Let(decl) if !decl.arguments.is_empty() => Some(decl),
        _ => None,
    }
}

/// A member of anything else than a process: a behaviour of an agent, a component of a vector.
pub(crate) fn member_of(
    context: &mut Context<'_>,
    lowered: Typed,
    base: &Expr,
    member: &Ident,
) -> Lowered<Typed> {
    match lowered {
        Typed::Agent(who) => modes::lower_mode(context, who, base.span, member),
        Typed::Processes(_) => context
            .report(error!(E0305, base.span, "expected a process, found an array of processes";
                    hint: "choose one: `{}[1].{}`", context.text(base.span), member.name)),
        Typed::Vector(x, y, dimension) if matches!(member.name.as_str(), "x" | "y") => {
            Ok(Typed::Num(if member.name == "x" { x } else { y }, dimension))
        }
        Typed::Point(x, y) if matches!(member.name.as_str(), "x" | "y") => {
            Ok(Typed::Number(if member.name == "x" { x } else { y }))
        }
        found => {
            let name = &member.name;
            let said = format!("expected a process before `.{name}`, found {}", found.noun());
            let is_behaviour = matches!(context.look_up(name, 0), Some((_, Meaning::Behaviour(_))));
            let hint = match (&found, is_behaviour) {
                (Typed::Agents { .. }, true) => {
                    let people = context.text(base.span);
                    format!("choose one agent, or count: `count(a in {people}: a.{name} == …) > 0`")
                }
                _ => "the values of agents are functions: `speed(user)`".to_owned(),
            };
            context.report(error!(E0305, base.span, "{said}"; hint: "{hint}"))
        }
    }
}

/// The error of a name that a process does not have.
pub(crate) fn unknown_member<T>(context: &mut Context<'_>, process: u32, member: &Ident) -> Lowered<T> {
    let process = &context.processes[process as usize];
    let known = process.names.keys().copied();
    let what = format!("name of `{}`", process.decl.name.name);
    let error = unknown(&what, &member.name, member.span, Code::E0201, known);
    context.report(error)
}

/// A member of an argument of a function: nothing is known about the argument except that a member of this name exists.
pub(crate) fn member_of_anybody(
    context: &mut Context<'_>,
    base: &Expr,
    member: &Ident,
    locals: &Locals,
) -> Lowered<Typed> {
    let ExprKind::Name(name) = &base.kind else { return Err(Reported) };
    let bound = locals.names.iter().rev().find(|(bound, _)| bound == name);
    if !matches!(bound, Some((_, None))) {
        return Err(Reported);
    }
    let of_processes = context.processes.iter().flat_map(|process| process.names.keys().copied());
    let of_people = context.conducts.behaviours.iter().map(|decl| decl.name.name.as_str());
    let known: Vec<&str> = of_processes.chain(of_people).chain(["x", "y"]).collect();
    if known.contains(&member.name.as_str()) {
        return Err(Reported);
    }
    let error = unknown("name", &member.name, member.span, Code::E0201, known.into_iter());
    context.report(match &error.hint {
        Some(_) => error,
        None => error.hint("the values of agents are functions: `speed(user)`"),
    })
}

/// All copies of an array of processes.
pub(crate) fn copies(context: &Context<'_>, process: u32) -> impl Iterator<Item = Typed> + use<> {
    let count = context.processes.get(process as usize).and_then(|p| p.copies).unwrap_or(1);
    (0..count).map(move |copy| Typed::Process { process, copy })
}
