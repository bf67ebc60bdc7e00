//! Errors that follow from others: said once, or not at all.
//!
//! What the parser could not read is missing from the tree. A name declared there is then unknown, a process that had
//! rates seems to have none, moves have no options: those errors would only confuse, and go away with the first one.
//! Nor is it told at each of its uses that a name is unknown.

use super::dimension;
use super::queries::Input;
use crate::syntax::ast::{Expr, ExprKind, Ident, Item, PropertyItem};
use crate::syntax::diagnostic::{Diagnostic, Label, Severity};
use crate::syntax::source::{Source, SourceId, Span};
use std::collections::BTreeSet;

/// Codes of names that are not there, or of what needs one.
const NAMES: [&str; 8] = ["E0201", "E0203", "E0205", "E0208", "E0209", "E0210", "E0505", "E0606"];
/// Those among them whose place is the name itself.
const PLACED_AT_NAME: [&str; 5] = ["E0201", "E0203", "E0208", "E0210", "E0606"];
/// Codes of a clock that has or lacks steps: a process that was not read may have had rates.
const CLOCKS: [&str; 3] = ["E0503", "E0507", "E0508"];
/// Codes of brackets that do not pair up.
const BRACKETS: [&str; 6] = ["E0102", "E0103", "E0104", "E0105", "E0106", "E0107"];
/// Code of moves without an option.
const NO_OPTIONS: &str = "E0406";
/// Code of an agent that nothing advises.
const NO_MOVES: &str = "E0606";
/// Code of people who start inside an obstacle.
const INSIDE: &str = "E0409";
/// Codes after which the rest of a line is anybody's guess, besides those of brackets.
const DERAILS: [&str; 2] = ["E0101", "E0112"];
/// Code of what a declaration lacks.
const LACKING: &str = "E0209";
/// Code of a field that nobody knows.
const UNKNOWN_FIELD: &str = "E0207";
/// Code of a wrong dimension.
const DIMENSION: &str = "E0303";
/// Code of a name that is used before it can be known.
const EARLY: &str = "E0205";
/// Codes of unknown names, told once.
const UNKNOWN: [&str; 4] = ["E0201", "E0203", "E0208", "E0210"];
/// Most further places that are marked.
const MOST_MARKS: usize = 3;

