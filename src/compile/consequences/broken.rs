//! What could not be read, and which errors come of it.

use super::{
    CIRCULAR, DIMENSION, EARLY, LACKING, UNKNOWN, bare, block_end, has_word, leading_word, lines, word, words,
};
use crate::compile::dimension;
use crate::compile::queries::Input;
use crate::compile::told::is_stepped;
use crate::syntax::ast::Item;
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::{Diagnostic, Severity};
use crate::syntax::parse::starts_name;
use crate::syntax::source::{Source, SourceId, Span};
use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet};

/// Codes of names that are not there, or of what needs one.
const NAMES: [Code; 8] =
    [Code::E0201, Code::E0203, Code::E0205, Code::E0208, Code::E0209, Code::E0210, Code::E0505, Code::E0606];
/// Those among them whose place is the name itself.
const PLACED_AT_NAME: [Code; 5] = [Code::E0201, Code::E0203, Code::E0208, Code::E0210, Code::E0606];
/// Codes of a clock that has or lacks steps: a process that was not read may have had rates.
const CLOCKS: [Code; 3] = [Code::E0503, Code::E0507, Code::E0508];
/// Codes of brackets that do not pair up.
const BRACKETS: [Code; 6] = [Code::E0102, Code::E0103, Code::E0104, Code::E0105, Code::E0106, Code::E0107];
/// Codes of a file that was not read at all, or not from this place on.
const TOO_DEEP: Code = Code::E0106;
const COMMENT: Code = Code::E0104;
/// Code of a closing bracket without an opening one.
const STRAY: Code = Code::E0103;
/// Code of a scenario without a valid horizon or step.
const SETTING: Code = Code::E0505;
/// Code of moves without an option.
const NO_OPTIONS: Code = Code::E0406;
/// Code of an agent without moves.
const NO_MOVES: Code = Code::E0606;
/// Codes of agents that start inside an obstacle, or where there is no room.
const INSIDE: [Code; 2] = [Code::E0409, Code::E0801];
/// Part of the title of an error about too many agents for a place.
const CROWDED: &str = " cannot be placed: ";
/// Codes after which the rest of a line is unreliable, besides those of brackets.
const DERAILS: [Code; 2] = [Code::E0101, Code::E0112];
/// Marks that follow the name of a declaration.
const AFTER_NAME: [char; 4] = ['=', ':', '{', '['];
/// Code of one sign of equality for another.
const EQUALS: Code = Code::E0112;
/// Words that start a declaration with a name.
const DECLARES: [&str; 22] = [
    "agent",
    "agents",
    "behaviour",
    "const",
    "group",
    "groups",
    "kind",
    "label",
    "let",
    "line",
    "obstacle",
    "param",
    "point",
    "process",
    "property",
    "region",
    "source",
    "state",
    "tracks",
    "var",
    "wall",
    "on",
];
/// Words that start what has no name of its own.
const NAMELESS: [&str; 14] = [
    "after", "check", "choose", "compare", "estimate", "family", "heading", "import", "moves", "periodic",
    "rank", "scene", "stop", "when",
];
/// Words that start a part of a scene.
const SCENERY: [&str; 7] = ["import", "line", "obstacle", "periodic", "point", "region", "wall"];
/// Words that start what has no part in a clock, and words that have.
const TIMELESS: [&str; 12] = [
    "const", "kind", "label", "let", "line", "obstacle", "param", "point", "region", "tracks", "var", "wall",
];
const TIMES: [&str; 6] = ["after", "at", "horizon", "process", "step", "when"];

/// Parts of sources by where they start, with the greatest end of a part up to there.
struct Parts(Vec<(Span, u32)>);

impl Parts {
    fn of(parts: impl Iterator<Item = Span>) -> Self {
        let mut parts: Vec<(Span, u32)> = parts.map(|part| (part, part.end)).collect();
        parts.sort_unstable();
        for k in 1..parts.len() {
            if parts[k - 1].0.source == parts[k].0.source {
                parts[k].1 = parts[k].1.max(parts[k - 1].1);
            }
        }
        Self(parts)
    }

