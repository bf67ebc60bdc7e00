//! Behaviours: who has which, and what they are when names, units and arguments are settled.
//!
//! `with phone, heedful(0.8)` fills in the arguments. What a state changes and how it ends is lowered once for a
//! declaration; conditions are lowered for each member, because they speak of `self`.

pub(crate) mod attachment;
pub(crate) mod conduct;

use crate::compile::context::{
    Context, Locals, Lowered, Reported,
    conducts::{With, states},
    people::{People, entities},
    symbols::unknown,
    typed::Typed,
};
use crate::compile::lower::{call, counted_arguments};

use crate::model::{AgentId, Attached, Behaviour, BehaviourId, Behaviours, Mode, Parameter, Route, Who};
use crate::syntax::ast::process::{BehaviourDecl, BehaviourItem, StateDecl};
use crate::syntax::ast::{Expr, Field, Ident};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::{Diagnostic, Label, Severity};
use crate::syntax::source::Span;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Events that reach agents from outside the model.
const EVENTS: [&str; 1] = ["advice"];
/// The answers to advice.
const OUTCOMES: [&str; 2] = ["follow", "ignore"];
/// Codes of errors of behaviours that do not depend on the agents that have them: weights, delays, fields of a state.
const OF_NO_AGENT: [Code; 3] = [Code::E0902, Code::E0906, Code::E0911];

/// Most names that a hint lists.
const MOST_LISTED: usize = 20;

/// Names that may be meant.
struct Names<'n> {
    /// In order of writing.
    written: Vec<&'n str>,
    sorted: BTreeSet<&'n str>,
}

impl<'n> Names<'n> {
    fn of(names: impl Iterator<Item = &'n str>) -> Self {
        let written: Vec<&str> = names.collect();
        Self { sorted: written.iter().copied().collect(), written }
    }

    fn listed(&self) -> String {
        let mut list = self.written[..self.written.len().min(MOST_LISTED)].join(", ");
        if self.written.len() > MOST_LISTED {
            list.push_str(&format!(" and {} more", self.written.len() - MOST_LISTED));
        }
        list
    }
}

/// Declares a behaviour and checks what needs no arguments: names of states, fields and events.
pub(crate) fn declare_behaviour<'a>(context: &mut Context<'a>, decl: &'a BehaviourDecl) {
    context.conducts.behaviours.push(decl);
    call::check_arguments(context, &decl.arguments);
    let mut seen: BTreeMap<&str, &Ident> = BTreeMap::new();
    let names = Names::of(states(decl).map(|state| state.name.name.as_str()));
    for item in &decl.items {
        let name = match item {
            BehaviourItem::State(state) => {
                check_state(context, state, &names);
                &state.name
            }
            BehaviourItem::Let(decl) => &decl.name,
            BehaviourItem::On(on) => {
                if !EVENTS.contains(&on.event.name.as_str()) {
                    let known = EVENTS.into_iter();
                    let error = unknown("event", &on.event.name, on.event.span, Code::E0201, known)
                            .hint("the only event is `advice`, a move suggested to the agent; write other events as conditions of a state: `when self in exit -> …`, `when contact(self) -> …`");
                    context.note(error);
                }
                check_targets(
                    context,
                    on.choices.iter().map(|choice| &choice.target),
                    &Names::of(OUTCOMES.into_iter()),
                    "reaction",
                );
                &on.event
            }
        };
        if let Some(first) = seen.insert(&name.name, name) {
            let error = error!(E0202, name.span, "`{}` is declared twice", name.name)
                .related(first.span, "first declared here");
            context.note(error);
        }
    }
}

fn check_state<'a>(context: &mut Context<'a>, state: &'a StateDecl, names: &Names<'_>) {
    let mut set: BTreeMap<&str, &Field> = BTreeMap::new();
    for field in &state.fields {
        let name = field.name.name.as_str();
        let first = *set.entry(name).or_insert(field);
        if !std::ptr::eq(first, field) {
            let error = error!(E0202, field.name.span, "`{name}` is set twice")
                .related(first.name.span, "first set here");
            context.note(error);
        } else if Parameter::named(name).is_some_and(|known| !known.description().changeable) {
            context.note(error!(E0911, field.name.span, "`{name}` belongs to the body and cannot change";
                    hint: "a state can set {} and route", all_parameters().join(", ")));
        } else if name != "route" && Parameter::changeable_of(name).is_none() {
            let known = all_parameters().into_iter().chain(["route"]);
            let error = unknown("parameter", name, field.name.span, Code::E0207, known);
            context.note(error);
        }
    }
    for transition in &state.transitions {
        check_targets(context, transition.targets.iter().map(|choice| &choice.target), names, "state");
    }
}

