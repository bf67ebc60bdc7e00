//! From a part of the text that no rule takes to one diagnostic at the exact place.
//!
//! The grammar wraps what it cannot take in `bad_…` rules. Such a part is parsed again with the strict rule of
//! its context, from its own start and from the start of the declaration before it (which may have
//! ended early); the farthest failure is the error.

use super::builder::{Builder, Pair};
use super::code;
use super::grammar::{Grammar, Rule};
use super::nesting::Braces;
use super::{lexeme, nesting, nouns};
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::source::Span;
use pest::Parser;
use pest::error::{ErrorVariant, InputLocation};

/// The place where the strict rule failed, with the rules expected there.
pub(super) struct Fault<'t> {
    /// Byte of the failure.
    pub(super) at: usize,
    /// The text found there; empty at the end of the file.
    pub(super) found: &'t str,
    /// The rules expected there.
    pub(super) expected: Vec<Rule>,
    /// Start of the declaration.
    pub(super) from: usize,
    /// The rule of the enclosing construct.
    pub(super) rule: Rule,
}

impl Fault<'_> {
    /// Whether an operator could have stood there: the place is after a value.
    pub(super) fn after_value(&self) -> bool {
        self.expected.iter().any(|&rule| nouns::is_operator(rule))
    }

    /// Whether a clause of a query could have stood there.
    pub(super) fn takes_clauses(&self) -> bool {
        self.expected.iter().any(|rule| matches!(rule, Rule::clause | Rule::under | Rule::kw_within))
    }
}

