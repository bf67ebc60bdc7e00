//! Certified statements in words.

use crate::base::tick::{Clock, Tick};
use crate::compile::study::{Measure, MeasureKind, Query, Said};
use crate::stats::{Claim, Coverage, Statement};

/// Largest number that is written with an exponent, for the many zeros it would begin with.
const TINY: f64 = 1e-9;

/// A number without noise of rounding: to ten places, and a small one to ten digits.
pub(in crate::engine) fn number(value: f64) -> String {
    if !value.is_finite() {
        return as_it_is(value);
    }
    let rounded = if value.abs() < 1e-4 {
        format!("{value:.9e}").parse().unwrap_or(value)
    } else {
        (value * 1e10).round() / 1e10
    };
    // What is too large to be counted in such places is whole.
    as_it_is(if rounded.is_finite() { rounded } else { value })
}

/// A number with all its digits.
fn as_it_is(value: f64) -> String {
    if value.is_nan() {
        return "NaN".to_owned();
    }
    if !value.is_finite() {
        return if value > 0.0 { "∞".to_owned() } else { "-∞".to_owned() };
    }
    if value == 0.0 {
        return "0".to_owned();
    }
    if value.abs() < TINY { format!("{value:e}") } else { format!("{value}") }
}

/// Largest power of ten by which digits are counted.
const LARGEST_SCALE: f64 = 1e300;

/// A number with its unit.
pub(in crate::engine) fn quantity(value: f64, unit: &str) -> String {
    if unit.is_empty() { number(value) } else { format!("{} {unit}", number(value)) }
}

/// A number with four digits, and its unit.
pub(in crate::engine) fn brief(value: f64, unit: &str) -> String {
    if value == 0.0 || !value.is_finite() {
        return quantity(value, unit);
    }
    let scale = scale(value, 1_000.0, 1e9);
    quantity((value * scale).round() / scale, unit)
}

/// The ends of an interval with no more digits than its width supports, rounded outward.
pub(in crate::engine) fn ends(low: f64, high: f64, unit: &str) -> String {
    let width = high - low;
    if !(width.is_finite() && width > 0.0) {
        return format!("{} .. {}", quantity(low, unit), quantity(high, unit));
    }
    // Two digits of the width.
    let scale = scale(width, 10.0, LARGEST_SCALE);
    // All digits that are left are written: rounding them to the nearest once more could make the interval narrower.
    let end = |scaled: f64, given: f64| {
        let said = as_it_is(if scaled.is_finite() { scaled / scale } else { given });
        if unit.is_empty() { said } else { format!("{said} {unit}") }
    };
    format!("{} .. {}", end((low * scale).floor(), low), end((high * scale).ceil(), high))
}

/// A bound with four digits, rounded upward or downward.
pub(in crate::engine) fn rounded(value: f64, upward: bool, unit: &str) -> String {
    let scale = if value == 0.0 { 1.0 } else { scale(value, 1_000.0, LARGEST_SCALE) };
    let scaled = value * scale;
    quantity(if upward { scaled.ceil() } else { scaled.floor() } / scale, unit)
}

/// A bound, rounded upward to three digits.
pub fn at_most(value: f64) -> f64 {
    three_digits(value, f64::ceil)
}

/// A bound, rounded downward to three digits.
pub(in crate::engine) fn at_least(value: f64) -> f64 {
    three_digits(value, f64::floor)
}

/// The power of ten, from 1 up to `most`, that brings the size of a number to `least`.
fn scale(value: f64, least: f64, most: f64) -> f64 {
    let mut scale = 1.0;
    while value.abs() * scale < least && scale < most {
        scale *= 10.0;
    }
    scale
}

fn three_digits(value: f64, round: impl Fn(f64) -> f64) -> f64 {
    if !(value.is_finite() && value > 0.0) {
        return value;
    }
    let scale = scale(value, 100.0, LARGEST_SCALE);
    // A number that has so few digits already stays as it is; and so does one that is smaller than any scale.
    let scaled = value * scale;
    if scaled < 100.0 || (scaled - scaled.round()).abs() < 1e-9 { value } else { round(scaled) / scale }
}

/// What a query is about as it is decided: the check of a quantile, `check Q(0.9, m) <= 15 s`, as `P(m <= 15 s)`.
pub(in crate::engine) fn decided(said: &Said) -> String {
    said.event.as_ref().map_or_else(|| said.measure.clone(), |event| format!("P({event})"))
}

/// What the decided check of a quantile certifies, if that is about the level it asks for: the claim about the
/// quantile, and what was tested.
pub(in crate::engine) fn quantile(said: &Said, level: f64, statement: &Statement) -> Option<String> {
    let event = said.event.as_ref()?;
    // The q-quantile is at most x exactly if P(m <= x) >= q. It is below x if P(m < x) > q, and not if P(m < x) < q; at
    // equality it may be either, so one of the two claims is true there as well.
    let (relation, beyond) = match (statement.claim, event.relation.as_str()) {
        (Claim::AtLeast(theta), "<=") if theta == level => ("<=", ">="),
        (Claim::Below(theta), "<=") if theta == level => (">", "<"),
        (Claim::Above(theta), "<") if theta == level => ("<", ">"),
        (Claim::AtMost(theta), "<") if theta == level => (">=", "<="),
        _ => return None,
    };
    Some(format!(
        "{} {relation} {}, tested as P({event}) {beyond} {}, error at most {}",
        said.measure,
        event.bound,
        number(level),
        error(statement.error)
    ))
}

