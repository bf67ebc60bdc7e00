//! The items of a text: each is parsed by itself, so what is wrong in one touches no other.
//!
//! An item ends with its line, or at `;`. It goes on while a round or square bracket is open that is closed before the
//! next brace, and where a line ends, or the next begins, with what cannot end or begin an item: an operator, a comma,
//! an arrow, a word such as `by`. A brace opens a block, which holds items of its own.
//!
//! ```text
//! kind adult: sfm {             one item, `kind adult: sfm { }`, whose block holds three:
//!   mass = normal(75 kg,          a bracket is open, so the second line belongs to it
//!                 10 kg)
//!   noise = 0; speed = 1 m/s      two items on a line
//! }
//! ```

use super::lexeme;
use crate::syntax::keywords;
use std::ops::Range;

/// The mark of a value that cannot be read, as in the grammar.
pub(super) const BROKEN: char = '\u{1A}';

/// A word, number, quoted text or mark.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::syntax) struct Token<'t> {
    /// Its first byte.
    pub(in crate::syntax) at: usize,
    pub(in crate::syntax) text: &'t str,
    /// Whether it is the first of its line.
    pub(in crate::syntax) starts_line: bool,
}

impl Token<'_> {
    /// One past its last byte.
    pub(in crate::syntax) fn end(&self) -> usize {
        self.at + self.text.len()
    }
}

/// A block in braces.
#[derive(Debug)]
pub(in crate::syntax) struct Block {
    /// Byte of the `{`.
    pub(in crate::syntax) open: usize,
    /// Byte of the `}`.
    pub(in crate::syntax) close: usize,
    pub(in crate::syntax) items: Vec<Item>,
}

/// An item of a file or block.
#[derive(Debug)]
pub(in crate::syntax) struct Item {
    /// Its tokens, those of its blocks among them.
    tokens: Range<usize>,
    pub(in crate::syntax) blocks: Vec<Block>,
    /// Bytes of round and square brackets without a partner.
    pub(in crate::syntax) unmatched: Vec<usize>,
}

/// The items of a file.
pub(in crate::syntax) struct Layout<'t> {
    /// Bytes of the text.
    length: usize,
    pub(in crate::syntax) tokens: Vec<Token<'t>>,
    pub(in crate::syntax) items: Vec<Item>,
}

/// The tokens of a text.
pub(in crate::syntax) fn tokens(text: &str) -> Vec<Token<'_>> {
    let (mut found, mut at, mut starts_line) = (Vec::new(), 0, true);
    while at < text.len() {
        let rest = &text[at..];
        if let Some(length) = lexeme::trivia(rest) {
            starts_line |= rest[..length].contains('\n');
            at += length;
            continue;
        }
        let token = lexeme::first(rest);
        found.push(Token { at, text: token, starts_line });
        starts_line = false;
        at += token.len();
    }
    found
}

/// Marks that stand between two parts of an item: neither does a line end with one, nor does an item begin with it.
#[rustfmt::skip]
const BETWEEN: [&str; 26] = [
    "+", "-", "*", "/", "^", "==", "!=", "≠", "<=", "≤", "<", ">=", "≥", ">", "&", "∧", "|", "∨", "=>", "⇒", "<=>", "⇔",
    ",", "->", "--", "..",
];
/// Further marks with which a line does not end, and further ones with which no item begins.
const NEVER_LAST: [&str; 3] = ["=", ":", "!"];
const NEVER_FIRST: [&str; 4] = ["(", ")", "]", "{"];

impl<'t> Layout<'t> {
    /// The items of tokens whose braces pair up.
    pub(in crate::syntax) fn of(text: &str, tokens: Vec<Token<'t>>, in_properties: bool) -> Self {
        let mut split = Split { is_closed: closed(&tokens), tokens: &tokens, in_properties, at: 0 };
        let mut items = Vec::new();
        while split.at < tokens.len() {
            items.extend(split.items());
            split.at += 1;
        }
        Self { length: text.len(), tokens, items }
    }

    /// The tokens as one item without blocks.
    pub(in crate::syntax) fn whole(text: &str, tokens: Vec<Token<'t>>) -> Self {
        let unmatched = (0..tokens.len()).zip(closed(&tokens)).filter(|(_, is_closed)| !is_closed);
        let unmatched = unmatched.map(|(at, _)| tokens[at].at).collect();
        let item = Item { tokens: 0..tokens.len(), blocks: Vec::new(), unmatched };
        Self { length: text.len(), tokens, items: vec![item] }
    }

    /// The bytes of an item.
    pub(in crate::syntax) fn bytes(&self, item: &Item) -> Range<usize> {
        let own = &self.tokens[item.tokens.clone()];
        // A brace that was put in may stand behind the last byte.
        let end = own.last().map_or(0, Token::end).min(self.length);
        own.first().map_or(0, |first| first.at).min(end)..end
    }