fn check_targets<'a>(
    context: &mut Context<'a>,
    targets: impl Iterator<Item = &'a Ident>,
    known: &Names<'_>,
    what: &str,
) {
    for target in targets {
        if !known.sorted.contains(target.name.as_str()) {
            let looked_at = if context.sink.looks_for_names() { usize::MAX } else { 0 };
            let names = known.written.iter().copied().take(looked_at);
            let error = unknown(what, &target.name, target.span, Code::E0201, names);
            let error = match &error.hint {
                Some(_) => error,
                None => error.hint(format!("the fields are {}", known.listed())),
            };
            context.note(error);
        }
    }
}

/// Lowers the behaviours of all agents.
pub(crate) fn settle_behaviours(
    context: &mut Context<'_>,
    people: &mut People,
    variables: usize,
) -> Behaviours {
    let mut out = Behaviours::default();
    for decl in &context.conducts.behaviours {
        let states = states(decl).map(|state| state.name.name.clone()).collect();
        context.origins.behaviours.push(decl.name.span);
        out.declared.push(Behaviour { name: decl.name.name.clone(), states });
    }
    // Errors outside of behaviours may have taken away whom these speak of.
    let declared: Vec<Span> = context.conducts.behaviours.iter().map(|decl| decl.span).collect();
    let inside = |place: Span| {
        let holds =
            |span: &Span| span.source == place.source && span.start <= place.start && place.end <= span.end;
        declared.iter().any(holds)
    };
    let elsewhere = |d: &Diagnostic| {
        d.severity == Severity::Error && d.place.as_ref().is_none_or(|place| !inside(place.span))
    };
    let taken = context.sink.diagnostics.iter().any(elsewhere);
    let before = context.sink.diagnostics.len();
    for arguments in std::mem::take(&mut context.conducts.stray) {
        let _ = context.lower_all(arguments, &Locals::of(0));
    }
    let withs = std::mem::take(&mut context.conducts.withs);
    for with in &withs {
        for &(id, arguments, written) in &with.behaviours {
            match settle_one(context, with, id, (arguments, written), people, variables) {
                Ok(attached) => out.attached.extend(attached),
                // The failure was reported; a behaviour is never dropped without a diagnostic.
                Err(Reported) if context.sink.failed() || !context.torn.is_empty() => {}
                Err(Reported) => {
                    let text = "internal error: this behaviour was rejected without a diagnostic";
                    context.note(error!(E0305, written.span, "{text}"));
                }
            }
        }
    }
    context.conducts.withs = withs;
    check_unused_behaviours(context, variables);
    if taken {
        // Errors elsewhere, as in a constant that they use, do not depend on the agent; nor do weights, delays and fields.
        let found = context.sink.diagnostics.split_off(before.min(context.sink.diagnostics.len()));
        let of_no_agent = |one: &Diagnostic| {
            elsewhere(one) || OF_NO_AGENT.contains(&one.code) || context.names.is_sure(one)
        };
        let kept: Vec<Diagnostic> = found.into_iter().filter(of_no_agent).collect();
        context.sink.diagnostics.extend(kept);
    }
    for one in &out.attached {
        let leaves = |mode: &Mode| matches!(mode.route, Some(Route::Legs { then_leave: true, .. }));
        if one.conduct.states.iter().any(leaves) {
            context.roster.passing.insert(one.agent);
        }
    }
    // Of one agent they stay in order of `with`.
    out.attached.sort_by_key(|one| one.agent);
    out
}

/// Adds the arguments of a behaviour to the errors in it that depend on them, from a given error on.
fn mark_given(context: &mut Context<'_>, from: usize, decl: &BehaviourDecl, at: Span) {
    // An error is marked if the whole condition or value that it stands in uses an argument: `gap > 2` is wrong at its number.
    let wholes = decl.values();
    let found = context.sink.diagnostics.iter_mut().skip(from);
    for one in found.filter(|one| one.code.is_of("E03") || one.code == Code::E0405) {
        let Some(place) = one.place.as_ref().map(|place| place.span) else { continue };
        let Some(whole) = wholes.iter().find(|whole| whole.holds(place)) else { continue };
        let is_marked = one.related.iter().any(|label| label.span == at);
        if !is_marked && context.names.hangs_on_bound(*whole, &decl.arguments) {
            one.related.push(Label { span: at, text: "with these arguments".to_owned() });
        }
    }
}

