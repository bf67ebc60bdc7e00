//! A scan of the brackets before the grammar sees the text: how deep they nest, and comments that never
//! end. It reads the text once and recurses nowhere.

use super::code;
use super::lexeme;
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::source::{Source, Span};

/// How deep prefixes and brackets may nest.
pub(super) const NESTING: u16 = 256;

/// What the scan says about a text.
pub(super) enum Scan {
    /// It may be parsed.
    Fine,
    /// It may be parsed up to this byte; there a comment starts that never ends.
    Until(usize, Diagnostic),
    /// It nests too deep to be parsed.
    TooDeep(Diagnostic),
}

/// The error for nesting that is too deep.
pub(super) fn too_deep(span: Span) -> Diagnostic {
    Diagnostic::error(
        code::TOO_DEEP,
        span,
        format!("brackets and prefixes are nested more than {NESTING} deep"),
    )
    .hint("name inner parts with `let`")
}

/// Scans a text, which is that of the source or one as long.
pub(super) fn scan(source: &Source, text: &str) -> Scan {
    let mut depth = 0_u16;
    let mut at = 0;
    while at < text.len() {
        let rest = &text[at..];
        if rest.starts_with("/*") && !rest[2..].contains("*/") {
            let place = Span::new(source.id, at, at + 2);
            return Scan::Until(
                at,
                Diagnostic::error(code::COMMENT, place, "the comment is not closed")
                    .hint("close it with `*/`; a comment with `//` ends with its line"),
            );
        }
        if let Some(length) = lexeme::trivia(rest) {
            at += length;
            continue;
        }
        let token = lexeme::first(rest);
        match token {
            "(" | "[" | "{" => {
                depth += 1;
                if depth > NESTING {
                    return Scan::TooDeep(too_deep(Span::new(source.id, at, at + 1)));
                }
            }
            ")" | "]" | "}" => depth = depth.saturating_sub(1),
            _ => {}
        }
        at += token.len().max(1);
    }
    Scan::Fine
}

/// The brackets of a text from a byte on, without those in comments and quoted texts.
fn brackets(text: &str, from: usize) -> impl Iterator<Item = (usize, char)> {
    let mut at = from;
    std::iter::from_fn(move || {
        while at < text.len() {
            let rest = &text[at..];
            if let Some(length) = lexeme::trivia(rest) {
                at += length;
                continue;
            }
            let (start, token) = (at, lexeme::first(rest));
            at += token.len().max(1);
            if matches!(token, "(" | "[" | "{" | ")" | "]" | "}") {
                return token.chars().next().map(|bracket| (start, bracket));
            }
        }
        None
    })
}

/// The brackets that are open at `until`, counted from `from`, the innermost last.
pub(super) fn open_brackets(text: &str, from: usize, until: usize) -> Vec<(usize, char)> {
    let mut open = Vec::new();
    // Behind it the next one may be far.
    for (at, bracket) in brackets(&text[..until], from) {
        match bracket {
            '(' | '[' | '{' => open.push((at, bracket)),
            _ => drop(open.pop()),
        }
    }
    open
}

/// The innermost of them.
pub(super) fn open_bracket(text: &str, from: usize, until: usize) -> Option<(usize, char)> {
    open_brackets(text, from, until).pop()
}

/// The bracket that closes another.
pub(super) fn partner(bracket: char) -> char {
    match bracket {
        '(' => ')',
        '[' => ']',
        _ => '}',
    }
}

/// The first bracket of a text that closes what was opened before it. A brace closes what stands open within it.
pub(super) fn first_closing(text: &str) -> Option<char> {
    let mut open: Vec<char> = Vec::new();
    for (_, bracket) in brackets(text, 0) {
        if matches!(bracket, '(' | '[' | '{') {
            open.push(partner(bracket));
            continue;
        }
        match open.iter().rposition(|close| *close == bracket) {
            Some(place) if bracket == '}' || !open[place..].contains(&'}') => open.truncate(place),
            _ if bracket != '}' && open.contains(&'}') => {}
            _ => return Some(bracket),
        }
    }
    None
}

/// The braces of a text and how many are open after each: one scan reports thousands of unmatched braces.
pub(super) struct Braces(Vec<(usize, usize)>);

impl Braces {
    pub(super) fn of(text: &str) -> Self {
        let mut open = 0_usize;
        let after =
            brackets(text, 0).filter(|(_, bracket)| matches!(bracket, '{' | '}')).map(|(at, brace)| {
                open = if brace == '{' { open + 1 } else { open.saturating_sub(1) };
                (at, open)
            });
        Self(after.collect())
    }

    /// Whether one is open at a byte.
    pub(super) fn is_open_at(&self, until: usize) -> bool {
        let before = self.0.partition_point(|(at, _)| *at < until);
        self.0[..before].last().is_some_and(|(_, open)| *open > 0)
    }
}