    /// Whether a place lies in one of them.
    fn hold(&self, place: Span) -> bool {
        let before =
            self.0.partition_point(|(part, _)| (part.source, part.start) <= (place.source, place.start));
        self.0[..before].last().is_some_and(|(part, end)| part.source == place.source && place.end <= *end)
    }

    /// Whether one of them lies in a place.
    fn some_within(&self, place: Span) -> bool {
        let from =
            self.0.partition_point(|(part, _)| (part.source, part.start) < (place.source, place.start));
        self.0[from..]
            .iter()
            .take_while(|(part, _)| part.source == place.source && part.start < place.end)
            .any(|(part, _)| part.end <= place.end)
    }
}

/// The parts of the sources that could not be read.
#[allow(clippy::struct_excessive_bools, reason = "each answers a question of its own")]
pub(super) struct Broken<'i> {
    sources: &'i [Source],
    /// Texts that were skipped or whose values could not be read, with declarations that ended early, and their words.
    lost: Parts,
    skipped: Parts,
    swallowed: BTreeSet<&'i str>,
    /// Names whose declarations were not read, or not to their end.
    suspects: BTreeSet<&'i str>,
    /// Names that may have grown together with the words before them.
    grown: BTreeSet<&'i str>,
    /// Names that were set, perhaps in a declaration whose first word is missing.
    set: BTreeSet<&'i str>,
    /// Whether any name may have been declared in what was not read.
    any_name: bool,
    /// Whether moves, parts of the scene, or what the clock comes of were not read.
    moves: bool,
    scenery: bool,
    clock: bool,
    /// Whether a setting, or a field, may have been among it.
    settings: bool,
    fields: bool,
    /// Kinds: what each starts from, and where its name is.
    kinds: BTreeMap<&'i str, (&'i str, Span)>,
    /// Sources with errors, and the lines that say no more since they could not be read.
    with_errors: BTreeSet<SourceId>,
    derailed: BTreeMap<(SourceId, usize), Vec<Span>>,
    /// All lines with an error.
    faulty: BTreeSet<(SourceId, usize)>,
}

impl<'i> Broken<'i> {
    pub(super) fn of(said: &[Diagnostic], input: &Input<'i>) -> Self {
        let files = input.properties.iter();
        let broken = input.scenario.broken.iter().chain(files.flat_map(|file| &file.broken));
        let swallowed = broken.clone().flat_map(|item| &item.words).map(String::as_str).collect();
        let mut doubts: Vec<Span> = broken.map(|item| item.span).collect();
        doubts.sort_unstable();
        let lost = doubts.iter();
        let mut broken = Self {
            sources: input.sources,
            lost: Parts::of(lost.clone().copied()),
            skipped: Parts::of(lost.clone().copied()),
            swallowed,
            suspects: BTreeSet::new(),
            grown: BTreeSet::new(),
            set: BTreeSet::new(),
            any_name: false,
            moves: false,
            scenery: false,
            clock: false,
            settings: false,
            fields: false,
            kinds: input.scenario.items.iter().filter_map(kind_of).collect(),
            with_errors: BTreeSet::new(),
            derailed: BTreeMap::new(),
            faulty: BTreeSet::new(),
        };
        let mut texts: Vec<Span> = Vec::new();
        for one in said.iter().filter(|one| one.severity == Severity::Error) {
            let Some(place) = &one.place else { continue };
            broken.with_errors.insert(place.span.source);
            broken.faulty.extend(broken.line_of(place.span));
            broken.swallow(one, place.span);
            broken.grown.extend(grown(word(input.sources, place.span).unwrap_or_default()));
            // What stands first in its line is missed by the one before, but for a bracket.
            let derails =
                DERAILS.contains(&one.code) && !broken.starts_line(place.span) && !broken.was_mended(one);
            if derails || BRACKETS.contains(&one.code) {
                broken.derail(place.span, &doubts);
                texts.extend(lines(input.sources, place.span));
            }
        }
        // Of texts that start alike the longest says all: each of thousands of errors on a line has that line.
        texts.extend(lost);
        texts.sort_by_key(|span| (span.source, span.start, Reverse(span.end)));
        texts.dedup_by_key(|span| (span.source, span.start));
        for span in texts {
            broken.add(span, word(input.sources, span).unwrap_or_default());
        }
        // Of a scenario without times in seconds the processes decide which clock it has.
        broken.clock &= !is_stepped(input.scenario);
        broken
    }

