//! Scans before the grammar sees a text: how deep its brackets nest, and comments that never end. They recurse nowhere.

use super::layout::{self, Token};
use super::lexeme;
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::source::{Source, Span};

/// How deep prefixes and brackets may nest.
pub(super) const NESTING: u16 = 256;

/// The error for nesting that is too deep.
pub(super) fn too_deep(span: Span) -> Diagnostic {
    error!(E0106, span, "brackets and prefixes are nested more than {NESTING} deep";
        hint: "name inner parts with `let`")
}

/// The error of brackets that nest too deep.
pub(super) fn depth(source: &Source, tokens: &[Token<'_>]) -> Option<Diagnostic> {
    let mut depth = 0_u16;
    for token in tokens {
        match token.text {
            "(" | "[" | "{" => depth += 1,
            ")" | "]" | "}" => depth = depth.saturating_sub(1),
            _ => {}
        }
        if depth > NESTING {
            return Some(too_deep(Span::new(source.id, token.at, token.at + 1)));
        }
    }
    None
}

/// The start of a comment that never ends, and its error.
pub(super) fn open_comment(source: &Source) -> Option<(usize, Diagnostic)> {
    let text = source.text.as_str();
    let mut at = 0;
    while at < text.len() {
        let rest = &text[at..];
        if rest.starts_with("/*") && !rest[2..].contains("*/") {
            let place = Span::new(source.id, at, at + 2);
            let error = error!(E0104, place, "the comment is not closed");
            return Some((at, error.hint("close it with `*/`; a comment with `//` ends with its line")));
        }
        at += lexeme::trivia(rest).unwrap_or_else(|| lexeme::first(rest).len());
    }
    None
}

/// The brackets that are open at a byte of a text without comments, the innermost last.
pub(super) fn open_brackets(text: &str, until: usize) -> Vec<(usize, char)> {
    let mut open = Vec::new();
    for token in layout::tokens(&text[..until]) {
        match token.text {
            "(" | "[" | "{" => open.extend(token.text.chars().next().map(|bracket| (token.at, bracket))),
            ")" | "]" | "}" => drop(open.pop()),
            _ => {}
        }
    }
    open
}

/// The innermost of them.
pub(super) fn open_bracket(text: &str, until: usize) -> Option<(usize, char)> {
    open_brackets(text, until).pop()
}

/// The bracket that closes another.
pub(super) fn partner(bracket: char) -> char {
    match bracket {
        '(' => ')',
        '[' => ']',
        _ => '}',
    }
}
