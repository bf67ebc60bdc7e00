//! From an item that its rule does not take to one diagnostic at the exact place: where the rule failed.

use super::builder::Builder;
use super::failure::{Fault, failure, place_and_expected};
use super::grammar::Rule;
use super::{lexeme, nesting, nouns, quantity};
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::keywords::{self, Declares};

/// An item that its rule does not take.
pub(super) struct Refusal {
    pub(super) diagnostic: Diagnostic,
    /// Whether nothing in it tells which item was meant.
    pub(super) is_alone: bool,
}

impl Builder<'_> {
    /// The error of the item at hand.
    pub(super) fn refusal(&self, rule: Rule, error: pest::error::Error<Rule>) -> Refusal {
        let (at, mut expected) = place_and_expected(error);
        let mut at = at + lexeme::all_trivia(&self.text[at..]);
        if let Some(diagnostic) = self.slip_of_name() {
            return Refusal { diagnostic, is_alone: false };
        }
        if is_bare_word(&self.text, at, &expected) {
            // Any word could set something (`word = …`); this one sets nothing.
            (at, expected) = (0, vec![declaration(rule)]);
        }
        let found = match lexeme::first(&self.text[at..]) {
            "" => self.next_token().map_or("", |next| next.text),
            found => found,
        };
        let diagnostic = self.describe(&Fault { at, found, expected, rule });
        Refusal { is_alone: at == 0 && diagnostic.hint.is_none(), diagnostic }
    }

    fn describe(&self, fault: &Fault<'_>) -> Diagnostic {
        let slip = self.slip_of_line(fault).or_else(|| self.slip_of_bracket(fault));
        let slip = slip.or_else(|| self.slip_of_opener(fault));
        if let Some(slip) = slip.or_else(|| self.slip(fault)) {
            return slip;
        }
        let place = self.place(fault.at, fault.found);
        let mut diagnostic = if matches!(fault.found, ")" | "]") && self.is_unmatched(fault.at) {
            error!(E0103, place, "`{}` has no opening bracket", fault.found)
        } else {
            let expected = expected_nouns(&fault.expected);
            let title = if expected.is_empty() {
                format!("unexpected {}", self.quote(fault.found))
            } else {
                format!("expected {expected}, found {}", self.quote(fault.found))
            };
            error!(E0101, place, "{title}")
        };
        let closes = fault.expected.contains(&Rule::t_rparen) || fault.expected.contains(&Rule::t_rbracket);
        if (closes || nouns::starts_declaration(fault.found))
            && let Some((open, bracket)) = nesting::open_bracket(&self.text, fault.at)
        {
            let span = self.at(open..open + 1);
            if self.is_unmatched(open) && (fault.at >= self.text.len() || self.ends_bracket(fault)) {
                // What follows on a later line, or cannot stand in it, belongs to something else: the bracket is the error.
                let close = nesting::partner(bracket);
                return error!(E0102, span, "`{bracket}` is not closed").related(
                    self.place(fault.at, fault.found),
                    format!("expected `{close}` before this text"),
                );
            }
            if closes {
                diagnostic = diagnostic.related(span, format!("`{bracket}` is still open"));
            }
        }
        if let Some(hint) = self.remedy(fault) { diagnostic.hint(hint) } else { diagnostic }
    }

    fn remedy(&self, fault: &Fault<'_>) -> Option<String> {
        if let Some(hint) = self.belonging(fault) {
            return Some(hint);
        }
        let declares = |(_, word): (usize, &str)| {
            keywords::keyword(word).is_some_and(|keyword| keyword.declares != Declares::Nothing)
        };
        let is_name = || lexeme::word_before(&self.text, fault.at).is_some_and(declares);
        if self.in_properties && keywords::OPERATORS.contains(&fault.found) && is_name() {
            return Some("this is an operator in property files; choose another name".to_owned());
        }
        if let Some(word) = Self::meant(fault) {
            return Some(format!("did you mean `{word}`?"));
        }
        if let Some(missing) = self.missing(fault) {
            return Some(format!("write `{missing}` before {}", self.quote(fault.found)));
        }
        let wants_value = || expected_nouns(&fault.expected).starts_with("a number");
        if fault.found.is_empty() && wants_value() {
            let is_set = self.text.ends_with('=');
            let behind = if is_set { "the value is missing" } else { "the line ends in an operator" };
            return Some(format!("{behind}; an item ends with its line"));
        }
        None
    }

    /// `mass = 80 kg  radius = 0.3 m`: two items on one line.
    fn slip_of_line(&self, fault: &Fault<'_>) -> Option<Diagnostic> {
        let (before, rest) = self.text.split_at_checked(fault.at).filter(|_| fault.at > 0)?;
        // A name that is set behind a number is no unit.
        let is_unit = quantity::UNITS.contains(&fault.found) && !keywords::is_marked(fault.found);
        let is_first = keywords::keyword(fault.found).is_some_and(|keyword| !keyword.begins.is_empty());
        let begins = !is_unit && (sets_name(rest) || is_first);
        if !begins || failure(fault.rule, before).is_some() {
            return None;
        }
        let place = self.place(fault.at, fault.found);
        let title = format!("expected the end of the line, found {}", nouns::quote(fault.found));
        let items = if fault.rule == Rule::line_of_fields { "fields" } else { "items on one line" };
        Some(error!(E0101, place, "{title}"; hint: "write `;` between two {items}"))
    }

    /// Where the word belongs that was found where a declaration is wanted.
    fn belonging(&self, fault: &Fault<'_>) -> Option<String> {
        let is_first = fault.expected.iter().any(|rule| matches!(rule, Rule::item | Rule::property_item));
        if !is_first && !fault.ends() {
            return None;
        }
        let starts = |rule| nouns::words(rule).contains(&fault.found);
        let (own, others) = (Rule::item, Rule::property_item);
        let (own, others) = if self.in_properties { (others, own) } else { (own, others) };
        if starts(own) {
            return None;
        }
        if starts(others) {
            let other = if self.in_properties { "scenario (`.scn`)" } else { "property file (`.bltl`)" };
            return Some(format!("`{}` belongs in a {other}", fault.found));
        }
        let blocks = [
            (Rule::behaviour_item, "behaviour"),
            (Rule::process_item, "process"),
            (Rule::program_item, "program"),
            (Rule::scene_item, "scene"),
            (Rule::move_option, "list of moves"),
        ];
        let is_outside = matches!(fault.rule, Rule::line_of_scenario);
        let (_, block) = blocks.into_iter().find(|(rule, _)| is_outside && starts(*rule))?;
        Some(format!("`{}` belongs in a {block}", fault.found))
    }

    /// The keyword that was probably meant.
    fn meant(fault: &Fault<'_>) -> Option<&'static str> {
        if !fault.found.starts_with(lexeme::starts_name) {
            return None;
        }
        let expected = fault.expected.iter();
        let known: Vec<_> =
            expected.flat_map(|&rule| nouns::keyword(rule).into_iter().chain(nouns::words(rule))).collect();
        // What is a keyword itself is no other one misspelt; of two or three letters it may be.
        let is_keyword = fault.found.len() > 3 && nouns::is_keyword(fault.found);
        if is_keyword || known.contains(&fault.found) {
            return None;
        }
        nouns::nearest(fault.found, known.into_iter())
    }
}

