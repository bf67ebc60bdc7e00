//! The state that the tree builders share: the source, the item at hand, what was said so far, and walking pest's pairs.
//!
//! The grammar fixes the shape of every pair, so the builders take the parts in order and give up
//! (`None`) on one that is not there; nothing panics.

use super::failure::Fault;
use super::grammar::Rule;
use super::layout::{Item, Layout, Token};
use crate::syntax::ast::{Broken, Ident, Text};
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::keywords::{Declares, keyword};
use crate::syntax::source::{Source, Span};
use std::cell::OnceCell;
use std::collections::BTreeMap;
use std::ops::Range;
use std::rc::Rc;

/// A piece of the text that a rule took.
pub(in crate::syntax) type Pair<'i> = pest::iterators::Pair<'i, Rule>;

/// Builds trees and collects diagnostics.
pub(super) struct Builder<'s> {
    pub(super) source: &'s Source,
    pub(super) layout: &'s Layout<'s>,
    /// Whether this is a property file.
    pub(super) in_properties: bool,
    /// The unit that hints write behind a time without one.
    pub(super) unit: &'static str,
    /// The text of the item at hand, with blanks for what stands in its blocks, and its first byte in the source.
    pub(super) text: Rc<str>,
    pub(super) base: usize,
    /// The item at hand.
    pub(super) item: Option<&'s Item>,
    pub(super) diagnostics: Vec<Diagnostic>,
    /// Items that could not be read.
    pub(super) broken: Vec<Broken>,
    /// The names that the file declares, each with the word before it, computed on first use.
    pub(super) names: OnceCell<BTreeMap<&'s str, &'s str>>,
}

/// Whether a pair is only a mark or keyword.
fn is_mark(rule: Rule) -> bool {
    matches!(
        rule,
        Rule::t_lparen
            | Rule::t_rparen
            | Rule::t_lbracket
            | Rule::t_rbracket
            | Rule::t_comma
            | Rule::t_colon
            | Rule::t_dot
            | Rule::t_dots
            | Rule::t_arrow
            | Rule::t_line
            | Rule::t_assign
            | Rule::t_unequal
            | Rule::t_bar
            | Rule::EOI
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
fn end_of(pair: &Pair<'_>) -> usize {
    let span = pair.as_span();
    match pair.clone().into_inner().rev().find(|part| part.as_span().end() > part.as_span().start()) {
        Some(last) => end_of(&last),
        None => span.end(),
    }
}

impl<'s> Builder<'s> {
    pub(super) fn of(
        source: &'s Source,
        layout: &'s Layout<'s>,
        in_properties: bool,
        unit: &'static str,
    ) -> Self {
        Self {
            source,
            layout,
            in_properties,
            unit,
            text: "".into(),
            base: 0,
            item: None,
            diagnostics: Vec::new(),
            broken: Vec::new(),
            names: OnceCell::new(),
        }
    }

    /// The item as it is written, each byte where it is in `text`.
    pub(super) fn written(&self) -> &'s str {
        self.item.map_or("", |item| &self.source.text[self.layout.bytes(item)])
    }

    /// A place in the source, of bytes of the item.
    pub(super) fn at(&self, bytes: Range<usize>) -> Span {
        // A brace that was put in may stand behind the last byte.
        let last = |at: usize| (self.base + at).min(self.source.text.len());
        Span::new(self.source.id, last(bytes.start), last(bytes.end))
    }

    /// Where a pair stands, without blanks after it.
    pub(super) fn span(&self, pair: &Pair<'_>) -> Span {
        self.at(pair.as_span().start()..end_of(pair))
    }

    /// The token behind the item on its line.
    pub(super) fn next_token(&self) -> Option<&'s Token<'s>> {
        self.layout.after(self.item?).filter(|next| !next.starts_line)
    }

    /// The place of a token.
    pub(super) fn place(&self, at: usize, found: &str) -> Span {
        match self.next_token().filter(|_| at >= self.text.len() && !found.is_empty()) {
            Some(next) => Span::new(self.source.id, next.at, next.end()),
            None => self.at(at..at + found.len()),
        }
    }

    /// The text found, for a message.
    pub(super) fn quote(&self, found: &str) -> String {
        if !found.is_empty() {
            return super::nouns::quote(found);
        }
        let is_last = self.item.is_none_or(|item| self.layout.after(item).is_none());
        if is_last { "the end of the file" } else { "the end of the line" }.to_owned()
    }

    /// The text behind the one found, less blanks.
    pub(super) fn behind(&self, fault: &Fault<'_>) -> &str {
        self.text.get(fault.at + fault.found.len()..).unwrap_or_default().trim_start()
    }

    /// Whether a bracket of the item at hand has no partner.
    pub(super) fn is_unmatched(&self, at: usize) -> bool {
        self.item.is_some_and(|item| item.unmatched.contains(&(self.base + at)))
    }

    /// Whether an arrow stands before a byte in its line.
    pub(super) fn follows_arrow(&self, at: usize) -> bool {
        let before = &self.text[..at];
        before.rsplit('\n').next().is_some_and(|line| line.contains("->"))
    }

    pub(super) fn say(&mut self, diagnostic: Diagnostic) {
        self.diagnostics.push(diagnostic);
    }

    pub(super) fn ident(&self, pair: &Pair<'_>) -> Ident {
        Ident { name: pair.as_str().to_owned(), span: self.span(pair) }
    }

    /// The names that the file declares, each with the word before it; one that may stand in a value, if there are several.
    pub(super) fn declared(&self) -> &BTreeMap<&'s str, &'s str> {
        self.names.get_or_init(|| {
            let mut found = BTreeMap::new();
            for pair in self.layout.tokens.windows(2) {
                let (word, name) = (pair[0].text, pair[1].text);
                if !name.starts_with(super::lexeme::starts_name) {
                    continue;
                }
                match keyword(word).map(|keyword| keyword.declares) {
                    Some(Declares::Value) => drop(found.insert(name, word)),
                    Some(Declares::Thing) => drop(found.entry(name).or_insert(word)),
                    _ => {}
                }
            }
            found
        })
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
                        self.say(error!(E0117, place, "unknown escape `\\{unknown}`";
                                hint: "the escapes are `\\\"`, `\\\\`, `\\n` and `\\t`"));
                        value.push(unknown);
                    }
                },
                plain => value.push(plain),
            }
        }
        Text { value, span }
    }
}