    /// Notes the names that an error of brackets or comments makes unreliable. Where braces did not pair up, declarations may
    /// be in the wrong block, and the name on a line with wrong brackets may be misspelt. A query declares nothing.
    fn swallow(&mut self, one: &Diagnostic, place: Span) {
        let bracket = BRACKETS.contains(&one.code) && place.source == SourceId(0);
        let braces = one.title.contains("`{`") || one.title.contains("`}`");
        let line = lines(self.sources, place).and_then(|line| word(self.sources, line));
        let (first, rest) = leading_word(line.unwrap_or_default());
        let declares = BRACKETS.contains(&one.code) && DECLARES.contains(&first) && !is_named(first, rest);
        let displaces = bracket && braces && !(one.code == STRAY && self.is_over(place));
        self.any_name |= displaces || declares || one.code == TOO_DEEP;
        self.clock |= bracket;
        if one.code == COMMENT
            && let Some(source) = self.sources.iter().find(|source| source.id == place.source)
        {
            self.swallowed.extend(words(&source.text[place.start as usize..]));
        }
    }

    /// A text that was not read, or not to its end.
    fn add(&mut self, span: Span, text: &'i str) {
        let source = span.source;
        // Something else may stand in the place of the first word.
        let text = text.trim_start_matches(|c: char| !starts_name(c));
        let (first, rest) = leading_word(text);
        let (second, _) = leading_word(rest);
        self.moves |= ["moves", "heading", "route", "stop"].iter().any(|word| has_word(text, word));
        self.scenery |= SCENERY.contains(&first);
        let times = !TIMELESS.contains(&first) || TIMES.iter().any(|word| has_word(text, word));
        self.clock |= source == SourceId(0) && times;
        // A word that starts no declaration may be a misspelt name of either.
        let is_declared = DECLARES.contains(&first) || NAMELESS.contains(&first) || first == "scenario";
        let sets = || ["horizon", "step"].iter().any(|word| has_word(text, word));
        // Of a field whose value alone could not be read the name was.
        let is_field = rest.trim() == "=" && self.is_in_block(span);
        self.settings |= source == SourceId(0) && (!is_declared && !is_field || sets());
        let has_fields =
            ["agent", "agents", "group", "kind", "source"].contains(&first) && text.contains('{');
        self.fields |= source == SourceId(0) && (!is_declared || has_fields);
        self.grown.extend(grown(first));
        if DECLARES.contains(&first) {
            // A wall may have no name.
            let nameless = first == "wall" && rest.trim_start().starts_with('(');
            self.any_name |= second.is_empty() && !nameless;
            self.suspects.extend(Some(second).filter(|name| !name.is_empty()));
        } else if rest.trim_start().starts_with('=') {
            self.set.insert(first);
        } else if !NAMELESS.contains(&first) {
            // The first word is misspelt, and a name follows, or it is missing.
            self.suspects.extend([first, second].into_iter().filter(|name| !name.is_empty()));
        }
    }

    /// Whether the parser took what stands there as it is meant: `==` for `=`.
    fn was_mended(&self, one: &Diagnostic) -> bool {
        one.code == EQUALS && !one.place.as_ref().is_some_and(|place| self.skipped.hold(place.span))
    }

    fn is_broken(&self, source: SourceId) -> bool {
        self.with_errors.contains(&source)
    }

    /// Whether a place is the first of its line.
    fn starts_line(&self, span: Span) -> bool {
        let line = lines(self.sources, span).map_or(span.start, |line| line.start);
        let before = word(self.sources, Span { start: line, end: span.start, ..span });
        before.unwrap_or_default().trim().is_empty()
    }