fn settle_one<'a>(
    context: &mut Context<'a>,
    with: &With<'a>,
    id: BehaviourId,
    (arguments, written): (&'a [Expr], &'a Expr),
    people: &mut People,
    variables: usize,
) -> Lowered<Vec<Attached>> {
    let decl = context.conducts.behaviours[id.0 as usize];
    let mut locals = Locals::of(0);
    let mut failed = arguments.len() != decl.arguments.len();
    if failed {
        let wanted = counted_arguments(decl.arguments.len());
        let _: Lowered<()> = context.arity(&decl.name, written.span, &wanted, (arguments, &locals));
        // It is unknown which of them is missing.
        decl.arguments.iter().for_each(|name| locals.bind_unknown(&name.name));
    }
    let given = if failed { &[] } else { arguments };
    for (name, argument) in decl.arguments.iter().zip(given) {
        match context.lower(argument, &Locals::of(0)) {
            Ok(value) => locals.bind(&name.name, value),
            Err(Reported) => {
                locals.bind_unknown(&name.name);
                failed = true;
            }
        }
    }
    locals.behaviour = Some((id.0, locals.names.len() + 1));
    let first = with.members.first().copied().unwrap_or(AgentId(0));
    context.conducts.attached_at = (!arguments.is_empty()).then_some(written.span);
    let having = with.members.is_empty().then(|| context.conducts.having.clone());
    if having.is_some() {
        context.conducts.stand_in();
    }
    let before = context.sink.diagnostics.len();
    let conduct = conduct::conduct(context, decl, &of(&locals, first), variables);
    context.conducts.attached_at = None;
    if failed || conduct.is_err() {
        // What is wrong with its conditions is said too.
        let _ = conduct::conditions(context, decl, &of(&locals, first));
        if !failed {
            mark_given(context, before, decl, written.span);
        }
    }
    if let Some(having) = having {
        context.conducts.having = having;
    }
    let conduct = Arc::new(conduct?);
    if failed {
        return Err(Reported);
    }
    let path = format!("{}.{}", with.name, decl.name.name);
    let entity = entities(context, people, &path, with.members.len() as u32, written.span)?;
    // Later people on the places of a source have numbers of their own.
    let later = match with.most {
        0 => 0,
        most => entities(context, people, &format!("{path}.later"), most, written.span)?,
    };
    let mut out = Vec::with_capacity(with.members.len());
    for (k, &agent) in with.members.iter().enumerate() {
        let Ok(guards) = conduct::conditions(context, decl, &of(&locals, agent)) else {
            mark_given(context, before, decl, written.span);
            return Err(Reported);
        };
        let (entity, later) = (entity + k as u32, later + k as u32);
        out.push(Attached { agent, behaviour: id, entity, later, conduct: conduct.clone(), guards });
    }
    Ok(out)
}

/// Checks behaviours that no agent has, except the parts that depend on their arguments.
fn check_unused_behaviours(context: &mut Context<'_>, variables: usize) {
    // Whoever would have one could have the others too.
    let having = context.conducts.having.clone();
    context.conducts.stand_in();
    for (k, decl) in context.conducts.behaviours.clone().into_iter().enumerate() {
        let id = BehaviourId(k as u32);
        let used =
            context.conducts.withs.iter().any(|with| with.behaviours.iter().any(|(known, ..)| *known == id));
        if !used {
            let mut locals = Locals::of(0);
            for argument in &decl.arguments {
                locals.bind_unknown(&argument.name);
            }
            locals.behaviour = Some((id.0, locals.names.len() + 1));
            let locals = if context.roster.agent_names.is_empty() {
                locals.names.insert(0, ("self".to_owned(), None));
                locals
            } else {
                of(&locals, AgentId(0))
            };
            let _: Result<_, Reported> = conduct::conduct(context, decl, &locals, variables);
            let _: Result<_, Reported> = conduct::conditions(context, decl, &locals);
        }
    }
    context.conducts.having = having;
}

/// Names as one agent sees them.
fn of(locals: &Locals, agent: AgentId) -> Locals {
    let mut own = locals.clone();
    own.names.insert(0, ("self".to_owned(), Some(Arc::new(Typed::Agent(Who::Agent(agent))))));
    own
}

fn all_parameters() -> Vec<&'static str> {
    Parameter::changeable().map(Parameter::name).collect()
}
