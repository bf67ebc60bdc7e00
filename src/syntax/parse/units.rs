//! Slips around units.

use super::builder::Builder;
use super::failure::Fault;
use super::grammar::Rule;
use super::{lexeme, nesting, nouns, quantity};
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::keywords::is_temporal;
use std::ops::Range;

/// Words that other languages, or people, have before the initial value of a variable.
const INITIAL: [&str; 4] = ["as", "init", "initially", "is"];

impl Builder<'_> {
    /// `F<=2 sec p`: the bound ended before its unit, which reads as a name.
    pub(super) fn slip_of_unit_in_bound(&self, fault: &Fault<'_>) -> Option<Diagnostic> {
        let (at, word) = lexeme::word_before(&self.text, fault.at).filter(|_| fault.after_value())?;
        let (number_at, number) = lexeme::word_before(&self.text, at)?;
        let before = self.text[..number_at].trim_end();
        let bounded = before.strip_suffix("<=").or_else(|| before.strip_suffix('≤'))?.trim_end();
        let (_, operator) = lexeme::word_before(bounded, bounded.len())?;
        let is_bound = matches!(operator, "min" | "max" | "sum" | "mean") || is_temporal(operator);
        let is_number = number.starts_with(|c: char| c.is_ascii_digit());
        // A name with its member is no unit.
        let is_fine = quantity::UNITS.contains(&word) || word.contains('.');
        if !is_bound || !is_number || is_fine || !self.in_properties || self.declared().contains_key(word) {
            return None;
        }
        let (unit, _) = quantity::time_meant(word)?;
        let error = error!(E0113, self.at(at..at + word.len()), "unknown unit `{word}`");
        Some(error.hint(format!("did you mean `{number} {unit}`?")))
    }

    /// `var n: 0 m .. 3 m = 0`: before the `=` the second unit reads as a name that is set.
    pub(super) fn slip_of_whole_range(&self, fault: &Fault<'_>) -> Option<Diagnostic> {
        let declared = &self.text[..fault.at];
        if fault.rule != Rule::line_of_process || lexeme::first(declared) != "var" {
            return None;
        }
        let (head, range) = declared.split_once(':')?;
        if !range.contains("..") || range.contains('=') {
            return None;
        }
        let end =
            if fault.found == "=" { fault.at } else { fault.at + fault.found.len() }.min(self.text.len());
        let (_, name) = lexeme::word_before(head, head.len())?;
        self.unit_in_range(name, fault.at - range.len()..end)
    }

    /// `var n: 0 .. 3 init 0`: a word for the sign, as other languages have it.
    pub(super) fn slip_of_initial(&self, fault: &Fault<'_>) -> Option<Diagnostic> {
        if fault.rule != Rule::line_of_process
            || lexeme::first(&self.text) != "var"
            || !fault.expected.contains(&Rule::t_assign)
            || !INITIAL.contains(&fault.found)
        {
            return None;
        }
        let value = lexeme::first(self.behind(fault));
        let is_value = value.starts_with(lexeme::continues_name);
        let title = format!("expected `=`, found `{}`", fault.found);
        let error = error!(E0101, self.place(fault.at, fault.found), "{title}");
        Some(error.hint(if is_value { format!("write `= {value}`") } else { "write `=`".to_owned() }))
    }

    /// That the range of a variable has a unit, said at the first one.
    pub(super) fn unit_in_range(&self, name: &str, range: Range<usize>) -> Option<Diagnostic> {
        let (mut at, mut after_number) = (range.start, false);
        while at < range.end {
            if let Some(length) = lexeme::trivia(&self.text[at..]) {
                at += length;
                continue;
            }
            let token = lexeme::first(&self.text[at..]);
            // No name follows a number. What is only like a unit may be another word for `=`.
            let is_unit = || {
                let meant = quantity::unit_meant(token);
                quantity::UNITS.contains(&token) || meant.is_some_and(|(_, is_sure)| is_sure)
            };
            if after_number && is_unit() {
                let place = self.at(at..at + token.len());
                let error = error!(E0113, place, "a range of whole numbers cannot have units");
                return Some(
                    error.hint(format!("remove the units, or declare a real number: `var {name}: real = …`")),
                );
            }
            after_number = token.starts_with(|c: char| c.is_ascii_digit());
            at += token.len().max(1);
        }
        None
    }

    /// `3 metres`
    pub(super) fn slip_of_unit(&self, fault: &Fault<'_>) -> Option<Diagnostic> {
        if !fault.found.starts_with(lexeme::starts_name) {
            return None;
        }
        if let Some(slip) = self.slip_of_factor(fault) {
            return Some(slip);
        }
        // `3 N m`
        let (unit_at, before_it) = lexeme::word_before(&self.text, fault.at)?;
        let factor = quantity::UNITS.contains(&fault.found) && quantity::UNITS.contains(&before_it);
        if factor
            && let Some((_, number)) = lexeme::word_before(&self.text, unit_at)
            && number.starts_with(|c: char| c.is_ascii_digit())
        {
            let place = self.place(fault.at, fault.found);
            let title = format!("unexpected `{}` after `{number} {before_it}`", fault.found);
            return Some(error!(E0113, place, "{title}";
                    hint: "write a product of units as `{number} {before_it}*{}`", fault.found));
        }
        let before = &self.text[..fault.at];
        let between = &before[before.trim_end().len()..];
        let (number_at, number) = lexeme::word_before(&self.text, fault.at)?;
        // In `m^2` it is a power.
        let is_power = self.text[..number_at].ends_with('^');
        if between.contains('\n') || is_power || !number.starts_with(|c: char| c.is_ascii_digit()) {
            return None;
        }
        let rest = self.behind(fault);
        if quantity::UNITS.contains(&fault.found) && rest.starts_with('=') && !rest.starts_with("==") {
            // A name that is set is no unit, so that the grammar stopped before it.
            let at = self.text.len() - rest.len();
            let said = error!(E0101, self.at(at..at + 1), "unexpected `=` after `{number} {}`", fault.found);
            return Some(said.hint("`=` sets a value, `==` compares"));
        }
        let unit = quantity::nearest_unit(fault.found);
        let near_keyword = fault.expected.iter().any(|&rule| {
            let words = nouns::keyword(rule).into_iter().chain(nouns::words(rule));
            nouns::nearest(fault.found, words).is_some()
        });
        // Some are functions, too.
        let is_keyword = fault.found == "in" || nouns::is_keyword(fault.found) && !rest.starts_with('(');
        if near_keyword
            || is_keyword
            || quantity::UNITS.contains(&fault.found)
            || unit.is_none() && !between.is_empty() && !fault.after_value()
        {
            return None;
        }
        let place = self.place(fault.at, fault.found);
        let argues = rest.starts_with('(') || rest.starts_with('=') && !rest.starts_with("==");
        if argues && fault.expected.contains(&Rule::t_comma) {
            let error = error!(E0101, place, "expected `,`, found `{}`", fault.found);
            return Some(error.hint(format!("write `{number}, {}`", fault.found)));
        }
        let hint = match unit {
            Some(unit) => format!("did you mean `{number} {unit}`?"),
            None => format!(
                "the units are {}; to multiply write `{number} * {}`",
                quantity::UNITS.join(", "),
                fault.found
            ),
        };
        Some(error!(E0113, place, "unknown unit `{}`", fault.found; hint: "{hint}"))
    }

    /// `5 kg/(m sec)`: a name among the units in parentheses.
    fn slip_of_factor(&self, fault: &Fault<'_>) -> Option<Diagnostic> {
        let (open, _) = nesting::open_bracket(&self.text, fault.at).filter(|(_, open)| *open == '(')?;
        let above = self.text[..open].strip_suffix('/')?;
        let (_, above) = lexeme::word_before(above, above.len())?;
        let factors = self.text.get(open + 1..fault.at + fault.found.len())?;
        let is_product =
            !factors.contains(|c: char| !lexeme::continues_name(c) && !matches!(c, ' ' | '\t' | '*'));
        if !quantity::UNITS.contains(&above) || !is_product {
            return None;
        }
        let mut words = factors.split(|c| !lexeme::continues_name(c));
        let word = words.find(|word| !word.is_empty() && !quantity::UNITS.contains(word))?;
        let (unit, _) = quantity::unit_meant(word).filter(|_| !self.declared().contains_key(word))?;
        let start = open + 1 + factors.find(word)?;
        let place = self.at(start..start + word.len());
        let error = error!(E0113, place, "unknown unit `{word}`");
        Some(error.hint(format!("did you mean `{unit}`?")))
    }
}
