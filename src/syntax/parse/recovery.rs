//! What the grammar could not take, part by part: one error each, but none of what may follow from the one before.

use super::anchor::{self, Way};
use super::braces;
use super::builder::{Builder, Pair, end_of};
use super::code;
use super::fault::{failure, quote};
use super::grammar::Rule;
use super::{lexeme, nesting, slips};
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::source::Span;

/// The strict rule for what a bad part was meant to be.
fn strict_rule(bad: Rule) -> Option<Rule> {
    Some(match bad {
        Rule::bad_item => Rule::strict_item,
        Rule::bad_property_item => Rule::strict_property_item,
        Rule::bad_scene_item => Rule::strict_scene_item,
        Rule::bad_field => Rule::strict_field,
        Rule::bad_move => Rule::strict_move,
        Rule::bad_process_item => Rule::strict_process_item,
        Rule::bad_behaviour_item => Rule::strict_behaviour_item,
        Rule::bad_state_item => Rule::strict_state_item,
        _ => return None,
    })
}

impl Builder<'_> {
    /// Looks through the direct parts of a block or file and reports the bad ones.
    pub(super) fn report_faults(&mut self, block: &Pair<'_>) {
        let text = self.text;
        let mut before: Option<Pair<'_>> = None;
        let mut last_bad_end = None;
        let mut way: Option<Way> = None;
        for part in block.clone().into_inner() {
            let rule = part.as_rule();
            let start = part.as_span().start();
            let anchor = anchor::at(rule, text, start);
            self.anchors.extend(anchor.map(|anchor| (start, anchor)));
            if let Some(strict) = strict_rule(rule) {
                self.lost.push(Span::new(self.source.id, start, end_of(&part)));
                // What follows a bad part on its line is a consequence of it, and what follows it elsewhere unless it starts
                // a line as declarations do.
                let follows = |end: usize| {
                    !text[end..start].contains('\n')
                        || rule == Rule::bad_item
                            && self.source.line_start(start as u32) != start as u32
                            && failure(Rule::scenario_start, text, start).is_some()
                };
                let begins = anchor.is_some_and(|anchor| {
                    way.as_mut().is_some_and(|way| way.allows(text, start, anchor)) && self.is_even()
                });
                let from = before.as_ref().filter(|_| anchor.is_none()).map(|pair| pair.as_span().start());
                let (mut doubtful, mut blamed) = (from.unwrap_or(start), start);
                if begins || !last_bad_end.is_some_and(follows) {
                    let fault = self.fault(strict, &part, before.as_ref());
                    if let Some(before) = &before
                        && fault.from == before.as_span().start()
                        && (fault.at > start
                            || !text[end_of(before)..start].contains('\n')
                            || !text[start..].starts_with(lexeme::starts_name))
                    {
                        self.cut.push(Span::new(self.source.id, fault.from, end_of(&part)));
                    }
                    doubtful = doubtful.min(fault.from);
                    blamed = fault.at;
                    way = Some(Way::from(start, blamed));
                    let diagnostic = self.describe(&fault);
                    self.say(diagnostic);
                }
                self.doubts.push((doubtful..end_of(&part), blamed));
                last_bad_end = Some(end_of(&part));
                before = None;
            } else if rule == Rule::missing_brace || rule == Rule::missing_decl {
                self.missing_brace(block, part.as_span().start());
            } else if rule == Rule::t_semi {
                before = None;
            } else {
                let is_mark = super::builder::is_mark(rule);
                if !is_mark {
                    // `param = 3 in 0 .. 5` reads as a setting, as far as one goes.
                    let inner =
                        part.clone().into_inner().next().filter(|inner| inner.as_rule() == Rule::setting);
                    let is_bad =
                        inner.is_some_and(|pair| slips::unsigned(lexeme::first(pair.as_str())).is_some());
                    // What reads as a member within a bracket that a bad part has left open is a consequence, too.
                    let is_within = last_bad_end.is_some_and(|end| !text[end..start].contains('\n'))
                        && anchor != Some(anchor::Anchor::Surely)
                        && way.as_mut().is_some_and(|way| way.is_open_at(text, start));
                    if is_within {
                        self.cut.push(Span::new(self.source.id, start, end_of(&part)));
                    }
                    last_bad_end = (is_bad || is_within).then(|| end_of(&part));
                }
                let is_member = !is_mark && part.as_span().start() < part.as_span().end();
                before = is_member.then_some(part);
            }
        }
    }

    fn missing_brace(&mut self, block: &Pair<'_>, at: usize) {
        let found = lexeme::first(&self.text[at..]);
        let place = self.place(at, found);
        let mut diagnostic =
            Diagnostic::error(code::UNCLOSED, place, format!("expected `}}`, found {}", quote(found)));
        if let Some((open, _)) = nesting::open_bracket(self.text, block.as_span().start(), at) {
            let span = Span::new(self.source.id, open, open + 1);
            diagnostic = diagnostic.related(span, "`{` is not closed");
        }
        self.say(diagnostic);
    }

    /// Whether the braces of the source pair up: where they do not, items may stand in the wrong blocks.
    fn is_even(&self) -> bool {
        *self.even.get_or_init(|| braces::is_even(&self.source.text))
    }

    /// The parts of lines that what could not be read leaves in doubt: each up to where an item surely begins, or the end
    /// of the line. Notes these items.
    pub(super) fn doubts(&mut self) -> Vec<Span> {
        let mut doubts = std::mem::take(&mut self.doubts);
        if doubts.is_empty() || !self.is_even() {
            return Vec::new();
        }
        doubts.sort_unstable_by_key(|(doubt, _)| (doubt.start, doubt.end));
        self.anchors.sort_unstable_by_key(|(at, _)| *at);
        let mut found: Vec<Span> = Vec::new();
        for (doubt, blamed) in doubts {
            let known = found.last().map_or(0, |last| last.end as usize);
            if doubt.end <= known {
                continue;
            }
            let end = self.source.line_end(doubt.end as u32) as usize;
            let mut way = Way::from(doubt.start, blamed);
            let first = self.anchors.partition_point(|(at, _)| *at < doubt.end);
            let begins = self.anchors[first..]
                .iter()
                .take_while(|(at, _)| *at < end)
                .find(|(at, anchor)| way.allows(self.text, *at, *anchor));
            if let Some((at, _)) = begins
                && way.is_even()
            {
                self.resumed.push(*at as u32);
            }
            let end = begins.map_or(end, |(at, _)| *at);
            found.push(Span::new(self.source.id, doubt.start.max(known), end));
        }
        found
    }
}
