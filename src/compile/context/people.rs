//! The people of a scenario, as they are declared one after the other.

use crate::base::random::name_hash;
use crate::compile::context::{
    Context, Lowered,
    roster::{Places, Starts},
};
use crate::model::Behaviours;
use crate::model::Processes;
use crate::model::Scenario;
use crate::model::Source;
use crate::model::{Agent, AgentId, Group};
use crate::syntax::ast::Field;
use crate::syntax::codes::Code;
use crate::syntax::source::Span;
use std::collections::BTreeSet;
use std::sync::Arc;

/// Most stable numbers of a declaration.
const MOST_ENTITIES: u64 = 1 << 20;

/// The people of a scenario so far.
#[derive(Default)]
pub(crate) struct People {
    /// Agents.
    pub(crate) agents: Vec<Agent>,
    /// Groups.
    pub(crate) groups: Vec<Group>,
    /// Where the starts are written.
    pub(crate) places: Places,
    /// Agents of a source.
    pub(crate) coming: BTreeSet<AgentId>,
    /// First numbers and sizes of the ranges of entities in use.
    ranges: Vec<(u32, u32)>,
}

impl People {
    /// Remembers where the start of some people is written: their field `at`, or else `other`.
    pub(crate) fn written(&mut self, members: &[AgentId], fields: &[&Field], other: Span) {
        let at = fields.iter().find(|field| field.name.name == "at").map(|field| field.value.span());
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

/// A range of `size` stable numbers for what is declared at a place.
pub(crate) fn entities(
    context: &mut Context<'_>,
    people: &mut People,
    path: &str,
    size: u32,
    span: Span,
) -> Lowered<u32> {
    match people.entities(path, size) {
            Some(first) => Ok(first),
            None => context.report(
                error!(E0913, span, "too many agents: the 16 million stable ids are used up";
                    hint: "every agent that may arrive by a source needs an id: reduce the arrivals, or shorten the horizon"),
            ),
        }
}

/// Code of a name that is declared or set twice, so its meaning is uncertain.
const TWICE: Code = Code::E0202;

/// Keeps who starts where, of a scenario in which something is wrong. Who is wrong is missing, and so is a barrier: there
/// is more room than that, not less. Where a radius, a field of theirs or what decides a number is wrong, nothing is known.
pub(crate) fn keep_starts(context: &mut Context<'_>, people: People, sources: Vec<Source>) {
    if context.roster.any_start || context.sink.diagnostics.iter().any(|one| one.code == TWICE) {
        return;
    }
    let scenario = Scenario {
        title: String::new(),
        clock: context.time.clock,
        horizon: context.time.horizon,
        scene: context.scene.clone(),
        agents: people.agents,
        groups: people.groups,
        moves: Vec::new(),
        processes: Processes::default(),
        behaviours: Behaviours::default(),
        sources,
        doors: Vec::new(),
    };
    context.roster.starts = Some(Starts { scenario: Arc::new(scenario), places: people.places });
}
