//! What could not be read, and which errors come of it.

use crate::compile::consequences::{DIMENSION, LACKING, bare, block_end, leading_word, word, words};
use crate::compile::context::clock::is_stepped;
use crate::compile::query::compiler::Input;
use crate::syntax::ast::{self, Item};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::{About, Diagnostic, Severity};
use crate::syntax::keywords::{Declares, KEYWORDS, Place, keyword};
use crate::syntax::parse::starts_name;
use crate::syntax::source::{Source, SourceId, Span};
use std::collections::{BTreeMap, BTreeSet};

/// Codes of names that are not there, or of what needs one.
const NAMES: [Code; 8] =
    [Code::E0201, Code::E0203, Code::E0205, Code::E0208, Code::E0209, Code::E0210, Code::E0505, Code::E0606];
/// Those among them whose place is the name itself.
const PLACED_AT_NAME: [Code; 5] = [Code::E0201, Code::E0203, Code::E0208, Code::E0210, Code::E0606];
/// Codes of a clock that has or lacks steps: a process that was not read may have had rates.
const CLOCKS: [Code; 3] = [Code::E0503, Code::E0507, Code::E0508];
/// Code of a scenario without a valid horizon or step.
const SETTING: Code = Code::E0505;
/// Code of moves without an option.
const NO_OPTIONS: Code = Code::E0406;
/// Code of an agent without moves.
const NO_MOVES: Code = Code::E0606;
/// Codes of agents that start inside an obstacle, or where there is no room.
const INSIDE: [Code; 2] = [Code::E0409, Code::E0801];
/// Words that decide the clock.
const TIMES: [&str; 6] = ["after", "at", "horizon", "process", "step", "when"];
/// Most broken items before a place that may reach up to it.
const MOST_AROUND: usize = 8;
/// Words of declarations that have fields.
const BODIES: [&str; 5] = ["agent", "agents", "group", "kind", "source"];

/// The items of the sources that could not be read.
#[allow(clippy::struct_excessive_bools, reason = "each answers a question of its own")]
pub(crate) struct Broken<'i> {
    sources: &'i [Source],
    /// Their places, and those of the errors of the parser; ascending.
    spans: Vec<Span>,
    errors: Vec<Span>,
    /// All their words, and those that may be the names of what they declare.
    words: BTreeSet<&'i str>,
    names: BTreeSet<&'i str>,
    /// Whether any name may have been declared: items may stand in the wrong blocks, or a name is missing.
    any_name: bool,
    /// Whether moves, parts of the scene, or what the clock comes of are among them.
    moves: bool,
    scenery: bool,
    clock: bool,
    /// Whether a setting, or a field, may be among them.
    settings: bool,
    fields: bool,
    /// Kinds: what each starts from, and where its name is.
    kinds: BTreeMap<&'i str, (&'i str, Span)>,
    /// The places of the horizon and the step.
    times: Vec<Span>,
    /// Sources with errors.
    with_errors: BTreeSet<SourceId>,
}

impl<'i> Broken<'i> {
    pub(crate) fn of(said: &[Diagnostic], input: &Input<'i>) -> Self {
        let errors = said.iter().filter(|one| one.severity == Severity::Error);
        let mut errors: Vec<Span> = errors.filter_map(|one| Some(one.place.as_ref()?.span)).collect();
        errors.sort_unstable();
        let times = input.scenario.items.iter().filter_map(|item| match item {
            Item::Setting { name, value } if TIMES.contains(&name.name.as_str()) => Some(value.span),
            _ => None,
        });
        let mut broken = Self {
            sources: input.sources,
            spans: Vec::new(),
            words: BTreeSet::new(),
            names: BTreeSet::new(),
            any_name: input.scenario.is_torn || input.properties.iter().any(|file| file.is_torn),
            moves: false,
            scenery: false,
            clock: input.scenario.is_torn,
            settings: false,
            fields: false,
            kinds: input.scenario.items.iter().filter_map(kind_of).collect(),
            with_errors: errors.iter().map(|place| place.source).collect(),
            times: times.collect(),
            errors,
        };
        for item in input.scenario.broken.iter().chain(input.properties.iter().flat_map(|file| &file.broken))
        {
            broken.add(item);
        }
        broken.spans.sort_unstable();
        // Of a scenario without times in seconds the processes decide which clock it has.
        broken.clock &= !is_stepped(input.scenario);
        broken
    }

    fn add(&mut self, item: &'i ast::Broken) {
        let words = || item.words.iter().map(String::as_str);
        let has = |word: &str| words().any(|own| own == word);
        let first = words().next().unwrap_or_default();
        // A keyword in another part than its own is a name like any other.
        let begins = keyword(first).filter(|keyword| keyword.begins.contains(&item.place));
        self.spans.push(item.span);
        self.words.extend(words());
        self.words.extend(words().flat_map(grown));
        match begins.map(|keyword| keyword.declares) {
            Some(Declares::Nothing) => {}
            Some(_) => {
                // A wall may have no name.
                self.any_name |= item.name.is_none() && first != "wall";
                self.names.extend(item.name.as_deref());
            }
            // The first word is misspelt, and a name follows, or it is missing.
            None => self.names.extend(words().next().into_iter().chain(item.name.as_deref())),
        }
        self.moves |= item.place == Place::Moves || has("moves");
        self.scenery |= item.place == Place::Scene || first == "scene";
        let of_file = item.place == Place::Scenario;
        let is_timeless = begins.is_some_and(|keyword| keyword.declares != Declares::Nothing);
        self.clock |= item.span.source == SourceId(0) && (!is_timeless || TIMES.iter().any(|word| has(word)));
        self.settings |= of_file && begins.is_none() || has("horizon") || has("step");
        self.fields |=
            item.place == Place::Fields || of_file && (begins.is_none() || BODIES.contains(&first));
    }