/// Whether a text begins with a name that is set.
fn sets_name(text: &str) -> bool {
    let name = lexeme::first(text);
    let rest = text[name.len()..].trim_start();
    name.starts_with(lexeme::starts_name) && rest.starts_with('=') && !rest.starts_with("==")
}

/// Whether all that failed is that a first word is not followed by `=`.
fn is_bare_word(text: &str, at: usize, expected: &[Rule]) -> bool {
    let word = lexeme::first(text);
    word.starts_with(lexeme::starts_name)
        && !matches!(word, "horizon" | "step")
        && expected.iter().all(|&rule| rule == Rule::t_assign)
        && at == word.len() + lexeme::all_trivia(&text[word.len()..])
}

/// The rule of the item that a rule of a line takes.
fn declaration(rule: Rule) -> Rule {
    match rule {
        Rule::line_of_scenario => Rule::item,
        Rule::line_of_properties => Rule::property_item,
        Rule::line_of_state => Rule::state_item,
        Rule::line_of_updates => Rule::update,
        Rule::line_of_program => Rule::program_item,
        Rule::line_of_level => Rule::level_item,
        _ => Rule::field,
    }
}

fn expected_nouns(expected: &[Rule]) -> String {
    // A point or name may always go on with `.` or `[`: that helps nobody.
    let goes_on = expected.contains(&Rule::t_dot);
    let mut nouns: Vec<_> = expected
        .iter()
        .filter(|&&rule| !(goes_on && rule == Rule::t_lbracket))
        .filter_map(|&rule| nouns::noun(rule))
        .collect();
    nouns.sort();
    nouns.dedup();
    // After a value there is always more that could follow; an operator stands for all of it.
    if nouns.iter().any(|(_, noun)| noun == "an operator") {
        nouns.retain(|(rank, noun)| {
            (3..9).contains(rank) && !matches!(noun.as_str(), "`(`" | "`[`" | "a declaration")
        });
    }
    if nouns.len() > 1 {
        nouns.retain(|(_, noun)| noun != "a unit");
    }
    let mut flat: Vec<String> = Vec::new();
    for (_, noun) in &nouns {
        for part in noun.split(", ").flat_map(|part| part.split(" or ")) {
            if !flat.iter().any(|known| known == part) {
                flat.push(part.to_owned());
            }
        }
    }
    flat.truncate(8);
    nouns::list(&flat)
}