/// An expectation of a metric that was clipped to its range: `E(m, clipped to 0 s .. 20 s)`.
pub(in crate::engine) fn clipped(said: &str, (low, high): (f64, f64), unit: &str) -> String {
    let inner = said.strip_suffix(')').unwrap_or(said);
    format!("{inner}, clipped to {} .. {})", quantity(low, unit), quantity(high, unit))
}

/// A probability of error in three digits, rounded upward.
pub(in crate::engine) fn error(error: f64) -> String {
    number(at_most(error))
}

/// The level that an error leaves, as a percentage, rounded downward: never more than is true. One of more nines than
/// anybody counts is said by what it lacks, `1 - 1e-22`.
pub(in crate::engine) fn level(error: f64) -> String {
    let percent = 100.0 * at_most(error);
    if !(percent > 0.0 && percent < 100.0) {
        return format!("{} %", number(100.0 - percent));
    }
    if error < 1e-11 {
        return format!("1 - {}", self::error(error));
    }
    // As many places as the three digits of the error have.
    let (mut places, mut scale) = (0usize, 1.0);
    while places < 12 && (percent * scale - (percent * scale).round()).abs() > 1e-9 * percent * scale {
        places += 1;
        scale *= 10.0;
    }
    format!("{:.places$} %", 100.0 - percent)
}

/// A time of a trial.
pub(in crate::engine) fn moment(clock: Clock, at: Tick) -> String {
    match clock {
        Clock::Steps => format!("step {}", at.0),
        clock => quantity(clock.seconds(at), "s"),
    }
}

/// Values of parameters, as the label of a side.
pub(in crate::engine) fn settings(settings: &[(String, String)]) -> String {
    settings.iter().map(|(name, value)| format!("{name} = {value}")).collect::<Vec<_>>().join(", ")
}

/// Of a condition; "holds" and "fails" are said of what was asked.
pub(in crate::engine) const fn truth(value: bool) -> &'static str {
    if value { "is true" } else { "is false" }
}

/// A condition and its truth.
pub(in crate::engine) fn condition((text, value): (&str, bool)) -> String {
    format!("`{text}` {}", truth(value))
}

/// A condition and what it was decided by: "`slow` is true because `v < 1 m/s` is true". What is the condition itself says
/// nothing more.
pub(in crate::engine) fn because((text, value): (&str, bool), grounds: &[String]) -> String {
    let whole = condition((text, value));
    if grounds.is_empty() || grounds.contains(&whole) {
        return whole;
    }
    format!("{whole} because {}", grounds.join(" and "))
}

/// What a test certifies.
pub(in crate::engine) fn statement(prepared: &str, statement: &Statement, unit: &str) -> String {
    let claim = match statement.claim {
        Claim::Above(bound) => format!("{prepared} > {}", quantity(bound, unit)),
        Claim::AtLeast(bound) => format!("{prepared} >= {}", quantity(bound, unit)),
        Claim::Below(bound) => format!("{prepared} < {}", quantity(bound, unit)),
        Claim::AtMost(bound) => format!("{prepared} <= {}", quantity(bound, unit)),
        Claim::Between(low, high) => {
            format!("{} < {prepared} < {}", quantity(low, unit), quantity(high, unit))
        }
    };
    format!("{claim}, error at most {}", self::error(statement.error))
}

/// Kind and level of an interval.
pub(in crate::engine) fn interval(coverage: Coverage, error: f64) -> String {
    let kind = match coverage {
        Coverage::FixedSize => "fixed size",
        Coverage::Sequential => "sequential",
        Coverage::TimeUniform => "time-uniform",
    };
    format!("{kind}, {}", level(error))
}

