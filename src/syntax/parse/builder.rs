//! What the tree builders share: the source, what was said so far, and walking pest's pairs.
//!
//! The grammar fixes the shape of every pair, so the builders take the parts in order and give up
//! (`None`) on one that is not there; nothing panics.

use super::anchor::Anchor;
use super::code;
use super::grammar::Rule;
use super::nesting::Braces;
use crate::syntax::ast::{Ident, Text};
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::source::{Source, Span};
use std::cell::OnceCell;
use std::collections::BTreeMap;
use std::ops::Range;

/// A piece of the text that a rule took.
pub(in crate::syntax) type Pair<'i> = pest::iterators::Pair<'i, Rule>;

/// Builds trees and collects diagnostics.
pub(super) struct Builder<'s> {
    pub(super) source: &'s Source,
    /// The part of the text that was parsed: all of it, or what stands before a comment that never ends.
    pub(super) text: &'s str,
    /// The kind of file.
    pub(super) root: Rule,
    /// The unit that hints write behind a time without one.
    pub(super) unit: &'static str,
    pub(super) diagnostics: Vec<Diagnostic>,
    /// Parts that ended early.
    pub(super) cut: Vec<Span>,
    /// Parts that could not be read, and heads of those whose values could not.
    pub(super) lost: Vec<Span>,
    /// Where items seem to begin.
    pub(super) anchors: Vec<(usize, Anchor)>,
    /// Parts that could not be read, with what stands before them and may be a piece of them, and where each was found wrong.
    pub(super) doubts: Vec<(Range<usize>, usize)>,
    /// Where, behind one of them on its line, an item surely begins and no bracket is open.
    pub(super) resumed: Vec<u32>,
    /// Whether the braces of the source pair up, computed on first use.
    pub(super) even: OnceCell<bool>,
    /// The braces of the text, computed on first use.
    pub(super) braces: OnceCell<Braces>,
    /// Its arrows, computed on first use: thousands of errors on a line search for one.
    pub(super) arrows: OnceCell<Vec<usize>>,
    /// The names that it declares, each with the word before it, computed on first use.
    pub(super) names: OnceCell<BTreeMap<&'s str, &'s str>>,
}

/// Whether a pair is only a mark or keyword.
pub(super) fn is_mark(rule: Rule) -> bool {
    matches!(
        rule,
        Rule::t_lparen
            | Rule::t_rparen
            | Rule::t_lbracket
            | Rule::t_rbracket
            | Rule::t_lbrace
            | Rule::t_rbrace
            | Rule::t_comma
            | Rule::t_semi
            | Rule::t_colon
            | Rule::t_dot
            | Rule::t_dots
            | Rule::t_arrow
            | Rule::t_line
            | Rule::t_assign
            | Rule::t_unequal
            | Rule::t_bar
    ) || super::nouns::keyword(rule).is_some()
}

/// The parts of a pair without marks and keywords, in order.
pub(super) struct Parts<'i> {
    pairs: std::iter::Peekable<std::vec::IntoIter<Pair<'i>>>,
}

impl<'i> Parts<'i> {
    pub(super) fn of(pair: Pair<'i>) -> Self {
        let pairs: Vec<_> = pair.into_inner().filter(|part| !is_mark(part.as_rule())).collect();
        Self { pairs: pairs.into_iter().peekable() }
    }

    /// The next part, if it is of this rule.
    pub(super) fn part(&mut self, rule: Rule) -> Option<Pair<'i>> {
        self.pairs.next_if(|part| part.as_rule() == rule)
    }

    /// Rule of the next part.
    pub(super) fn rule(&mut self) -> Option<Rule> {
        self.pairs.peek().map(Pair::as_rule)
    }
}

impl<'i> Iterator for Parts<'i> {
    type Item = Pair<'i>;

    fn next(&mut self) -> Option<Pair<'i>> {
        self.pairs.next()
    }
}

/// End of the last token of a pair. Pest counts the blanks before a part that turned out empty as part
/// of the pair.
pub(super) fn end_of(pair: &Pair<'_>) -> usize {
    let span = pair.as_span();
    match pair.clone().into_inner().rev().find(|part| part.as_span().end() > part.as_span().start()) {
        Some(last) => end_of(&last),
        None => span.end(),
    }
}

impl Builder<'_> {
    /// Where a pair stands, without blanks after it.
    pub(super) fn span(&self, pair: &Pair<'_>) -> Span {
        Span::new(self.source.id, pair.as_span().start(), end_of(pair))
    }

    /// Whether an arrow stands before a byte in its line.
    pub(super) fn follows_arrow(&self, at: usize) -> bool {
        let arrows = self.arrows.get_or_init(|| self.text.match_indices("->").map(|(at, _)| at).collect());
        let before = arrows.partition_point(|&arrow| arrow < at);
        arrows[..before].last().is_some_and(|&arrow| arrow >= self.source.line_start(at as u32) as usize)
    }

    pub(super) fn say(&mut self, diagnostic: Diagnostic) {
        self.diagnostics.push(diagnostic);
    }

    /// What is missed elsewhere if a part could not be made: from its start to the end of the name that it declares, of
    /// what is set to the sign after it; of commands and moves, which have no names, their first word.
    pub(super) fn head(&self, part: &Pair<'_>) -> Option<Span> {
        let last = |inner: &Pair<'_>| match part.as_rule() {
            Rule::setting | Rule::field => matches!(inner.as_rule(), Rule::t_assign | Rule::t_unequal),
            Rule::command | Rule::heading | Rule::headings => true,
            Rule::rank => false,
            _ => inner.as_rule() == Rule::name,
        };
        let inner = part.clone().into_inner().find(last)?;
        Some(Span { end: self.span(&inner).end, ..self.span(part) })
    }

    /// A part; where it could not be made for its values, its head is lost.
    pub(super) fn missed<T>(&mut self, part: Option<T>, head: Option<Span>) -> Option<T> {
        if part.is_none() {
            self.lost.extend(head);
        }
        part
    }

    pub(super) fn ident(&self, pair: &Pair<'_>) -> Ident {
        Ident { name: pair.as_str().to_owned(), span: self.span(pair) }
    }

    /// A quoted text, escapes resolved.
    pub(super) fn quoted(&mut self, pair: &Pair<'_>) -> Text {
        let span = self.span(pair);
        let inner = pair.as_str().trim_start_matches('"');
        let inner = inner.strip_suffix('"').unwrap_or(inner);
        let mut value = String::with_capacity(inner.len());
        let mut characters = pair.as_str().char_indices().skip(1);
        while let Some((at, character)) = characters.next() {
            match character {
                '"' => break,
                '\\' => match characters.next() {
                    Some((_, 'n')) => value.push('\n'),
                    Some((_, 't')) => value.push('\t'),
                    Some((_, plain @ ('"' | '\\'))) => value.push(plain),
                    other => {
                        let unknown = other.map_or(' ', |(_, c)| c);
                        let start = span.start as usize + at;
                        let place = Span::new(span.source, start, start + 1 + unknown.len_utf8());
                        self.say(
                            Diagnostic::error(code::ESCAPE, place, format!("unknown escape `\\{unknown}`"))
                                .hint("the escapes are `\\\"`, `\\\\`, `\\n` and `\\t`"),
                        );
                        value.push(unknown);
                    }
                },
                plain => value.push(plain),
            }
        }
        Text { value, span }
    }
}
