//! Changes of texts: rename, format, and the remedies of errors.

use super::desk::{Checked, Desk};
use super::place;
use crate::syntax::diagnostic::{Diagnostic, Severity};
use crate::syntax::keywords::is_marked;
use crate::syntax::parse::{lexeme_at, lexemes};
use crate::syntax::print::{format_lines, format_properties, format_scenario};
use crate::syntax::source::{Source, SourceId, Span};
use lsp_types::{CodeAction, CodeActionKind, Location, Position, Range, TextEdit, Uri, WorkspaceEdit};
use std::collections::HashMap;
use std::str::FromStr;

/// Most remedies that are tried at a place.
const MOST_TRIED: usize = 8;

/// The places of the name at a position, that of its declaration first.
pub(super) fn places(checked: &Checked, uri: &str, position: Position) -> Vec<Location> {
    let spans = || {
        let source = checked.source(uri)?;
        let here = lexeme_at(source, place::byte(source, position))?;
        Some(checked.names.places(checked.names.at(here)?))
    };
    let spans = spans().unwrap_or_default();
    let location = |span: &Span| {
        let (uri, source) = checked.file(*span)?;
        Some(Location::new(Uri::from_str(uri).ok()?, place::range(source, *span)))
    };
    spans.iter().filter_map(location).collect()
}

#[allow(clippy::mutable_key_type, clippy::disallowed_types, reason = "the protocol has this type")]
fn edits(of: Vec<(Uri, TextEdit)>) -> WorkspaceEdit {
    let mut changes: HashMap<Uri, Vec<TextEdit>> = HashMap::new();
    for (uri, edit) in of {
        changes.entry(uri).or_default().push(edit);
    }
    WorkspaceEdit { changes: Some(changes), ..WorkspaceEdit::default() }
}

/// The edits that give the name at a position another one, in all files of the scenario.
///
/// # Errors
/// Where there is no name, the new one is none, or something has it already.
pub(super) fn rename(
    desk: &mut Desk,
    uri: &str,
    position: Position,
    new: &str,
) -> Result<WorkspaceEdit, String> {
    if lexemes(new).len() != 1
        || lexemes(new)[0].1 != new
        || !new.starts_with(|c: char| c.is_alphabetic() || c == '_')
    {
        return Err(format!("`{new}` is no name: a name has letters, digits and `_`"));
    }
    if is_marked(new) {
        return Err(format!("`{new}` is a word of the language"));
    }
    let checked = desk.whole(uri);
    let found = places(&checked, uri, position);
    if found.is_empty() {
        return Err("there is no name here that a file declares".to_owned());
    }
    if checked.names.declared.iter().any(|one| one.name == new) {
        return Err(format!("`{new}` is declared already"));
    }
    Ok(edits(found.into_iter().map(|at| (at.uri, TextEdit::new(at.range, new.to_owned()))).collect()))
}

/// The edit that formats a text, or the lines of a range; none where the text has errors or is formatted.
pub(super) fn format(text: &str, asks: bool, range: Option<Range>) -> Option<TextEdit> {
    let source = Source::new(SourceId(0), "", text);
    let formatted = if asks { format_properties(&source) } else { format_scenario(&source) }.ok()?;
    let (span, new) = match range {
        None => (Span::new(source.id, 0, text.len()), formatted),
        Some(Range { start, end }) => {
            format_lines(&source, &formatted, place::byte(&source, start), place::byte(&source, end))?
        }
    };
    (source.slice(span) != new).then(|| TextEdit::new(place::range(&source, span), new))
}

/// The remedies of the errors within a range: what their hints say is tried, and offered if fewer errors are left.
pub(super) fn fixes(desk: &mut Desk, uri: &str, range: Range) -> Vec<CodeAction> {
    let checked = desk.checked(uri);
    let (Some(source), Ok(address)) = (checked.source(uri), Uri::from_str(uri)) else { return Vec::new() };
    let errors = |checked: &Checked| {
        checked.inputs.diagnostics.iter().filter(|one| one.severity == Severity::Error).count()
    };
    let before = errors(&checked);
    let here = |one: &&Diagnostic| {
        let span = one.place.as_ref().map(|place| place.span);
        span.is_some_and(|span| {
            let own = place::range(source, span);
            span.source == source.id && own.start <= range.end && range.start <= own.end
        })
    };
    let mut found = Vec::new();
    for one in checked.inputs.diagnostics.iter().filter(here).take(MOST_TRIED) {
        let (Some(hint), Some(place)) = (&one.hint, &one.place) else { continue };
        for new in written(hint) {
            let span = place.span;
            let (start, end) = (span.start as usize, span.end as usize);
            let text = format!("{}{new}{}", &source.text[..start], &source.text[end..]);
            if desk.with_text(uri, &text, |checked| errors(checked)) >= before {
                continue;
            }
            let edit = TextEdit::new(place::range(source, span), new.to_owned());
            found.push(CodeAction {
                title: format!("write `{new}`"),
                kind: Some(CodeActionKind::QUICKFIX),
                edit: Some(edits(vec![(address.clone(), edit)])),
                is_preferred: Some(hint.starts_with("did you mean")),
                ..CodeAction::default()
            });
        }
    }
    found
}

/// The texts that a hint says to write.
fn written(hint: &str) -> impl Iterator<Item = &str> {
    let says = hint.starts_with("did you mean") || hint.contains("write ");
    hint.split('`').skip(1).step_by(2).filter(move |text| says && !text.is_empty() && !text.contains('…'))
}
