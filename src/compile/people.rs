//! Agents: declared one by one, in numbers, or from a recording.

use super::behaviour::With;
use super::dimension::Dimension;
use super::elaborator::{Elaborator, Locals, Lowered};
use super::kinds::Kind;
use super::laws::value_span;
use super::places::Written;
use super::sighting::Sighting;
use super::symbols::{Meaning, unknown};
use super::wishes::{Intended, split};
use crate::base::geometry::Vec2;
use crate::base::random::name_hash;
use crate::model::{Agent, AgentId, Body, Group, Law, Parameter, Route, Source, Start};
use crate::syntax::ast::{AgentsDecl, Expr, Field, Ident};
use crate::syntax::codes::Code;
use crate::syntax::source::Span;
use std::collections::BTreeSet;
use std::sync::Arc;

/// Speed below which a recorded person stands, m/s.
pub(super) const STANDS: f64 = 0.05;
/// After so many seconds nobody is waited for.
const NEVER: f64 = 1e9;
/// Most agents of a scenario.
const MOST_AGENTS: usize = 1_000_000;
/// Most stable numbers of a declaration.
const MOST_ENTITIES: u64 = 1 << 20;

/// The people of a scenario so far.
#[derive(Default)]
pub(super) struct People {
    /// Agents.
    pub(super) agents: Vec<Agent>,
    /// Groups.
    pub(super) groups: Vec<Group>,
    /// Where the starts are written.
    pub(super) places: Written,
    /// Agents of a source.
    pub(super) coming: BTreeSet<AgentId>,
    /// First numbers and sizes of the ranges of entities in use.
    ranges: Vec<(u32, u32)>,
}

impl People {
    /// Remembers where the start of some people is written: their field `at`, or else `other`.
    pub(super) fn written(&mut self, members: &[AgentId], fields: &[&Field], other: Span) {
        let at = fields.iter().find(|field| field.name.name == "at").map(|field| value_span(&field.value));
        if let Some(first) = members.first() {
            self.places.push((*first, at.unwrap_or(other)));
        }
    }

    /// A range of `size` stable numbers for a declaration; where ranges collide, the next free one, if there is one. It
    /// begins where the name says, whatever the size: who is there already keeps its numbers when more are declared.
    fn entities(&mut self, path: &str, size: u32) -> Option<u32> {
        const ALL: u64 = 1 << 24;
        let mut first = name_hash(path) % (ALL - MOST_ENTITIES);
        let mut turned = false;
        while let Some((start, length)) = self.ranges.iter().find(|(start, length)| {
            first < u64::from(start + length) && u64::from(*start) < first + u64::from(size)
        }) {
            first = u64::from(start + length);
            if first + u64::from(size) >= ALL {
                if std::mem::replace(&mut turned, true) {
                    return None;
                }
                first = 0;
            }
        }
        self.ranges.push((first as u32, size));
        Some(first as u32)
    }
}

impl<'a> Elaborator<'a> {
    /// A range of `size` stable numbers for what is declared at a place.
    pub(super) fn entities(
        &mut self,
        people: &mut People,
        path: &str,
        size: u32,
        span: Span,
    ) -> Lowered<u32> {
        match people.entities(path, size) {
            Some(first) => Ok(first),
            None => self.report(
                error!(E0913, span, "too many agents: the 16 million stable ids are used up";
                    hint: "every agent that may arrive by a source needs an id: reduce the arrivals, or shorten the horizon"),
            ),
        }
    }

