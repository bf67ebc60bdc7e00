//! The place where the rule of an item fails.

use super::grammar::{Grammar, Rule};
use super::{layout, lexeme, nouns};
use pest::Parser;
use pest::error::{ErrorVariant, InputLocation};

/// The place in an item where its rule failed, with the rules expected there.
pub(super) struct Fault<'t> {
    /// Byte of the failure.
    pub(super) at: usize,
    /// The text found there; empty at the end of the file or line.
    pub(super) found: &'t str,
    /// The rules expected there.
    pub(super) expected: Vec<Rule>,
    /// The rule of the item.
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

    /// Whether the item could have ended there.
    pub(super) fn ends(&self) -> bool {
        self.expected.contains(&Rule::EOI)
    }
}

/// The farthest failure of the rule of a line, and what it would have taken there.
pub(super) fn failure(rule: Rule, text: &str) -> Option<(usize, Vec<Rule>)> {
    let plain = layout::hollow(text);
    let (at, expected) = place_and_expected(Grammar::parse(rule, &plain).err()?);
    Some((at + lexeme::all_trivia(&plain[at..]), expected))
}

/// The place of an error of pest, and the rules that could have stood there.
pub(super) fn place_and_expected(error: pest::error::Error<Rule>) -> (usize, Vec<Rule>) {
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
