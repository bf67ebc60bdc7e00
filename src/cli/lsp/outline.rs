//! The shape of a text: its declarations, its blocks, and the words that are names.

use super::desk::Checked;
use super::place;
use crate::model::BuiltIn;
use crate::syntax::ast::PropertyItem;
use crate::syntax::keywords::{is_marked, is_temporal};
use crate::syntax::names::Declared;
use crate::syntax::parse::{blocks, lexemes};
use crate::syntax::source::{Source, Span};
use lsp_types::{DocumentSymbol, FoldingRange, SemanticToken, SemanticTokenType, SymbolKind};
use serde_json::{Value, json};

/// The kinds of words, in the order of their numbers.
pub(super) const KINDS: [SemanticTokenType; 10] = [
    SemanticTokenType::KEYWORD,
    SemanticTokenType::FUNCTION,
    SemanticTokenType::VARIABLE,
    SemanticTokenType::PARAMETER,
    SemanticTokenType::PROPERTY,
    SemanticTokenType::CLASS,
    SemanticTokenType::ENUM_MEMBER,
    SemanticTokenType::NUMBER,
    SemanticTokenType::STRING,
    SemanticTokenType::OPERATOR,
];

/// The kind of a name by the word that declares it.
fn kind(noun: &str) -> (SymbolKind, SemanticTokenType) {
    match noun {
        "const" => (SymbolKind::CONSTANT, SemanticTokenType::VARIABLE),
        "param" | "argument" => (SymbolKind::VARIABLE, SemanticTokenType::PARAMETER),
        "let" | "signal" | "property" | "label" => (SymbolKind::FUNCTION, SemanticTokenType::FUNCTION),
        "kind" | "process" | "program" | "behaviour" | "tracks" => {
            (SymbolKind::CLASS, SemanticTokenType::CLASS)
        }
        "state" => (SymbolKind::ENUM_MEMBER, SemanticTokenType::ENUM_MEMBER),
        "agent" | "agents" | "group" | "groups" | "source" => {
            (SymbolKind::OBJECT, SemanticTokenType::VARIABLE)
        }
        _ => (SymbolKind::FIELD, SemanticTokenType::PROPERTY),
    }
}

/// The declarations of a file, and its queries.
pub(super) fn symbols(checked: &Checked, uri: &str) -> Vec<DocumentSymbol> {
    let Some(source) = checked.source(uri) else { return Vec::new() };
    let mut found = within(checked, source, None);
    let files = checked.properties.iter().flat_map(|file| &file.items);
    for item in files {
        if let PropertyItem::Query(query) = item
            && query.span.source == source.id
        {
            let text = source.in_one_line(query.span);
            found.push(symbol(
                source,
                (&text, "query", SymbolKind::EVENT),
                (query.span, query.span),
                Vec::new(),
            ));
        }
    }
    found.sort_by_key(|one| one.range.start);
    found
}

#[allow(deprecated, reason = "the field has no other way to be left out")]
fn symbol(
    source: &Source,
    (name, detail, kind): (&str, &str, SymbolKind),
    (whole, own): (Span, Span),
    children: Vec<DocumentSymbol>,
) -> DocumentSymbol {
    DocumentSymbol {
        name: name.to_owned(),
        detail: Some(detail.to_owned()),
        kind,
        tags: None,
        deprecated: None,
        range: place::range(source, whole),
        selection_range: place::range(source, own),
        children: (!children.is_empty()).then_some(children),
    }
}

fn within(checked: &Checked, source: &Source, around: Option<usize>) -> Vec<DocumentSymbol> {
    let all = checked.names.declared.iter().enumerate();
    let own =
        all.filter(|(_, one)| one.inside == around && one.span.source == source.id && one.noun != "argument");
    own.map(|(at, one)| {
        let children = within(checked, source, Some(at));
        symbol(source, (&one.name, one.noun, kind(one.noun).0), (one.whole, one.span), children)
    })
    .collect()
}

/// The blocks of a file that have several lines. The brace that ends one stays in sight.
pub(super) fn folds(source: &Source) -> Vec<FoldingRange> {
    let line = |at: usize| source.line(at as u32) as u32 - 1;
    let lines = blocks(&source.text).into_iter().map(|(open, close)| (line(open), line(close)));
    let long = lines.filter(|(first, last)| first < last);
    long.map(|(start_line, last)| FoldingRange { start_line, end_line: last - 1, ..FoldingRange::default() })
        .collect()
}

/// The unit and the value of each named expression that computes them, behind its name; nothing where they are written.
pub(super) fn hints(checked: &Checked, uri: &str) -> Vec<Value> {
    let Some(source) = checked.source(uri) else { return Vec::new() };
    let hint = |one: &Declared| {
        let value = one.value.filter(|_| one.span.source == source.id)?;
        let text =
            checked.inputs.notes.get(&value)?.split_once(", ").map(|(_, value)| format!("= {value}"))?;
        let is_written = source.slice(value).starts_with(|c: char| c.is_ascii_digit());
        let at = place::position(source, one.span.end);
        (!is_written).then(|| json!({ "position": at, "label": text, "paddingLeft": true }))
    };
    checked.names.declared.iter().filter_map(hint).collect()
}

/// The words of a file with their kinds.
pub(super) fn tokens(checked: &Checked, uri: &str) -> Vec<SemanticToken> {
    let Some(source) = checked.source(uri) else { return Vec::new() };
    let names = &checked.names;
    let declared = names.declared.iter().map(|one| (one.span, one.noun));
    let used = names.used.iter().map(|one| (one.span, names.declared[one.means].noun));
    let known: std::collections::BTreeMap<Span, &str> = declared.chain(used).collect();
    let (mut found, mut last) = (Vec::new(), lsp_types::Position::default());
    for (at, text) in lexemes(&source.text) {
        let span = Span::new(source.id, at, at + text.len());
        let first = text.chars().next().unwrap_or_default();
        let kind = match known.get(&span) {
            Some(noun) => kind(noun).1,
            None if is_temporal(text) => SemanticTokenType::OPERATOR,
            None if is_marked(text) => SemanticTokenType::KEYWORD,
            None if BuiltIn::find(text).is_some() && source.text[at + text.len()..].starts_with('(') => {
                SemanticTokenType::FUNCTION
            }
            None if first == '"' => SemanticTokenType::STRING,
            None if first.is_ascii_digit() => SemanticTokenType::NUMBER,
            None => continue,
        };
        // A token of several lines is none for the protocol.
        if text.contains('\n') {
            continue;
        }
        let place = place::position(source, span.start);
        let delta_line = place.line - last.line;
        found.push(SemanticToken {
            delta_line,
            delta_start: if delta_line == 0 { place.character - last.character } else { place.character },
            length: text.encode_utf16().count() as u32,
            token_type: KINDS.iter().position(|known| *known == kind).unwrap_or(0) as u32,
            token_modifiers_bitset: 0,
        });
        last = place;
    }
    found
}
