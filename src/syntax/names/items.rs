//! The names that the items of a scenario declare and use.

use super::Walk;
use crate::syntax::ast::{
    AgentsDecl, BehaviourItem, Choice, Domain, Expr, Field, GroupDecl, Ident, Item, MoveOption, ProcessItem,
    Recorded, SceneItem, Timing,
};
use crate::syntax::source::Span;

impl Walk {
    pub(super) fn recorded(&mut self, recorded: Option<&Recorded>) {
        if let Some(recorded) = recorded {
            self.used(&recorded.tracks);
            self.expr(&recorded.at);
        }
    }

    pub(super) fn item(&mut self, item: &Item) {
        match item {
            Item::Title(_) => {}
            Item::Setting { value, .. } => self.exprs([value]),
            Item::Const { name, value } => {
                self.declare("const", name, value.span, Some(value));
                self.expr(value);
            }
            Item::Param { name, value, range, choices } => {
                self.declare("param", name, value.span, Some(value));
                if choices.is_empty() {
                    self.exprs([value]);
                }
                self.exprs(range.iter().flat_map(|(low, high)| [low, high]));
            }
            Item::Let(decl) => self.named_expression("let", decl),
            Item::Tracks { name, body, .. } => {
                self.declare("tracks", name, end_of(body, name.span), None);
                self.fields(body);
            }
            Item::Scene(items) => items.iter().for_each(|item| self.scene_item(item)),
            Item::Kind(decl) => {
                self.declare("kind", &decl.name, end_of(&decl.body, decl.name.span), None);
                self.all_used(decl.base.iter().chain(&decl.preset));
                self.fields(&decl.body);
            }
            Item::Agents(AgentsDecl { plural, name, count, kind, with, recorded, body }) => {
                let noun = if *plural { "agents" } else { "agent" };
                self.declare(noun, name, end_of(body, kind.span), None);
                self.people(kind, with, body, count.as_ref(), recorded.as_ref());
            }
            Item::Group(GroupDecl { plural, name, count, kind, with, recorded, body, .. }) => {
                let noun = if *plural { "groups" } else { "group" };
                self.declare(noun, name, end_of(body, kind.span), None);
                self.people(kind, with, body, count.as_ref(), recorded.as_ref());
            }
            Item::Moves(decl) => {
                self.used(&decl.agent);
                self.exprs(decl.member.iter().chain([&decl.duration]));
                for option in &decl.options {
                    match option {
                        MoveOption::Headings { from, to, by, .. } => self.exprs([from, to, by]),
                        MoveOption::Heading(angle) => self.exprs([angle]),
                        MoveOption::Route { route, .. } => self.value(route),
                        MoveOption::Stop(_) => {}
                    }
                }
            }
            Item::Paths(decl) => {
                self.used(&decl.agent);
                self.exprs(decl.member.iter().chain([&decl.alternatives]));
            }
            Item::Process(decl) => {
                let at = self.declare("process", &decl.name, decl.span, None);
                self.exprs(&decl.count);
                self.within(at, |walk| decl.items.iter().for_each(|item| walk.process_item(item)));
            }
            Item::Program(decl) => {
                let at = self.declare("program", &decl.process.name, decl.process.span, None);
                if let Some(people) = &decl.people {
                    self.declare("agents", &people.name, people.columns.span, None);
                    self.exprs(&people.count);
                }
                self.within(at, |walk| {
                    decl.signals.iter().for_each(|signal| walk.named_expression("signal", signal));
                });
                self.fields(&decl.body);
            }
            Item::Behaviour(decl) => {
                let at = self.declare("behaviour", &decl.name, decl.span, None);
                self.within(at, |walk| {
                    walk.binding(&decl.arguments, |walk| {
                        decl.items.iter().for_each(|item| walk.behaviour_item(item));
                    });
                });
            }
            Item::Source(decl) => {
                self.declare("source", &decl.name, decl.span, None);
                self.people(&decl.kind, &decl.with, &decl.body, None, None);
            }
        }
    }

