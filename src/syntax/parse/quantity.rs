//! Numbers and units.

use super::builder::{Builder, Pair};
use super::grammar::Rule;
use crate::base::decimal::Decimal;
use crate::syntax::ast::{Ident, Quantity, UnitExpr, UnitFactor};
use crate::syntax::codes::Code;
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::source::Span;

/// The units of both languages, as in `grammar/common.pest`.
pub(super) const UNITS: [&str; 18] = [
    "m", "cm", "mm", "km", "s", "ms", "min", "h", "kg", "g", "N", "kN", "deg", "rad", "Hz", "%", "step",
    "steps",
];

/// Those of times.
const TIMES: [&str; 6] = ["s", "ms", "min", "h", "step", "steps"];

/// Common spellings of units, and the unit.
const SPOKEN: [(&[&str], &str); 18] = [
    (&["metre", "metres", "meter", "meters", "M"], "m"),
    (&["centimetre", "centimetres", "centimeter", "centimeters"], "cm"),
    (&["millimetre", "millimetres", "millimeter", "millimeters"], "mm"),
    (&["kilometre", "kilometres", "kilometer", "kilometers"], "km"),
    (&["second", "seconds", "sec", "secs", "S"], "s"),
    (&["millisecond", "milliseconds", "msec"], "ms"),
    (&["minute", "minutes", "mins"], "min"),
    (&["hour", "hours", "hr", "hrs"], "h"),
    (&["kilogram", "kilograms", "KG", "Kg"], "kg"),
    (&["gram", "grams"], "g"),
    (&["newton", "newtons", "Newton"], "N"),
    (&["degree", "degrees", "degs", "grad"], "deg"),
    (&["radian", "radians", "rads"], "rad"),
    (&["hertz", "hz", "HZ"], "Hz"),
    (&["mps"], "m/s"),
    (&["kmh", "kph"], "km/h"),
    (&["percent", "pct"], "%"),
    (&["ticks", "tick", "Steps"], "steps"),
];

/// The unit that was probably meant.
pub(super) fn nearest_unit(word: &str) -> Option<&'static str> {
    if let Some((_, unit)) = SPOKEN.iter().find(|(spoken, _)| spoken.contains(&word)) {
        return Some(unit);
    }
    super::nouns::nearest(word, UNITS.iter().copied())
}

/// The unit that a name was probably meant to be, with its power as in `s2`, and whether that is beyond doubt.
pub(crate) fn unit_meant(name: &str) -> Option<(String, bool)> {
    let base = name.trim_end_matches(|c: char| c.is_ascii_digit());
    let power = &name[base.len()..];
    let is_spoken = SPOKEN.iter().any(|(spoken, _)| spoken.contains(&base));
    let unit = UNITS.into_iter().find(|unit| *unit == base).or_else(|| nearest_unit(base))?;
    let is_sure = is_spoken || unit == base;
    Some((if matches!(power, "" | "1") { unit.to_owned() } else { format!("{unit}^{power}") }, is_sure))
}

/// The unit of time that a name behind a bound was probably meant to be, and whether that is beyond doubt.
pub(crate) fn time_meant(name: &str) -> Option<(String, bool)> {
    // They lie near `min` and `ms`, but are words of their own.
    let is_word = super::nouns::is_keyword(name) || name == "is";
    unit_meant(name).filter(|(unit, _)| !is_word && TIMES.contains(&unit.as_str()))
}

