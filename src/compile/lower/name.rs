//! Names and members of sets.

use crate::compile::context::levels;
use crate::compile::context::symbols::Param;
use crate::compile::context::{
    Context, Locals, Lowered, Reported,
    dependence::Meant,
    number::Number,
    processes::Declared,
    symbols::{Meaning, unknown},
    typed::Typed,
    wording::Use,
};
use crate::compile::dimension::Dimension;
use crate::compile::lower::{
    builtin::BUILT_IN,
    counted_arguments, misspelt, modes,
    process_names::{self, Found},
    weight::{self, Weight},
};
use crate::model::{Set, Who};
use crate::syntax::ast::{Expr, ExprKind, Ident};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::About;
use crate::syntax::source::Span;

pub(crate) fn lower_name(
    context: &mut Context<'_>,
    name: &str,
    span: Span,
    locals: &Locals,
) -> Lowered<Typed> {
    if let Some(at) = locals.names.iter().rposition(|(bound, _)| bound == name) {
        let typed = locals.names[at].1.as_ref().ok_or(Reported)?;
        context.names.uses.entry(span).or_insert_with(|| Meant::Bound(name.to_owned()));
        if let Some((_, meant)) = locals.written.iter().find(|(argument, _)| *argument == at) {
            context.words.aliases.insert(span, *meant);
        }
        if context.temporal {
            context.words.uses.at.insert(span, Use::Given(at as u32));
        }
        weight::count_copy(context, Weight::of(typed), span)?;
        return Ok((**typed).clone());
    }
    if let Some(process) = locals.process
        && let Some(inside) = lower_inside(context, process, name, span)
    {
        process_names::note_inside(context, span);
        return inside;
    }
    if let Some(inside) = lower_inside_behaviour(context, name, span, locals) {
        return inside;
    }
    let full = levels::on_level(context, name);
    let name = full.as_deref().unwrap_or(name);
    let Some((scope, meaning)) = context.look_up(name, locals.scope) else {
        return match name {
            "time" if context.time.clock.is_jumps() => {
                let error = error!(E0508, span, "`time` is not available in continuous time";
                        hint: "use a bound such as `F[4 s, 5 s]`, or `time_until(…)`");
                context.report(error)
            }
            "time" => Ok(Typed::Num(crate::model::Num::Time, context.time.dimension())),
            "everyone" => Ok(Typed::Agents {
                set: Set { members: context.roster.everyone(), except: None },
                particle: false,
            }),
            "pi" => Ok(Typed::Number(Number::rounded(std::f64::consts::PI, Dimension::NONE))),
            _ => match process_names::lower_settling(context, name, span, locals) {
                Some(lowered) => lowered,
                None => unknown_name(context, name, span, locals),
            },
        };
    };
    if let Meaning::Constant(value) | Meaning::Param(Param { value, .. }) = &meaning
        && matches!(&value.kind, ExprKind::Quantity(quantity) if quantity.unit.is_none())
        // A declaration that is looked at by its name is no use of it.
        && value.span != span
    {
        context.names.bare.insert(span, value.span);
    }
    // A declaration that is looked at by its name is no use of it.
    if meaning.body() != Some(span) {
        let meant = meaning.body().map_or(Meant::Other, Meant::Written);
        let is_param = matches!(meaning, Meaning::Param(_));
        context.names.uses.insert(span, if is_param { Meant::Parameter } else { meant });
    }
    match meaning {
        Meaning::Constant(value) => context.constant(scope, name, span, |this| {
            let lowered = timeless(this, value, &Locals::of(scope));
            this.unchanging(lowered, value)
        }),
        Meaning::Plan(_) => context
            .report(error!(E0206, span, "expected a value, but `{name}` is a floor plan";
            hint: "name a part of it: `{name}.foyer`, `{name}[\"Room 12\"]`")),
        Meaning::Param(Param { choices, .. }) if !choices.is_empty() => {
            let said = format!("`{name}` is a choice, not a number");
            context.report(
                error!(E0213, span, "{said}"; hint: "a choice is used by kinds: `kind adult: preset {name}`"),
            )
        }
        Meaning::Param(Param { value, .. }) => {
            if let Some(set) = context.names.settings.get(name) {
                return Ok(Typed::Number(*set));
            }
            context
                .constant(scope, name, span, |this| this.number(value, &Locals::of(scope)).map(Typed::Number))
        }
        Meaning::Let(decl) => {
            if !decl.arguments.is_empty() {
                return context.report(error!(E0204, span, "`{name}` is a function of {}", counted_arguments(decl.arguments.len());
                    hint: "call it: `{name}(…)`"));
            }
            let inner = Locals { running: locals.running, ..Locals::of(scope) };
            context.expand_once(scope, name, span, |this| this.lower(&decl.body, &inner))
        }
        Meaning::Property(_) if !context.temporal => {
            let text = format!("a number is needed here, but `{name}` is a property");
            context.report(error!(E0305, span, "{text}"))
        }
        Meaning::Property(formula) => {
            let inner = Locals { running: locals.running, ..Locals::of(scope) };
            context.expand_once(scope, name, span, |this| match this.lower(formula, &inner)? {
                typed @ (Typed::Truth(..) | Typed::Formula(_)) => Ok(typed),
                // Said where it is declared, however often it is used.
                found => this.mismatch(formula.span, "a condition", &found),
            })
        }
        Meaning::Level(_) => context.report(error!(E0206, span, "expected a value, but `{name}` is a level";
            hint: "name something on it, `{name}.exit`, or a place: `{name} (3, 4)`")),
        Meaning::Region(id, _) | Meaning::Stairs(id) => Ok(Typed::Region(id)),
        Meaning::Barrier(id) => Ok(Typed::Barrier(id)),
        Meaning::Line(id) => Ok(Typed::Line(id)),
        Meaning::Point(_) if !context.scene.storeys.are_none() => {
            let point = context.scene.points.iter().find(|(known, _)| known == name);
            point.map(|(_, point)| Typed::point(*point)).ok_or(Reported)
        }
        Meaning::Point(at) => context.constant(scope, name, span, |this| this.lower(at, &Locals::of(scope))),
        Meaning::Process(process) => {
            let is_array = context.processes.get(process as usize).is_some_and(Declared::is_array);
            Ok(if is_array { Typed::Processes(process) } else { Typed::Process { process, copy: 0 } })
        }
        Meaning::Agent(id) => Ok(Typed::Agent(Who::Agent(id))),
        Meaning::Agents { members, particle } => {
            Ok(Typed::Agents { set: Set { members, except: None }, particle })
        }
        Meaning::Doubtful => {
            context.names.unknowns += 1;
            Err(Reported)
        }
        Meaning::Declared => context.report(
            error!(E0205, span, "`{name}` is not available here";
                hint: "numbers of agents and parameters cannot depend on agents")
            .about(About::Unsettled),
        ),
        Meaning::Kind(_) | Meaning::Tracks(_) | Meaning::Behaviour(_) => {
            context.report(error!(E0206, span, "`{name}` is {} and has no value", meaning.noun()))
        }
    }
}

