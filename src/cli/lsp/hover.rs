//! The text over which the mouse rests: kind, unit and value of a name, and the line of the manual for words of the language.

use super::desk::Checked;
use super::place;
use crate::cli::manual;
use crate::model::{BuiltIn, Parameter};
use crate::report::model;
use crate::stats::PROCEDURES;
use crate::syntax::codes::Code;
use crate::syntax::parse::lexeme_at;
use lsp_types::{Hover, HoverContents, MarkupContent, MarkupKind, Position};

/// The text for a position.
pub(super) fn hover(checked: &Checked, uri: &str, position: Position) -> Option<Hover> {
    let source = checked.source(uri)?;
    let here = lexeme_at(source, place::byte(source, position))?;
    let mut said: Vec<String> = Vec::new();
    said.extend(checked.names.at(here).map(|name| declared(checked, name)));
    // The smallest expression that is one name, member or call here.
    let notes = checked.inputs.notes.iter().filter(|(span, _)| span.holds(here));
    let note = notes.min_by_key(|(span, _)| span.end - span.start);
    let is_declaration = checked.names.declared.iter().any(|one| one.span == here);
    if let Some((span, note)) = note.filter(|_| !is_declaration) {
        said.push(format!("`{}`: {note}", source.in_one_line(*span)));
    }
    if said.is_empty() || note.is_some_and(|(span, _)| source.slice(*span).ends_with(')')) {
        said.extend(of_language(source.slice(here)));
    }
    let codes = checked.inputs.diagnostics.iter().filter(|one| {
        one.place.as_ref().is_some_and(|place| place.span.holds(here) || here.holds(place.span))
    });
    // The examples of its page are left to `smc explain`.
    let page = |code: Code| code.page().split("\n\n").nth(1).unwrap_or_default();
    said.extend(
        codes.map(|one| format!("**{}: {}**\n\n{}", one.code, one.code.title(), page(one.code))).take(1),
    );
    if said.is_empty() {
        return None;
    }
    let contents = MarkupContent { kind: MarkupKind::Markdown, value: said.join("\n\n") };
    Some(Hover { contents: HoverContents::Markup(contents), range: Some(place::range(source, here)) })
}

/// A declaration in words: what it is, where it stands, and its value.
pub(super) fn declared(checked: &Checked, declaration: usize) -> String {
    let one = &checked.names.declared[declaration];
    let Some((_, source)) = checked.file(one.span) else { return String::new() };
    let arguments =
        if one.arguments.is_empty() { String::new() } else { format!("({})", one.arguments.join(", ")) };
    let mut said = format!("**{}** `{}{arguments}`", one.noun, one.name);
    if let Some(value) = one.value {
        said += &format!(" = `{}`", crate::base::visible::shortened(source.in_one_line(value)));
        // The value of a declaration is noted under its name, at the place of the value.
        said += &checked.inputs.notes.get(&value).map_or(String::new(), |note| format!("\n\n{note}"));
    }
    let about = checked.inputs.study.as_ref().and_then(|study| model::about(study, &one.name));
    if let Some(about) = about.filter(|_| one.value.is_none() && one.inside.is_none()) {
        said += &format!("\n\n```text\n{about}\n```");
    }
    said
}

/// The manual's line for a keyword, function, procedure or parameter.
pub(super) fn of_language(word: &str) -> Vec<String> {
    let built_in = BuiltIn::find(word).and_then(manual::function);
    let procedures = PROCEDURES.iter().filter(|one| one.name == word);
    let procedures =
        procedures.map(|one| format!("{} by `{}`\n\n{}.", one.serves, one.signature(), one.guarantee));
    let parameter = Parameter::named(word).map(|one| {
        let about = one.description();
        let default = about.default.map_or(String::new(), |value| format!("; {value} unless set"));
        let unit = if about.dimension.is_none() { String::new() } else { format!(" ({})", about.dimension) };
        format!("`{word}`{unit}: {}{default}", about.meaning)
    });
    built_in.into_iter().chain(procedures).chain(parameter).chain(manual::keyword(word)).collect()
}
