//! Errors that follow from others are reported once or not at all.
//!
//! Text that the parser could not read is missing from the tree. A name declared there is then unknown, a process with
//! rates seems to have none, moves have no options. Such errors would confuse, and disappear with the first one.
//! An unknown name is not reported at each of its uses.

pub(crate) mod broken;

use crate::compile::consequences::broken::Broken;
use crate::compile::context::dependence::UNKNOWN;
use crate::compile::dimension;
use crate::compile::query::compiler::Input;

use crate::syntax::ast::{Expr, ExprKind, Ident, Item, PropertyItem};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::{About, Diagnostic, Label, Severity};
use crate::syntax::parse::{continues_name, starts_name};
use crate::syntax::source::{Source, SourceId, Span};
use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::RangeInclusive;

/// Code of what a declaration lacks.
const LACKING: Code = Code::E0209;
/// Code of an unknown field.
const UNKNOWN_FIELD: Code = Code::E0207;
/// Code of an unknown unit.
const UNKNOWN_UNIT: Code = Code::E0113;
/// Code of a wrong dimension.
const DIMENSION: Code = Code::E0303;
/// Code of a name that is used before it can be known.
const EARLY: Code = Code::E0205;
/// Most further places that are marked.
const MOST_MARKS: usize = 3;

/// The errors of compilation without those that follow from errors of the parser in the same texts.
pub fn own_errors(found: Vec<Diagnostic>, said: &[Diagnostic], input: &Input<'_>) -> Vec<Diagnostic> {
    let broken = Broken::of(said, input);
    let fails = |all: &[Diagnostic]| all.iter().any(|one| one.severity == Severity::Error);
    // Values surely make no difference only where nothing else is wrong.
    let is_idle = |one: &&Diagnostic| one.about == About::Idle;
    let is_torn = fails(said) || found.iter().any(|one| one.severity == Severity::Error && !is_idle(&one));
    let is_own = |one: &&Diagnostic| broken.is_own(one) && !(is_torn && is_idle(one));
    let own: Vec<Diagnostic> = found.iter().filter(is_own).cloned().collect();
    let own = once_a_name(at_declarations(less_what_follows(own, input.sources), input), input.sources);
    // Nothing is refused without a word.
    if fails(&found) && !fails(&own) && !fails(said) { found } else { own }
}

/// Errors less those that follow from the one before: of what stands right after it or is compared with it, of a name
/// that was set without being declared, and of a field that is missing since it is misspelt.
fn less_what_follows(mut found: Vec<Diagnostic>, sources: &[Source]) -> Vec<Diagnostic> {
    let place = |one: &Diagnostic| one.place.as_ref().map(|place| place.span);
    let settings: BTreeSet<&str> = found
        .iter()
        .filter(|one| one.code == UNKNOWN_FIELD || one.code == UNKNOWN_UNIT)
        .filter_map(|one| Some((one.code, word(sources, place(one)?)?)))
        .flat_map(|(code, name)| {
            // `constA = 3` reads as a setting, and `0 labeldone = on` begins with a quantity.
            broken::grown(name).chain(Some(name).filter(|_| code == UNKNOWN_FIELD))
        })
        .collect();
    let mut ends: BTreeSet<(SourceId, u32)> = BTreeSet::new();
    let mut starts: BTreeMap<(SourceId, u32), Code> = BTreeMap::new();
    for one in &found {
        let Some(span) = place(one) else { continue };
        ends.insert((span.source, span.end));
        starts.entry((span.source, span.start)).or_insert(one.code);
    }
    let follows = |one: &Diagnostic| {
        let Some(span) = place(one) else { return false };
        let beside = || {
            let before = word(sources, Span { start: 0, end: span.start, ..span }).unwrap_or_default();
            // `1 metre/s`: of a unit that is misspelt the rest reads as a name.
            let unit = word(sources, span).is_some_and(|name| dimension::unit(name).is_some());
            gaps(before, unit).any(|gap| {
                let (from, to) = (*gap.start() as u32, *gap.end() as u32);
                ends.range((span.source, from)..=(span.source, to)).next().is_some()
            })
        };
        // It may stand in parentheses.
        let of_setting = || {
            let name = word(sources, span).map(|text| leading_word(bare(text)).0);
            name.is_some_and(|name| settings.contains(name) && is_about(one, name))
        };
        let misspelt = || {
            let source = sources.iter().find(|source| source.id == span.source);
            let block = source.and_then(|source| source.text.get(span.end as usize..)).map_or(0, block_end);
            let within = span.start..=span.end.saturating_add(block as u32);
            let fields = starts.range((span.source, *within.start())..=(span.source, *within.end()));
            fields.into_iter().any(|(_, code)| *code == UNKNOWN_FIELD)
        };
        one.severity == Severity::Error
            && (UNKNOWN.contains(&one.code) && (beside() || of_setting())
                || one.code == LACKING && misspelt())
    };
    let broken = found.iter().any(|one| {
        one.severity == Severity::Error && place(one).is_some_and(|span| span.source == SourceId(0))
    });
    let follows = |one: &Diagnostic| {
        // Who could not be declared is not known yet, either.
        let early = broken
            && one.code == EARLY
            && one.about != About::Circle
            && place(one).is_some_and(|span| span.source != SourceId(0));
        early || follows(one)
    };
    let gone: Vec<bool> = found.iter().map(follows).collect();
    let mut gone = gone.into_iter();
    found.retain(|_| !gone.next().unwrap_or(false));
    found
}

