//! Spellings of other languages, and what to write instead: one table, which is consulted where the grammar fails.
//!
//! A pattern is a row of marks, words and holes. A hole keeps the text of the user, so the hint holds the user's own
//! names. A spelling is reported only if the text reads on once it is replaced.

mod forms;

use super::builder::Builder;
use super::failure::{Fault, failure};
use super::{lexeme, quantity};
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::keywords::is_temporal;
use crate::syntax::source::Span;
use forms::{Both, CONDITION, FORMS, INSIDE, In, OPERATORS, Properties, Row, Scenario, WORDS};
use std::fmt::Write as _;
use std::ops::Range;

/// Bytes of its line before a fault, and bytes behind it, in which a spelling is looked for.
const BEFORE: usize = 1 << 8;
const REACH: usize = 1 << 10;
/// Bytes of a hole that is quoted in a title.
const SHORT: usize = 8;

/// The replacement of a name or function that belongs to another language.
pub(crate) fn word(name: &str, arguments: &str) -> Option<String> {
    let (_, ours) = WORDS.iter().find(|(foreign, _)| *foreign == name)?;
    Some(format!("write `{}`", ours.replace("$a", arguments)))
}

/// The texts of the holes of a pattern, by their names, and the place of the error.
#[derive(Default)]
struct Found<'p> {
    holes: Vec<(&'p str, Range<usize>)>,
    here: usize,
}

/// The tokens of a text.
struct Tokens<'t> {
    text: &'t str,
    spans: Vec<Range<usize>>,
    /// Written behind a time without a unit.
    unit: &'static str,
}

impl<'t> Tokens<'t> {
    fn of(text: &'t str, from: usize, end: usize) -> Self {
        let (mut spans, mut at) = (Vec::new(), from);
        while at < end {
            let rest = &text[at..];
            if let Some(length) = lexeme::trivia(rest) {
                at += length;
                continue;
            }
            let length = lexeme::first(rest).len().max(1);
            spans.push(at..at + length);
            at += length;
        }
        Self { text, spans, unit: "" }
    }

