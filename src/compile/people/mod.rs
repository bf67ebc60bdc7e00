//! Agents: declared one by one, in numbers, or from a recording.

pub(crate) mod groups;
pub(crate) mod intended;
pub(crate) mod intentions;
pub(crate) mod kinds;
pub(crate) mod places;
pub(crate) mod planners;
pub(crate) mod positions;
pub(crate) mod recordings;
pub(crate) mod refused;
pub(crate) mod routes;
pub(crate) mod sources;
pub(crate) mod step;
pub(crate) mod stepping;
pub(crate) mod tracks;

use crate::base::geometry::Vec2;
use crate::compile::behaviour::attachment;
use crate::compile::context::{
    Context, Locals, Lowered,
    conducts::With,
    kind::Kind,
    people::{People, entities},
    sighting::{STANDS, Sighting},
    symbols::{Meaning, unknown},
};
use crate::compile::dimension::Dimension;
use crate::compile::lower::laws;
use crate::compile::people::intended::{Intended, parted};
use crate::model::{Agent, AgentId, Body, Goal, Law, Leg, Parameter, Route, Source, Start};
use crate::syntax::ast::{AgentsDecl, Expr, Field, Ident};
use crate::syntax::codes::Code;
use std::sync::Arc;

/// After so many seconds nobody is waited for.
const NEVER: f64 = 1e9;
/// Most agents of a scenario.
const MOST_AGENTS: usize = 1_000_000;

/// `agent user: adult { … }`, `agents crowd[12]: adult { … }`
pub(crate) fn agents<'a>(context: &mut Context<'a>, decl: &'a AgentsDecl, people: &mut People) {
    let kind = kinds::kind(context, &decl.kind);
    let count = match (&decl.count, &decl.recorded) {
        (Some(count), None) if !decl.plural => context
            .report(error!(E0402, count.span, "`agent` declares only one agent";
                    hint: "write `agents {}[…]: …` for several agents", decl.name.name)),
        (Some(count), None) => counted(context, count),
        (Some(count), Some(_)) => {
            let said = "the recording determines the number of agents";
            context.report(error!(E0402, count.span, "{said}"; hint: "remove the number in brackets"))
        }
        (None, None) if decl.plural => context
            .report(error!(E0402, decl.name.span, "the number of `{}` is missing", decl.name.name;
                    hint: "write `agents {}[12]: …`", decl.name.name)),
        _ => Ok(1),
    };
    let with = attachment::with(context, &decl.name, &decl.with);
    if let Some(recorded) = &decl.recorded {
        declare_recorded(context, decl, recorded, kind, with, people);
        return;
    }
    let mut kind = kind;
    let rest = kinds::parameters(context, &decl.body, kind.as_mut().ok(), &Locals::default());
    let start = positions::start(context, &decl.name, &rest, people, true);
    let headed = headed(context, &rest, start);
    only(context, &rest, &["at", "velocity", "route", "direction"]);
    let body = kind.and_then(|kind| kinds::body(context, &kind, &decl.kind));
    let (Ok(count), Ok(body), Ok((start, route))) = (count, body, headed) else {
        define_empty(context, &decl.name, decl.plural || decl.count.is_some(), with);
        return;
    };
    let Ok(members) = enlist(context, &decl.name, count, decl.plural, people, |_| {
        (Arc::new(body.clone()), start.clone(), route.clone())
    }) else {
        define_empty(context, &decl.name, decl.plural || decl.count.is_some(), with);
        return;
    };
    people.written(&members, &rest, decl.name.span);
    attachment::attach(context, with, &members);
    let meaning = match members.as_slice() {
        [one] if !decl.plural => Meaning::Agent(*one),
        _ => Meaning::Agents { members: members.into(), particle: false },
    };
    context.names.scopes[0].define(&decl.name, meaning);
}

