//! What the tree builders share: the source, the item at hand, what was said so far, and walking pest's pairs.
//!
//! The grammar fixes the shape of every pair, so the builders take the parts in order and give up
//! (`None`) on one that is not there; nothing panics.

use super::grammar::{Grammar, Rule};
use super::layout::{Item, Layout, Token};
use crate::syntax::ast::{Broken, Ident, Text};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::keywords::{Declares, Place, keyword};
use crate::syntax::source::{Source, Span};
use pest::Parser;
use std::cell::OnceCell;
use std::collections::BTreeMap;
use std::ops::Range;
use std::rc::Rc;

/// The mark of a value that cannot be read, as in the grammar.
pub(super) const BROKEN: char = '\u{1A}';

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

/// The rule of the items in the block that a rule takes.
pub(in crate::syntax) fn inner(rule: Rule) -> Rule {
    match rule {
        Rule::scene => Rule::line_of_scene,
        Rule::moves => Rule::line_of_moves,
        Rule::paths => Rule::line_of_paths,
        Rule::process => Rule::line_of_process,
        Rule::updates => Rule::line_of_updates,
        Rule::behaviour => Rule::line_of_behaviour,
        Rule::state => Rule::line_of_state,
        Rule::on => Rule::line_of_answers,
        Rule::answers => Rule::line_of_choices,
        _ => Rule::line_of_fields,
    }
}

