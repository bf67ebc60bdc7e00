//! Slips that are known by what a small change makes of the text: with a bracket closed, or a word spelt right, what
//! could not be read before can be.

use super::builder::Builder;
use super::code;
use super::fault::{Fault, failure, starts_declaration};
use super::grammar::Rule;
use super::{lexeme, nesting, nouns, quantity};
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::source::Span;
use std::ops::Range;

/// Bytes behind a fault that are looked at.
const BEHIND: usize = 1 << 10;
/// Most brackets that are closed, and most words that are spelt anew, for one fault.
const MOST_BRACKETS: usize = 4;
const MOST_WORDS: usize = 4;

/// Keywords in whose place the grammar takes a name, so that it stumbles only over what follows.
const OPENERS: [&str; 9] =
    ["circle", "rect", "polygon", "near", "uniform", "wait", "choose", "from", "count"];
/// Common spellings of shapes, and the shape.
const SPOKEN: [(&str, &str); 3] = [("rectangle", "rect"), ("disc", "circle"), ("disk", "circle")];

impl Builder<'_> {
    /// `at = (1, 2 velocity = …`, `speed = normal(1 m/s, 0.1 m/s }`: a bracket that nothing closes, and with which closed
    /// the text goes on.
    pub(super) fn slip_of_bracket(&self, fault: &Fault<'_>) -> Option<Diagnostic> {
        let mut open = nesting::open_brackets(self.text, fault.from, fault.at);
        let inner = open.iter().rposition(|(_, bracket)| *bracket == '{').map_or(0, |brace| brace + 1);
        open.drain(..inner);
        let &(at, bracket) = open.last()?;
        // `(2 m =`: the sign stands where the bracket was closed; of a name that is set nobody knows that it is a unit.
        let sets = self.text[fault.at + fault.found.len()..].trim_start().starts_with('=');
        let is_replaced = quantity::UNITS.contains(&fault.found) && sets;
        if is_replaced || self.is_closed_behind(fault.at, bracket) {
            return None;
        }
        let mut closed = String::new();
        for count in 1..=open.len().min(MOST_BRACKETS) {
            closed.push(nesting::partner(open[open.len() - count].1));
            if self.read_again(fault, fault.at..fault.at, &closed) == Again::No {
                continue;
            }
            let mark = |at: usize| Span::new(self.source.id, at, at + 1);
            let close = nesting::partner(bracket);
            let error = Diagnostic::error(code::UNCLOSED, mark(at), format!("`{bracket}` is not closed"))
                .related(self.place(fault.at, fault.found), format!("expected `{close}` before this text"));
            let others = open.iter().rev().skip(1).take(count - 1);
            return Some(others.fold(error, |error, (at, _)| error.related(mark(*at), "also not closed")));
        }
        None
    }

    /// Whether a bracket that is open at a byte is closed behind it, in the same declaration, or farther behind than
    /// anybody looks.
    pub(super) fn is_closed_behind(&self, at: usize, bracket: char) -> bool {
        let end = self.text.floor_char_boundary(at.saturating_add(BEHIND));
        let (behind, is_whole) = own_part(&self.text[at..end]);
        match nesting::first_closing(behind) {
            Some(closing) => closing == nesting::partner(bracket),
            None => !is_whole && end < self.text.len(),
        }
    }

    /// Whether what was found is a keyword, which stands in no bracket, and nothing closes the one that is open.
    pub(super) fn ends_bracket(&self, fault: &Fault<'_>, bracket: char) -> bool {
        // Some start a value, others are functions, too.
        let rest = self.text[fault.at + fault.found.len()..].trim_start();
        let is_value = matches!(fault.found, "forall" | "exists") || rest.starts_with('(');
        nouns::is_keyword(fault.found) && !is_value && !self.is_closed_behind(fault.at, bracket)
    }

    /// `obstacle pillar: circel (4, 4) radius 1 m`: a keyword that reads as a name until something follows that follows
    /// no name.
    pub(super) fn slip_of_opener(&self, fault: &Fault<'_>) -> Option<Diagnostic> {
        let mut words = Vec::new();
        let mut at = fault.from.max(self.source.line_start(fault.at as u32) as usize);
        while at < fault.at {
            if let Some(length) = lexeme::trivia(&self.text[at..]) {
                at += length;
                continue;
            }
            let token = lexeme::first(&self.text[at..]);
            words.push((at, token));
            at += token.len().max(1);
        }
        let near = words.into_iter().rev().filter_map(|(at, word)| Some((at, word, opener(word)?)));
        let (at, word, meant) = near.take(MOST_WORDS).find(|(at, word, meant)| {
            match self.read_again(fault, *at..at + word.len(), meant) {
                Again::Whole => true,
                Again::Further => !self.is_declared(word),
                Again::No => false,
            }
        })?;
        let title = format!("expected `{meant}`, found `{word}`");
        let error = Diagnostic::error(code::UNEXPECTED, self.place(at, word), title);
        Some(error.hint(format!("did you mean `{meant}`?")))
    }

    /// `(1 2)`, `region hall rect …`: the only word or mark with which, put before what was found on the same line, the
    /// text goes on.
    pub(super) fn missing(&self, fault: &Fault<'_>) -> Option<&'static str> {
        let before = &self.text[fault.from..fault.at];
        let lies_behind = before.trim_end_matches([' ', '\t']);
        if fault.found.is_empty() || lies_behind.is_empty() || lies_behind.ends_with('\n') {
            return None;
        }
        // Between two values `in` is an operator as any other, after a field an arrow is one of many ways to go on, and a
        // bracket that is opened is closed somewhere.
        let ends = [Rule::field_end, Rule::state_item_end].iter().any(|rule| fault.expected.contains(rule));
        let wanted = fault.expected.iter().filter(|&&rule| match rule {
            Rule::kw_in => !fault.after_value(),
            Rule::t_arrow => !ends,
            _ => true,
        });
        let mut wanted: Vec<_> = wanted.filter_map(|&rule| nouns::token(rule)).collect();
        wanted.retain(|token| !matches!(*token, "(" | "[" | "{"));
        wanted.sort_unstable();
        wanted.dedup();
        let again = |token: &&str| self.read_again(fault, fault.at..fault.at, &format!("{token} "));
        let mut with = wanted.into_iter().filter(|token| again(token) == Again::Whole);
        with.next().filter(|_| with.next().is_none())
    }

    /// How far the text goes on once a part of it before the fault is another.
    fn read_again(&self, fault: &Fault<'_>, part: Range<usize>, by: &str) -> Again {
        let end = self.text.floor_char_boundary(fault.at.saturating_add(BEHIND));
        let before = &self.text[fault.from..part.start];
        // A word that the fault lies in is read as it is.
        let Some(between) = self.text.get(part.end..fault.at) else { return Again::No };
        let found = before.len() + by.len() + between.len();
        let text = format!("{before}{by}{between}{}", &self.text[fault.at..end]);
        match failure(fault.rule, &text, 0) {
            None => Again::Whole,
            Some((at, _)) if at > found => Again::Further,
            Some(_) => Again::No,
        }
    }
}