pub(crate) fn define_empty<'a>(context: &mut Context<'a>, name: &Ident, plural: bool, with: With<'a>) {
    // What follows can then speak of the name without further errors. Numbers of people begin at 0.
    let id = AgentId(u32::MAX - context.roster.undeclared.len() as u32);
    context.roster.undeclared.insert(id);
    attachment::attach(context, with, &[id]);
    let meaning =
        if plural { Meaning::Agents { members: [id].into(), particle: false } } else { Meaning::Agent(id) };
    context.names.scopes[0].define(name, meaning);
}

/// Adds `count` people of one declaration.
pub(crate) fn enlist(
    context: &mut Context<'_>,
    name: &Ident,
    count: usize,
    plural: bool,
    people: &mut People,
    each: impl Fn(usize) -> (Arc<Body>, Start, Route),
) -> Lowered<Vec<AgentId>> {
    let first = entities(context, people, &name.name, count as u32, name.span)?;
    Ok(members(context, name, count, plural, first, people, each))
}

/// Adds `count` people of one declaration, whose stable numbers begin with `first`.
pub(crate) fn members(
    context: &mut Context<'_>,
    name: &Ident,
    count: usize,
    plural: bool,
    first: u32,
    people: &mut People,
    each: impl Fn(usize) -> (Arc<Body>, Start, Route),
) -> Vec<AgentId> {
    let mut shared: Option<Arc<Body>> = None;
    (0..count)
        .map(|k| {
            let text = if plural { format!("{}[{}]", name.name, k + 1) } else { name.name.clone() };
            let (body, start, route) = each(k);
            let route = match (&body.premovement, route) {
                (Some(law), Route::Legs { mut legs, then_leave }) if !legs.is_empty() => {
                    legs.insert(0, Leg::Wait(law.clone()));
                    Route::Legs { legs, then_leave }
                }
                (_, route) => route,
            };
            if k == 0 && body.premovement.is_some() && matches!(route, Route::Onward | Route::OneOf { .. }) {
                let error = error!(E0408, name.span, "`{}` has a premovement and no route on which to set out", name.name;
                    hint: "write a `route`, or leave `premovement` out");
                context.note(error);
            }
            let chooses = |goal: &Goal| match goal {
                Goal::Region(id) => !context.scene.regions[id.0 as usize].exits.is_empty(),
                Goal::Point(_) => false,
            };
            let is_led = body.planner.is_some() || body.stepper.is_some();
            if k == 0 && is_led && route.goals().any(chooses) {
                let error = error!(E0408, name.span, "`{}` walks on planned paths or by steps, and does not look for the quickest exit", name.name;
                    hint: "choose the nearest one: `nearest(…)`");
                context.note(error);
            }
            // Equal bodies are kept once.
            let body = match &shared {
                Some(known) if **known == *body => known.clone(),
                _ => body,
            };
            shared = Some(body.clone());
            context.roster.agent_names.push(text.clone());
            let legs = if let Route::OneOf { .. } = route { 1 } else { route.goals().count() };
            context.roster.legs.push(legs as u32);
            if matches!(route, Route::Legs { then_leave: true, .. }) {
                context.roster.passing.insert(AgentId(context.roster.agent_names.len() as u32 - 1));
            }
            let entity = first + k as u32;
            people.agents.push(Agent { name: text, entity, body, start, route, group: None, particle: None });
            AgentId(people.agents.len() as u32 - 1)
        })
        .collect()
}

pub(crate) fn counted(context: &mut Context<'_>, expr: &Expr) -> Lowered<usize> {
    let number = context.number_of(expr, Dimension::NONE, &Locals::default())?;
    match number.as_whole() {
        Some(n) if n < 0 => {
            let said = format!("the number of agents cannot be negative (got {n})");
            context.report(error!(E0402, expr.span, "{said}"))
        }
        Some(n) if n as usize <= MOST_AGENTS => Ok(n as usize),
        Some(n) => context
            .report(error!(E0402, expr.span, "the number of agents must be at most {MOST_AGENTS} (got {n})")),
        None if number.value > MOST_AGENTS as f64 && number.value.fract() == 0.0 => {
            let text = format!("the number of agents must be at most {MOST_AGENTS} (got {})", number.value);
            context.report(error!(E0402, expr.span, "{text}"))
        }
        None => context
            .report(error!(E0402, expr.span, "the number of agents must be whole (got {})", number.value;
                    hint: "round it: `round(…)`")),
    }
}