impl Builder<'_> {
    pub(super) fn fault<'t>(&self, strict: Rule, bad: &Pair<'_>, before: Option<&Pair<'_>>) -> Fault<'t>
    where
        Self: 't,
    {
        let start = bad.as_span().start();
        let mut fault = Fault { at: start, found: "", expected: Vec::new(), from: start, rule: strict };
        let starts = before.map(|pair| pair.as_span().start()).into_iter().chain([start]);
        for from in starts {
            if let Some((mut at, mut expected)) = failure(strict, self.text, from) {
                if from == start && is_bare_word(self.text, start, at, &expected) {
                    // Any word could set something (`word = …`); this one sets nothing.
                    at = start;
                    expected = vec![declaration(strict)];
                }
                if at > fault.at {
                    fault = Fault { at, expected, from, ..fault };
                } else if at == fault.at {
                    if fault.expected.is_empty() {
                        fault.from = from;
                    }
                    fault.expected.extend(expected);
                }
            }
        }
        fault
    }

    /// The place of a token.
    pub(super) fn place(&self, at: usize, found: &str) -> Span {
        if found.is_empty() {
            // At the end of the text: right after its last token.
            let end = self.text.trim_end().len();
            let end = last_token_end(self.text, 0, end);
            return Span::new(self.source.id, end, end);
        }
        Span::new(self.source.id, at, at + found.len())
    }

    /// The place of a fault. Where the next declaration stands on a later line, something lacks before it: that
    /// is right after the token before.
    pub(super) fn place_of(&self, fault: &Fault<'_>) -> Span {
        let expects_it = fault.expected.iter().any(|rule| {
            matches!(
                rule,
                Rule::item
                    | Rule::item_end
                    | Rule::property_item
                    | Rule::property_item_end
                    // A variable may be called as what a declaration starts with.
                    | Rule::process_item_end
            )
        });
        if starts_declaration(fault.found) && !expects_it {
            let end = last_token_end(self.text, fault.from, fault.at);
            if end > fault.from && self.text[end..fault.at].contains('\n') {
                return Span::new(self.source.id, end, end);
            }
        }
        self.place(fault.at, fault.found)
    }

    pub(super) fn describe(&self, fault: &Fault<'_>) -> Diagnostic {
        let fault = Fault {
            at: fault.at,
            found: lexeme::first(&self.text[fault.at..]),
            expected: fault.expected.clone(),
            ..*fault
        };
        let slip = self.slip_of_bracket(&fault).or_else(|| self.slip_of_opener(&fault));
        if let Some(slip) = slip.or_else(|| self.slip(&fault)) {
            return slip;
        }
        let place = self.place_of(&fault);
        let mut diagnostic = if matches!(fault.found, ")" | "]" | "}") && self.closes_nothing(&fault) {
            Diagnostic::error(code::STRAY, place, format!("`{}` has no opening bracket", fault.found))
        } else {
            let expected = expected_nouns(&fault.expected);
            let title = if expected.is_empty() {
                format!("unexpected {}", quote(fault.found))
            } else {
                format!("expected {expected}, found {}", quote(fault.found))
            };
            Diagnostic::error(code::UNEXPECTED, place, title)
        };
        let closes = fault.expected.contains(&Rule::t_rparen) || fault.expected.contains(&Rule::t_rbracket);
        if (closes || starts_declaration(fault.found))
            && let Some((open, bracket)) = nesting::open_bracket(self.text, fault.from, fault.at)
        {
            let span = Span::new(self.source.id, open, open + 1);
            let later = self.text[open..fault.at].contains('\n');
            if bracket != '{' && (later || self.ends_bracket(&fault, bracket)) {
                // What follows on a later line, or cannot stand in it, belongs to something else: the bracket is the error.
                let close = nesting::partner(bracket);
                return Diagnostic::error(code::UNCLOSED, span, format!("`{bracket}` is not closed"))
                    .related(
                        self.place(fault.at, fault.found),
                        format!("expected `{close}` before this text"),
                    );
            }
            if closes {
                diagnostic = diagnostic.related(span, format!("`{bracket}` is still open"));
            }
        }
        if let Some(hint) = self.belonging(&fault) {
            diagnostic = diagnostic.hint(hint);
        } else if nouns::OPERATORS.contains(&fault.found) && lexeme::declares_name(self.text, fault.at) {
            diagnostic = diagnostic.hint("this is an operator in property files; choose another name");
        } else if let Some(word) = Self::meant(&fault) {
            diagnostic = diagnostic.hint(format!("did you mean `{word}`?"));
        } else if let Some(missing) = self.missing(&fault) {
            diagnostic = diagnostic.hint(format!("write `{missing}` before {}", quote(fault.found)));
        }
        diagnostic
    }

    fn closes_nothing(&self, fault: &Fault<'_>) -> bool {
        let within = || nesting::open_bracket(self.text, fault.from, fault.at).map(|(_, open)| open);
        // A block opens before its lines, other brackets within one.
        match fault.found {
            // One that is closed behind it lacks nothing.
            ")" | "]" => within().is_none_or(|open| open == '{' || self.is_closed_behind(fault.at + 1, open)),
            _ => !self.braces.get_or_init(|| Braces::of(self.text)).is_open_at(fault.at),
        }
    }

    /// Where the word belongs that was found where a declaration is wanted.
    fn belonging(&self, fault: &Fault<'_>) -> Option<String> {
        let wanted = [Rule::item, Rule::item_end, Rule::property_item, Rule::property_item_end];
        if !wanted.iter().any(|rule| fault.expected.contains(rule)) {
            return None;
        }
        let starts = |rule| nouns::words(rule).contains(&fault.found);
        let in_scenario = self.root == Rule::scenario_file;
        let (own, others) = (Rule::item, Rule::property_item);
        let (own, others) = if in_scenario { (own, others) } else { (others, own) };
        if starts(own) {
            return None;
        }
        if starts(others) {
            let other = if in_scenario { "property file (`.bltl`)" } else { "scenario (`.scn`)" };
            return Some(format!("`{}` belongs in a {other}", fault.found));
        }
        let blocks = [
            (Rule::behaviour_item, "behaviour"),
            (Rule::process_item, "process"),
            (Rule::scene_item, "scene"),
            (Rule::move_option, "list of moves"),
        ];
        let (_, block) = blocks.into_iter().find(|(rule, _)| in_scenario && starts(*rule))?;
        let is_after_a_brace = self.text[..fault.at].trim_end().ends_with('}');
        Some(if is_after_a_brace {
            format!("`{}` belongs in a {block}; the `}}` before it may be one too many", fault.found)
        } else {
            format!("`{}` belongs in a {block}", fault.found)
        })
    }

    /// The keyword that was probably meant.
    fn meant(fault: &Fault<'_>) -> Option<&'static str> {
        if !fault.found.starts_with(lexeme::starts_name) {
            return None;
        }
        let known = || {
            let expected = fault.expected.iter();
            expected
                .flat_map(|&rule| nouns::keyword(rule).into_iter().chain(nouns::words(rule).iter().copied()))
        };
        // What is a keyword itself is no other one misspelt; of two or three letters it may be.
        let is_keyword = fault.found.len() > 3 && nouns::is_keyword(fault.found);
        if is_keyword || known().any(|word| word == fault.found) {
            return None;
        }
        nouns::nearest(fault.found, known())
    }
}