impl Builder<'_> {
    /// `0.2 m/s`
    pub(super) fn quantity(&mut self, pair: Pair<'_>) -> Option<Quantity> {
        let mut value = None;
        let mut unit = None;
        for part in pair.into_inner() {
            match part.as_rule() {
                Rule::number => value = Some(self.number(&part)?),
                Rule::unit => unit = Some(self.unit(part)?),
                _ => {}
            }
        }
        if let Some(UnitExpr { factors, span }) = &unit
            && let [UnitFactor { name: Ident { name, .. }, power: 1 }] = factors.as_slice()
            && self.names_a_number(name)
            && !self.diagnostics.iter().any(|one| one.code == Code::W0103)
        {
            let title = format!("`{name}` is read as the unit, but is also a name");
            let warning = Diagnostic::warning(Code::W0103, *span, title);
            self.say(warning.hint(format!("choose another name; for a product write `2 * {name}`")));
        }
        Some(Quantity { value: value?, unit })
    }

    /// `#40`
    pub(super) fn steps(&mut self, pair: &Pair<'_>) -> Option<Quantity> {
        let span = self.span(pair);
        let Some(value) = Decimal::parse(pair.as_str().trim_start_matches('#')) else {
            self.number_too_long(span);
            return None;
        };
        let mark = Span::new(span.source, span.start as usize, span.start as usize + 1);
        let name = Ident { name: "steps".to_owned(), span: mark };
        Some(Quantity {
            value,
            unit: Some(UnitExpr { factors: vec![UnitFactor { name, power: 1 }], span: mark }),
        })
    }

    fn number(&mut self, pair: &Pair<'_>) -> Option<Decimal> {
        let value = Decimal::parse(pair.as_str());
        if value.is_none() {
            let span = self.span(pair);
            self.number_too_long(span);
        }
        value
    }

    fn number_too_long(&mut self, span: Span) {
        self.say(error!(E0110, span, "the number has too many digits";
                hint: "a number can have about 37 digits, including decimals and exponent"));
    }

    /// `kg/(m s)`, of a quantity or a point.
    pub(super) fn unit(&mut self, pair: Pair<'_>) -> Option<UnitExpr> {
        let span = self.span(&pair);
        let mut factors = Vec::new();
        for part in pair.into_inner() {
            match part.as_rule() {
                Rule::percent => factors.push(UnitFactor { name: self.ident(&part), power: 1 }),
                Rule::unit_factor => factors.push(self.unit_factor(&part, 1)?),
                Rule::unit_over => {
                    for below in part.into_inner() {
                        factors.push(self.unit_factor(&below, -1)?);
                    }
                }
                _ => {}
            }
        }
        Some(UnitExpr { factors, span })
    }

    fn unit_factor(&mut self, pair: &Pair<'_>, sign: i32) -> Option<UnitFactor> {
        let start = pair.as_span().start();
        let (name, power) = pair.as_str().split_once('^').unwrap_or((pair.as_str(), "1"));
        let Some(power) = power.parse::<i8>().ok() else {
            let span = self.span(pair);
            self.say(error!(E0110, span, "the power of the unit is too large"));
            return None;
        };
        let span = self.at(start..start + name.len());
        Some(UnitFactor { name: Ident { name: name.to_owned(), span }, power: sign * i32::from(power) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::syntax::parse::{parse_properties, parse_scenario};
    use crate::syntax::source::{Source, SourceId};

    #[test]
    fn a_name_that_is_a_unit_is_told_only_behind_a_number() {
        let source = |text: &str| Source::new(SourceId(0), "a", text);
        let count = |said: &[Diagnostic]| said.iter().filter(|one| one.code == Code::W0103).count();
        for (wanted, text) in [
            (0, "check P(F<=9 s (count(s in sensor: s.works) >= 3)) >= 0.9"),
            (0, "property a = F<=9 s (forall m in all: speed(m) < 2 m/s) & distance(a, b) > 2 m"),
            (0, "const s = 3"),
            (0, "const s = 3\nlet far = 2 * s"),
            (0, "const s = 3\nlet far = 2 m/s"),
            (1, "const s = 3 m\nlet far = 2 s\nlet near = 1 s"),
            (1, "let far = 2 m\nlet m(a) = a + 1"),
            (0, "property s = F<=9 s true"),
        ] {
            let said = parse_properties(&source(text)).1;
            assert_eq!(count(&said), wanted, "{text}\n{said:?}");
        }
        let scenario = |text: &str| count(&parse_scenario(&source(text)).1);
        assert_eq!(scenario("horizon = 9 steps\nprocess s { var m = 3; when m > 2 -> m = 2 }"), 0);
        // A member is no unit.
        assert_eq!(scenario("horizon = 9 s\nprocess s { var m = 3; when m > 2 -> m = 2 }"), 0);
        assert_eq!(scenario("horizon = 9 s\nstep = 1 s\nparam s = 3"), 1);
    }
}