pub(crate) fn route_of(context: &mut Context<'_>, fields: &[&Field]) -> Lowered<Route> {
    match fields.iter().find(|f| f.name.name == "route") {
        Some(field) => routes::route(context, &field.value, &Locals::default()),
        None => Ok(Route::Legs { legs: Vec::new(), then_leave: false }),
    }
}

/// Refuses fields that mean nothing here.
pub(crate) fn only(context: &mut Context<'_>, fields: &[&Field], known: &[&str]) {
    for field in fields.iter().filter(|field| !known.contains(&field.name.name.as_str())) {
        let all = known.iter().copied().chain(Parameter::ALL.map(Parameter::name));
        let error = unknown("field", &field.name.name, field.name.span, Code::E0207, all);
        context.note(error);
        // It may have been the radius.
        context.roster.any_start = true;
        refused::look_at(context, &field.value, &Locals::default());
    }
}

/// People whose start state a recording gives.
fn declare_recorded<'a>(
    context: &mut Context<'a>,
    decl: &'a AgentsDecl,
    recorded: &'a crate::syntax::ast::Recorded,
    kind: Lowered<Kind>,
    with: With<'a>,
    people: &mut People,
) {
    let found = recordings::sighted(context, recorded, !decl.plural);
    let mut kind = kind;
    let (wants, fields) = parted(&decl.body);
    let rest = kinds::parameters(context, fields, kind.as_mut().ok(), &Locals::default());
    let intended = intentions::intended(context, &wants);
    let has_route = rest.iter().any(|f| f.name.name == "route");
    let route = if has_route { route_of(context, &rest) } else { Ok(Route::Onward) };
    only(context, &rest, &["route"]);
    let base = kind.and_then(|kind| kinds::body(context, &kind, &decl.kind));
    let (Ok(found), Ok(base), Ok(route), Ok(intended)) = (found, base, route, intended) else {
        intentions::look_at(context, &wants);
        define_empty(context, &decl.name, decl.plural || decl.count.is_some(), with);
        return;
    };
    if found.people.is_empty() && !decl.plural {
        unseen(context, &decl.name, base, with, people);
        return;
    }
    let found = recordings::onto_rims(context, recorded, found.people, &base[Parameter::Radius]);
    let own_speed = decl.body.iter().any(|f| f.name.name == "speed") && !intended.is_of_speed();
    let each: Lowered<Vec<_>> =
        found.iter().map(|seen| walker(context, (&base, own_speed), seen, &route, &intended)).collect();
    let members = each
        .and_then(|each| enlist(context, &decl.name, found.len(), decl.plural, people, |k| each[k].clone()));
    let Ok(members) = members else {
        define_empty(context, &decl.name, decl.plural || decl.count.is_some(), with);
        return;
    };
    people.written(&members, &[], recorded.span);
    attachment::attach(context, with, &members);
    let meaning = match members.as_slice() {
        [one] if !decl.plural => Meaning::Agent(*one),
        _ => Meaning::Agents { members: members.into(), particle: false },
    };
    context.names.scopes[0].define(&decl.name, meaning);
}

