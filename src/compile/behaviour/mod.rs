//! Behaviours: who has which, and what they are when names, units and arguments are settled.
//!
//! `with phone, heedful(0.8)` fills in the arguments. What a state changes and how it ends is lowered once for a
//! declaration; conditions are lowered for each member, because they speak of `self`.

mod conduct;
mod names;

use super::consequences::words;
use super::elaborator::{Elaborator, Locals, Lowered, Reported};
use super::lower::counted_arguments;
use super::people::People;
use super::symbols::{Meaning, unknown};
use super::typed::Typed;
use crate::model::{AgentId, Attached, Behaviour, BehaviourId, Behaviours, Mode, Parameter, Route, Who};
use crate::syntax::ast::process::{BehaviourDecl, BehaviourItem, StateDecl};
use crate::syntax::ast::{Expr, ExprKind, Field, Ident, LetDecl};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::{Diagnostic, Label, Severity};
use crate::syntax::source::{Source, Span};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Events that reach agents from outside the model.
const EVENTS: [&str; 1] = ["advice"];
/// The answers to advice.
const OUTCOMES: [&str; 2] = ["follow", "ignore"];
/// Codes of errors of behaviours that do not depend on the agents that have them: weights, delays, fields of a state.
const OF_NO_AGENT: [Code; 3] = [Code::E0902, Code::E0906, Code::E0911];

/// `with` of one declaration, and those who have it.
pub(super) struct With<'a> {
    /// Behaviours, in order of writing, with their arguments.
    behaviours: Vec<(BehaviourId, &'a [Expr], &'a Expr)>,
    /// Name of the declaration.
    name: String,
    members: Vec<AgentId>,
    /// Whether it names an unknown behaviour.
    strays: bool,
    /// For a source: the largest number of agents.
    pub(super) most: u32,
}

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

fn states(decl: &BehaviourDecl) -> impl Iterator<Item = &StateDecl> {
    decl.items
        .iter()
        .filter_map(|item| if let BehaviourItem::State(state) = item { Some(state) } else { None })
}

fn lets(decl: &BehaviourDecl) -> impl Iterator<Item = &LetDecl> {
    decl.items.iter().filter_map(|item| if let BehaviourItem::Let(decl) = item { Some(decl) } else { None })
}

