//! The words and marks of a text, one at a time: for marking what an error points at and for scans that
//! come before the grammar.

// The tables that the grammar has its characters from.
use pest::unicode;

/// Marks of several characters, longer ones first.
const MARKS: [&str; 14] =
    ["<=>", "===", "==", "=>", "!=", "<=", ">=", "->", "--", "..", "&&", "||", "**", ":="];

/// Whether a character may start a name, as in the grammar.
pub(crate) fn starts_name(c: char) -> bool {
    unicode::XID_START(c) || c == '_'
}

/// Whether a character may continue a name, as in the grammar: no `²`, though it is a number.
pub(crate) fn continues_name(c: char) -> bool {
    unicode::XID_CONTINUE(c)
}

/// Length of the blank or comment at the start of a text, if there is one.
pub(super) fn trivia(text: &str) -> Option<usize> {
    let first = text.chars().next()?;
    if matches!(first, ' ' | '\t' | '\r' | '\n' | '\u{FEFF}') {
        return Some(first.len_utf8());
    }
    if text.starts_with("//") {
        return Some(text.find('\n').unwrap_or(text.len()));
    }
    text.strip_prefix("/*")?.find("*/").map(|at| at + 4)
}

/// Length of all blanks and comments at the start of a text.
pub(super) fn all_trivia(text: &str) -> usize {
    let mut at = 0;
    while let Some(length) = trivia(&text[at..]) {
        at += length;
    }
    at
}

/// The first word, number, quoted text or mark of a text that starts with no blank. Empty only at the end.
pub(super) fn first(text: &str) -> &str {
    let Some(start) = text.chars().next() else { return "" };
    if starts_name(start) {
        return &text[..text.find(|c| !continues_name(c)).unwrap_or(text.len())];
    }
    if start.is_ascii_digit() {
        return number(text);
    }
    if start == '"' {
        return quoted(text);
    }
    if let Some(mark) = MARKS.iter().find(|mark| text.starts_with(**mark)) {
        return &text[..mark.len()];
    }
    &text[..start.len_utf8()]
}

/// Digits, fraction and exponent.
fn number(text: &str) -> &str {
    let bytes = text.as_bytes();
    let digits = |mut at: usize| {
        while bytes.get(at).is_some_and(u8::is_ascii_digit) {
            at += 1;
        }
        at
    };
    let mut end = digits(0);
    if bytes.get(end) == Some(&b'.') && bytes.get(end + 1).is_some_and(u8::is_ascii_digit) {
        end = digits(end + 1);
    }
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
        if bytes.get(end + 1 + sign).is_some_and(u8::is_ascii_digit) {
            end = digits(end + 1 + sign);
        }
    }
    &text[..end]
}

/// A quoted text with its quotes, or, if it is not closed on its line, that up to the braces, behind a blank, and the
/// comment at its end.
fn quoted(text: &str) -> &str {
    let mut escaped = false;
    // Where the blanks and braces start that nothing else has followed yet, and those before a comment.
    let (mut line_end, mut before_comment) = (None, None);
    for (at, c) in text.char_indices().skip(1) {
        match c {
            '\n' => return &text[..before_comment.or(line_end).unwrap_or(at)],
            '"' if !escaped => return &text[..=at],
            _ => escaped = c == '\\' && !escaped,
        }
        match c {
            ' ' | '\t' | '\r' => line_end = line_end.or(Some(at)),
            '{' | '}' if line_end.is_some() => {}
            _ => {
                if text[at..].starts_with("//") {
                    before_comment = before_comment.or(line_end);
                }
                line_end = None;
            }
        }
    }
    &text[..before_comment.or(line_end).unwrap_or(text.len())]
}

/// Whether what `first` gave is a quoted text without its closing quote.
pub(super) fn is_open_text(token: &str) -> bool {
    let (mut closed, mut escaped) = (false, false);
    for c in token.chars().skip(1) {
        closed = c == '"' && !escaped;
        escaped = c == '\\' && !escaped;
    }
    token.starts_with('"') && !closed
}

/// The word or number that ends right before `at`, blanks skipped, and where it starts.
pub(super) fn word_before(text: &str, at: usize) -> Option<(usize, &str)> {
    let trimmed = text[..at].trim_end();
    let start = trimmed
        .rfind(|c: char| !continues_name(c) && c != '.')
        .map_or(0, |before| before + trimmed[before..].chars().next().map_or(1, char::len_utf8));
    (start < trimmed.len()).then(|| (start, &trimmed[start..]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::syntax::parse::grammar::{Grammar, Rule};
    use pest::Parser;

    #[test]
    fn the_grammar_takes_as_much_of_a_name() {
        for c in (0..=0x10_FFFF).filter_map(char::from_u32) {
            for text in [format!("{c}"), format!("a{c}b")] {
                let taken = Grammar::parse(Rule::ident, &text)
                    .map_or(0, |mut pairs| pairs.next().map_or(0, |pair| pair.as_str().len()));
                let is_name = first(&text).starts_with(starts_name);
                assert_eq!(if is_name { first(&text).len() } else { 0 }, taken, "{text:?}");
            }
        }
    }

    #[test]
    fn the_grammar_takes_as_much_of_a_quoted_text() {
        let letters = ['"', '\\', ' ', '\r', '{', '}', '/', 'x', '\u{A0}', '\n'];
        for code in 0..1_000_000_usize {
            let text: String = (0..6)
                .scan(code, |rest, _| {
                    let letter = letters[*rest % letters.len()];
                    *rest /= letters.len();
                    Some(letter)
                })
                .collect();
            let text = format!("\"{text}");
            let taken = Grammar::parse(Rule::text, &text).map_or(0, |taken| taken.as_str().len());
            let closed = Some(first(&text)).filter(|token| !is_open_text(token)).map_or(0, str::len);
            assert_eq!(closed, taken, "{text:?}");
        }
    }
}
