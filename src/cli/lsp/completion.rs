//! Completion: the compiler is asked for a name that nothing has, and says which names it knows at that place.

use super::desk::{Checked, Desk};
use super::hover;
use super::place;
use crate::compile::{DISTRIBUTIONS, dimension};
use crate::model::BuiltIn;
use crate::syntax::ast::Item;
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::About;
use crate::syntax::keywords::{self, Place};
use crate::syntax::parse::{lexeme_at, lexemes, parse_properties, parse_scenario};
use crate::syntax::source::{Source, SourceId, Span};
use lsp_types::{
    CompletionItem, CompletionItemKind, CompletionTextEdit, Documentation, MarkupContent, MarkupKind,
    Position, Range, TextEdit,
};
use std::collections::BTreeMap;

/// A name that nothing has.
const NOBODY: &str = "name_to_complete_";

/// The names that may stand at a position, in the place of the word there.
pub(super) fn complete(desk: &mut Desk, uri: &str, position: Position) -> Vec<CompletionItem> {
    let Ok(text) = desk.text(uri) else { return Vec::new() };
    let source = Source::new(SourceId(0), uri, &*text);
    let at = place::byte(&source, position);
    let is_word = |span: &Span| source.slice(*span).starts_with(|c: char| c.is_alphabetic() || c == '_');
    let word =
        lexeme_at(&source, at).filter(is_word).unwrap_or(Span::new(source.id, at as usize, at as usize));
    let (before, after) = (&text[..word.start as usize], &text[word.end as usize..]);
    let range = place::range(&source, word);
    if is_behind_number(before) {
        return units(&desk.checked(uri), word.start.saturating_sub(1), range);
    }
    // An item that is not finished is finished in several ways, until the name in it is looked for.
    let line = before.rfind('\n').map_or(0, |at| at + 1);
    let open = unclosed(&before[line..], after.lines().next().unwrap_or_default());
    let is_first = before[line..].trim().is_empty() || before.trim_end().ends_with(['{', ';']);
    let (field, rest) = ((" = 0", ""), [("", ""), ("", " { }"), ("", " >= 0")]);
    let ends = if is_first { [field, rest[0], rest[1], rest[2]] } else { [rest[0], field, rest[1], rest[2]] };
    let here = Span::new(source.id, word.start as usize, word.start as usize + NOBODY.len());
    let mut found: BTreeMap<String, CompletionItem> = BTreeMap::new();
    let mut part = None;
    for (own, end) in ends {
        let asked = format!("{before}{NOBODY}{own}{open}{end}{after}");
        let (place, is_read) = part_with(&asked, desk.asks(uri), here);
        part = part.or(place);
        if is_read {
            let known = desk.with_text(uri, &asked, |checked| known_at(checked, uri, here, range));
            found.extend(known.into_iter().map(|item| (item.label.clone(), item)));
            break;
        }
    }
    // Where an item begins, so may those of the part in which it stands.
    if let Some(part) = part.filter(|_| is_first) {
        found.extend(keywords::beginning(part).map(|word| (word.to_owned(), keyword(word, range))));
    }
    if found.is_empty() {
        let checked = desk.checked(uri);
        let file = checked.source(uri).map(|source| source.id);
        let in_reach = checked.names.declared.iter().enumerate().filter(|(_, one)| {
            one.inside.is_none() && (Some(one.span.source) == file || one.span.source == SourceId(0))
        });
        let items = in_reach.map(|(_, one)| item(&checked, &one.name, range));
        found.extend(items.map(|item| (item.label.clone(), item)));
    }
    found.into_values().collect()
}

/// The part of a text in which an item begins at a place, as far as that shows, and whether that item can be read.
fn part_with(text: &str, asks: bool, here: Span) -> (Option<Place>, bool) {
    let source = Source::new(here.source, "", text);
    let (broken, items) = if asks {
        (parse_properties(&source).0.broken, Vec::new())
    } else {
        let file = parse_scenario(&source).0;
        (file.broken, file.items)
    };
    let broken = broken
        .iter()
        .filter(|one| one.span.holds(here) || here.holds(one.span))
        .map(|one| one.place)
        .next_back();
    // `name = 0` is read as a setting of the scenario.
    let is_setting = |item: &Item| matches!(item, Item::Setting { name, .. } if name.span == here);
    (broken.or_else(|| items.iter().any(is_setting).then_some(Place::Scenario)), broken.is_none())
}

