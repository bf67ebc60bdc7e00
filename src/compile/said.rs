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
        let (levels, metric) = apart(inner);
        let event = bound.filter(|_| letter == 'Q').map(|(relation, bound)| Event {
            metric: metric.to_owned(),
            relation: if matches!(relation, BinaryOp::AtMost | BinaryOp::Greater) { "<=" } else { "<" },
            bound: self.text(bound.span),
        });
        let measure = match &measure.kind {
            // Of several levels this is one.
            MeasureKind::Quantile(level) if at_depth_zero(levels, ',').next().is_some() => {
                format!("Q({}, {metric})", self.text(level.span))
            }
            _ => format!("{letter}({inner})"),
        };
        Said { measure, event }
    }
}

/// What stands in the first parentheses of a text.
fn inside(text: &str) -> &str {
    let Some(open) = text.find('(') else { return text };
    let inner = &text[open + 1..];
    let end = at_depth_zero(inner, ')').next().unwrap_or(inner.len());
    inner[..end].trim()
}

/// The levels of a quantile, and what follows them: a metric has no comma outside of brackets.
fn apart(inner: &str) -> (&str, &str) {
    match at_depth_zero(inner, ',').last() {
        Some(comma) => (inner[..comma].trim(), inner[comma + 1..].trim()),
        None => ("", inner),
    }
}

/// Where a character stands outside of brackets that open in the text.
fn at_depth_zero(text: &str, wanted: char) -> impl Iterator<Item = usize> {
    let mut depth = 0i32;
    text.char_indices().filter_map(move |(at, c)| {
        let found = c == wanted && depth == 0;
        depth += i32::from(matches!(c, '(' | '[')) - i32::from(matches!(c, ')' | ']'));
        found.then_some(at)
    })
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
            block if block.starts_with("/*") => block[2..].find("*/").map_or(block.len(), |end| end + 4),
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
        assert_eq!(apart("min(0.5, 0.9), f(a, b)"), ("min(0.5, 0.9)", "f(a, b)"));
        assert_eq!(apart("0.5, 0.9, f(a)"), ("0.5, 0.9", "f(a)"));
        assert_eq!(apart("f(a)"), ("", "f(a)"));
    }

    #[test]
    fn comments_go_and_texts_stay() {
        assert_eq!(without_comments("a // b\nc /* d */ e"), "a  \nc   e");
        assert_eq!(without_comments("\"http://a\" // b"), "\"http://a\"  ");
        assert_eq!(without_comments("a /* b"), "a  ");
        assert_eq!(without_comments("a /*/ b */ c"), "a   c");
    }
}
