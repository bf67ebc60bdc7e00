//! Measures as one would say them: `P(safe)`, `Q(0.9, metric)`, and the event that the check of a quantile is decided by.

use crate::compile::context::Context;
use crate::compile::study::{Event, Said};
use crate::syntax::ast::{BinaryOp, Expr, Measure, MeasureKind};

/// A measure and, where a check compares a quantile with a bound, what that is about: `Q <= x` and `Q > x` are settled by
/// P(metric <= x), `Q < x` and `Q >= x` by P(metric < x).
pub(crate) fn said(context: &Context<'_>, measure: &Measure, bound: Option<(BinaryOp, &Expr)>) -> Said {
    let text = context.text(measure.span);
    let inner = inside(&text);
    let letter = match &measure.kind {
        MeasureKind::Probability => "P",
        MeasureKind::Expectation => "E",
        MeasureKind::Quantile(_) => "Q",
        MeasureKind::Tail(_) => "CVaR",
    };
    let (levels, metric) = apart(inner);
    let sign = |relation| if matches!(relation, BinaryOp::AtMost | BinaryOp::Greater) { "<=" } else { "<" };
    let event = bound.filter(|_| letter == "Q").map(|(relation, bound)| Event {
        metric: metric.to_owned(),
        relation: sign(relation).to_owned(),
        bound: context.text(bound.span),
    });
    let measure = match &measure.kind {
        // Of several levels this is one.
        MeasureKind::Quantile(level) | MeasureKind::Tail(level)
            if at_depth_zero(levels, ',').next().is_some() =>
        {
            format!("{letter}({}, {metric})", context.text(level.span))
        }
        _ => format!("{letter}({inner})"),
    };
    Said { measure, event }
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
}
