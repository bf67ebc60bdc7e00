//! From texts to syntax trees.
//!
//! Parsing never fails. A text is split into items, and each is parsed by itself: one that is broken is reported at its
//! exact byte, and has a node of its own in the tree.

mod agents;
mod bounds;
mod braces;
mod builder;
mod columns;
pub(super) mod comments;
mod declaration;
mod expression;
mod failure;
mod fault;
mod foreign;
pub(super) mod grammar;
mod items;
pub(super) mod layout;
mod lexeme;
mod nesting;
mod nouns;
mod process;
mod property;
mod quantity;
mod retry;
mod scenario;
mod scene;
mod slips;
mod units;

pub(crate) use foreign::word as foreign_word;
pub(crate) use lexeme::{continues_name, starts_name};
pub use nouns::edits;
pub(crate) use quantity::{time_meant, unit_meant};

pub(super) use builder::Pair;
pub(super) use items::inner;

use super::ast::{Expr, PropertyFile, ScenarioFile};

use super::codes::Code;
use super::diagnostic::{Diagnostic, Severity};
use super::source::{Source, SourceId, Span};
use builder::Builder;
use grammar::Rule;
use layout::Layout;

/// Reads bytes as a source text: UTF-8, not empty, below 4 GiB.
#[allow(clippy::result_large_err, reason = "called once a file")]
pub fn decode(id: SourceId, name: &str, bytes: &[u8]) -> Result<Source, Diagnostic> {
    if u32::try_from(bytes.len()).is_err() {
        return Err(Diagnostic::placeless(Code::E0107, format!("{name} is larger than 4 GiB")));
    }
    match std::str::from_utf8(bytes) {
        Ok(text) if text.trim_matches(|c: char| c.is_whitespace() || c == '\u{FEFF}').is_empty() => {
            Err(Diagnostic::placeless(Code::E0108, format!("{name} is empty")))
        }
        Ok(text) => Ok(Source::new(id, name, text)),
        Err(error) => {
            let at = error.valid_up_to();
            let valid = std::str::from_utf8(&bytes[..at]).unwrap_or("");
            let line = valid.matches('\n').count() + 1;
            let column = valid.rsplit('\n').next().unwrap_or("").chars().count() + 1;
            let title = format!("{name}:{line}:{column} is not UTF-8: byte 0x{:02X}", bytes[at]);
            let hint = if bytes.starts_with(&[0xFF, 0xFE]) || bytes.starts_with(&[0xFE, 0xFF]) {
                "the file looks like UTF-16; save it as UTF-8"
            } else {
                "save the file as UTF-8"
            };
            Err(error!(E0107, Span::new(id, at, at + 1), "{title}"; hint: "{hint}"))
        }
    }
}

/// Parses a scenario (`.scn`). What could not be read is reported.
pub fn parse_scenario(source: &Source) -> (ScenarioFile, Vec<Diagnostic>) {
    let (file, is_torn, said) = parse(source, false, " s", &|builder| builder.scenario_file());
    (ScenarioFile { is_torn, fails: fails(&said), ..file.unwrap_or_default() }, said)
}

/// Parses a property file (`.bltl`). What could not be read is reported.
pub fn parse_properties(source: &Source) -> (PropertyFile, Vec<Diagnostic>) {
    parse_properties_of(source, false)
}

/// The same, where it is known whether the scenario counts steps: hints write times as it does.
pub fn parse_properties_of(source: &Source, counts_steps: bool) -> (PropertyFile, Vec<Diagnostic>) {
    let unit = if counts_steps { "" } else { " s" };
    let (file, is_torn, said) = parse(source, true, unit, &|builder| builder.property_file());
    (PropertyFile { is_torn, fails: fails(&said), ..file.unwrap_or_default() }, said)
}

fn fails(said: &[Diagnostic]) -> bool {
    said.iter().any(|one| one.severity == Severity::Error)
}

