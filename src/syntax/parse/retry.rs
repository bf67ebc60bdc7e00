//! Slips that are known by what a small change makes of the text: with a bracket closed, or a word spelt right, what
//! could not be read before can be.

use super::builder::Builder;
use super::failure::{Fault, failure};
use super::grammar::Rule;
use super::{layout, lexeme, nesting, nouns, quantity};
use crate::syntax::diagnostic::Diagnostic;
use std::ops::Range;

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
        let open = nesting::open_brackets(&self.text, fault.at);
        let &(at, bracket) = open.last()?;
        // `(2 m =`: the sign stands where the bracket was closed; of a name that is set nobody knows that it is a unit.
        let sets = self.behind(fault).starts_with('=');
        let is_replaced = quantity::UNITS.contains(&fault.found) && sets;
        if is_replaced || !self.is_unmatched(at) {
            return None;
        }
        let mut closed = String::new();
        for count in 1..=open.len().min(MOST_BRACKETS) {
            closed.push(nesting::partner(open[open.len() - count].1));
            // The rest may be an item of its own.
            let ends = || failure(fault.rule, &format!("{}{closed}", &self.text[..fault.at])).is_none();
            if self.read_again(fault, fault.at..fault.at, &closed) == Again::No && !ends() {
                continue;
            }
            let mark = |at: usize| self.at(at..at + 1);
            let close = nesting::partner(bracket);
            let error = error!(E0102, mark(at), "`{bracket}` is not closed")
                .related(self.place(fault.at, fault.found), format!("expected `{close}` before this text"));
            let others = open.iter().rev().skip(1).take(count - 1);
            return Some(others.fold(error, |error, (at, _)| error.related(mark(*at), "also not closed")));
        }
        None
    }

    /// Whether what was found is a keyword, which stands in no bracket.
    pub(super) fn ends_bracket(&self, fault: &Fault<'_>) -> bool {
        // Some start a value, others are functions, too.
        let is_value = matches!(fault.found, "forall" | "exists") || self.behind(fault).starts_with('(');
        nouns::is_keyword(fault.found) && !is_value
    }

    /// `obstacle pillar: circel (4, 4) radius 1 m`: a keyword that reads as a name until something follows that follows
    /// no name.
    pub(super) fn slip_of_opener(&self, fault: &Fault<'_>) -> Option<Diagnostic> {
        let line = self.text[..fault.at].rfind('\n').map_or(0, |end| end + 1);
        let words = layout::tokens(&self.text[line..fault.at]);
        let near =
            words.iter().rev().filter_map(|word| Some((line + word.at, word.text, opener(word.text)?)));
        let (at, word, meant) = near.take(MOST_WORDS).find(|(at, word, meant)| {
            match self.read_again(fault, *at..at + word.len(), meant) {
                Again::Whole => true,
                Again::Further => !self.declared().contains_key(word),
                Again::No => false,
            }
        })?;
        let title = format!("expected `{meant}`, found `{word}`");
        let error = error!(E0101, self.at(at..at + word.len()), "{title}");
        Some(error.hint(format!("did you mean `{meant}`?")))
    }

    /// `(1 2)`, `region hall rect …`: the only word or mark with which, put before what was found on the same line, the
    /// text goes on.
    pub(super) fn missing(&self, fault: &Fault<'_>) -> Option<&'static str> {
        let lies_behind = self.text[..fault.at].trim_end_matches(' ');
        if fault.at >= self.text.len() || lies_behind.is_empty() || lies_behind.ends_with('\n') {
            return None;
        }
        // Between two values `in` is an operator as any other, after a field an arrow is one of many ways to go on, and a
        // bracket that is opened is closed somewhere.
        let ends = [Rule::line_of_fields, Rule::line_of_state].contains(&fault.rule);
        let wanted = fault.expected.iter().filter(|&&rule| match rule {
            Rule::kw_in => !fault.after_value(),
            Rule::t_arrow => !ends,
            _ => true,
        });
        let mut wanted: Vec<_> = wanted.filter_map(|&rule| nouns::token(rule)).collect();
        wanted.retain(|token| !matches!(*token, "(" | "["));
        wanted.sort_unstable();
        wanted.dedup();
        let again = |token: &&str| self.read_again(fault, fault.at..fault.at, &format!("{token} "));
        let mut with = wanted.into_iter().filter(|token| again(token) == Again::Whole);
        with.next().filter(|_| with.next().is_none())
    }

    /// How far the text goes on once a part of it before the fault is another.
    fn read_again(&self, fault: &Fault<'_>, part: Range<usize>, by: &str) -> Again {
        let before = &self.text[..part.start];
        // A word that the fault lies in is read as it is.
        let Some(between) = self.text.get(part.end..fault.at) else { return Again::No };
        let found = before.len() + by.len() + between.len();
        let text = format!("{before}{by}{between}{}", &self.text[fault.at..]);
        match failure(fault.rule, &text) {
            None => Again::Whole,
            Some((at, _)) if at > found => Again::Further,
            Some(_) => Again::No,
        }
    }
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
    use crate::syntax::codes::Code;
    use crate::syntax::parse::parse_properties;
    use crate::syntax::source::{Source, SourceId};

    #[test]
    fn a_bracket_is_accused_where_nothing_closes_it() {
        let codes = |behind: &str| {
            let text = format!("check P(F<=1 s (p within {behind}");
            let (_, said) = parse_properties(&Source::new(SourceId(0), "a.bltl", text.as_str()));
            said.into_iter().map(|one| one.code).collect::<Vec<_>>()
        };
        let sum = "1 + ".repeat(1000);
        assert_eq!(codes("2 >= 0.5"), [Code::E0102]);
        assert_eq!(codes("2)) >= 0.5"), [Code::E0101]);
        assert_eq!(codes(&format!("{sum}2)) >= 0.5")), [Code::E0101]);
        // A declaration says nothing in a comment.
        assert_eq!(codes("/* 1\nlet it be */ 2)) >= 0.5"), [Code::E0101]);
    }
}