/// Words that start a declaration with a name.
const DECLARES: [&str; 20] = [
    "agent",
    "agents",
    "behaviour",
    "const",
    "group",
    "kind",
    "label",
    "let",
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
const NAMELESS: [&str; 13] = [
    "after", "check", "choose", "compare", "estimate", "family", "heading", "import", "moves", "rank",
    "scene", "stop", "when",
];
/// Words that start a part of a scene.
const SCENERY: [&str; 5] = ["import", "obstacle", "point", "region", "wall"];

/// What compilation found, less what follows from what the parser had said of the same texts.
pub fn own_errors(found: Vec<Diagnostic>, said: &[Diagnostic], input: &Input<'_>) -> Vec<Diagnostic> {
    let broken = Broken::of(said, input);
    let fails = |all: &[Diagnostic]| all.iter().any(|one| one.severity == Severity::Error);
    let own: Vec<Diagnostic> = found.iter().filter(|one| broken.is_own(one)).cloned().collect();
    let own = once_a_name(at_declarations(less_what_follows(own, input.sources), input), input.sources);
    // Nothing is refused without a word.
    if fails(&found) && !fails(&own) && !fails(said) { found } else { own }
}

/// What could not be read.
struct Broken<'i> {
    sources: &'i [Source],
    /// Texts that were skipped.
    lost: Vec<(Span, &'i str)>,
    /// Names whose declarations were not read, or not to their end.
    suspects: Vec<&'i str>,
    /// Names that were set, perhaps in a declaration whose first word is missing.
    set: Vec<&'i str>,
    /// Whether any name may have been declared in what was not read.
    any_name: bool,
    /// Whether moves, or parts of the scene, were not read.
    moves: bool,
    scenery: bool,
    /// Sources with errors, and the lines that say no more since they could not be read.
    with_errors: BTreeSet<SourceId>,
    derailed: BTreeSet<(SourceId, usize)>,
}

impl<'i> Broken<'i> {
    fn of(said: &[Diagnostic], input: &Input<'i>) -> Self {
        let files = input.properties.iter();
        let lost = input.scenario.lost.iter().chain(files.clone().flat_map(|file| &file.lost));
        let cut = input.scenario.cut.iter().chain(files.flat_map(|file| &file.cut));
        let text = |span: &Span| Some((*span, word(input.sources, *span)?));
        let lost: Vec<(Span, &str)> = lost.filter_map(text).collect();
        let mut broken = Self {
            sources: input.sources,
            suspects: Vec::new(),
            set: Vec::new(),
            any_name: said.iter().any(|one| BRACKETS.contains(&one.code)),
            moves: false,
            scenery: false,
            with_errors: BTreeSet::new(),
            derailed: BTreeSet::new(),
            lost: lost.clone(),
        };
        for one in said.iter().filter(|one| one.severity == Severity::Error) {
            let Some(place) = &one.place else { continue };
            broken.with_errors.insert(place.span.source);
            // What stands first in its line is missed by the one before, but for a bracket.
            let derails = DERAILS.contains(&one.code) && !broken.starts_line(place.span);
            if derails || BRACKETS.contains(&one.code) {
                broken.derailed.extend(broken.line_of(place.span));
                broken.add(lines(input.sources, place.span).unwrap_or_default());
            }
        }
        for (_, text) in lost.into_iter().chain(cut.filter_map(text)) {
            broken.add(text);
        }
        broken
    }

    /// A text that was not read, or not to its end.
    fn add(&mut self, text: &'i str) {
        let (first, rest) = leading_word(text);
        let (second, _) = leading_word(rest);
        self.moves |= ["moves", "heading", "stop"].iter().any(|word| has_word(text, word));
        self.scenery |= SCENERY.contains(&first);
        if DECLARES.contains(&first) {
            self.any_name |= second.is_empty();
            self.suspects.extend(Some(second).filter(|name| !name.is_empty()));
        } else if rest.trim_start().starts_with('=') {
            self.set.push(first);
        } else if !NAMELESS.contains(&first) {
            // The first word is misspelt, and a name follows.
            self.suspects.extend(Some(second).filter(|name| !name.is_empty()));
        }
    }

    fn is_broken(&self, source: SourceId) -> bool {
        self.with_errors.contains(&source)
    }

    /// Whether a place is the first of its line.
    fn starts_line(&self, span: Span) -> bool {
        let before = Span { start: 0, end: span.start, ..span };
        let text = word(self.sources, before).unwrap_or_default();
        text[text.rfind('\n').map_or(0, |newline| newline + 1)..].trim().is_empty()
    }

    /// The line in which a place starts.
    fn line_of(&self, span: Span) -> Option<(SourceId, usize)> {
        let source = self.sources.iter().find(|source| source.id == span.source)?;
        Some((span.source, source.line_column(span.start).0))
    }

    /// Whether a name may have been declared where it stands in what was skipped.
    fn may_declare(&self, place: Span) -> bool {
        let Some(text) = word(self.sources, place) else { return true };
        let (name, _) = leading_word(text);
        self.any_name
            || self.suspects.contains(&name)
            || self.set.contains(&name)
            || self.lost.iter().any(|(_, skipped)| has_word(skipped, name))
    }

    fn is_own(&self, one: &Diagnostic) -> bool {
        let scenario = self.is_broken(SourceId(0));
        let Some(place) = one.place.as_ref().map(|place| place.span) else {
            return !(scenario && NAMES.contains(&one.code));
        };
        if !scenario && !self.is_broken(place.source) {
            return true;
        }
        // A line that could not be read says no more.
        let of_line = self.line_of(place).is_some_and(|line| self.derailed.contains(&line));
        let of_clock = CLOCKS.contains(&one.code) || one.code == DIMENSION && one.title.contains("(steps)");
        let of_options = one.code == NO_OPTIONS && self.lost.iter().any(|(part, _)| within(*part, place));
        let of_moves = one.code == NO_MOVES && one.title.contains("no moves") && self.moves;
        let of_scenery = one.code == INSIDE && self.scenery;
        let of_name =
            NAMES.contains(&one.code) && (!PLACED_AT_NAME.contains(&one.code) || self.may_declare(place));
        let line = lines(self.sources, place).unwrap_or_default();
        let unit = UNKNOWN.contains(&one.code)
            && word(self.sources, place).is_some_and(|name| dimension::unit(name).is_some());
        let of_suspect =
            (one.code.starts_with("E03") || one.code.starts_with("E09") || UNKNOWN.contains(&one.code))
                && self.suspects.iter().any(|name| has_word(line, name));
        !(scenario && of_clock
            || of_options
            || of_moves
            || of_scenery
            || of_name
            || of_suspect
            || of_line
            || unit)
    }
}

/// Errors less those that follow from the one before: of what stands right after it or is compared with it, of a name
/// that was set without being declared, and of a field that is missing since it is misspelt.
fn less_what_follows(mut found: Vec<Diagnostic>, sources: &[Source]) -> Vec<Diagnostic> {
    let place = |one: &Diagnostic| one.place.as_ref().map(|place| place.span);
    let settings: Vec<&str> = found
        .iter()
        .filter(|one| one.code == UNKNOWN_FIELD)
        .filter_map(|one| word(sources, place(one)?))
        .collect();
    let all: Vec<(&'static str, Span)> =
        found.iter().filter_map(|one| Some((one.code, place(one)?))).collect();
    let follows = |one: &Diagnostic| {
        let Some(span) = place(one) else { return false };
        let beside = all.iter().any(|(_, before)| {
            before.source == span.source
                && before.end <= span.start
                && word(sources, Span { start: before.end, end: span.start, ..span }).is_some_and(|between| {
                    ["", "==", "!=", "/", "*"].contains(&between.trim()) && !between.contains('\n')
                })
        });
        let of_setting = word(sources, span).is_some_and(|name| settings.contains(&name));
        let misspelt = || {
            let next =
                all.iter().filter(|(_, other)| other.source == span.source && other.start > span.start);
            next.min_by_key(|(_, other)| other.start).is_some_and(|(code, _)| *code == UNKNOWN_FIELD)
        };
        one.severity == Severity::Error
            && (UNKNOWN.contains(&one.code) && (beside || of_setting) || one.code == LACKING && misspelt())
    };
    let broken = found.iter().any(|one| {
        one.severity == Severity::Error && place(one).is_some_and(|span| span.source == SourceId(0))
    });
    let follows = |one: &Diagnostic| {
        // Who could not be declared is not known yet, either.
        let early = broken && one.code == EARLY && place(one).is_some_and(|span| span.source != SourceId(0));
        early || follows(one)
    };
    let gone: Vec<bool> = found.iter().map(follows).collect();
    let mut gone = gone.into_iter();
    found.retain(|_| !gone.next().unwrap_or(false));
    found
}

/// A constant or parameter that is a bare number.
struct Bare<'i> {
    name: &'i str,
    value: Span,
}

/// Of a bare number that is used as a quantity its declaration lacks the unit, not each of its uses.
fn at_declarations(found: Vec<Diagnostic>, input: &Input<'_>) -> Vec<Diagnostic> {
    let bare = |name: &'_ Ident, value: &'_ Expr| {
        matches!(&value.kind, ExprKind::Quantity(quantity) if quantity.unit.is_none())
            .then_some(value.span)
            .map(|value| (name.span, value))
    };
    let of_scenario = input.scenario.items.iter().filter_map(|item| match item {
        Item::Const { name, value } | Item::Param { name, value, .. } => bare(name, value),
        _ => None,
    });
    let of_properties = input.properties.iter().flat_map(|file| &file.items).filter_map(|item| match item {
        PropertyItem::Const { name, value } => bare(name, value),
        _ => None,
    });
    let declared: Vec<Bare<'_>> = of_scenario
        .chain(of_properties)
        .filter_map(|(name, value)| Some(Bare { name: word(input.sources, name)?, value }))
        .collect();
    let mut kept: Vec<Diagnostic> = Vec::new();
    for one in found {
        let blamed = blamed(&one, &declared, input.sources);
        let Some((bare, wanted, place)) = blamed else {
            kept.push(one);
            continue;
        };
        let before = kept
            .iter_mut()
            .find(|k| k.code == DIMENSION && k.place.as_ref().is_some_and(|p| p.span == bare.value));
        let use_of = Label { span: place, text: format!("used as {wanted}") };
        if let Some(before) = before {
            if before.related.len() < MOST_MARKS {
                before.related.push(use_of);
            }
            continue;
        }
        let title = format!("`{}` is a pure number, but is used as {wanted}", bare.name);
        let mut moved = Diagnostic::error(DIMENSION, bare.value, title);
        let number = word(input.sources, bare.value).unwrap_or_default();
        if let Some((_, unit)) = wanted.split_once('(') {
            moved = moved.hint(format!("write its unit: `{number} {}`", unit.trim_end_matches(')')));
        }
        moved.related.push(use_of);
        kept.push(moved);
    }
    kept
}

/// The bare number that an error of dimensions comes of, what it is used as, and where.
fn blamed<'b, 'd>(
    one: &'d Diagnostic,
    declared: &'b [Bare<'b>],
    sources: &[Source],
) -> Option<(&'b Bare<'b>, &'d str, Span)> {
    let wanted = one.title.strip_prefix("expected ")?.strip_suffix(", found a pure number")?;
    let place = one.place.as_ref().filter(|_| one.code == DIMENSION)?.span;
    let text = word(sources, place)?;
    let mut named = declared.iter().filter(|bare| has_word(text, bare.name));
    // A call may make a pure number of anything.
    let first = named.next().filter(|_| !text.contains('('))?;
    named.next().is_none().then_some((first, wanted, place))
}