    /// `agent user: adult { … }`, `agents crowd[12]: adult { … }`
    pub(super) fn agents(&mut self, decl: &'a AgentsDecl, people: &mut People) {
        let kind = self.kind(&decl.kind);
        let count = match (&decl.count, &decl.recorded) {
            (Some(count), None) if !decl.plural => self
                .report(error!(E0402, count.span, "`agent` declares only one agent";
                    hint: "write `agents {}[…]: …` for several agents", decl.name.name)),
            (Some(count), None) => self.count(count),
            (Some(count), Some(_)) => {
                let said = "the recording determines the number of agents";
                self.report(error!(E0402, count.span, "{said}"; hint: "remove the number in brackets"))
            }
            (None, None) if decl.plural => self
                .report(error!(E0402, decl.name.span, "the number of `{}` is missing", decl.name.name;
                    hint: "write `agents {}[12]: …`", decl.name.name)),
            _ => Ok(1),
        };
        let with = self.with(&decl.name, &decl.with);
        if let Some(recorded) = &decl.recorded {
            self.recorded(decl, recorded, kind, with, people);
            return;
        }
        let mut kind = kind;
        let rest = self.parameters(&decl.body, kind.as_mut().ok(), &Locals::default());
        let start = self.start(&decl.name, &rest, people, true);
        let headed = self.headed(&rest, start);
        self.only(&rest, &["at", "velocity", "route", "direction"]);
        let body = kind.and_then(|kind| self.body(&kind, &decl.kind));
        let (Ok(count), Ok(body), Ok((start, route))) = (count, body, headed) else {
            self.define_empty(&decl.name, decl.plural || decl.count.is_some(), with);
            return;
        };
        let Ok(members) = self.people(&decl.name, count, decl.plural, people, |_| {
            (Arc::new(body.clone()), start.clone(), route.clone())
        }) else {
            self.define_empty(&decl.name, decl.plural || decl.count.is_some(), with);
            return;
        };
        people.written(&members, &rest, decl.name.span);
        self.attach(with, &members);
        let meaning = match members.as_slice() {
            [one] if !decl.plural => Meaning::Agent(*one),
            _ => Meaning::Agents { members: members.into(), particle: false },
        };
        self.scopes[0].define(&decl.name, meaning);
    }

    pub(super) fn define_empty(&mut self, name: &Ident, plural: bool, with: With<'a>) {
        // What follows can then speak of the name without further errors. Numbers of people begin at 0.
        let id = AgentId(u32::MAX - self.undeclared.len() as u32);
        self.undeclared.insert(id);
        self.attach(with, &[id]);
        let meaning = if plural {
            Meaning::Agents { members: [id].into(), particle: false }
        } else {
            Meaning::Agent(id)
        };
        self.scopes[0].define(name, meaning);
    }

    /// Adds `count` people of one declaration.
    pub(super) fn people(
        &mut self,
        name: &Ident,
        count: usize,
        plural: bool,
        people: &mut People,
        each: impl Fn(usize) -> (Arc<Body>, Start, Route),
    ) -> Lowered<Vec<AgentId>> {
        let first = self.entities(people, &name.name, count as u32, name.span)?;
        Ok(self.members(name, count, plural, first, people, each))
    }