/// Body, start and route of somebody who was seen.
pub(crate) fn walker(
    context: &mut Context<'_>,
    (kind, own_speed): (&Body, bool),
    seen: &Sighting,
    route: &Route,
    intended: &Intended<'_>,
) -> Lowered<(Arc<Body>, Start, Route)> {
    // Around the heading of one alone a law would be wider than around that of the companions.
    let seen = &if intended.is_drawn() { Sighting { driving: seen.shared, ..*seen } } else { *seen };
    let (mut body, mut start, mut route) = (moving(kind, seen, own_speed), start(seen), route.clone());
    intentions::intend(context, intended, (seen, kind), (&mut body, &mut start, &mut route))?;
    Ok((Arc::new(body), start, route))
}

/// Declares somebody who is named and not seen, and so never comes.
pub(crate) fn unseen<'a>(
    context: &mut Context<'a>,
    name: &Ident,
    body: Body,
    with: With<'a>,
    people: &mut People,
) {
    let start = Start::at_rest(Vec2::zeros());
    let route = Route::Legs { legs: Vec::new(), then_leave: false };
    let body = Arc::new(body);
    let every = entities(context, people, &format!("{}.every", name.name), 1, name.span);
    let members = enlist(context, name, 1, false, people, |_| (body.clone(), start.clone(), route.clone()));
    let (Ok(members), Ok(entity)) = (members, every) else {
        define_empty(context, name, false, with);
        return;
    };
    attachment::attach(context, with, &members);
    context.tracks.unseen.push((members[0], entity));
    context.roster.coming = true;
    context.roster.passing.insert(members[0]);
    people.coming.insert(members[0]);
    context.names.scopes[0].define(name, Meaning::Agent(members[0]));
}

/// Sources of those who never come.
pub(crate) fn never_arriving(context: &Context<'_>, people: &People) -> Vec<Source> {
    let source = |(agent, entity): &(AgentId, u32)| Source {
        name: people.agents[agent.0 as usize].name.clone(),
        entity: *entity,
        every: Law::Constant(NEVER),
        members: vec![*agent],
        most: 1,
    };
    context.tracks.unseen.iter().map(source).collect()
}

/// The body of a kind with the speed of somebody who was seen, unless it has one of its own.
fn moving(body: &Body, seen: &Sighting, own_speed: bool) -> Body {
    let mut body = body.clone();
    let speed = seen.driving.norm();
    if speed >= STANDS && !own_speed && body.planner.is_none() {
        body[Parameter::Speed] = Law::Constant(speed);
    }
    body
}

/// The start of somebody who was seen.
fn start(seen: &Sighting) -> Start {
    let driving = (seen.driving != seen.velocity).then_some(seen.driving);
    let velocity = seen.velocity;
    Start { velocity, driving, seen: vec![seen.id], ..Start::at_rest(seen.position) }
}

/// Where somebody goes: its `route`, or in a periodic scene its `direction`, which is part of its start.
pub(crate) fn headed(
    context: &mut Context<'_>,
    fields: &[&Field],
    start: Lowered<Start>,
) -> Lowered<(Start, Route)> {
    let field = |name: &str| fields.iter().find(|field| field.name.name == name);
    let Some(direction) = field("direction") else {
        let route = route_of(context, fields);
        return Ok((start?, route?));
    };
    let law = laws::law(context, &direction.value, Dimension::ANGLE, &Locals::default());
    // A part that could not be read may have been the period.
    let is_torn = context.torn.iter().any(|part| part.span.source == direction.name.span.source);
    let (wrong, hint) = if context.scene.periods.are_none() {
        (
            Some("`direction` needs a periodic scene"),
            "write a `route`, or `periodic x in 0 m .. 20 m` in the scene",
        )
    } else {
        (field("route").map(|_| "an agent has a `direction` or a `route`, not both"), "remove `route`")
    };
    if let Some(text) = wrong.filter(|_| !is_torn) {
        return context.report(error!(E0410, direction.name.span, "{text}"; hint: "{hint}"));
    }
    let start = Start { driving: Some(Vec2::new(1.0, 0.0)), turn: law?, own_speed: true, ..start? };
    Ok((start, Route::Onward))
}