    fn fails(&self, source: SourceId) -> bool {
        self.with_errors.contains(&source)
    }

    /// Whether a broken item, or an error of the parser, meets a place.
    fn meets(&self, place: Span) -> bool {
        let is_within = |spans: &[Span]| {
            let from = spans.partition_point(|span| (span.source, span.start) < (place.source, place.start));
            spans.get(from).is_some_and(|span| span.source == place.source && span.start < place.end)
        };
        is_within(&self.spans) || is_within(&self.errors) || self.covers(place)
    }

    /// Whether a place lies in a broken item. Few of them hold others.
    fn covers(&self, place: Span) -> bool {
        let before =
            self.spans.partition_point(|span| (span.source, span.start) <= (place.source, place.start));
        let near = self.spans[..before].iter().rev().take(MOST_AROUND);
        near.take_while(|span| span.source == place.source).any(|span| place.start < span.end)
    }

    /// Whether a name may have been declared where it stands in what could not be read.
    fn may_declare(&self, place: Span) -> bool {
        let Some(text) = word(self.sources, place) else { return true };
        let bare = bare(text);
        let (name, _) = leading_word(bare);
        // What belongs to a level stands in its block without the name of that.
        let mut parts = bare.split('.').map(|part| leading_word(part).0);
        // A name may have grown together with the sign behind it: `nin 0 .. 3` for `n: 0 .. 3`.
        let is_longer = || {
            let longer = self.names.range(name..).next();
            longer.is_some_and(|longer| longer.starts_with(name))
        };
        self.any_name || parts.any(|part| self.words.contains(part)) || !self.names.is_empty() && is_longer()
    }

    /// Whether something in the block behind a name could not be read.
    fn is_torn_behind(&self, place: Span) -> bool {
        let source = self.sources.iter().find(|source| source.id == place.source);
        let behind = source.and_then(|source| source.text.get(place.end as usize..)).unwrap_or_default();
        let end = place.end.saturating_add(block_end(behind) as u32);
        self.any_name || self.meets(Span { end, ..place })
    }

    /// Whether a kind, and all that it starts from, were read to their ends.
    fn is_whole_kind(&self, name: &str) -> bool {
        let mut name = name;
        for _ in 0..=self.kinds.len() {
            let Some((base, place)) = self.kinds.get(name) else {
                return crate::model::Kind::named(name).is_some();
            };
            if self.is_torn_behind(*place) {
                return false;
            }
            name = base;
        }
        false
    }

    /// Whether an error of compilation follows from nothing that could not be read.
    pub(crate) fn is_own(&self, one: &Diagnostic) -> bool {
        let scenario = self.fails(SourceId(0));
        let Some(place) = one.place.as_ref().map(|place| place.span) else {
            return !(scenario && NAMES.contains(&one.code));
        };
        if !scenario && !self.fails(place.source) {
            return true;
        }
        let text = word(self.sources, place).unwrap_or_default();
        let of_clock = self.clock
            && (CLOCKS.contains(&one.code)
                || matches!(one.about, About::Unit { in_steps: true, .. })
                || one.code == DIMENSION && self.times.contains(&place));
        let of_options = one.code == NO_OPTIONS && self.meets(place);
        let of_moves = one.about == About::Moves && self.moves;
        // With barriers that were not read there is less room for many, not more.
        let is_crowd = one.about == About::Crowd;
        let needs_barriers = INSIDE.contains(&one.code) && !is_crowd || one.about == About::Door;
        let of_scenery =
            needs_barriers && self.scenery || one.about == About::Storey && self.is_torn_behind(place);
        // The room that bodies need is unknown if a part of them was not read.
        let of_bodies = is_crowd && scenario && (self.fields || self.any_name);
        // No name that is missing makes a circle; only the scenario declares moves; a start stands with its agent.
        let alone = one.about == About::Circle
            || one.code == NO_MOVES && !scenario
            || one.about == About::Start && !self.is_torn_behind(place)
            || one.code == LACKING && !self.any_name && (!self.fields || self.is_whole_kind(text))
            || one.code == SETTING
                && (one.about != About::Clock || !self.settings && !self.any_name && !self.clock)
            || one.about == About::Unsettled;
        let of_name = !alone
            && NAMES.contains(&one.code)
            && (!PLACED_AT_NAME.contains(&one.code) || self.may_declare(place));
        let of_suspect = (one.code.is_of("E03") || one.code.is_of("E09"))
            && words(text).any(|name| self.names.contains(name));
        // A command of several lines is judged as a whole.
        let of_part = one.code.is_of("E09") && self.meets(place);
        let of_item = self.covers(place);
        !(of_item
            || of_clock
            || of_options
            || of_moves
            || of_scenery
            || of_bodies
            || of_name
            || of_suspect
            || of_part)
    }
}

fn kind_of(item: &Item) -> Option<(&str, (&str, Span))> {
    match item {
        Item::Kind(decl) => Some((&decl.name.name, (&decl.base.as_ref()?.name, decl.name.span))),
        _ => None,
    }
}

/// The names that a word may have had behind it before it grew together with them: `n` of `varn`.
pub(crate) fn grown(text: &str) -> impl Iterator<Item = &str> {
    let (first, _) = leading_word(text);
    let declaring = KEYWORDS.iter().filter(|keyword| keyword.declares != Declares::Nothing);
    let is_whole = keyword(first).is_some();
    declaring
        .filter(move |_| !is_whole)
        .filter_map(move |keyword| first.strip_prefix(keyword.word))
        .filter(|name| name.starts_with(starts_name))
}