    pub(super) fn people(
        &mut self,
        kind: &Ident,
        with: &[Expr],
        body: &[Field],
        count: Option<&Expr>,
        recorded: Option<&Recorded>,
    ) {
        self.used(kind);
        self.exprs(with.iter().chain(count));
        self.recorded(recorded);
        self.fields(body);
    }

    pub(super) fn scene_item(&mut self, item: &SceneItem) {
        match item {
            SceneItem::Wall { name, points, span } => {
                if let Some(name) = name {
                    self.declare("wall", name, *span, None);
                }
                self.exprs(points);
            }
            SceneItem::Obstacle { name, shape } => {
                if let Some(name) = name {
                    self.declare("obstacle", name, shape.span(), None);
                }
                self.shape(shape);
            }
            SceneItem::Region { name, shape } => {
                self.declare("region", name, shape.span(), None);
                self.shape(shape);
            }
            SceneItem::Point { name, at } => {
                self.declare("point", name, at.span, Some(at));
                self.expr(at);
            }
            SceneItem::Line { name, ends, span } => {
                self.declare("line", name, *span, None);
                self.exprs(ends);
            }
            SceneItem::Door { name, ends, fields, span } => {
                self.declare("door", name, *span, None);
                self.exprs(ends);
                self.fields(fields);
            }
            SceneItem::Level { name, fields, items } => {
                let at = self.declare("level", name, end_of(fields, name.span), None);
                self.fields(fields);
                self.within(at, |walk| items.iter().for_each(|item| walk.scene_item(item)));
            }
            SceneItem::Stairs { name, ends, fields, span } => {
                self.declare("stairs", name, *span, None);
                self.exprs(ends);
                self.fields(fields);
            }
            SceneItem::Periodic { ends, .. } => self.exprs(ends),
            SceneItem::Import { called, fields, span, .. } => {
                if let Some(name) = called {
                    self.declare("import", name, *span, None);
                }
                self.fields(fields);
            }
            SceneItem::Storeys { import, levels, storey } => {
                self.scene_item(import);
                for (name, text) in levels {
                    self.declare("level", name, text.span, None);
                }
                self.exprs(storey);
            }
        }
    }

    pub(super) fn process_item(&mut self, item: &ProcessItem) {
        match item {
            ProcessItem::Var(decl) => {
                self.declare("var", &decl.name, decl.initial.span, Some(&decl.initial));
                if let Some(Domain::Range(low, high)) = &decl.domain {
                    self.exprs([low, high]);
                }
                self.expr(&decl.initial);
            }
            ProcessItem::Let(decl) => self.named_expression("let", decl),
            ProcessItem::Label { name, value } => {
                self.declare("label", name, value.span, Some(value));
                self.expr(value);
            }
            ProcessItem::Command(command) => {
                self.expr(&command.guard);
                match &command.timing {
                    Some(Timing::Rate(rate)) => self.exprs([rate]),
                    Some(Timing::Delay(delay)) => self.value(delay),
                    None => {}
                }
                for branch in &command.branches {
                    self.exprs(&branch.weight);
                    for update in &branch.updates {
                        self.used(&update.target);
                        self.expr(&update.value);
                    }
                }
            }
            ProcessItem::Choose(_) => {}
        }
    }

    pub(super) fn behaviour_item(&mut self, item: &BehaviourItem) {
        match item {
            BehaviourItem::State(state) => {
                self.declare("state", &state.name, state.span, None);
                self.fields(&state.fields);
                for transition in &state.transitions {
                    self.exprs(&transition.guard);
                    transition.after.iter().for_each(|after| self.value(after));
                    self.choices(&transition.targets);
                }
            }
            BehaviourItem::On(on) => self.choices(&on.choices),
            BehaviourItem::Let(decl) => self.named_expression("let", decl),
        }
    }

    pub(super) fn choices(&mut self, choices: &[Choice]) {
        for choice in choices {
            self.exprs(&choice.weight);
            self.member(self.inside, &choice.target);
        }
    }
}

/// The end of the last field of a declaration.
fn end_of(fields: &[Field], without: Span) -> Span {
    fields.last().map_or(without, |field| without.to(field.value.span()))
}
