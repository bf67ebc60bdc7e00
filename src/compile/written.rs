//! How parameters, names, processes and behaviours were written, with their units, for `smc show`.

use super::elaborator::Elaborator;
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

impl Elaborator<'_> {
    /// How a scenario was written.
    pub(super) fn written(&self, file: &ScenarioFile) -> Written {
        let mut out = Written { with: self.written_with(), ..Written::default() };
        for item in &file.items {
            match item {
                Item::Param { name, value, range } => {
                    let range = range.as_ref().map_or(String::new(), |(low, high)| {
                        format!(" in {} .. {}", self.text(low.span), self.text(high.span))
                    });
                    out.parameters.push(format!("{} = {}{range}", name.name, self.text(value.span)));
                }
                Item::Let(decl) => out.names.push(self.written_let(decl)),
                Item::Process(decl) => out.processes.push(self.written_process(decl)),
                Item::Behaviour(decl) => {
                    out.arguments.push(decl.arguments.iter().map(|name| name.name.clone()).collect());
                    let states = decl.items.iter().filter_map(|item| match item {
                        BehaviourItem::State(state) => Some(state),
                        _ => None,
                    });
                    let guards = states.flat_map(|state| &state.transitions).filter_map(|t| t.guard.as_ref());
                    out.conditions.push(guards.map(|guard| self.text(guard.span)).collect());
                }
                _ => {}
            }
        }
        out
    }

    fn written_let(&self, decl: &LetDecl) -> String {
        let arguments: Vec<&str> = decl.arguments.iter().map(|name| name.name.as_str()).collect();
        let arguments =
            if arguments.is_empty() { String::new() } else { format!("({})", arguments.join(", ")) };
        format!("{}{arguments} = {}", decl.name.name, self.text(decl.body.span))
    }

    fn written_process(&self, decl: &ProcessDecl) -> (String, Vec<String>) {
        let copies = |count: &Expr| format!("[{}]", self.text(count.span));
        let head = format!("{}{}", decl.name.name, decl.count.as_ref().map_or(String::new(), copies));
        let line = |item: &ProcessItem| match item {
            ProcessItem::Var(VarDecl { name, initial, .. }) => {
                format!("var {}", self.text(name.span.to(initial.span)))
            }
            ProcessItem::Let(decl) => format!("let {}", self.written_let(decl)),
            ProcessItem::Label { name, value } => format!("label {} = {}", name.name, self.text(value.span)),
            ProcessItem::Command(command) => self.text(command.span),
            ProcessItem::Choose(_) => "choose".to_owned(),
        };
        (head, decl.items.iter().map(line).collect())
    }
}