impl<'a> Elaborator<'a> {
    /// Declares a behaviour and checks what needs no arguments: names of states, fields and events.
    pub(super) fn declare_behaviour(&mut self, decl: &'a BehaviourDecl) {
        self.behaviours.push(decl);
        self.check_arguments(&decl.arguments);
        let mut seen: BTreeMap<&str, &Ident> = BTreeMap::new();
        let names = Names::of(states(decl).map(|state| state.name.name.as_str()));
        for item in &decl.items {
            let name = match item {
                BehaviourItem::State(state) => {
                    self.check_state(state, &names);
                    &state.name
                }
                BehaviourItem::Let(decl) => &decl.name,
                BehaviourItem::On(on) => {
                    if !EVENTS.contains(&on.event.name.as_str()) {
                        let known = EVENTS.into_iter();
                        let error = unknown("event", &on.event.name, on.event.span, Code::E0201, known)
                            .hint("the only event is `advice`, a move suggested to the agent; write other events as conditions of a state: `when self in exit -> …`, `when contact(self) -> …`");
                        self.note(error);
                    }
                    self.check_targets(
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
                self.note(error);
            }
        }
    }

    fn check_state(&mut self, state: &'a StateDecl, names: &Names<'_>) {
        let mut set: BTreeMap<&str, &Field> = BTreeMap::new();
        for field in &state.fields {
            let name = field.name.name.as_str();
            let first = *set.entry(name).or_insert(field);
            if !std::ptr::eq(first, field) {
                let error = error!(E0202, field.name.span, "`{name}` is set twice")
                    .related(first.name.span, "first set here");
                self.note(error);
            } else if Parameter::named(name).is_some_and(|known| !known.description().changeable) {
                self.note(error!(E0911, field.name.span, "`{name}` belongs to the body and cannot change";
                    hint: "a state can set {} and route", all_parameters().join(", ")));
            } else if name != "route" && Parameter::changeable_of(name).is_none() {
                let known = all_parameters().into_iter().chain(["route"]);
                let error = unknown("parameter", name, field.name.span, Code::E0207, known);
                self.note(error);
            }
        }
        for transition in &state.transitions {
            self.check_targets(transition.targets.iter().map(|choice| &choice.target), names, "state");
        }
    }

    fn check_targets(&mut self, targets: impl Iterator<Item = &'a Ident>, known: &Names<'_>, what: &str) {
        for target in targets {
            if !known.sorted.contains(target.name.as_str()) {
                let looked_at = if self.looks_for_names() { usize::MAX } else { 0 };
                let names = known.written.iter().copied().take(looked_at);
                let error = unknown(what, &target.name, target.span, Code::E0201, names);
                let error = match &error.hint {
                    Some(_) => error,
                    None => error.hint(format!("the fields are {}", known.listed())),
                };
                self.note(error);
            }
        }
    }

    /// The behaviours that a declaration names after `with`. Errors are noted.
    pub(super) fn with(&mut self, name: &Ident, with: &'a [Expr]) -> With<'a> {
        let mut behaviours: Vec<(BehaviourId, &'a [Expr], &'a Expr)> = Vec::new();
        let mut strays = false;
        for expr in with {
            let (called, arguments): (&str, &'a [Expr]) = match &expr.kind {
                ExprKind::Name(called) => (called, &[]),
                ExprKind::Call { function, arguments } => (&function.name, arguments),
                _ => {
                    self.note(error!(E0305, expr.span, "expected a behaviour";
                        hint: "for example `with phone, heedful(0.8)`"));
                    strays = true;
                    continue;
                }
            };
            let id = match self.find(called, 0) {
                Some((_, Meaning::Behaviour(id))) => id,
                Some((_, other)) => {
                    if !matches!(other, Meaning::Doubtful) {
                        let text = format!("expected a behaviour, but `{called}` is {}", other.noun());
                        self.note(error!(E0206, expr.span, "{text}"));
                    }
                    self.stray.push(arguments);
                    strays = true;
                    continue;
                }
                None => {
                    let known: Vec<&str> =
                        self.behaviours.iter().map(|decl| decl.name.name.as_str()).collect();
                    let error = unknown("behaviour", called, expr.span, Code::E0201, known.into_iter());
                    self.note(error);
                    self.stray.push(arguments);
                    strays = true;
                    continue;
                }
            };
            if let Some((.., first)) = behaviours.iter().find(|(known, ..)| *known == id) {
                let error = error!(E0912, expr.span, "`{}` already has the behaviour `{called}`", name.name)
                    .related(first.span, "first attached here");
                self.note(error);
                self.stray.push(arguments);
                continue;
            }
            behaviours.push((id, arguments, expr));
        }
        With { behaviours, name: name.name.clone(), members: Vec::new(), strays, most: 0 }
    }

    /// Gives behaviours to the members of a declaration.
    pub(super) fn attach(&mut self, mut with: With<'a>, members: &[AgentId]) {
        with.members = members.to_vec();
        if with.strays {
            self.strayed.extend(members);
        }
        for (behaviour, ..) in &with.behaviours {
            self.having.extend(members.iter().map(|member| (*member, *behaviour)));
        }
        self.withs.push(with);
    }

    /// Whether an agent has a behaviour.
    fn has_behaviour(&self, agent: AgentId, behaviour: BehaviourId) -> bool {
        self.having.contains(&(agent, behaviour))
    }

    /// Lowers the behaviours of all agents.
    pub(super) fn settle_behaviours(&mut self, people: &mut People, variables: usize) -> Behaviours {
        let mut out = Behaviours::default();
        for decl in &self.behaviours {
            let states = states(decl).map(|state| state.name.name.clone()).collect();
            self.origins.behaviours.push(decl.name.span);
            out.declared.push(Behaviour { name: decl.name.name.clone(), states });
        }
        // Errors outside of behaviours may have taken away whom these speak of.
        let declared: Vec<Span> = self.behaviours.iter().map(|decl| decl.span).collect();
        let inside = |place: Span| {
            let holds = |span: &Span| {
                span.source == place.source && span.start <= place.start && place.end <= span.end
            };
            declared.iter().any(holds)
        };
        let elsewhere = |d: &Diagnostic| {
            d.severity == Severity::Error && d.place.as_ref().is_none_or(|place| !inside(place.span))
        };
        let taken = self.diagnostics.iter().any(elsewhere);
        let before = self.diagnostics.len();
        for arguments in std::mem::take(&mut self.stray) {
            let _ = self.lower_all(arguments, &Locals::of(0));
        }
        let withs = std::mem::take(&mut self.withs);
        for with in &withs {
            for &(id, arguments, written) in &with.behaviours {
                match self.settle_one(with, id, (arguments, written), people, variables) {
                    Ok(attached) => out.attached.extend(attached),
                    // The failure was reported; a behaviour is never dropped without a diagnostic.
                    Err(Reported) if self.failed() || !self.torn.is_empty() => {}
                    Err(Reported) => {
                        let text = "internal error: this behaviour was rejected without a diagnostic";
                        self.note(error!(E0305, written.span, "{text}"));
                    }
                }
            }
        }
        self.withs = withs;
        self.check_unused_behaviours(variables);
        if taken {
            // Errors elsewhere, as in a constant that they use, do not depend on the agent; nor do weights, delays and fields.
            let found = self.diagnostics.split_off(before.min(self.diagnostics.len()));
            let of_no_agent =
                |one: &Diagnostic| elsewhere(one) || OF_NO_AGENT.contains(&one.code) || self.is_sure(one);
            let kept: Vec<Diagnostic> = found.into_iter().filter(of_no_agent).collect();
            self.diagnostics.extend(kept);
        }
        for one in &out.attached {
            let leaves = |mode: &Mode| matches!(mode.route, Some(Route::Legs { then_leave: true, .. }));
            if one.conduct.states.iter().any(leaves) {
                self.may_be_absent(one.agent);
            }
        }
        // Of one agent they stay in order of `with`.
        out.attached.sort_by_key(|one| one.agent);
        out
    }

    /// How each agent was given each of its behaviours.
    pub(super) fn written_with(&self) -> BTreeMap<(AgentId, BehaviourId), String> {
        let each = |with: &With<'a>| {
            let texts: Vec<_> =
                with.behaviours.iter().map(|&(id, _, written)| (id, self.text(written.span))).collect();
            let members = with.members.iter().copied();
            members
                .flat_map(|agent| {
                    texts.iter().map(move |(id, text)| ((agent, *id), text.clone())).collect::<Vec<_>>()
                })
                .collect::<Vec<_>>()
        };
        self.withs.iter().flat_map(each).collect()
    }

    /// Adds the arguments of a behaviour to the errors in it that depend on them, from a given error on.
    fn given(&mut self, from: usize, decl: &BehaviourDecl, at: Span) {
        // What stands before the place in its condition or value belongs to it: `gap > 2` is wrong at its number.
        let hangs = |sources: &[Source], place: Span| {
            let source = sources.iter().find(|source| source.id == place.source)?;
            let before = source.text.get(source.line_start(place.start) as usize..place.start as usize)?;
            let starts = ["when ", "after ", " = ", "{", "->"].iter();
            let start = starts.filter_map(|word| before.rfind(word).map(|at| at + word.len())).max();
            let own = source.text.get(place.start as usize..place.end as usize)?;
            let is_given = |word: &str| decl.arguments.iter().any(|argument| argument.name == word);
            Some(words(&before[start.unwrap_or(0)..]).chain(words(own)).any(is_given))
        };
        for one in self.diagnostics.iter_mut().skip(from) {
            let Some(place) = one.place.as_ref().map(|place| place.span) else { continue };
            let inside = place.source == decl.span.source
                && decl.span.start <= place.start
                && place.end <= decl.span.end;
            let is_marked = one.related.iter().any(|label| label.span == at);
            let of_value = one.code.is_of("E03") || one.code == Code::E0405;
            if inside && of_value && !is_marked && hangs(self.sources, place) == Some(true) {
                one.related.push(Label { span: at, text: "with these arguments".to_owned() });
            }
        }
    }

    fn settle_one(
        &mut self,
        with: &With<'a>,
        id: BehaviourId,
        (arguments, written): (&'a [Expr], &'a Expr),
        people: &mut People,
        variables: usize,
    ) -> Lowered<Vec<Attached>> {
        let decl = self.behaviours[id.0 as usize];
        let mut locals = Locals::of(0);
        let mut failed = arguments.len() != decl.arguments.len();
        if failed {
            let wanted = counted_arguments(decl.arguments.len());
            let _: Lowered<()> = self.arity(&decl.name, written.span, &wanted, (arguments, &locals));
            // It is unknown which of them is missing.
            decl.arguments.iter().for_each(|name| locals.bind_unknown(&name.name));
        }
        let given = if failed { &[] } else { arguments };
        for (name, argument) in decl.arguments.iter().zip(given) {
            match self.lower(argument, &Locals::of(0)) {
                Ok(value) => locals.bind(&name.name, value),
                Err(Reported) => {
                    locals.bind_unknown(&name.name);
                    failed = true;
                }
            }
        }
        locals.behaviour = Some((id.0, locals.names.len() + 1));
        let first = with.members.first().copied().unwrap_or(AgentId(0));
        self.attached_at = (!arguments.is_empty()).then_some(written.span);
        let having = with.members.is_empty().then(|| self.having.clone());
        if having.is_some() {
            self.stand_in();
        }
        let before = self.diagnostics.len();
        let conduct = self.conduct(decl, &of(&locals, first), variables);
        self.attached_at = None;
        if failed || conduct.is_err() {
            // What is wrong with its conditions is said too.
            let _ = self.conditions(decl, &of(&locals, first));
            if !failed {
                self.given(before, decl, written.span);
            }
        }
        if let Some(having) = having {
            self.having = having;
        }
        let conduct = Arc::new(conduct?);
        if failed {
            return Err(Reported);
        }
        let path = format!("{}.{}", with.name, decl.name.name);
        let entity = self.entities(people, &path, with.members.len() as u32, written.span)?;
        // Later people on the places of a source have numbers of their own.
        let later = match with.most {
            0 => 0,
            most => self.entities(people, &format!("{path}.later"), most, written.span)?,
        };
        let mut out = Vec::with_capacity(with.members.len());
        for (k, &agent) in with.members.iter().enumerate() {
            let Ok(guards) = self.conditions(decl, &of(&locals, agent)) else {
                self.given(before, decl, written.span);
                return Err(Reported);
            };
            let (entity, later) = (entity + k as u32, later + k as u32);
            out.push(Attached { agent, behaviour: id, entity, later, conduct: conduct.clone(), guards });
        }
        Ok(out)
    }

    /// Uses the first agent in place of any agent, with any behaviour.
    pub(super) fn stand_in(&mut self) {
        self.having.extend((0..self.behaviours.len()).map(|k| (AgentId(0), BehaviourId(k as u32))));
    }

    /// Checks behaviours that no agent has, except the parts that depend on their arguments.
    fn check_unused_behaviours(&mut self, variables: usize) {
        // Whoever would have one could have the others too.
        let having = self.having.clone();
        self.stand_in();
        for (k, decl) in self.behaviours.clone().into_iter().enumerate() {
            let id = BehaviourId(k as u32);
            let used = self.withs.iter().any(|with| with.behaviours.iter().any(|(known, ..)| *known == id));
            if !used {
                let mut locals = Locals::of(0);
                for argument in &decl.arguments {
                    locals.bind_unknown(&argument.name);
                }
                locals.behaviour = Some((id.0, locals.names.len() + 1));
                let locals = if self.agent_names.is_empty() {
                    locals.names.insert(0, ("self".to_owned(), None));
                    locals
                } else {
                    of(&locals, AgentId(0))
                };
                let _: Result<_, Reported> = self.conduct(decl, &locals, variables);
                let _: Result<_, Reported> = self.conditions(decl, &locals);
            }
        }
        self.having = having;
    }
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
