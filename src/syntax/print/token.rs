//! Members and tokens of a file, taken from the pairs of the grammar.

use crate::syntax::parse::Pair;
use crate::syntax::parse::grammar::Rule;

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

/// The members of a file.
pub(super) fn members(file: Pair<'_>) -> Vec<Vec<Node>> {
    file.into_inner()
        .filter(|part| !matches!(part.as_rule(), Rule::t_semi | Rule::EOI))
        .map(|part| {
            let mut nodes = Vec::new();
            collect(part, Rule::EOI, &mut nodes);
            nodes
        })
        .collect()
}

fn has_block(rule: Rule) -> bool {
    matches!(
        rule,
        Rule::scene
            | Rule::fields
            | Rule::moves
            | Rule::paths
            | Rule::process
            | Rule::behaviour
            | Rule::state
    )
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

fn collect(pair: Pair<'_>, parent: Rule, out: &mut Vec<Node>) {
    let rule = pair.as_rule();
    if matches!(rule, Rule::unit | Rule::point_unit) || pair.clone().into_inner().next().is_none() {
        if pair.as_span().start() < pair.as_span().end()
            && !matches!(rule, Rule::no_body | Rule::missing_brace)
        {
            out.push(Node::Token(leaf(&pair, parent)));
        }
        return;
    }
    if has_block(rule) {
        return collect_block(pair, out);
    }
    let parts: Vec<_> = pair.into_inner().collect();
    // Whether an operand comes next tells the two kinds of minus apart.
    let mut wants_operand = true;
    for (k, part) in parts.iter().enumerate() {
        let first = out.len();
        collect(part.clone(), rule, out);
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

/// Whether the token before `at` is a unit: `2 m^2` is another value than `2 m ^ 2`.
fn follows_unit(nodes: &[Node], at: usize) -> bool {
    matches!(at.checked_sub(1).and_then(|before| nodes.get(before)), Some(Node::Token(token)) if token.is_unit)
}

fn collect_block(pair: Pair<'_>, out: &mut Vec<Node>) {
    let rule = pair.as_rule();
    let mut open = None;
    let mut members = Vec::new();
    for part in pair.into_inner() {
        match (part.as_rule(), &open) {
            (Rule::t_lbrace, None) => open = Some(leaf(&part, rule)),
            (_, None) => collect(part, rule, out),
            (Rule::t_semi, _) => {}
            (Rule::t_rbrace, _) => {
                if let Some(open) = open.take() {
                    let close = leaf(&part, rule);
                    out.push(Node::Block { open, members: std::mem::take(&mut members), close });
                }
            }
            _ => {
                let mut nodes = Vec::new();
                collect(part, rule, &mut nodes);
                members.push(nodes);
            }
        }
    }
}

/// A number without a unit.
fn is_plain_number(pair: &Pair<'_>) -> bool {
    pair.as_rule() == Rule::primary
        && pair.as_str().trim_end().bytes().all(|byte| byte.is_ascii_digit() || byte == b'.')
}

fn leaf(pair: &Pair<'_>, parent: Rule) -> Token {
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
                    | Rule::method
            );
            (called, true)
        }
        Rule::t_rparen | Rule::t_rbracket | Rule::t_comma | Rule::t_semi | Rule::t_colon => (true, false),
        Rule::t_lbracket | Rule::t_dot => (true, true),
        Rule::op_not => (false, true),
        Rule::op_at_most if parent == Rule::bound => (true, true),
        _ => (false, false),
    };
    let is_unit = matches!(rule, Rule::unit | Rule::point_unit);
    let span = pair.as_span();
    let text = if is_unit { unit(pair.as_str()) } else { pair.as_str().to_owned() };
    Token { text, start: span.start(), end: span.end(), glued_left, glued_right, aligned: false, is_unit }
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