/// Tells of an unknown name where it stands first, and marks where it stands again.
fn once_a_name(found: Vec<Diagnostic>, sources: &[Source]) -> Vec<Diagnostic> {
    let mut kept: Vec<Diagnostic> = Vec::new();
    let mut again: Vec<Vec<Span>> = Vec::new();
    for one in found {
        let name = |one: &Diagnostic| {
            let place = one.place.as_ref().filter(|_| UNKNOWN.contains(&one.code))?;
            word(sources, place.span).map(|text| leading_word(text).0)
        };
        let known = name(&one).filter(|name| !name.is_empty());
        let first = kept.iter().position(|before| known.is_some() && name(before) == known);
        match (first, &one.place) {
            (Some(first), Some(place)) => again[first].push(place.span),
            _ => {
                kept.push(one);
                again.push(Vec::new());
            }
        }
    }
    for (one, again) in kept.iter_mut().zip(again) {
        let more = again.len().saturating_sub(MOST_MARKS);
        for (k, span) in again.into_iter().take(MOST_MARKS).enumerate() {
            let last = k + 1 == MOST_MARKS && more > 0;
            let text = if last { format!("here too, and {more} more times") } else { "here too".to_owned() };
            one.related.push(Label { span, text });
        }
    }
    kept
}

/// The name at the start of a text, and what follows.
fn leading_word(text: &str) -> (&str, &str) {
    let text = text.trim_start();
    let starts = text.starts_with(|c: char| c.is_alphabetic() || c == '_');
    let end = text.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(text.len());
    if starts { text.split_at(end) } else { ("", text) }
}

/// The lines of a place.
fn lines(sources: &[Source], span: Span) -> Option<&str> {
    let text = &sources.iter().find(|source| source.id == span.source)?.text;
    let from = text.get(..span.start as usize)?.rfind('\n').map_or(0, |newline| newline + 1);
    let rest = text.get(span.end as usize..)?;
    let to = span.end as usize + rest.find('\n').unwrap_or(rest.len());
    text.get(from..to)
}

/// Whether a place lies in another one.
fn within(place: Span, whole: Span) -> bool {
    place.source == whole.source && whole.start <= place.start && place.end <= whole.end
}

/// The text of a place.
fn word(sources: &[Source], span: Span) -> Option<&str> {
    let source = sources.iter().find(|source| source.id == span.source)?;
    source.text.get(span.start as usize..span.end as usize)
}

/// Whether a name stands in a text as a word of its own.
fn has_word(text: &str, name: &str) -> bool {
    let inside = |c: Option<char>| c.is_some_and(|c| c.is_alphanumeric() || c == '_');
    let name = name.trim();
    name.is_empty()
        || text.match_indices(name).any(|(at, _)| {
            !inside(text[..at].chars().next_back()) && !inside(text[at + name.len()..].chars().next())
        })
}
