//! Members and tokens of a file, taken from the pairs of the grammar.

use crate::syntax::parse::grammar::{Grammar, Rule};
use crate::syntax::parse::layout::{Item, Layout};
use crate::syntax::parse::{Pair, inner};
use pest::Parser;

/// A token and how it stands beside others.
#[allow(clippy::struct_excessive_bools, reason = "four independent marks")]
pub(super) struct Token {
    /// As it is written out.
    pub(super) text: String,
    /// Its bytes in the source.
    pub(super) start: usize,
    /// One past its last byte.
    pub(super) end: usize,
    /// No blank before it.
    pub(super) glued_left: bool,
    /// No blank after it.
    pub(super) glued_right: bool,
    /// The first `=` of a declaration whose `=` are aligned.
    pub(super) aligned: bool,
    is_unit: bool,
}

/// A token or a block.
pub(super) enum Node {
    Token(Token),
    Block { open: Token, members: Vec<Vec<Node>>, close: Token },
}

/// The members of a file or block that was read before.
pub(super) fn members(layout: &Layout<'_>, items: &[Item], rule: Rule) -> Vec<Vec<Node>> {
    items
        .iter()
        .map(|item| {
            let plain = layout.plain(item);
            let mut nodes = Vec::new();
            if let Ok(pairs) = Grammar::parse(rule, &plain) {
                let collector = Collector { layout, item, base: layout.bytes(item).start };
                pairs.for_each(|line| collector.collect(line, Rule::EOI, &mut nodes));
            }
            nodes
        })
        .collect()
}

fn aligns(rule: Rule) -> bool {
    matches!(
        rule,
        Rule::field
            | Rule::setting
            | Rule::const_decl
            | Rule::param
            | Rule::let_decl
            | Rule::property
            | Rule::tracks
            | Rule::named_route
    )
}

/// Takes the tokens of an item from what the grammar made of it.
struct Collector<'l, 't> {
    layout: &'l Layout<'t>,
    item: &'l Item,
    base: usize,
}

impl Collector<'_, '_> {
    fn collect(&self, pair: Pair<'_>, parent: Rule, out: &mut Vec<Node>) {
        let rule = pair.as_rule();
        if rule == Rule::block {
            return self.block(&pair, parent, out);
        }
        if matches!(rule, Rule::unit | Rule::point_unit) || pair.clone().into_inner().next().is_none() {
            if pair.as_span().start() < pair.as_span().end() {
                out.push(Node::Token(self.leaf(&pair, parent)));
            }
            return;
        }
        let parts: Vec<_> = pair.into_inner().collect();
        // Whether an operand comes next tells the two kinds of minus apart.
        let mut wants_operand = true;
        for (k, part) in parts.iter().enumerate() {
            let first = out.len();
            self.collect(part.clone(), rule, out);
            let next = parts.get(k + 1);
            if let Some(Node::Token(token)) = out.get_mut(first) {
                match part.as_rule() {
                    Rule::op_minus if wants_operand => {
                        // Two minus signs side by side would be a line.
                        token.glued_right = next.is_none_or(|next| next.as_rule() != Rule::op_minus);
                    }
                    Rule::op_over => {
                        let fraction =
                            k > 0 && is_plain_number(&parts[k - 1]) && next.is_some_and(is_plain_number);
                        token.glued_left = fraction;
                        token.glued_right = fraction;
                    }
                    Rule::t_assign => token.aligned = aligns(rule),
                    _ => {}
                }
            }
            if part.as_rule() == Rule::op_power
                && !follows_unit(out, first)
                && let Some(Node::Token(token)) = out.get_mut(first)
            {
                token.glued_left = true;
                token.glued_right = true;
            }
            wants_operand = !matches!(part.as_rule(), Rule::primary | Rule::member | Rule::index);
        }
    }

    fn block(&self, pair: &Pair<'_>, parent: Rule, out: &mut Vec<Node>) {
        let open = self.base + pair.as_span().start();
        let Some(block) = self.item.blocks.iter().find(|block| block.open == open) else { return };
        let brace = |at: usize, text: &str| Token {
            text: text.to_owned(),
            start: at,
            end: at + 1,
            glued_left: false,
            glued_right: false,
            aligned: false,
            is_unit: false,
        };
        let members = members(self.layout, &block.items, inner(parent));
        out.push(Node::Block { open: brace(block.open, "{"), members, close: brace(block.close, "}") });
    }

    fn leaf(&self, pair: &Pair<'_>, parent: Rule) -> Token {
        let rule = pair.as_rule();
        let (glued_left, glued_right) = match rule {
            Rule::t_lparen => {
                let called = matches!(
                    parent,
                    Rule::call
                        | Rule::arguments
                        | Rule::count
                        | Rule::parameters
                        | Rule::probability
                        | Rule::expectation
                        | Rule::quantile
                        | Rule::tail
                        | Rule::method
                );
                (called, true)
            }
            Rule::t_rparen | Rule::t_rbracket | Rule::t_comma | Rule::t_colon => (true, false),
            Rule::t_lbracket | Rule::t_dot => (true, true),
            Rule::op_not => (false, true),
            Rule::op_at_most if parent == Rule::bound => (true, true),
            _ => (false, false),
        };
        let is_unit = matches!(rule, Rule::unit | Rule::point_unit);
        let span = pair.as_span();
        let text = if is_unit { unit(pair.as_str()) } else { pair.as_str().to_owned() };
        Token {
            text,
            start: self.base + span.start(),
            end: self.base + span.end(),
            glued_left,
            glued_right,
            aligned: false,
            is_unit,
        }
    }
}

/// Whether the token before `at` is a unit: `2 m^2` is another value than `2 m ^ 2`.
fn follows_unit(nodes: &[Node], at: usize) -> bool {
    matches!(at.checked_sub(1).and_then(|before| nodes.get(before)), Some(Node::Token(token)) if token.is_unit)
}

/// A number without a unit.
fn is_plain_number(pair: &Pair<'_>) -> bool {
    pair.as_rule() == Rule::primary
        && pair.as_str().trim_end().bytes().all(|byte| byte.is_ascii_digit() || byte == b'.')
}

/// A unit with no blanks but one between factors in parentheses.
fn unit(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for word in
        text.replace('(', "( ").replace(')', " )").replace('/', " / ").replace('*', " * ").split_whitespace()
    {
        let tight = matches!(word, "/" | "*" | "(" | ")") || out.is_empty() || out.ends_with(['/', '*', '(']);
        if !tight {
            out.push(' ');
        }
        out.push_str(word);
    }
    out
}