    /// Adds `count` people of one declaration, whose stable numbers begin with `first`.
    pub(super) fn members(
        &mut self,
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
                // Equal bodies are kept once.
                let body = match &shared {
                    Some(known) if **known == *body => known.clone(),
                    _ => body,
                };
                shared = Some(body.clone());
                self.agent_names.push(text.clone());
                let legs = if let Route::OneOf { .. } = route { 1 } else { route.goals().count() };
                self.legs.push(legs as u32);
                if matches!(route, Route::Legs { then_leave: true, .. }) {
                    self.may_be_absent(AgentId(self.agent_names.len() as u32 - 1));
                }
                let entity = first + k as u32;
                people.agents.push(Agent {
                    name: text,
                    entity,
                    body,
                    start,
                    route,
                    group: None,
                    particle: None,
                });
                AgentId(people.agents.len() as u32 - 1)
            })
            .collect()
    }

    /// Remembers that an agent is not there all the time.
    pub(super) fn may_be_absent(&mut self, agent: AgentId) {
        self.passing.insert(agent);
    }

    pub(super) fn count(&mut self, expr: &Expr) -> Lowered<usize> {
        let number = self.number_of(expr, Dimension::NONE, &Locals::default())?;
        match number.as_whole() {
            Some(n) if n < 0 => {
                let said = format!("the number of agents cannot be negative (got {n})");
                self.report(error!(E0402, expr.span, "{said}"))
            }
            Some(n) if n as usize <= MOST_AGENTS => Ok(n as usize),
            Some(n) => self.report(error!(
                E0402,
                expr.span, "the number of agents must be at most {MOST_AGENTS} (got {n})"
            )),
            None if number.value > MOST_AGENTS as f64 && number.value.fract() == 0.0 => {
                let text =
                    format!("the number of agents must be at most {MOST_AGENTS} (got {})", number.value);
                self.report(error!(E0402, expr.span, "{text}"))
            }
            None => self.report(
                error!(E0402, expr.span, "the number of agents must be whole (got {})", number.value;
                    hint: "round it: `round(…)`"),
            ),
        }
    }

    pub(super) fn route_of(&mut self, fields: &[&Field]) -> Lowered<Route> {
        match fields.iter().find(|f| f.name.name == "route") {
            Some(field) => self.route(&field.value, &Locals::default()),
            None => Ok(Route::Legs { legs: Vec::new(), then_leave: false }),
        }
    }

    /// Refuses fields that mean nothing here.
    pub(super) fn only(&mut self, fields: &[&Field], known: &[&str]) {
        for field in fields.iter().filter(|field| !known.contains(&field.name.name.as_str())) {
            let all = known.iter().copied().chain(Parameter::ALL.map(Parameter::name));
            let error = unknown("field", &field.name.name, field.name.span, Code::E0207, all);
            self.note(error);
            // It may have been the radius.
            self.any_start = true;
            self.look_at(&field.value, &Locals::default());
        }
    }

    /// People whose start state a recording gives.
    fn recorded(
        &mut self,
        decl: &'a AgentsDecl,
        recorded: &'a crate::syntax::ast::Recorded,
        kind: Lowered<Kind>,
        with: With<'a>,
        people: &mut People,
    ) {
        let found = self.sighted(recorded, !decl.plural);
        let mut kind = kind;
        let (wants, fields) = split(&decl.body);
        let rest = self.parameters(fields, kind.as_mut().ok(), &Locals::default());
        let intended = self.intended(&wants);
        let has_route = rest.iter().any(|f| f.name.name == "route");
        let route = if has_route { self.route_of(&rest) } else { Ok(Route::Onward) };
        self.only(&rest, &["route"]);
        let base = kind.and_then(|kind| self.body(&kind, &decl.kind));
        let (Ok(found), Ok(base), Ok(route), Ok(intended)) = (found, base, route, intended) else {
            self.define_empty(&decl.name, decl.plural || decl.count.is_some(), with);
            return;
        };
        if found.people.is_empty() && !decl.plural {
            self.unseen(&decl.name, base, with, people);
            return;
        }
        let found = self.onto_rims(recorded, found.people, &base[Parameter::Radius]);
        let own_speed = decl.body.iter().any(|f| f.name.name == "speed") && !intended.is_of_speed();
        let each: Lowered<Vec<_>> =
            found.iter().map(|seen| self.walker((&base, own_speed), seen, &route, &intended)).collect();
        let members = each
            .and_then(|each| self.people(&decl.name, found.len(), decl.plural, people, |k| each[k].clone()));
        let Ok(members) = members else {
            self.define_empty(&decl.name, decl.plural || decl.count.is_some(), with);
            return;
        };
        people.written(&members, &[], recorded.span);
        self.attach(with, &members);
        let meaning = match members.as_slice() {
            [one] if !decl.plural => Meaning::Agent(*one),
            _ => Meaning::Agents { members: members.into(), particle: false },
        };
        self.scopes[0].define(&decl.name, meaning);
    }

    /// Body, start and route of somebody who was seen.
    pub(super) fn walker(
        &mut self,
        (body, own_speed): (&Body, bool),
        seen: &Sighting,
        route: &Route,
        intended: &Intended<'_>,
    ) -> Lowered<(Arc<Body>, Start, Route)> {
        let (mut body, mut start, mut route) = (moving(body, seen, own_speed), start(seen), route.clone());
        self.intend(intended, seen, (&mut body, &mut start, &mut route))?;
        Ok((Arc::new(body), start, route))
    }

    /// Declares somebody who is named and not seen, and so never comes.
    pub(super) fn unseen(&mut self, name: &Ident, body: Body, with: With<'a>, people: &mut People) {
        let start = Start::at_rest(Vec2::zeros());
        let route = Route::Legs { legs: Vec::new(), then_leave: false };
        let body = Arc::new(body);
        let every = self.entities(people, &format!("{}.every", name.name), 1, name.span);
        let members = self.people(name, 1, false, people, |_| (body.clone(), start.clone(), route.clone()));
        let (Ok(members), Ok(entity)) = (members, every) else {
            self.define_empty(name, false, with);
            return;
        };
        self.attach(with, &members);
        self.unseen.push((members[0], entity));
        self.coming = true;
        self.may_be_absent(members[0]);
        people.coming.insert(members[0]);
        self.scopes[0].define(name, Meaning::Agent(members[0]));
    }

    /// Sources of those who never come.
    pub(super) fn never_arriving(&self, people: &People) -> Vec<Source> {
        let source = |(agent, entity): &(AgentId, u32)| Source {
            name: people.agents[agent.0 as usize].name.clone(),
            entity: *entity,
            every: Law::Constant(NEVER),
            members: vec![*agent],
            most: 1,
        };
        self.unseen.iter().map(source).collect()
    }
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