    /// Whether a brace that closes nothing is just one too many: one that starts a line may stand for a word.
    fn is_over(&self, place: Span) -> bool {
        let line = lines(self.sources, place).map_or(place.end, |line| line.end);
        let behind = word(self.sources, Span { start: place.end, end: line, ..place });
        !self.starts_line(place) || behind.unwrap_or_default().trim().is_empty()
    }

    /// The line in which a place starts.
    fn line_of(&self, span: Span) -> Option<(SourceId, usize)> {
        let source = self.sources.iter().find(|source| source.id == span.source)?;
        Some((span.source, source.line(span.start)))
    }

    /// The name that is set to what stands at a place: `density = 0.2 /m^2`.
    fn set_by(&self, place: Span) -> Option<&'i str> {
        let before = word(self.sources, Span { start: 0, end: place.start, ..place })?;
        words(before.trim_end().strip_suffix('=')?).next_back()
    }

    /// Whether some line of a place has an error.
    fn covers_an_error(&self, place: Span) -> bool {
        let end = Span { start: place.end, ..place };
        let (Some(first), Some(last)) = (self.line_of(place), self.line_of(end)) else { return false };
        self.faulty.range(first..=last).next().is_some()
    }

    /// Whether a name may have been declared where it stands in what was skipped.
    fn may_declare(&self, place: Span) -> bool {
        let Some(text) = word(self.sources, place) else { return true };
        let (name, _) = leading_word(bare(text));
        self.any_name
            || self.suspects.contains(name)
            || self.grown.contains(name)
            || self.set.contains(name)
            || self.swallowed.contains(name)
            || name.is_empty() && !self.lost.0.is_empty()
    }

    /// Whether something in the block behind a name could not be read.
    fn is_torn_behind(&self, place: Span) -> bool {
        let source = self.sources.iter().find(|source| source.id == place.source);
        let behind = source.and_then(|source| source.text.get(place.end as usize..)).unwrap_or_default();
        let block = Span { end: place.end.saturating_add(block_end(behind) as u32), ..place };
        self.any_name
            || self.lost.some_within(block)
            || self.skipped.some_within(block)
            || self.skipped.hold(place)
    }

    /// The part of its line that an error makes unreliable: everything except what the parser is sure of.
    fn derail(&mut self, place: Span, doubts: &[Span]) {
        let (Some(line), Some(key)) = (lines(self.sources, place), self.line_of(place)) else { return };
        let before =
            doubts.partition_point(|doubt| (doubt.source, doubt.start) <= (place.source, place.start));
        let holds = |doubt: &Span| doubt.source == place.source && place.start <= doubt.end;
        if !doubts[..before].last().is_some_and(holds) {
            self.derailed.insert(key, vec![line]);
            return;
        }
        self.derailed.entry(key).or_insert_with(|| {
            let first =
                doubts.partition_point(|doubt| (doubt.source, doubt.end) <= (line.source, line.start));
            let is_here = |doubt: &&Span| doubt.source == line.source && doubt.start < line.end;
            doubts[first..].iter().take_while(is_here).copied().collect()
        });
    }

    /// Whether a place stands where a line is in doubt.
    fn is_derailed(&self, place: Span) -> bool {
        let Some(doubts) = self.line_of(place).and_then(|line| self.derailed.get(&line)) else {
            return false;
        };
        // They are in order and apart.
        let before = doubts.partition_point(|doubt| doubt.start <= place.end);
        doubts[..before].last().is_some_and(|doubt| place.start < doubt.end)
    }

    /// Whether a place stands in braces.
    fn is_in_block(&self, place: Span) -> bool {
        let before = word(self.sources, Span { start: 0, end: place.start, ..place }).unwrap_or_default();
        before.matches('{').count() > before.matches('}').count()
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

    pub(super) fn is_own(&self, one: &Diagnostic) -> bool {
        let scenario = self.is_broken(SourceId(0));
        let Some(place) = one.place.as_ref().map(|place| place.span) else {
            return !(scenario && NAMES.contains(&one.code));
        };
        if !scenario && !self.is_broken(place.source) {
            return true;
        }
        let text = word(self.sources, place).unwrap_or_default();
        // A line that could not be read says no more.
        let of_line = self.is_derailed(place);
        let of_clock = self.clock
            && (CLOCKS.contains(&one.code)
                || one.code == DIMENSION
                    && (one.title.contains("(steps)")
                        || matches!(self.set_by(place), Some("horizon" | "step"))));
        let of_options = one.code == NO_OPTIONS && self.lost.some_within(place);
        let of_moves = one.code == NO_MOVES && one.title.contains("no moves") && self.moves;
        // With barriers that were not read there is less room for many, not more.
        let is_crowd = one.title.contains(CROWDED);
        let of_scenery = INSIDE.contains(&one.code) && self.scenery && !is_crowd;
        // The room that bodies need is unknown if a part of them was not read.
        let of_bodies = is_crowd && scenario && (self.fields || self.any_name);
        // No name that is missing makes a circle; only the scenario declares moves; a start stands with its agent.
        let alone = one.title.ends_with(CIRCULAR)
            || one.code == NO_MOVES && !scenario
            || one.code == LACKING && one.title.ends_with(" has no `at`") && !self.is_torn_behind(place)
            || one.code == LACKING && !self.any_name && (!self.fields || self.is_whole_kind(text))
            || one.code == SETTING
                && (!one.title.contains("has no") || !self.settings && !self.any_name && !self.clock)
            || one.code == EARLY && one.title.ends_with("is not available here");
        let of_name = !alone
            && NAMES.contains(&one.code)
            && (!PLACED_AT_NAME.contains(&one.code) || self.may_declare(place));
        // Beside a part that could not be read, what reads as a name may be the rest of a unit.
        let is_faulty = || self.line_of(place).is_some_and(|line| self.faulty.contains(&line));
        let unit = UNKNOWN.contains(&one.code) && dimension::unit(text).is_some() && is_faulty();
        // Of a name that grew together with the sign behind it, `nin 0 .. 3` for `n: 0 .. 3`, its line misses the first part.
        let name = leading_word(bare(text)).0;
        let of_longer = UNKNOWN.contains(&one.code)
            && self.line_of(place).is_some_and(|line| self.derailed.contains_key(&line))
            && !name.is_empty()
            && self.suspects.range(name..).next().is_some_and(|suspect| suspect.starts_with(name));
        // What is at a name, not what stands beside it.
        let of_suspect = (one.code.is_of("E03") || one.code.is_of("E09") || UNKNOWN.contains(&one.code))
            && (words(text).any(|name| self.suspects.contains(name))
                || self.set_by(place).is_some_and(|name| self.suspects.contains(name)));
        // A command of several lines is judged as a whole.
        let of_part = one.code.is_of("E09") && self.covers_an_error(place);
        !(of_clock
            || of_options
            || of_moves
            || of_scenery
            || of_bodies
            || of_longer
            || of_name
            || of_suspect
            || of_part
            || of_line
            || unit)
    }
}

fn kind_of(item: &Item) -> Option<(&str, (&str, Span))> {
    match item {
        Item::Kind(decl) => Some((&decl.name.name, (&decl.base.name, decl.name.span))),
        _ => None,
    }
}

/// The names that a word may have had behind it before it grew together with them: `n` of `varn`.
pub(super) fn grown(text: &str) -> impl Iterator<Item = &str> {
    let (first, _) = leading_word(text);
    let is_whole = DECLARES.contains(&first) || NAMELESS.contains(&first);
    let keywords = DECLARES.iter().filter(move |_| !is_whole);
    keywords
        .filter_map(move |keyword| first.strip_prefix(keyword))
        .filter(|name| name.starts_with(starts_name))
}

/// Whether what follows the first word of a declaration is its name, whole.
fn is_named(first: &str, rest: &str) -> bool {
    let (name, after) = leading_word(rest);
    let after = after.trim_start();
    !name.is_empty() && (after.starts_with(AFTER_NAME) || first == "let" && after.starts_with('('))
}