/// The part of a file whose items a rule takes.
fn part(rule: Rule) -> Place {
    match rule {
        Rule::line_of_scenario => Place::Scenario,
        Rule::line_of_properties => Place::Properties,
        Rule::line_of_scene => Place::Scene,
        Rule::line_of_process => Place::Process,
        Rule::line_of_behaviour => Place::Behaviour,
        Rule::line_of_state => Place::State,
        Rule::line_of_moves => Place::Moves,
        Rule::line_of_fields => Place::Fields,
        _ => Place::Other,
    }
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

    /// The items of a file or block, each read by its rule and built from what that took.
    pub(super) fn items<T>(
        &mut self,
        items: &'s [Item],
        rule: Rule,
        build: &mut dyn FnMut(&mut Self, Pair<'_>) -> Option<T>,
    ) -> Vec<T> {
        let outer = (Rc::clone(&self.text), self.base, self.item);
        let mut built = Vec::with_capacity(items.len());
        let mut is_broken = false;
        // Where a block of another language ends.
        let mut foreign_end = 0;
        for (place, item) in items.iter().enumerate() {
            let mut text: Rc<str> = self.layout.plain(item).into();
            self.text = Rc::clone(&text);
            self.base = self.layout.bytes(item).start;
            self.item = Some(item);
            let read = match Grammar::parse(rule, &text) {
                Ok(taken) => taken,
                Err(error) => {
                    let refusal = self.refusal(rule, error);
                    // A line that begins no item, right behind one that could not be read, is a piece of it.
                    let is_piece = is_broken && refusal.is_alone || place < foreign_end;
                    if refusal.diagnostic.code == Code::E0130 {
                        let word = format!("end{}", super::lexeme::first(&text));
                        let is_end = |item: &Item| self.layout.words(item).eq([word.as_str()]);
                        foreign_end = items.iter().rposition(is_end).map_or(foreign_end, |end| end + 1);
                    }
                    if is_piece {
                        self.lose(item, rule, self.whole(item));
                        continue;
                    }
                    self.say(refusal.diagnostic);
                    text = self.with_broken_value();
                    let Ok(taken) = Grammar::parse(rule, &text) else {
                        is_broken = true;
                        self.lose(item, rule, self.whole(item));
                        continue;
                    };
                    // Its head stands for it.
                    let head = &text[..text.len() - BROKEN.len_utf8()];
                    let span = self.at(0..head.len());
                    self.lose(item, rule, span);
                    taken
                }
            };
            is_broken = false;
            for line in read {
                self.report_unequal(&line);
                if let Some(part) = line.into_inner().next() {
                    match build(self, part) {
                        Some(one) => built.push(one),
                        None => self.lose(item, rule, self.whole(item)),
                    }
                }
            }
        }
        (self.text, self.base, self.item) = outer;
        built
    }

    /// The items of the block that a pair takes: the first of its blocks that was not asked for before.
    pub(super) fn block<T>(
        &mut self,
        block: &Pair<'_>,
        rule: Rule,
        build: &mut dyn FnMut(&mut Self, Pair<'_>) -> Option<T>,
    ) -> Vec<T> {
        let open = self.base + block.as_span().start();
        let blocks = self.item.map_or(&[][..], |item| &item.blocks);
        match blocks.iter().find(|block| block.open == open) {
            Some(block) => self.items(&block.items, rule, build),
            None => Vec::new(),
        }
    }

    /// The item of a block that holds just one.
    pub(super) fn only<T>(
        &mut self,
        block: &Pair<'_>,
        rule: Rule,
        build: &mut dyn FnMut(&mut Self, Pair<'_>) -> Option<T>,
    ) -> Option<T> {
        let open = self.base + block.as_span().start();
        let own = self.item?.blocks.iter().find(|block| block.open == open)?;
        let unexpected = |span: Span, wanted: &str| {
            let found = self.source.slice(span);
            error!(E0101, span, "expected {wanted}, found `{found}`")
        };
        match own.items.as_slice() {
            [] => {
                let wanted = super::nouns::noun(rule).map_or(String::new(), |(_, noun)| noun);
                let error = unexpected(Span::new(self.source.id, own.close, own.close + 1), &wanted);
                self.say(error);
            }
            [_] => {}
            [_, second, ..] => {
                let error = unexpected(self.first_of(second), "`}`");
                self.say(error);
            }
        }
        self.block(block, rule, build).into_iter().next()
    }

    /// The first token of an item.
    fn first_of(&self, item: &Item) -> Span {
        let bytes = self.layout.bytes(item);
        let length = super::lexeme::first(&self.source.text[bytes.clone()]).len();
        Span::new(self.source.id, bytes.start, bytes.start + length)
    }

    /// The item as it is written, each byte where it is in `text`.
    pub(super) fn written(&self) -> &'s str {
        self.item.map_or("", |item| &self.source.text[self.layout.bytes(item)])
    }

    /// A place in the source, of bytes of the item.
    pub(super) fn at(&self, bytes: Range<usize>) -> Span {
        Span::new(self.source.id, self.base + bytes.start, self.base + bytes.end)
    }

    /// Where a pair stands, without blanks after it.
    pub(super) fn span(&self, pair: &Pair<'_>) -> Span {
        self.at(pair.as_span().start()..end_of(pair))
    }

    /// The token behind the item on its line.
    pub(super) fn next_token(&self) -> Option<&'s Token<'s>> {
        self.layout.after(self.item?).filter(|next| !next.starts_line)
    }

    /// Whether an arrow stands before a byte in its line.
    pub(super) fn follows_arrow(&self, at: usize) -> bool {
        let before = &self.text[..at];
        before.rsplit('\n').next().is_some_and(|line| line.contains("->"))
    }

    pub(super) fn say(&mut self, diagnostic: Diagnostic) {
        self.diagnostics.push(diagnostic);
    }

    /// The place of an item.
    fn whole(&self, item: &Item) -> Span {
        let bytes = self.layout.bytes(item);
        Span::new(self.source.id, bytes.start, bytes.end)
    }

    /// Notes an item that could not be read or made; its head stands for it where that could.
    fn lose(&mut self, item: &Item, rule: Rule, span: Span) {
        let words = self.layout.words(item).map(str::to_owned).collect();
        let name = self.layout.second_word(item).map(str::to_owned);
        self.broken.push(Broken { span, place: part(rule), name, words });
    }

    /// The item at hand with a mark for what stands behind its first sign of equality: so its name is known.
    fn with_broken_value(&self) -> Rc<str> {
        let mut depth = 0_usize;
        for token in super::layout::tokens(&self.text) {
            match token.text {
                "(" | "[" | "{" => depth += 1,
                ")" | "]" | "}" => depth = depth.saturating_sub(1),
                "=" if depth == 0 => return format!("{}{BROKEN}", &self.text[..token.end()]).into(),
                _ => {}
            }
        }
        Rc::clone(&self.text)
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