/// Where something before may end that the end of a text stands right after, or is a factor of, in the same line: the
/// places in which blanks, or blanks around an operator, are all that follows.
fn gaps(text: &str, factor: bool) -> impl Iterator<Item = RangeInclusive<usize>> {
    let blank = |text: &str| text.trim_end_matches(|c: char| c.is_whitespace() && c != '\n').len();
    let plain = blank(text);
    let behind = ["/", "*"].into_iter().filter(move |_| factor).filter_map(move |operator| {
        let before = text[..plain].strip_suffix(operator)?;
        Some(blank(before)..=before.len())
    });
    std::iter::once(plain..=text.len()).chain(behind)
}

/// A constant or parameter that is a bare number.
struct Bare<'i> {
    name: &'i str,
    value: Span,
}

/// Reports a number without a unit that is used as a quantity once, at its declaration, not at each use.
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
    let mut told_at: BTreeMap<Span, usize> = BTreeMap::new();
    for one in found {
        let blamed = blamed(&one, &declared, input.sources);
        let Some((bare, wanted, place)) = blamed else {
            if let Some(place) = one.place.as_ref().filter(|_| one.code == DIMENSION) {
                told_at.entry(place.span).or_insert(kept.len());
            }
            kept.push(one);
            continue;
        };
        let before = told_at.get(&bare.value).and_then(|at| kept.get_mut(*at));
        let use_of = Label { span: place, text: format!("used as {wanted}") };
        if let Some(before) = before {
            if before.related.len() < MOST_MARKS {
                before.related.push(use_of);
            }
            continue;
        }
        let title = format!("`{}` has no unit, but is used as {wanted}", bare.name);
        let mut moved = Diagnostic::error(DIMENSION, bare.value, title);
        let number = word(input.sources, bare.value).unwrap_or_default();
        if let Some((_, unit)) = wanted.split_once('(') {
            moved = moved.hint(format!("write a unit: `{number} {}`", unit.trim_end_matches(')')));
        }
        moved.related.push(use_of);
        told_at.insert(bare.value, kept.len());
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
    let About::Unit { wanted, is_bare: true, .. } = &one.about else { return None };
    let place = one.place.as_ref().filter(|_| one.code == DIMENSION)?.span;
    // A call may make a pure number of anything.
    let comes_of = one.comes_of.filter(|_| word(sources, place).is_some_and(|text| !text.contains('(')))?;
    let bare = declared.iter().find(|bare| bare.value == comes_of)?;
    Some((bare, wanted, place))
}