    fn get(&self, at: usize) -> &'t str {
        self.spans.get(at).map_or("", |span| &self.text[span.clone()])
    }

    fn is_name(&self, at: usize) -> bool {
        self.get(at).starts_with(lexeme::starts_name)
    }

    fn is_number(&self, at: usize) -> bool {
        self.get(at).starts_with(|c: char| c.is_ascii_digit())
    }

    /// The bytes of some tokens.
    fn bytes(&self, tokens: &Range<usize>) -> Range<usize> {
        if tokens.is_empty() {
            let at = self.spans.get(tokens.start).map_or(self.text.len(), |span| span.start);
            return at..at;
        }
        self.spans[tokens.start].start..self.spans[tokens.end - 1].end
    }

    fn starts_line(&self, at: usize) -> bool {
        let before = at.checked_sub(1).map_or(0, |before| self.spans[before].end);
        self.text[before..self.spans.get(at).map_or(before, |span| span.start)].contains('\n')
    }

    /// Where a hole that starts at a token may end. The last one of a pattern goes as far as it can.
    fn ends(&self, hole: &str, at: usize, is_last: bool) -> Vec<usize> {
        let one = |fits: bool| if fits { vec![at + 1] } else { Vec::new() };
        let token = self.get(at);
        match hole.as_bytes().first() {
            Some(b'n') => one(self.is_number(at)),
            Some(b'q') => one(token.starts_with('"')),
            Some(b'r') => one(matches!(token, ">=" | ">" | "<=" | "<")),
            Some(b'o') => one(is_temporal(token)),
            Some(b'y') => one(matches!(token, "int" | "double" | "float" | "real" | "bool")),
            Some(b't') if self.is_number(at) => {
                // A name that is set or has a member is no unit, as in the grammar.
                let is_free = !matches!(self.get(at + 2), "=" | ".");
                vec![at + 1 + usize::from(is_free && quantity::UNITS.contains(&self.get(at + 1)))]
            }
            Some(b'w') if self.is_name(at) => {
                let mut end = at + 1;
                while self.get(end) == "." && self.is_name(end + 1) {
                    end += 2;
                }
                vec![end]
            }
            Some(b'p') => {
                let is_weight = |at: &usize| self.is_number(*at) || self.is_name(*at) || self.get(*at) == "/";
                let end = (at..self.spans.len()).take_while(is_weight).count() + at;
                if end > at { vec![end] } else { Vec::new() }
            }
            Some(b'l') => {
                let line = (at..self.spans.len()).take_while(|at| !self.starts_line(*at)).count();
                vec![at + line]
            }
            Some(b'e' | b'c' | b'u') => self.even(at, is_last),
            _ => Vec::new(),
        }
    }

    /// The ends of texts with even brackets.
    fn even(&self, start: usize, is_last: bool) -> Vec<usize> {
        let (mut ends, mut open) = (Vec::new(), 0_usize);
        for at in start..self.spans.len() {
            match self.get(at) {
                ";" if open == 0 => break,
                _ if open == 0 && is_last && at > start && self.starts_line(at) => break,
                "(" | "[" | "{" => open += 1,
                ")" | "]" | "}" if open == 0 => break,
                ")" | "]" | "}" => open -= 1,
                _ => {}
            }
            if open == 0 {
                ends.push(at + 1);
            }
        }
        if is_last { ends.pop().into_iter().collect() } else { ends }
    }

    /// Where a pattern that starts at a token ends.
    fn matched<'p>(&self, pattern: &[&'p str], at: usize, found: &mut Found<'p>) -> Option<usize> {
        let Some((piece, rest)) = pattern.split_first() else { return Some(at) };
        if *piece == "@" {
            found.here = at;
            return self.matched(rest, at, found);
        }
        let Some(hole) = piece.strip_prefix('$') else {
            return if self.get(at) == *piece { self.matched(rest, at + 1, found) } else { None };
        };
        for end in self.ends(hole, at, rest.is_empty()) {
            let before = found.holes.len();
            found.holes.push((hole, at..end));
            if let Some(end) = self.matched(rest, end, found) {
                return Some(end);
            }
            found.holes.truncate(before);
        }
        None
    }

    /// A replacement with the texts of the holes.
    fn filled(&self, template: &str, found: &Found<'_>, file: In) -> String {
        let mut parts = template.split('$');
        let mut filled = parts.next().unwrap_or("").to_owned();
        for part in parts {
            let length = part.find(|c: char| !c.is_ascii_alphanumeric()).unwrap_or(part.len());
            let (hole, rest) = part.split_at(length);
            if let Some((_, tokens)) = found.holes.iter().find(|(name, _)| *name == hole) {
                let text = &self.text[self.bytes(tokens)];
                match hole.as_bytes()[0] {
                    b'e' | b'u' => filled.push_str(&inside(text, self.unit, file, &[])),
                    b'c' => filled.push_str(&inside(text, self.unit, file, CONDITION)),
                    b'q' => filled.push_str(text.trim_matches('"')),
                    b't' if tokens.len() == 1 => drop(write!(filled, "{text}{}", self.unit)),
                    _ => filled.push_str(text),
                }
            }
            filled.push_str(rest);
        }
        filled
    }
}

/// A hole in which spellings are replaced, too.
fn inside(text: &str, unit: &'static str, file: In, more: &[Row]) -> String {
    let tokens = Tokens { unit, ..Tokens::of(text, 0, text.len()) };
    let (mut written, mut copied, mut at) = (String::new(), 0, 0);
    while at < tokens.spans.len() {
        let hit = INSIDE.iter().chain(more).filter(|row| row.0 == Both || row.0 == file).find_map(|row| {
            let mut found = Found::default();
            let end = tokens.matched(&pieces(row.2), at, &mut found)?;
            Some((end, tokens.filled(row.3, &found, file)))
        });
        let Some((end, ours)) = hit else {
            at += 1;
            continue;
        };
        let bytes = tokens.bytes(&(at..end));
        written.push_str(&text[copied..bytes.start]);
        written.push_str(&ours);
        (copied, at) = (bytes.end, end);
    }
    written.push_str(&text[copied..]);
    written
}

fn pieces(pattern: &str) -> Vec<&str> {
    pattern.split(' ').collect()
}

