//! Behaviours as they are declared, and who has them.

use crate::model::{AgentId, BehaviourId};
use crate::syntax::ast::process::{BehaviourDecl, BehaviourItem, StateDecl};
use crate::syntax::ast::{Expr, LetDecl};
use crate::syntax::source::Span;
use std::collections::BTreeSet;

/// `with` of one declaration, and those who have it.
pub(crate) struct With<'a> {
    /// Behaviours, in order of writing, with their arguments.
    pub(crate) behaviours: Vec<(BehaviourId, &'a [Expr], &'a Expr)>,
    /// Name of the declaration.
    pub(crate) name: String,
    pub(crate) members: Vec<AgentId>,
    /// Whether it names an unknown behaviour.
    pub(crate) strays: bool,
    /// For a source: the largest number of agents.
    pub(crate) most: u32,
}

/// The behaviours of a scenario, and who has them.
#[derive(Default)]
pub(crate) struct Conducts<'a> {
    /// The declarations so far.
    pub(crate) behaviours: Vec<&'a BehaviourDecl>,
    /// The behaviours of agents, by declaration.
    pub(crate) withs: Vec<With<'a>>,
    /// The behaviours of single agents.
    pub(crate) having: BTreeSet<(AgentId, BehaviourId)>,
    /// Agents with an unknown behaviour.
    pub(crate) strayed: BTreeSet<AgentId>,
    /// Arguments of unknown behaviours.
    pub(crate) stray: Vec<&'a [Expr]>,
    /// Where the behaviour that is looked at gets its arguments, if it takes any.
    pub(crate) attached_at: Option<Span>,
}

impl Conducts<'_> {
    /// Whether an agent has a behaviour.
    pub(crate) fn has(&self, agent: AgentId, behaviour: BehaviourId) -> bool {
        self.having.contains(&(agent, behaviour))
    }

    /// Uses the first agent in place of any agent, with any behaviour.
    pub(crate) fn stand_in(&mut self) {
        self.having.extend((0..self.behaviours.len()).map(|k| (AgentId(0), BehaviourId(k as u32))));
    }
}

/// The states of a behaviour.
pub(crate) fn states(decl: &BehaviourDecl) -> impl Iterator<Item = &StateDecl> {
    decl.items
        .iter()
        .filter_map(|item| if let BehaviourItem::State(state) = item { Some(state) } else { None })
}

/// The names that a behaviour declares.
pub(crate) fn lets(decl: &BehaviourDecl) -> impl Iterator<Item = &LetDecl> {
    decl.items.iter().filter_map(|item| if let BehaviourItem::Let(decl) = item { Some(decl) } else { None })
}