fn unknown_name(context: &mut Context<'_>, name: &str, span: Span, locals: &Locals) -> Lowered<Typed> {
    context.names.unknowns += 1;
    if context.sink.is_said(Code::E0201, span) || context.sink.is_said(Code::E0113, span) {
        return Err(Reported);
    }
    let mut known: Vec<String> = Vec::new();
    if context.sink.looks_for_names() {
        known.extend(locals.names.iter().map(|(n, _)| n.clone()));
        known.extend(process_names::names_inside(context, locals));
        for scope in [locals.scope, 0] {
            known.extend(
                context.names.scopes.get(scope).into_iter().flat_map(|s| s.names().map(str::to_owned)),
            );
        }
        known.extend(BUILT_IN.map(str::to_owned));
    }
    let error = unknown("name", name, span, Code::E0201, known.iter().map(String::as_str));
    context.report(match misspelt::misread_name(context, name) {
        Some(hint) => error.hint(hint),
        None => error,
    })
}

/// An expression in which, whoever asks, operators over time are known: what is wrong with them is said of a whole.
pub(crate) fn timeless(context: &mut Context<'_>, value: &Expr, locals: &Locals) -> Lowered<Typed> {
    let temporal = std::mem::replace(&mut context.temporal, locals.scope > 0);
    let lowered = context.lower(value, locals);
    context.temporal = temporal;
    lowered
}

/// A name inside a process, if it has it.
fn lower_inside(
    context: &mut Context<'_>,
    copy: (u32, u32),
    name: &str,
    span: Span,
) -> Option<Lowered<Typed>> {
    Some(process_names::inside(context, copy, name, span)?.and_then(|found| match found {
        Found::Value(typed) => Ok(typed),
        Found::Body { body, locals, path } => {
            context.expand(0, &path, span, |this| this.lower(body, &locals))
        }
    }))
}

