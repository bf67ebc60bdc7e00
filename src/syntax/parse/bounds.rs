//! Slips around operators that look ahead in time, and their bounds.

use super::builder::Builder;
use super::failure::Fault;
use super::grammar::{Grammar, Rule};
use super::{lexeme, quantity};
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::keywords::{Declares, is_temporal, keyword};
use pest::Parser;

impl Builder<'_> {
    /// `let late = F<=2 s (…)` in a scenario, where `F` is a name like any other.
    pub(super) fn slip_of_time(&self, fault: &Fault<'_>) -> Option<Diagnostic> {
        if !fault.after_value() || self.in_properties {
            return None;
        }
        let line = self.text[..fault.at].rsplit('\n').next()?;
        let start = fault.at - line.len();
        let operators = ["<=", "≤", "["].iter().filter_map(|mark| {
            let at = line.rfind(mark)?;
            let before = line[..at].trim_end();
            let letter =
                before.chars().next_back().filter(|letter| is_temporal(letter.encode_utf8(&mut [0; 4])))?;
            let name = &before[..before.len() - letter.len_utf8()];
            let alone = !name.ends_with(lexeme::continues_name);
            (alone && is_bound(&line[at..], fault.found)).then_some((start + name.len(), letter))
        });
        let (at, letter) =
            operators.max().filter(|(_, letter)| !self.names_a_value(letter.encode_utf8(&mut [0; 4])))?;
        Some(
            error!(E0101, self.at(at..at + letter.len_utf8()), "the temporal operator `{letter}` is not allowed in a scenario";
                hint: "move this formula to a property file (`.bltl`)"),
        )
    }

    /// Whether a word is the name of a value in this text.
    fn names_a_value(&self, word: &str) -> bool {
        let before = self.declared().get(word).and_then(|before| keyword(before));
        before.is_some_and(|before| before.declares == Declares::Value)
    }

    /// Whether a word is the name of a number in this text.
    pub(super) fn names_a_number(&self, word: &str) -> bool {
        matches!(self.declared().get(word), Some(&("const" | "let" | "param")))
    }

    /// `F<=0 s == 3`: the bound took the name for its unit; and `F<5 s p`.
    pub(super) fn slip_of_bound(&self, fault: &Fault<'_>) -> Option<Diagnostic> {
        let comparison = matches!(fault.found, "==" | "!=" | "<" | "<=" | ">" | ">=" | "≤" | "≥" | "≠");
        let (unit_at, word) = lexeme::word_before(&self.text, fault.at)?;
        let place = self.place(fault.at, fault.found);
        if comparison && is_temporal(word) {
            return Some(error!(E0119, place, "the bound of `{word}` must be written with `<=`";
                    hint: "write `{word}<=` and a time, or an interval: `{word}[1 s, 5 s]`"));
        }
        if !(comparison || matches!(fault.found, "+" | "*" | "/" | "^" | "-" | "in"))
            || !quantity::UNITS.contains(&word)
        {
            return None;
        }
        let (number_at, number) = lexeme::word_before(&self.text, unit_at)?;
        let before = self.text[..number_at].trim_end();
        let mark = ["<=", "≤"].into_iter().find(|mark| before.ends_with(mark))?;
        if !number.starts_with(|c: char| c.is_ascii_digit()) {
            return None;
        }
        let unit = self.at(unit_at..unit_at + word.len());
        let operator =
            lexeme::word_before(&self.text, before.len() - mark.len()).map_or("", |(_, word)| word);
        let formula = format!("({word} {} …)", fault.found);
        let hint = format!("write parentheses: `{operator}{mark}{number}{} {formula}`", self.unit);
        Some(
            error!(E0115, place, "expected a formula, found {}", self.quote(fault.found))
                .related(unit, "read as the unit of the bound")
                .hint(hint),
        )
    }
}

/// Whether a text from `<=` or `[` on is the bound of an operator, up to what was found behind it: a scenario takes
/// `F[1 s`, but no comma.
fn is_bound(text: &str, found: &str) -> bool {
    let (rule, text) = match text.strip_prefix('[') {
        Some(first) if found == "," => (Rule::expr, first.trim()),
        Some(_) => return false,
        None => (Rule::bound, text.trim_end()),
    };
    let whole = |mut taken: pest::iterators::Pairs<'_, Rule>| {
        taken.next().is_some_and(|pair| pair.as_span().end() == text.len())
    };
    Grammar::parse(rule, text).is_ok_and(whole)
}
