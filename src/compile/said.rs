//! Measures as one would say them: `P(safe)`, `Q(0.9, metric)`, and the event that the check of a quantile is decided by.

use super::elaborator::Elaborator;
use super::study::{Event, Said};
use crate::syntax::ast::{BinaryOp, Expr, Measure, MeasureKind};

impl Elaborator<'_> {
    /// A measure and, where a check compares a quantile with a bound, what that is about: `Q <= x` and `Q > x` are settled by
    /// P(metric <= x), `Q < x` and `Q >= x` by P(metric < x).
    pub(super) fn said(&self, measure: &Measure, bound: Option<(BinaryOp, &Expr)>) -> Said {
        let text = self.text(measure.span);
        let inner = inside(&text);
        let letter = match &measure.kind {
            MeasureKind::Probability => 'P',
            MeasureKind::Expectation => 'E',
            MeasureKind::Quantile(_) => 'Q',
        };
        let event = bound.filter(|_| letter == 'Q').map(|(relation, bound)| Event {
            metric: after_level(inner).to_owned(),
            relation: if matches!(relation, BinaryOp::AtMost | BinaryOp::Greater) { "<=" } else { "<" },
            bound: self.text(bound.span),
        });
        Said { measure: format!("{letter}({inner})"), event }
    }
}

/// What stands in the first parentheses of a text.
fn inside(text: &str) -> &str {
    let Some(open) = text.find('(') else { return text };
    let inner = &text[open + 1..];
    let end = at_depth_zero(inner, ')').unwrap_or(inner.len());
    inner[..end].trim()
}

/// What follows the level of a quantile.
fn after_level(inner: &str) -> &str {
    at_depth_zero(inner, ',').map_or(inner, |comma| inner[comma + 1..].trim())
}

/// Where a character stands first outside of brackets that open in the text.
fn at_depth_zero(text: &str, wanted: char) -> Option<usize> {
    let mut depth = 0i32;
    for (at, c) in text.char_indices() {
        if c == wanted && depth == 0 {
            return Some(at);
        }
        depth += i32::from(matches!(c, '(' | '[')) - i32::from(matches!(c, ')' | ']'));
    }
    None
}

/// A text without its comments, which end what follows them once lines are joined.
pub(super) fn without_comments(text: &str) -> String {
    let mut left = String::with_capacity(text.len());
    let mut rest = text;
    let mut quoted = false;
    while let Some(c) = rest.chars().next() {
        let skipped = match rest {
            _ if quoted => 0,
            line if line.starts_with("//") => line.find('\n').unwrap_or(line.len()),
            block if block.starts_with("/*") => block.find("*/").map_or(block.len(), |end| end + 2),
            _ => 0,
        };
        if skipped > 0 {
            left.push(' ');
            rest = &rest[skipped..];
            continue;
        }
        // A quote in a text is written `\"`.
        quoted ^= c == '"' && !left.ends_with('\\');
        left.push(c);
        rest = &rest[c.len_utf8()..];
    }
    left
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn measures_are_taken_apart_by_their_brackets() {
        assert_eq!(inside("P (a & (b)) more"), "a & (b)");
        assert_eq!(after_level("min(0.5, 0.9), f(a, b)"), "f(a, b)");
        assert_eq!(after_level("0.5, f(a)"), "f(a)");
    }

    #[test]
    fn comments_go_and_texts_stay() {
        assert_eq!(without_comments("a // b\nc /* d */ e"), "a  \nc   e");
        assert_eq!(without_comments("\"http://a\" // b"), "\"http://a\"  ");
        assert_eq!(without_comments("a /* b"), "a  ");
    }
}