/// The measure as one would say it: `P(safe)`. Where trials left the declared range, what is known of the expectation
/// is known of the clipped metric alone, and is said of that.
pub(in crate::engine) fn measured(query: &Query, measure: &Measure, cut: u64) -> String {
    match &measure.kind {
        MeasureKind::Probability => decided(&query.said),
        MeasureKind::Quantile { .. } | MeasureKind::Curve { .. } => query.said.measure.clone(),
        MeasureKind::Expectation { range, dimension, .. } => {
            let said = &query.said.measure;
            if cut == 0 { said.clone() } else { clipped(said, *range, &dimension.to_string()) }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compile::study::Event;

    #[test]
    fn checks_of_quantiles_certify_quantiles() {
        let of = |relation: &str| Said {
            measure: "Q(0.9, f(a))".to_owned(),
            event: Some(Event {
                metric: "f(a)".to_owned(),
                relation: relation.to_owned(),
                bound: "3 m".to_owned(),
            }),
        };
        let said = |relation, claim| quantile(&of(relation), 0.9, &Statement { claim, error: 0.01 });
        let below = Claim::Below(0.9);
        assert_eq!(
            said("<", Claim::AtMost(0.9)).unwrap(),
            "Q(0.9, f(a)) >= 3 m, tested as P(f(a) < 3 m) <= 0.9, error at most 0.01"
        );
        assert_eq!(
            said("<", Claim::Above(0.9)).unwrap(),
            "Q(0.9, f(a)) < 3 m, tested as P(f(a) < 3 m) > 0.9, error at most 0.01"
        );
        assert_eq!(
            said("<=", Claim::AtLeast(0.9)).unwrap(),
            "Q(0.9, f(a)) <= 3 m, tested as P(f(a) <= 3 m) >= 0.9, error at most 0.01"
        );
        assert_eq!(
            said("<=", below).unwrap(),
            "Q(0.9, f(a)) > 3 m, tested as P(f(a) <= 3 m) < 0.9, error at most 0.01"
        );
        // An indifference region certifies another level.
        assert_eq!(said("<=", Claim::Above(0.88)), None);
        let plain = Said { measure: "P(a)".to_owned(), event: None };
        assert_eq!(quantile(&plain, 0.9, &Statement { claim: below, error: 0.01 }), None);
        assert_eq!((decided(&plain).as_str(), decided(&of("<")).as_str()), ("P(a)", "P(f(a) < 3 m)"));
    }

    #[test]
    fn clipped_metrics_are_said_to_be() {
        assert_eq!(clipped("E(time_until(a))", (0.0, 20.0), "s"), "E(time_until(a), clipped to 0 s .. 20 s)");
    }

    #[test]
    fn ends_are_rounded_outward() {
        assert_eq!(ends(0.066_677, 0.105_317, ""), "0.066 .. 0.106");
        assert_eq!(ends(-0.106_7, 0.216_35, "m"), "-0.11 m .. 0.22 m");
        assert_eq!(ends(1.0, f64::INFINITY, "s"), "1 s .. ∞ s");
        assert_eq!(
            (rounded(1.310_386, true, "m"), rounded(-0.031_04, false, "")),
            ("1.311 m".into(), "-0.03104".into())
        );
        assert_eq!((at_most(0.019_923_3), at_most(0.02)), (0.02, 0.02));
        assert_eq!(at_most(0.049_169_9), 0.0492);
    }

    /// However small an error or a bound is, it is not said to be nothing, and no level is all.
    #[test]
    fn small_ones_are_not_rounded_away() {
        assert_eq!([1e-22, 1.2341e-13, 5e-324].map(error), ["1e-22", "1.24e-13", "5e-324"]);
        assert_eq!(
            [1e-22, 1.2341e-13, 1e-11, 2e-11, 1.234e-10].map(level),
            ["1 - 1e-22", "1 - 1.24e-13", "99.999999999 %", "99.999999998 %", "99.9999999876 %"]
        );
        assert_eq!((at_least(3.456e-15), at_most(3.456e-15)), (3.45e-15, 3.46e-15));
        assert_eq!(number(at_least(3.456e-15)), "3.45e-15");
        assert_eq!([1e-9, 9.87e-10, -1.5e-20].map(number), ["0.000000001", "9.87e-10", "-1.5e-20"]);
        assert_eq!(rounded(1.234_56e-18, true, "m"), "1.235e-18 m");
        assert_eq!(rounded(1.234_56e-18, false, ""), "1.234e-18");
        assert_eq!(ends(1.23e-15, 7.89e-15, ""), "1.2e-15 .. 7.9e-15");
        // Narrow, and not small: outward all the same.
        let (low, high) = (0.499_999_999_999, 0.500_000_000_003_6);
        let said = ends(low, high, "");
        let (from, to) = said.split_once(" .. ").unwrap();
        let (from, to) = (from.parse::<f64>().unwrap(), to.parse::<f64>().unwrap());
        assert!(from <= low && high <= to && to - from < 2.0 * (high - low), "{said}");
    }

    #[test]
    fn numbers_have_no_noise() {
        assert_eq!(number(0.1 + 0.2), "0.3");
        assert_eq!(number(1e-6), "0.000001");
        assert_eq!(
            [0.05, 0.01, 0.05 / 3.0, 0.005, 1e-9].map(level),
            ["95 %", "99 %", "98.33 %", "99.5 %", "99.9999999 %"]
        );
        assert_eq!([0.05, 0.05 / 3.0, 1.0 / 3.0].map(error), ["0.05", "0.0167", "0.334"]);
        assert_eq!([0.0, -0.0, 123_456.789].map(number), ["0", "0", "123456.789"]);
        assert!(number(1e300).starts_with("1000"));
        let said = statement("P(safe)", &Statement { claim: Claim::Above(0.48), error: 0.01 }, "");
        assert_eq!(said, "P(safe) > 0.48, error at most 0.01");
    }
}
