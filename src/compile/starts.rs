//! Who starts where in the worlds that are surely asked about, known even where something else is wrong.

use super::elaborator::Elaborator;
use super::people::People;
use super::places;
use super::queries::Compiler;
use super::study::Ask;
use crate::model::{AgentId, Behaviours, Processes, Scenario, Source};
use crate::syntax::ast::{PropertyFile, PropertyItem, Query, QueryKind, Ranked};
use crate::syntax::codes::Code;
use crate::syntax::parse::{continues_name, starts_name};
use crate::syntax::source::{SourceId, Span};
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
        let parts = Parts::of(self.input.properties);
        let is_cut = |span: Span| self.sites.iter().any(|site| site.elaborator.is_cut(span));
        let is_whole = |span: Span| !is_cut(span) && !parts.goes_on(span);
        for query in &self.queries {
            if matches!(query.ask, Ask::Compare { .. } | Ask::Rank { .. }) && is_whole(query.span) {
                worlds.extend(query.ask.worlds());
            }
        }
        worlds.extend(self.asked.iter().filter(|(span, _)| is_whole(*span)).map(|(_, world)| *world));
        if self.asks_though_lost(&parts) {
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
    fn asks_though_lost(&self, parts: &Parts) -> bool {
        let text = |span: &Span| {
            let source = self.input.sources.iter().find(|source| source.id == span.source)?;
            source.text.get(span.start as usize..span.end as usize)
        };
        self.input.properties.iter().flat_map(|file| &file.lost).any(|lost| {
            text(lost).is_some_and(|text| {
                let mut words =
                    text.split(|c: char| !continues_name(c)).filter(|word| word.starts_with(starts_name));
                let asks =
                    words.next().is_some_and(|first| ASKING.contains(&first) && text.starts_with(first));
                let of_one_world = !text.starts_with("rank") || text.contains("moves");
                asks && of_one_world
                    && words.all(|word| word != "under")
                    && !sets(text)
                    && !parts.goes_on(*lost)
            })
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

/// Where the items of property files start, and what could not be read; both in order.
struct Parts {
    items: Vec<(SourceId, u32)>,
    lost: Vec<(SourceId, u32)>,
}

impl Parts {
    fn of(files: &[PropertyFile]) -> Self {
        let start = |span: Span| (span.source, span.start);
        let mut items: Vec<_> =
            files.iter().flat_map(|file| &file.items).map(|item| start(place(item))).collect();
        let mut lost: Vec<_> = files.iter().flat_map(|file| &file.lost).map(|lost| start(*lost)).collect();
        items.sort_unstable();
        lost.sort_unstable();
        Self { items, lost }
    }

    /// Whether something that could not be read follows a part before the next item: it may be a piece of it.
    fn goes_on(&self, part: Span) -> bool {
        let end = (part.source, part.end);
        let first = |all: &[(SourceId, u32)]| {
            all.get(all.partition_point(|at| *at < end)).copied().filter(|(source, _)| *source == part.source)
        };
        first(&self.lost).is_some_and(|lost| first(&self.items).is_none_or(|item| lost < item))
    }
}

/// Where an item stands, or its name.
fn place(item: &PropertyItem) -> Span {
    match item {
        PropertyItem::Let(decl) => decl.name.span,
        PropertyItem::Const { name, .. } | PropertyItem::Property { name, .. } => name.span,
        PropertyItem::Family { span, .. } => *span,
        PropertyItem::Query(query) => query.span,
    }
}

/// Whether a text has a sign by which a value is set.
fn sets(text: &str) -> bool {
    let bytes = text.as_bytes();
    (0..bytes.len()).filter(|&at| bytes[at] == b'=').any(|at| {
        let before = at.checked_sub(1).map(|before| bytes[before]);
        let compares = matches!(before, Some(b'<' | b'>' | b'=' | b'!'));
        !compares && !matches!(bytes.get(at + 1), Some(b'=' | b'>'))
    })
}
