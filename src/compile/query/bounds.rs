//! What errors and widths of procedures may be: as far as a result with them says anything, and as far as the
//! procedures go.

use crate::compile::context::{Context, Lowered};
use crate::compile::dimension::Dimension;
use crate::compile::query::measures::{Sketch, What};
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::source::Span;

/// An error probability of 0.5 carries no information. Two errors below it sum to less than 1, without which a sequential
/// test has no region to sample in.
const COIN: f64 = 0.5;

/// Least half width of an interval, as a part of what the measure ranges over.
const NARROWEST: f64 = 1e-5;

/// Largest half width of an interval of one measure, in the same parts: that is all there is.
pub(crate) const WIDEST: f64 = 0.5;

/// A probability of error, below one half.
pub(crate) fn error_of(
    context: &mut Context<'_>,
    value: Option<(f64, Span)>,
    default: f64,
    name: &str,
) -> Lowered<f64> {
    match value {
        None => Ok(default),
        Some((value, _)) if value > 0.0 && value < COIN => Ok(value),
        Some((value, span)) => {
            let error = error!(E0604, span, "`{name}` must be between 0 and 0.5 (got {value})");
            let hint = if value >= COIN {
                "an error probability of 0.5 or more carries no information; write for example 0.01 or 0.05"
            } else {
                "no number of trials excludes every error; write for example 0.01 or 0.05"
            };
            context.report(error.hint(hint))
        }
    }
}

/// A half width, in the unit of the measure, must be a legal part of what the measure ranges over.
pub(crate) fn width(
    context: &mut Context<'_>,
    (epsilon, at): (f64, Span),
    sketch: Sketch,
    widest: f64,
) -> Lowered<f64> {
    let (range, ranged, dimension) = match sketch {
        Sketch { what: What::Probability | What::Curve, .. } => (1.0, None, Dimension::NONE),
        Sketch {
            what: What::Expectation | What::Tail,
            range: Some((range, at)),
            dimension: Some(dimension),
            ..
        } => (range.1 - range.0, Some(at), dimension),
        // Without a range there is nothing to compare the width with.
        _ if epsilon > 0.0 || sketch.what == What::Quantile => return Ok(epsilon),
        _ => {
            return context.report(error!(E0604, at, "the width must be positive (got {epsilon})"));
        }
    };
    let part = epsilon / range;
    if (NARROWEST..=widest).contains(&part) {
        return Ok(epsilon);
    }
    if epsilon <= 0.0 {
        return context.report(error!(E0604, at, "the width must be positive (got {epsilon})"));
    }
    let unit = if dimension.is_none() { String::new() } else { format!(" {dimension}") };
    let (word, end, hint) = if part < NARROWEST {
        let hint = "such a narrow interval needs too many trials; write a larger width";
        ("at least", NARROWEST * range, hint)
    } else {
        ("at most", widest * range, "such a wide interval carries no information; write a smaller width")
    };
    let said = format!("the width must be {word} {end}{unit} (got {epsilon}{unit})");
    let error = error!(E0604, at, "{said}"; hint: "{hint}");
    context.report(ranged.into_iter().fold(error, Diagnostic::hanging_on))
}
