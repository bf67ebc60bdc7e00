//! Records and cells of comma-separated values, with their places in the text.
//!
//! A cell that begins with a quotation mark ends with the next one that is not doubled, and may hold commas and line ends
//! (RFC 4180).

use std::borrow::Cow;

/// Where a text stands after a character.
#[derive(Clone, Copy, PartialEq)]
enum At {
    /// Before the first character of a cell that is no blank.
    Start,
    /// Between quotation marks.
    Quoted,
    /// Behind a quotation mark that ends a cell, unless another one follows.
    Closed,
    /// In a cell without quotation marks.
    Plain,
}

impl At {
    fn after(self, c: char, separator: char) -> Self {
        match (self, c) {
            (Self::Quoted, '"') => Self::Closed,
            (Self::Quoted, _) | (Self::Start | Self::Closed, '"') => Self::Quoted,
            (_, c) if c == separator || c == '\n' => Self::Start,
            (Self::Start, c) if c.is_whitespace() => Self::Start,
            (Self::Closed, c) if c.is_whitespace() => Self::Closed,
            _ => Self::Plain,
        }
    }
}

/// The separator of the cells of a table with this header: a comma, or the semicolon or tab of spreadsheets.
pub(super) fn separator(header: &str) -> char {
    [';', '\t'].into_iter().find(|one| header.contains(*one)).unwrap_or(',')
}

/// The records of a text that are not empty, each with the number of its first line, from 1, and whether its last cell
/// ends.
pub(super) fn records(text: &str, separator: char) -> impl Iterator<Item = (usize, &str, bool)> {
    let (mut rest, mut line) = (text, 1);
    std::iter::from_fn(move || {
        if rest.is_empty() {
            return None;
        }
        let (mut at, mut end) = (At::Start, rest.len());
        for (place, c) in rest.char_indices() {
            if c == '\n' && at != At::Quoted {
                end = place + 1;
                break;
            }
            at = at.after(c, separator);
        }
        let (record, after) = rest.split_at(end);
        let number = line;
        line += record.matches('\n').count();
        rest = after;
        Some((number, record.trim_end_matches(['\n', '\r']), at != At::Quoted))
    })
    .filter(|(_, record, _)| !record.trim().is_empty())
}

/// The cells of a record without blanks and quotation marks around them, each with the character (from 1) at which it
/// begins.
pub(super) fn cells(record: &str, separator: char) -> impl Iterator<Item = (usize, Cow<'_, str>)> {
    let (mut rest, mut column) = (Some(record), 1);
    std::iter::from_fn(move || {
        let text = rest?;
        let mut at = At::Start;
        let comma = text.char_indices().find(|(_, c)| {
            let ends = *c == separator && at != At::Quoted;
            at = at.after(*c, separator);
            ends
        });
        let cell = comma.map_or(text, |(place, _)| &text[..place]);
        rest = comma.map(|(place, _)| &text[place + 1..]);
        let start = column + cell.chars().take_while(|c| c.is_whitespace()).count();
        column += cell.chars().count() + 1;
        let cell = cell.trim();
        let inner = cell.strip_prefix('"').and_then(|cell| cell.strip_suffix('"'));
        let inner = inner.map(|inner| {
            if inner.contains('"') { Cow::Owned(inner.replace("\"\"", "\"")) } else { Cow::Borrowed(inner) }
        });
        Some((start, inner.unwrap_or(Cow::Borrowed(cell))))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quoted_cells_hold_anything() {
        let text = "a, \"b, \"\"c\"\"\n\" ,5\" wide,\"\"\r\n\n é , x\n";
        let all = |record| cells(record, ',').map(|(k, c)| (k, c.into_owned())).collect::<Vec<_>>();
        let found: Vec<_> =
            records(text, ',').map(|(line, record, ends)| (line, all(record), ends)).collect();
        let cell = |k: usize, text: &str| (k, text.to_owned());
        assert_eq!(
            found,
            [
                (1, vec![cell(1, "a"), cell(4, "b, \"c\"\n"), cell(17, "5\" wide"), cell(25, "")], true),
                (4, vec![cell(2, "é"), cell(6, "x")], true),
            ]
        );
        assert_eq!(
            records("a,\"b\nc", ',').map(|(line, _, ends)| (line, ends)).collect::<Vec<_>>(),
            [(1, false)]
        );
    }
}
