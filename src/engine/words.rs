//! Certified statements in words.

use crate::stats::{Claim, Coverage, Statement};

/// A number without noise of rounding.
pub(super) fn number(value: f64) -> String {
    if !value.is_finite() {
        return if value > 0.0 { "∞".to_owned() } else { "-∞".to_owned() };
    }
    let magnitude = value.abs();
    let digits = if magnitude == 0.0 || magnitude >= 1e-4 { 1e10 } else { 1e15 };
    let rounded = (value * digits).round() / digits;
    format!("{}", if rounded == 0.0 { 0.0 } else { rounded })
}

/// A number with its unit.
pub(super) fn quantity(value: f64, unit: &str) -> String {
    if unit.is_empty() { number(value) } else { format!("{} {unit}", number(value)) }
}

/// A share as a percentage.
pub(super) fn percent(share: f64) -> String {
    format!("{} %", number(100.0 * share))
}

/// What a test certifies.
pub(super) fn statement(subject: &str, statement: &Statement, unit: &str) -> String {
    let claim = match statement.claim {
        Claim::Above(bound) => format!("{subject} > {}", quantity(bound, unit)),
        Claim::Below(bound) => format!("{subject} < {}", quantity(bound, unit)),
        Claim::Between(low, high) => {
            format!("{} < {subject} < {}", quantity(low, unit), quantity(high, unit))
        }
    };
    format!("{claim}, error at most {}", number(statement.error))
}

/// Kind and level of an interval.
pub(super) fn interval(coverage: Coverage, error: f64) -> String {
    let kind = match coverage {
        Coverage::FixedSize => "fixed size",
        Coverage::Sequential => "sequential, calibrated",
        Coverage::TimeUniform => "time-uniform",
    };
    format!("{kind}, {}", percent(1.0 - error))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_no_noise() {
        assert_eq!(number(0.1 + 0.2), "0.3");
        assert_eq!(number(1e-6), "0.000001");
        assert_eq!(percent(1.0 - 0.05), "95 %");
        let said = statement("P(safe)", &Statement { claim: Claim::Above(0.48), error: 0.01 }, "");
        assert_eq!(said, "P(safe) > 0.48, error at most 0.01");
    }
}
