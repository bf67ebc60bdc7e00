//! How parameters, names, processes and behaviours were written, with their units, for `smc show`.

use crate::compile::context::{Context, conducts::With};
use crate::model::{AgentId, BehaviourId};
use crate::syntax::ast::process::{BehaviourItem, ProcessDecl, ProcessItem, VarDecl};
use crate::syntax::ast::{Expr, Item, LetDecl, ScenarioFile};
use std::collections::BTreeMap;

/// Texts of a scenario.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Written {
    /// `density = 0.4 /m^2 in 0 /m^2 .. 2 /m^2`
    pub parameters: Vec<String>,
    /// `gap(a) = distance(user, a) - radius(user) - radius(a)`
    pub names: Vec<String>,
    /// Name of a process, with the number of its copies, and its lines.
    pub processes: Vec<(String, Vec<String>)>,
    /// The conditions of the transitions of each behaviour, in order of writing.
    pub conditions: Vec<Vec<String>>,
    /// How an agent was given a behaviour: `wary(1.5 m)`.
    pub with: BTreeMap<(AgentId, BehaviourId), String>,
    /// Names of the arguments of each behaviour.
    pub arguments: Vec<Vec<String>>,
}

/// How a scenario was written.
pub(crate) fn written(context: &Context<'_>, file: &ScenarioFile) -> Written {
    let mut out = Written { with: written_with(context), ..Written::default() };
    for item in &file.items {
        match item {
            Item::Param { name, value, range, choices } => {
                let range = match range {
                    Some((low, high)) => {
                        format!(" in {} .. {}", context.text(low.span), context.text(high.span))
                    }
                    None if choices.is_empty() => String::new(),
                    None => {
                        let names: Vec<&str> = choices.iter().map(|choice| choice.name.as_str()).collect();
                        format!(" in {}", names.join(", "))
                    }
                };
                out.parameters.push(format!("{} = {}{range}", name.name, context.text(value.span)));
            }
            Item::Let(decl) => out.names.push(written_let(context, decl)),
            Item::Process(decl) => out.processes.push(written_process(context, decl)),
            Item::Program(decl) => out.names.extend(decl.signals.iter().map(|one| written_let(context, one))),
            Item::Behaviour(decl) => {
                out.arguments.push(decl.arguments.iter().map(|name| name.name.clone()).collect());
                let states = decl.items.iter().filter_map(|item| match item {
                    BehaviourItem::State(state) => Some(state),
                    _ => None,
                });
                let guards = states.flat_map(|state| &state.transitions).filter_map(|t| t.guard.as_ref());
                out.conditions.push(guards.map(|guard| context.text(guard.span)).collect());
            }
            _ => {}
        }
    }
    out
}

fn written_let(context: &Context<'_>, decl: &LetDecl) -> String {
    let arguments: Vec<&str> = decl.arguments.iter().map(|name| name.name.as_str()).collect();
    let arguments = if arguments.is_empty() { String::new() } else { format!("({})", arguments.join(", ")) };
    format!("{}{arguments} = {}", decl.name.name, context.text(decl.body.span))
}

fn written_process(context: &Context<'_>, decl: &ProcessDecl) -> (String, Vec<String>) {
    let copies = |count: &Expr| format!("[{}]", context.text(count.span));
    let head = format!("{}{}", decl.name.name, decl.count.as_ref().map_or(String::new(), copies));
    let line = |item: &ProcessItem| match item {
        ProcessItem::Var(VarDecl { name, initial, .. }) => {
            format!("var {}", context.text(name.span.to(initial.span)))
        }
        ProcessItem::Let(decl) => format!("let {}", written_let(context, decl)),
        ProcessItem::Label { name, value } => format!("label {} = {}", name.name, context.text(value.span)),
        ProcessItem::Command(command) => context.text(command.span),
        ProcessItem::Choose(_) => "choose".to_owned(),
    };
    (head, decl.items.iter().map(line).collect())
}

/// How each agent was given each of its behaviours.
fn written_with<'a>(context: &Context<'a>) -> BTreeMap<(AgentId, BehaviourId), String> {
    let each = |with: &With<'a>| {
        let texts: Vec<_> =
            with.behaviours.iter().map(|&(id, _, written)| (id, context.text(written.span))).collect();
        let members = with.members.iter().copied();
        members
            .flat_map(|agent| {
                texts.iter().map(move |(id, text)| ((agent, *id), text.clone())).collect::<Vec<_>>()
            })
            .collect::<Vec<_>>()
    };
    context.conducts.withs.iter().flat_map(each).collect()
}