/// Reports an unknown name at its first place, and marks the other places.
fn once_a_name(found: Vec<Diagnostic>, sources: &[Source]) -> Vec<Diagnostic> {
    let mut kept: Vec<Diagnostic> = Vec::new();
    let mut again: Vec<Vec<Span>> = Vec::new();
    let mut first: BTreeMap<&str, usize> = BTreeMap::new();
    for one in found {
        let place = one.place.as_ref().filter(|_| UNKNOWN.contains(&one.code)).map(|place| place.span);
        let name = place.and_then(|span| Some((leading_word(bare(word(sources, span)?)).0, span)));
        // Of `--set` the value is the place.
        let name = name.filter(|(name, _)| is_about(&one, name));
        if let Some((name, span)) = name.filter(|(name, _)| !name.is_empty()) {
            match first.entry(name) {
                Entry::Occupied(before) => {
                    again[*before.get()].push(span);
                    continue;
                }
                Entry::Vacant(none) => {
                    none.insert(kept.len());
                }
            }
        }
        kept.push(one);
        again.push(Vec::new());
    }
    for (one, again) in kept.iter_mut().zip(again) {
        let more = again.len().saturating_sub(MOST_MARKS);
        for (k, span) in again.into_iter().take(MOST_MARKS).enumerate() {
            let last = k + 1 == MOST_MARKS && more > 0;
            let text = match more {
                1 if last => "also here, and in 1 more place".to_owned(),
                _ if last => format!("also here, and in {more} more places"),
                _ => "also here".to_owned(),
            };
            one.related.push(Label { span, text });
        }
    }
    kept
}

/// Whether an error is about a name.
fn is_about(one: &Diagnostic, name: &str) -> bool {
    matches!(&one.about, About::Name(unknown) if unknown == name)
}

/// Where the first block of a text ends.
fn block_end(text: &str) -> usize {
    let mut depth = 0u32;
    for (at, c) in text.char_indices() {
        match c {
            '{' => depth += 1,
            '}' if depth <= 1 => return at,
            '}' => depth -= 1,
            _ => {}
        }
    }
    text.len()
}

/// A name in parentheses without them.
fn bare(text: &str) -> &str {
    text.trim_start_matches(|c: char| c.is_whitespace() || c == '(')
}

/// The name at the start of a text, and what follows.
fn leading_word(text: &str) -> (&str, &str) {
    let text = text.trim_start();
    let starts = text.starts_with(starts_name);
    let end = text.find(|c: char| !continues_name(c)).unwrap_or(text.len());
    if starts { text.split_at(end) } else { ("", text) }
}

/// The words of a text.
pub(crate) fn words(text: &str) -> impl DoubleEndedIterator<Item = &str> {
    text.split(|c: char| !continues_name(c)).filter(|word| !word.is_empty())
}

/// The text of a place.
fn word(sources: &[Source], span: Span) -> Option<&str> {
    let source = sources.iter().find(|source| source.id == span.source)?;
    source.text.get(span.start as usize..span.end as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gaps_are_where_something_beside_may_end() {
        for text in [
            "a == ", "a==", "a  \t", "a /", "a", "a\n", "a\n* ", "a *\n", "a =", "é != ", "", " ", "ab /  * ",
        ] {
            for factor in [false, true] {
                let signs = if factor { &["", "/", "*"][..] } else { &[""] };
                let beside = |between: &str| signs.contains(&between.trim()) && !between.contains('\n');
                let ends = (0..=text.len()).filter(|&at| text.get(at..).is_some_and(beside));
                let mut found: Vec<usize> =
                    gaps(text, factor).flatten().filter(|&at| text.is_char_boundary(at)).collect();
                found.sort_unstable();
                assert_eq!(found, ends.collect::<Vec<_>>(), "{text:?}");
            }
        }
    }

    #[test]
    fn many_unknown_names_are_told_once_each_in_their_order() {
        let names: Vec<String> = (0..20_000).map(|k| format!("n{}", k % 15_000)).collect();
        let text = names.join(" + ");
        let sources = [Source::new(SourceId(0), "a.scn", text.as_str())];
        let mut at = 0;
        let found = names.iter().map(|name| {
            let span = Span::new(SourceId(0), at, at + name.len());
            at += name.len() + 3;
            error!(E0201, span, "unknown name `{name}`").about(About::Name(name.clone()))
        });
        let told = once_a_name(less_what_follows(found.collect(), &sources), &sources);
        assert_eq!(told.len(), 15_000);
        assert!((0..15_000).all(|k| told[k].title == format!("unknown name `n{k}`")));
        assert!((0..15_000).all(|k| told[k].related.len() == usize::from(k < 5_000)));
    }
}
