//! The items of a file or block, read one by one.

use super::builder::{Builder, Pair};
use super::grammar::{Grammar, Rule};
use super::layout::{self, BROKEN, Block, Item};
use super::{lexeme, nouns};
use crate::syntax::ast::Broken;
use crate::syntax::codes::Code;
use crate::syntax::keywords::Place;
use crate::syntax::source::Span;
use pest::Parser;
use std::rc::Rc;

/// The rule of the items in the block that a rule takes.
pub(in crate::syntax) fn inner(rule: Rule) -> Rule {
    match rule {
        Rule::scene => Rule::line_of_scene,
        Rule::level => Rule::line_of_level,
        Rule::moves => Rule::line_of_moves,
        Rule::paths => Rule::line_of_paths,
        Rule::process => Rule::line_of_process,
        Rule::program => Rule::line_of_program,
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
        Rule::line_of_scene | Rule::line_of_level => Place::Scene,
        Rule::line_of_process => Place::Process,
        Rule::line_of_program => Place::Program,
        Rule::line_of_behaviour => Place::Behaviour,
        Rule::line_of_state => Place::State,
        Rule::line_of_moves => Place::Moves,
        Rule::line_of_fields => Place::Fields,
        _ => Place::Other,
    }
}

impl<'s> Builder<'s> {
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
        // The end of a block of another language.
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
                        let word = format!("end{}", lexeme::first(&text));
                        let is_end = |item: &Item| self.layout.words(item).eq([word.as_str()]);
                        let end = items[place..].iter().position(is_end);
                        foreign_end = end.map_or(foreign_end, |end| place + end + 1);
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

    /// The items of the block that a pair takes.
    pub(super) fn block<T>(
        &mut self,
        block: &Pair<'_>,
        rule: Rule,
        build: &mut dyn FnMut(&mut Self, Pair<'_>) -> Option<T>,
    ) -> Vec<T> {
        self.taken(block).map_or_else(Vec::new, |block| self.items(&block.items, rule, build))
    }

    /// The block of the item at hand that a pair takes.
    fn taken(&self, pair: &Pair<'_>) -> Option<&'s Block> {
        let open = self.base + pair.as_span().start();
        self.item?.blocks.iter().find(|block| block.open == open)
    }

    /// The item of a block that holds just one.
    pub(super) fn only<T>(
        &mut self,
        block: &Pair<'_>,
        rule: Rule,
        build: &mut dyn FnMut(&mut Self, Pair<'_>) -> Option<T>,
    ) -> Option<T> {
        let own = self.taken(block)?;
        let unexpected = |span: Span, wanted: &str| {
            let found = self.source.slice(span);
            error!(E0101, span, "expected {wanted}, found `{found}`")
        };
        match own.items.as_slice() {
            [] => {
                let wanted = nouns::noun(rule).map_or(String::new(), |(_, noun)| noun);
                let close = own.close - self.base;
                let error = unexpected(self.at(close..close + 1), &wanted);
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
        let length = lexeme::first(&self.source.text[bytes.clone()]).len();
        Span::new(self.source.id, bytes.start, bytes.start + length)
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
        for token in layout::tokens(&self.text) {
            match token.text {
                "(" | "[" | "{" => depth += 1,
                ")" | "]" | "}" => depth = depth.saturating_sub(1),
                "=" if depth == 0 => return format!("{}{BROKEN}", &self.text[..token.end()]).into(),
                _ => {}
            }
        }
        Rc::clone(&self.text)
    }
}