/// `queue.n`, `sensor[2].works`, and the components of a vector.
pub(crate) fn lower_member(
    context: &mut Context<'_>,
    base: &Expr,
    member: &Ident,
    locals: &Locals,
) -> Lowered<Typed> {
    let Ok(lowered) = context.lower(base, locals) else {
        return process_names::member_of_anybody(context, base, member, locals);
    };
    let Typed::Process { process, copy } = lowered else {
        return process_names::member_of(context, lowered, base, member);
    };
    match lower_inside(context, (process, copy), &member.name, member.span) {
        Some(lowered) => lowered,
        None => process_names::unknown_member(context, process, member),
    }
}

/// A name inside a behaviour, if it has it.
pub(crate) fn lower_inside_behaviour(
    context: &mut Context<'_>,
    name: &str,
    span: Span,
    locals: &Locals,
) -> Option<Lowered<Typed>> {
    let (decl, inner, path) = modes::inside_behaviour(context, name, locals)?;
    if !decl.arguments.is_empty() {
        let text = format!("`{name}` is a function of {}", counted_arguments(decl.arguments.len()));
        let error = error!(E0204, span, "{text}"; hint: "call it: `{name}(…)`");
        return Some(context.report(error));
    }
    Some(context.expand(0, &path, span, |this| this.lower(&decl.body, &inner)))
}

/// `crowd[3]`; members count from 1.
pub(crate) fn lower_index(
    context: &mut Context<'_>,
    base: &Expr,
    index: &Expr,
    locals: &Locals,
) -> Lowered<Typed> {
    let lowered = context.lower(base, locals);
    if lowered.is_err() {
        let _ = context.number(index, locals);
    }
    let set = match lowered? {
        Typed::Agents { set, particle: false } => set,
        Typed::Processes(process) => return lower_copy(context, process, base, index, locals),
        Typed::Agents { particle: true, .. } => {
            return context
                .report(error!(E0206, base.span, "a group `as particle` is one body and has no members";
                hint: "remove `as particle` to simulate the members"));
        }
        found => return context.mismatch(base.span, "a set of agents", &found),
    };
    // The number of agents whose declaration failed is unknown.
    if let [only] = set.members[..]
        && context.roster.undeclared.contains(&only)
    {
        let _ = context.number_of(index, Dimension::NONE, locals);
        return Ok(Typed::Agent(Who::Agent(only)));
    }
    let left_out = match set.except {
        None => None,
        Some(Who::Agent(id)) => Some(id),
        Some(Who::Running(_)) => {
            return context.report(
                error!(E0304, base.span, "the members of this set differ for each value of the quantifier";
                hint: "choose a member of a fixed set such as `crowd[1]`, or quantify over this set"),
            );
        }
    };
    let members: Vec<_> = set.members.iter().filter(|id| Some(**id) != left_out).copied().collect();
    let place = member(context, base, index, members.len(), locals)?;
    Ok(Typed::Agent(Who::Agent(members[place])))
}

/// One copy of an array of processes.
fn lower_copy(
    context: &mut Context<'_>,
    process: u32,
    base: &Expr,
    index: &Expr,
    locals: &Locals,
) -> Lowered<Typed> {
    if context.processes.get(process as usize).is_some_and(|process| process.uncounted) {
        let _ = context.number(index, locals);
        return Ok(Typed::Process { process, copy: 0 });
    }
    let count = process_names::copies(context, process).count();
    let copy = member(context, base, index, count, locals)? as u32;
    Ok(Typed::Process { process, copy })
}

/// The place, from 0, of a member counted from 1.
fn member(
    context: &mut Context<'_>,
    base: &Expr,
    index: &Expr,
    count: usize,
    locals: &Locals,
) -> Lowered<usize> {
    let number = context.number_of(index, Dimension::NONE, locals)?;
    let member = number.as_whole().and_then(|n| usize::try_from(n).ok());
    match member {
        Some(n) if (1..=count).contains(&n) => Ok(n - 1),
        _ => {
            let error =
                error!(E0212, index.span, "`{1}` has no member {0}", number.value, context.text(base.span))
                    .hint(match count {
                        0 => "the set is empty".to_owned(),
                        1 => "the only member is `[1]`".to_owned(),
                        count => {
                            let name = context.text(base.span);
                            format!("the members are `{name}[1]` to `{name}[{count}]`")
                        }
                    });
            context.report(error)
        }
    }
}