/// Parses a file: its items one by one. Says whether items may stand in the wrong blocks.
fn parse<T>(
    source: &Source,
    in_properties: bool,
    unit: &'static str,
    build: &dyn for<'s> Fn(&mut Builder<'s>) -> T,
) -> (Option<T>, bool, Vec<Diagnostic>) {
    let open_comment = nesting::open_comment(source);
    let end = open_comment.as_ref().map_or(source.text.len(), |(at, _)| *at);
    let mut tokens = layout::tokens(&source.text[..end]);
    if let Some(too_deep) = nesting::depth(source, &tokens) {
        return (None, true, vec![too_deep]);
    }
    let mended = braces::mend(source, &mut tokens, in_properties);
    let is_torn = open_comment.is_some() || mended.is_torn;
    let layout = Layout::of(&source.text, tokens, in_properties);
    let mut builder = Builder::of(source, &layout, in_properties, unit);
    builder.broken = mended.lines;
    let built = build(&mut builder);
    let mut said = braces::together(source, builder.diagnostics, mended.slips);
    if let Some((_, unclosed)) = open_comment {
        // An error at the end of a text that was cut there is a consequence of the cut.
        let last = layout.tokens.last().map_or(0, |last| last.at) as u32;
        said.retain(|one| one.place.as_ref().is_none_or(|place| place.span.start < last));
        said.push(unclosed);
    }
    order(&mut said);
    (Some(built), is_torn, said)
}

/// The words, numbers, quoted texts and marks of a text, each with its first byte; comments are left out.
pub fn lexemes(text: &str) -> Vec<(usize, &str)> {
    layout::tokens(text).iter().map(|token| (token.at, token.text)).collect()
}

/// The word, number, quoted text or mark at a byte. Behind a word the word counts, not the mark that follows.
pub fn lexeme_at(source: &Source, byte: u32) -> Option<Span> {
    let at = byte as usize;
    let before = layout::tokens(&source.text).into_iter().take_while(|token| token.at <= at);
    let is_word = |text: &str| text.starts_with(|c: char| c.is_alphanumeric() || c == '_');
    let mut holding = before.filter(|token| at < token.end() || at == token.end() && is_word(token.text));
    holding.next().map(|token| Span::new(source.id, token.at, token.end()))
}

/// The blocks in braces of a text: the bytes of both braces, inner blocks before those around them.
pub fn blocks(text: &str) -> Vec<(usize, usize)> {
    let (mut open, mut found) = (Vec::new(), Vec::new());
    for token in layout::tokens(text) {
        match token.text {
            "{" => open.push(token.at),
            "}" => found.extend(open.pop().map(|start| (start, token.at))),
            _ => {}
        }
    }
    found
}

/// The parts of a text that are separated by commas outside brackets.
pub fn split_values(text: &str) -> Vec<&str> {
    let mut depth = 0i32;
    let outside = |c: char| {
        depth += i32::from(matches!(c, '(' | '[')) - i32::from(matches!(c, ')' | ']'));
        c == ',' && depth == 0
    };
    text.split(outside).collect()
}

/// Parses one value, such as the right side of `--set name=value`.
pub fn parse_value(source: &Source) -> Result<Expr, Vec<Diagnostic>> {
    if let Some((_, unclosed)) = nesting::open_comment(source) {
        return Err(vec![unclosed]);
    }
    let tokens = layout::tokens(&source.text);
    if let Some(too_deep) = nesting::depth(source, &tokens) {
        return Err(vec![too_deep]);
    }
    let layout = Layout::whole(&source.text, tokens);
    let mut builder = Builder::of(source, &layout, false, " s");
    let mut values =
        builder.items(&layout.items, Rule::line_of_value, &mut |builder, value| Some(builder.expr(value)));
    let mut said = builder.diagnostics;
    order(&mut said);
    match values.pop() {
        Some(value) if !fails(&said) => Ok(value),
        _ => Err(said),
    }
}

/// Sorts by place, one error and one warning a place.
fn order(diagnostics: &mut Vec<Diagnostic>) {
    diagnostics.sort_by_key(|diagnostic| diagnostic.place.as_ref().map(|place| place.span));
    diagnostics.dedup_by_key(|diagnostic| {
        diagnostic.place.as_ref().map(|place| (place.span.start, diagnostic.severity))
    });
}