    /// The token that follows an item.
    pub(in crate::syntax) fn after(&self, item: &Item) -> Option<&Token<'t>> {
        self.tokens.get(item.tokens.end)
    }

    /// The words of an item, those in its blocks among them.
    pub(in crate::syntax) fn words(&self, item: &Item) -> impl Iterator<Item = &'t str> {
        let own = self.tokens[item.tokens.clone()].iter().map(|token| token.text);
        own.filter(|token| token.starts_with(lexeme::starts_name))
    }

    /// The second token of an item, if it is a word.
    pub(in crate::syntax) fn second_word(&self, item: &Item) -> Option<&'t str> {
        let second = self.tokens[item.tokens.clone()].get(1)?.text;
        second.starts_with(lexeme::starts_name).then_some(second)
    }

    /// An item with blanks for what is no token and for what stands in its blocks, each token as far from the start as in
    /// the text.
    pub(in crate::syntax) fn plain(&self, item: &Item) -> String {
        let mut plain = String::new();
        let start = self.bytes(item).start;
        let mut blocks = item.blocks.iter();
        let mut block = blocks.next();
        let mut at = item.tokens.start;
        while let Some(token) = self.tokens[..item.tokens.end].get(at) {
            let is_late = at > item.tokens.start && token.starts_line;
            pad(&mut plain, token.at - start, is_late);
            plain.push_str(readable(token.text));
            at += 1;
            if let Some(inner) = block.filter(|inner| inner.open == token.at) {
                at += self.tokens[at..].partition_point(|token| token.at < inner.close);
                block = blocks.next();
            }
        }
        plain
    }
}

/// A token, unless it is the mark that the parser puts in for a value.
fn readable(token: &str) -> &str {
    if token.starts_with(BROKEN) { "\u{1B}" } else { token }
}

/// Fills a text with blanks up to a length, a line end among them if one was there.
fn pad(plain: &mut String, length: usize, breaks: bool) {
    if breaks && plain.len() < length {
        plain.push('\n');
    }
    plain.extend(std::iter::repeat_n(' ', length.saturating_sub(plain.len())));
}

/// Whether each token is a bracket that is closed, or closes one, before the next brace.
fn closed(tokens: &[Token<'_>]) -> Vec<bool> {
    let mut is_closed = vec![false; tokens.len()];
    let mut open: Vec<usize> = Vec::new();
    let text = |at: usize| tokens.get(at).map_or("", |token| token.text);
    for (at, token) in tokens.iter().enumerate() {
        match token.text {
            "(" | "[" => open.push(at),
            "{" | "}" => open.clear(),
            // A declaration stands in no bracket.
            word if token.starts_line && keywords::begins(word, text(at + 1)) => open.clear(),
            ")" | "]" => {
                let wanted = if token.text == ")" { "(" } else { "[" };
                if let Some(place) = open.iter().rposition(|&open| tokens[open].text == wanted) {
                    is_closed[open[place]] = true;
                    is_closed[at] = true;
                    open.truncate(place);
                }
            }
            _ => {}
        }
    }
    is_closed
}

/// Tokens on the way to items.
struct Split<'s, 't> {
    tokens: &'s [Token<'t>],
    is_closed: Vec<bool>,
    in_properties: bool,
    at: usize,
}

impl Split<'_, '_> {
    /// The items up to the next `}` that closes what is open, or the end.
    fn items(&mut self) -> Vec<Item> {
        let mut items = Vec::new();
        while let Some(token) = self.tokens.get(self.at) {
            match token.text {
                "}" => break,
                ";" => self.at += 1,
                _ => items.push(self.item()),
            }
        }
        items
    }

    fn item(&mut self) -> Item {
        let start = self.at;
        let (mut blocks, mut unmatched, mut depth) = (Vec::new(), Vec::new(), 0_usize);
        while let Some(token) = self.tokens.get(self.at) {
            let ends = match token.text {
                "}" => true,
                ";" => depth == 0,
                _ => depth == 0 && self.at > start && token.starts_line && !self.goes_on(self.at),
            };
            if ends {
                break;
            }
            match token.text {
                "(" | "[" | ")" | "]" if !self.is_closed[self.at] => unmatched.push(token.at),
                "(" | "[" => depth += 1,
                ")" | "]" => depth -= 1,
                "{" => {
                    self.at += 1;
                    let items = self.items();
                    let close = self.tokens.get(self.at).map_or(token.at + 1, |close| close.at);
                    blocks.push(Block { open: token.at, close, items });
                }
                _ => {}
            }
            self.at += 1;
        }
        Item { tokens: start..self.at.min(self.tokens.len()), blocks, unmatched }
    }

    /// Whether the token that starts a line goes on with the item of the line before.
    fn goes_on(&self, at: usize) -> bool {
        let text = |at: usize| self.tokens.get(at).map_or("", |token| token.text);
        let (before, first, second) = (text(at - 1), text(at), text(at + 1));
        let is_operator = |word: &str| word == "in" || self.in_properties && matches!(word, "U" | "W" | "R");
        // A name that is set begins an item, but for an update and a value of a parameter.
        let sets = second == "=" && !matches!(before, "->" | "|" | ":" | "," | "under" | "with");
        if sets || keywords::begins(first, second) {
            return false;
        }
        BETWEEN.contains(&before)
            || BETWEEN.contains(&first)
            || NEVER_LAST.contains(&before)
            || NEVER_FIRST.contains(&first)
            || is_operator(before)
            || is_operator(first)
            || keywords::continues(first) && second != ":"
    }
}

/// A text with blanks for its comments and for what stands in its blocks.
pub(super) fn hollow(text: &str) -> String {
    let (mut plain, mut depth) = (String::new(), 0_usize);
    for token in tokens(text) {
        let is_outer = depth == 0 || token.text == "}" && depth == 1;
        match token.text {
            "{" => depth += 1,
            "}" => depth = depth.saturating_sub(1),
            _ => {}
        }
        if is_outer {
            let breaks = token.starts_line && !plain.is_empty();
            pad(&mut plain, token.at, breaks);
            plain.push_str(readable(token.text));
        }
    }
    plain
}