/// A text up to the line that starts the next declaration, and whether there is one; less a comment that was cut.
fn own_part(text: &str) -> (&str, bool) {
    let (mut at, mut starts_line) = (0, false);
    while at < text.len() {
        let rest = &text[at..];
        if let Some(length) = lexeme::trivia(rest) {
            starts_line |= rest[..length].contains('\n');
            at += length;
            continue;
        }
        let token = lexeme::first(rest);
        let is_next = starts_line && starts_declaration(token);
        if is_next || rest.starts_with("/*") {
            return (&text[..at], is_next);
        }
        starts_line = false;
        at += token.len().max(1);
    }
    (text, false)
}

/// How far a text goes on that was changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Again {
    /// No further.
    No,
    /// Beyond what could not be read before.
    Further,
    /// To the end of the declaration.
    Whole,
}

/// The keyword that a word probably is.
fn opener(word: &str) -> Option<&'static str> {
    if word.len() < 3 || !word.starts_with(lexeme::starts_name) || OPENERS.contains(&word) {
        return None;
    }
    let spoken = SPOKEN.iter().find(|(spoken, _)| *spoken == word);
    spoken.map(|(_, meant)| *meant).or_else(|| nouns::nearest(word, OPENERS.into_iter()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::syntax::parse::parse_properties;
    use crate::syntax::source::{Source, SourceId};

    #[test]
    fn a_bracket_is_accused_only_where_all_behind_it_was_seen() {
        let codes = |behind: &str| {
            let text = format!("check P(F<=1 s (p within {behind}");
            let (_, said) = parse_properties(&Source::new(SourceId(0), "a.bltl", text.as_str()));
            said.into_iter().map(|one| one.code).collect::<Vec<_>>()
        };
        let sum = "1 + ".repeat(BEHIND);
        assert_eq!(codes("2 >= 0.5"), [code::UNCLOSED]);
        assert_eq!(codes("2)) >= 0.5"), [code::UNEXPECTED]);
        assert_eq!(codes(&format!("{sum}2)) >= 0.5")), [code::UNEXPECTED]);
        assert_eq!(codes(&format!("2\nlet a = {sum}2)) >= 0.5"))[0], code::UNCLOSED);
        // What a comment says declares nothing.
        assert_eq!(codes("/* 1\nlet it be */ 2)) >= 0.5"), [code::UNEXPECTED]);
        assert_eq!(codes("2 /* 1\n */ let a = (2) >= 0.5")[0], code::UNCLOSED);
    }
}