impl Builder<'_> {
    /// A form of another language at a fault.
    pub(super) fn slip_of_form(&self, fault: &Fault<'_>) -> Option<Diagnostic> {
        let hit = self.foreign(fault, FORMS)?;
        let title = match hit.row.1 {
            language if !language.contains(' ') => format!("`{}` is {language} syntax", hit.shown),
            title => title.replace("{}", &hit.shown),
        };
        let error = error!(E0130, hit.place, "{title}");
        Some(error.hint(match hit.ours.strip_prefix(' ') {
            Some(advice) => advice.to_owned(),
            None => format!("write `{}`", hit.ours),
        }))
    }

    /// An operator of another language at a fault.
    pub(super) fn slip_of_operator(&self, fault: &Fault<'_>) -> Option<Diagnostic> {
        let hit = self.foreign(fault, OPERATORS)?;
        let title = format!("`{}` is not an operator here", hit.shown);
        Some(error!(E0114, hit.place, "{title}"; hint: "write `{}`", hit.ours))
    }

    /// The first spelling of a table that a fault lies in, and with which replaced the text reads on.
    fn foreign(&self, fault: &Fault<'_>, rows: &'static [Row]) -> Option<Hit> {
        let file = if self.in_properties { Properties } else { Scenario };
        let text = self.written();
        // A brace that was put in may stand behind the last byte.
        let line = text[..fault.at.min(text.len())].rfind('\n').map_or(0, |end| end + 1);
        let from = text.floor_char_boundary(fault.at.saturating_sub(BEFORE)).max(line);
        let end = text.floor_char_boundary(fault.at.saturating_add(REACH));
        let tokens = Tokens { unit: self.unit, ..Tokens::of(text, from, end) };
        let behind = tokens.spans.partition_point(|span| span.start <= fault.at);
        let are_operators = rows.len() == OPERATORS.len();
        let rows = || rows.iter().filter(|row| row.0 == Both || row.0 == file);
        (0..behind).flat_map(|at| rows().map(move |row| (at, row))).find_map(|(at, row)| {
            let first = row.2.split(' ').next()?;
            // A percent sign within a line is a unit.
            if !first.starts_with('$') && first != tokens.get(at) || first == "%" && at > 0 {
                return None;
            }
            let mut found = Found { here: at, holes: Vec::new() };
            let pattern = pieces(row.2);
            let end = tokens.matched(&pattern, at, &mut found)?;
            // A fault lies in what could not be read, or right behind it.
            let next = tokens.spans.get(end).map_or(text.len(), |span| span.start);
            let ours = tokens.filled(row.3, &found, file);
            let bytes = tokens.bytes(&(at..end));
            // Only a prefix, or the first half of a mark, is read as something else.
            let is_operator = are_operators && !matches!(row.3, "!" | "^");
            let is_late = fault.at > if is_operator { bytes.start } else { next };
            if is_late || !self.reads_on(fault, bytes.clone(), &ours) {
                return None;
            }
            let (place, shown) = self.shown(&tokens, &pattern, &found, end);
            Some(Hit { row, place, shown, ours })
        })
    }

    /// Whether the text can be read beyond a part once that is another. Advice and templates with gaps are not read.
    fn reads_on(&self, fault: &Fault<'_>, part: Range<usize>, ours: &str) -> bool {
        if ours.contains('…') || ours.starts_with(' ') {
            return true;
        }
        let written = self.written();
        let before = format!("{}{ours}", &written[..part.start]);
        let text = format!("{before}{}", &written[part.end..]);
        // What a comment leaves is whole: `n % 2)` is none.
        let is_fine = |at: usize| at > before.len() && !ours.starts_with("//");
        let is_empty = lexeme::all_trivia(&text) == text.len();
        is_empty || failure(fault.rule, &text).is_none_or(|(at, _)| is_fine(at))
    }

    /// The place of a spelling, and how it is quoted: up to its first long hole, and the marks at its end.
    fn shown(&self, tokens: &Tokens<'_>, pattern: &[&str], found: &Found<'_>, end: usize) -> (Span, String) {
        let is_long = |(hole, part): &&(&str, Range<usize>)| {
            hole.starts_with(['e', 'c', 'u', 'l'])
                && part.start >= found.here
                && tokens.bytes(part).len() > SHORT
        };
        let head = found.holes.iter().find(is_long).map_or(end, |(_, part)| part.start);
        let bytes = tokens.bytes(&(found.here..head));
        let text = tokens.text;
        let mut shown: String = text[bytes.clone()].split_whitespace().collect::<Vec<_>>().join(" ");
        if shown.ends_with(')') && !shown.contains('(') {
            shown.pop();
        }
        let marks = pattern.iter().rev().take_while(|piece| !piece.starts_with('$')).count();
        if marks > 0 && head < end && !pattern.contains(&"@") {
            let _ = write!(shown, " … {}", &text[tokens.bytes(&(end - marks..end))]);
        }
        (self.at(bytes), shown)
    }
}

/// A spelling that was found.
struct Hit {
    row: &'static Row,
    place: Span,
    /// The spelling, for the title.
    shown: String,
    /// The replacement.
    ours: String,
}

#[cfg(test)]
mod tests;
