//! Who starts where in the worlds that are surely asked about, known even where something else is wrong.

use super::elaborator::Elaborator;
use super::people::People;
use super::places;
use super::queries::Compiler;
use super::study::Ask;
use crate::model::{AgentId, Behaviours, Processes, Scenario, Source};
use crate::syntax::ast::{Query, QueryKind, Ranked};
use crate::syntax::codes::Code;
use crate::syntax::source::Span;
use std::collections::BTreeSet;
use std::sync::Arc;

/// Words that start a query of the world of the call, unless it sets values of its own.
const ASKING: [&str; 3] = ["check", "estimate", "rank"];
/// Code of a name that is declared or set twice, so its meaning is uncertain.
const TWICE: Code = Code::E0202;

/// The people of a world and where they start.
#[derive(Clone, Debug)]
pub struct Starts {
    /// The scenario; where something in it is wrong, only its scene, its people and its sources.
    pub scenario: Arc<Scenario>,
    /// Where the starts of the people of each declaration are written, by the first of them; ascending.
    places: Vec<(AgentId, Span)>,
}

impl Starts {
    /// The place where the start of an agent is written.
    pub fn place_of(&self, agent: AgentId) -> Option<Span> {
        places::written(&self.places, agent)
    }
}

impl Elaborator<'_> {
    /// Keeps who starts where, of a scenario in which something is wrong. Who is wrong is missing, and so is a barrier: there
    /// is more room than that, not less. Where a radius, a field of theirs or what decides a number is wrong, nothing is known.
    pub(super) fn keep_starts(&mut self, people: People, sources: Vec<Source>) {
        if self.any_start || self.diagnostics.iter().any(|one| one.code == TWICE) {
            return;
        }
        let scenario = Scenario {
            title: String::new(),
            clock: self.clock,
            horizon: self.horizon,
            scene: self.scene.clone(),
            agents: people.agents,
            groups: people.groups,
            moves: Vec::new(),
            processes: Processes::default(),
            behaviours: Behaviours::default(),
            sources,
        };
        self.starts = Some(Starts { scenario: Arc::new(scenario), places: people.places });
    }
}

impl Compiler<'_> {
    /// The starts of the worlds that are surely asked about.
    pub(super) fn starts(&self) -> Vec<Starts> {
        let mut worlds: BTreeSet<usize> = BTreeSet::new();
        for query in &self.queries {
            if matches!(query.ask, Ask::Compare { .. } | Ask::Rank { .. }) {
                worlds.extend(query.ask.worlds());
            }
        }
        worlds.extend(self.asked.iter().map(|(_, world)| *world));
        if self.asks_though_lost() {
            worlds.extend(&self.bases);
        }
        let starts = |world: &usize| {
            let site = self.sites.get(*world)?;
            match &site.scenario {
                Some(scenario) => {
                    let places = site.elaborator.places.clone();
                    Some(Starts { scenario: Arc::clone(scenario), places })
                }
                None => site.elaborator.starts.clone(),
            }
        };
        worlds.iter().filter_map(starts).collect()
    }

    /// Whether a query that could not be read surely sets no values of its own.
    fn asks_though_lost(&self) -> bool {
        self.input.properties.iter().flat_map(|file| &file.broken).any(|item| {
            let has = |word: &str| item.words.iter().any(|own| own == word);
            let asks = item.words.first().is_some_and(|first| ASKING.contains(&first.as_str()));
            asks && (!has("rank") || has("moves")) && !has("under")
        })
    }

    /// Notes which world a query asks about; a comparison, and a ranking of values, has some of its own.
    pub(super) fn note_asked(&mut self, query: &Query, world: usize) {
        let has_own =
            matches!(query.kind, QueryKind::Compare { .. } | QueryKind::Rank { of: Ranked::Values(_), .. });
        if !has_own {
            self.asked.push((query.span, world));
        }
    }
}