/// Whether all that failed is that a first word is not followed by `=`.
fn is_bare_word(text: &str, start: usize, at: usize, expected: &[Rule]) -> bool {
    let word = lexeme::first(&text[start..]);
    let after = start + word.len();
    word.starts_with(lexeme::starts_name)
        && !matches!(word, "horizon" | "step")
        && expected.iter().all(|&rule| rule == Rule::t_assign)
        && at == after + lexeme::all_trivia(&text[after..])
}

/// What a strict rule is a rule of.
fn declaration(strict: Rule) -> Rule {
    match strict {
        Rule::strict_item => Rule::item,
        Rule::strict_property_item => Rule::property_item,
        Rule::strict_state_item => Rule::state_item,
        _ => Rule::field,
    }
}

/// Whether a word starts declarations of either language.
pub(super) fn starts_declaration(word: &str) -> bool {
    [Rule::item, Rule::property_item].iter().any(|&rule| nouns::words(rule).contains(&word))
}

/// Bytes that a strict rule is given at first.
const FIRST: usize = 1 << 10;
/// Tokens that a rule may look at behind the place of its failure; few look at more than three.
const AHEAD: usize = 16;

/// The farthest failure of a rule from a byte on, and what it would have taken there.
pub(super) fn failure(strict: Rule, text: &str, from: usize) -> Option<(usize, Vec<Rule>)> {
    failure_within(strict, text, from, FIRST)
}

/// That failure, found in so many bytes or, where it lies near their end, in more: the errors of pest read all that
/// follows them, and that would be the rest of the file for each of thousands.
fn failure_within(strict: Rule, text: &str, from: usize, mut length: usize) -> Option<(usize, Vec<Rule>)> {
    loop {
        let end = text.floor_char_boundary(from.saturating_add(length));
        let (at, failure) = match Grammar::parse(strict, &text[from..end]) {
            Ok(mut taken) => (from + taken.next_back().map_or(0, |pair| pair.as_span().end()), None),
            Err(error) => {
                let (at, expected) = place_and_expected(error);
                (from + at, Some(expected))
            }
        };
        if end == text.len() || after_tokens(text, at, AHEAD) <= end {
            // Blanks and comments may precede what could not be taken.
            return failure.map(|expected| (at + lexeme::all_trivia(&text[at..]), expected));
        }
        length = length.saturating_mul(4);
    }
}

/// Where an error of pest lies, and what could have stood there.
fn place_and_expected(error: pest::error::Error<Rule>) -> (usize, Vec<Rule>) {
    let at = match error.location {
        InputLocation::Pos(at) | InputLocation::Span((at, _)) => at,
    };
    let expected = match error.variant {
        ErrorVariant::ParsingError { mut positives, .. } => {
            positives.retain(|rule| *rule != Rule::t_unequal);
            positives
        }
        ErrorVariant::CustomError { .. } => Vec::new(),
    };
    (at, expected)
}