/// The names that the compiler knows at a place where it met the one that nothing has.
fn known_at(checked: &Checked, uri: &str, here: Span, range: Range) -> Vec<CompletionItem> {
    let Some(source) = checked.source(uri) else { return Vec::new() };
    let here = Span { source: source.id, ..here };
    let mut names: Vec<String> = Vec::new();
    for one in &checked.inputs.diagnostics {
        if !one.place.as_ref().is_some_and(|place| place.span.holds(here)) {
            continue;
        }
        names.extend(one.known.iter().cloned());
        // Where a value may stand, a function may.
        if one.code == Code::E0201 {
            names.extend(BuiltIn::names().map(str::to_owned));
        }
    }
    names.iter().map(|name| item(checked, name, range)).collect()
}

fn edit(text: &str, range: Range) -> CompletionTextEdit {
    CompletionTextEdit::Edit(TextEdit::new(range, text.to_owned()))
}

fn documented(text: String) -> Documentation {
    Documentation::MarkupContent(MarkupContent { kind: MarkupKind::Markdown, value: text })
}

fn keyword(word: &str, range: Range) -> CompletionItem {
    CompletionItem { kind: Some(CompletionItemKind::KEYWORD), ..plain(word, range) }
}

fn plain(text: &str, range: Range) -> CompletionItem {
    CompletionItem { label: text.to_owned(), text_edit: Some(edit(text, range)), ..CompletionItem::default() }
}

/// A name with its kind, and what is known of it; of words of the language that follows (`resolved`).
fn item(checked: &Checked, name: &str, range: Range) -> CompletionItem {
    let Some(at) = checked.names.declared.iter().position(|one| one.name == name) else {
        let is_call = BuiltIn::find(name).is_some() || DISTRIBUTIONS.contains(&name);
        let kind = if is_call { CompletionItemKind::FUNCTION } else { CompletionItemKind::PROPERTY };
        return CompletionItem { kind: Some(kind), ..plain(name, range) };
    };
    let one = &checked.names.declared[at];
    CompletionItem {
        kind: Some(match one.noun {
            "const" => CompletionItemKind::CONSTANT,
            "kind" => CompletionItemKind::CLASS,
            "property" | "label" => CompletionItemKind::EVENT,
            "region" | "wall" | "obstacle" | "line" | "point" | "door" | "level" | "stairs" => {
                CompletionItemKind::FIELD
            }
            _ if !one.arguments.is_empty() => CompletionItemKind::FUNCTION,
            _ => CompletionItemKind::VARIABLE,
        }),
        detail: Some(one.noun.to_owned()),
        documentation: Some(documented(hover::declared(checked, at))),
        ..plain(name, range)
    }
}

/// A completion with what the manual says of it.
pub(super) fn resolved(mut item: CompletionItem) -> CompletionItem {
    let said = || hover::of_language(&item.label).into_iter().next().map(documented);
    item.documentation = item.documentation.take().or_else(said);
    item
}

/// The brackets that a line has left open, closed, unless the rest of the line does so.
fn unclosed(line: &str, rest: &str) -> String {
    let mut open = Vec::new();
    for (_, text) in lexemes(line) {
        match text {
            "(" => open.push(')'),
            "[" => open.push(']'),
            ")" | "]" => drop(open.pop()),
            _ => {}
        }
    }
    let closed = rest.chars().filter(|c| matches!(c, ')' | ']')).count();
    open.iter().rev().take(open.len().saturating_sub(closed)).collect()
}

/// Whether a unit may stand behind a text: it ends with a number and a blank.
fn is_behind_number(before: &str) -> bool {
    let number = before
        .strip_suffix(' ')
        .and_then(|rest| rest.rsplit(|c: char| !(c.is_ascii_alphanumeric() || c == '.' || c == '_')).next());
    number.is_some_and(|number| {
        number.starts_with(|c: char| c.is_ascii_digit()) && number.parse::<f64>().is_ok()
    })
}

/// The units, those first that are wanted behind the number that ends at a byte.
fn units(checked: &Checked, end: u32, range: Range) -> Vec<CompletionItem> {
    let wanted = checked.inputs.diagnostics.iter().find_map(|one| match (&one.about, &one.place) {
        (About::Unit { wanted, .. }, Some(place)) if place.span.end == end => Some(wanted),
        _ => None,
    });
    let unit = |name: &str| {
        let detail = dimension::unit(name).map(|unit| dimension::describe(unit.dimension));
        let is_wanted = wanted.is_none() || wanted == detail.as_ref();
        CompletionItem {
            kind: Some(CompletionItemKind::UNIT),
            detail,
            sort_text: Some(format!("{}{name}", u8::from(!is_wanted))),
            ..plain(name, range)
        }
    };
    dimension::UNITS.into_iter().map(unit).collect()
}