/// The byte after so many tokens.
fn after_tokens(text: &str, from: usize, count: usize) -> usize {
    let mut at = from;
    for _ in 0..count {
        at += lexeme::all_trivia(&text[at..]);
        at += lexeme::first(&text[at..]).len();
    }
    at
}

/// End of the last token from `from` on and before `end`: comments there are no tokens.
fn last_token_end(text: &str, from: usize, end: usize) -> usize {
    let mut at = from;
    let mut last = from;
    while at < end {
        let rest = &text[at..];
        if let Some(length) = lexeme::trivia(rest) {
            at += length;
        } else {
            at += lexeme::first(rest).len().max(1);
            last = at;
        }
    }
    last
}

/// The text found, for a message.
pub(super) fn quote(found: &str) -> String {
    if found.is_empty() {
        return "the end of the file".to_owned();
    }
    let short: String = found.chars().take(40).flat_map(char::escape_debug).collect();
    // A quoted text keeps its quotes as they are.
    format!("`{}`", short.replace("\\\"", "\"").replace("\\'", "'"))
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
    let has = |name: &str| nouns.iter().any(|(_, noun)| noun == name);
    if has("a declaration") && has("the next declaration") {
        let less = if nouns.len() == 2 { "the next declaration" } else { "a declaration" };
        nouns.retain(|(_, noun)| noun != less);
    }
    if nouns.iter().any(|(_, noun)| noun == "the next line of the block") {
        nouns.retain(|(_, noun)| noun != "`name = value`");
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

impl Builder<'_> {
    /// The whole text was refused: only `parse_value` has no rule for what is bad.
    pub(super) fn refused(&mut self, error: pest::error::Error<Rule>) {
        let (at, expected) = place_and_expected(error);
        let at = at + lexeme::all_trivia(&self.text[at..]);
        let diagnostic = self.describe(&Fault { at, found: "", expected, from: 0, rule: self.root });
        self.say(diagnostic);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failure_is_the_same_however_little_of_the_text_is_read_first() {
        let item = "kind k: sfm { mass = 80 kg; radius = 0.3 /* so */ m }";
        let mut compared = 0;
        for (strict, line) in [
            (Rule::strict_item, item),
            (Rule::strict_item, "process p[3] { var n: 0 .. 3 = 1 when n < 3 at 2 /s -> { n = n + 1 } }"),
            (Rule::strict_item, "moves m for 2 s { heading from (1 + 2) deg to 20 deg by 5 deg stop }"),
            (Rule::strict_item, "let f(x) = count(a in c: a.v > 3 m / (s * s)) + min(x, (1, 2) m) // no\n"),
            (Rule::strict_field, "goal = wait 3 s in 0 s .. 9 s -> near (a + b) within 2 m then leave }"),
            (Rule::strict_scene_item, "region r: polygon (1, 2) (3, 4) (5, 6) hole (1, 1) (2, 2) (1, 2) }"),
            (Rule::strict_property_item, "property p = F[0 s, 3 s] (a.v > 1 m/s => G<=2 s !b) U (c & \"d\")"),
            (Rule::strict_property_item, "check P(min<=3 s a.v > 2) >= 0.9 confidence 95 % under n = 3 by x"),
        ] {
            let tokens = |line: &str| {
                let (mut at, mut ends) = (0, vec![0]);
                while at < line.len() {
                    at = after_tokens(line, at, 1);
                    ends.push(at);
                }
                ends
            };
            for end in tokens(line) {
                for stray in ["", " )", " =", " \"", " 7 7", " x y z", " /*", " ("] {
                    for rest in ["", &line[end..], &format!("\n{}", format!("{line}\n").repeat(40))] {
                        let text = format!("\n{}{stray}{rest}", &line[..end]);
                        let whole = failure_within(strict, &text, 1, text.len());
                        for first in [1, 7, 30, 100, 1_000] {
                            let part = failure_within(strict, &text, 1, first);
                            assert_eq!(part, whole, "{strict:?} {first} {text}");
                            compared += 1;
                        }
                    }
                }
            }
        }
        assert!(compared > 10_000, "{compared}");
    }
}
