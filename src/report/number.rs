//! Numbers for people: no more digits than their interval supports.
//!
//! The first significant digit of half the interval's width decides; a 1 or 2 there allows one digit more,
//! as the Particle Data Group rounds. Ends are rounded outwards, so that the printed interval contains the
//! computed one.

use crate::engine::outcome::Interval;
use crate::stats::Estimate;

/// Below this all numbers of an interval are written with an exponent.
const SMALL: f64 = 1e-4;
/// The width of an interval, as a share of its largest number, below which it is rounding.
const NARROW: f64 = 1e-9;
/// Significant digits of a number without an uncertainty.
const EXACT: usize = 6;
/// Seconds of a minute and of an hour.
const MINUTE: f64 = 60.0;
const HOUR: f64 = 3600.0;

/// An estimate and its interval, ready to print.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Printed {
    /// The estimate.
    pub estimate: String,
    /// `[low, high]`
    pub interval: String,
}

#[derive(Clone, Copy, PartialEq)]
enum Round {
    Nearest,
    Down,
    Up,
}

/// Prints a number with its interval. Numbers beyond the horizon read `> 30`.
pub fn interval(value: &Interval, horizon: Option<f64>) -> Printed {
    let Interval { estimate, low, high } = *value;
    let largest = largest(value);
    let decimals = decimals(value);
    let show = |x: f64, round: Round| {
        if x == f64::INFINITY {
            return horizon.map_or_else(|| "∞".to_owned(), |h| format!("> {}", plain(h)));
        }
        if x == f64::NEG_INFINITY {
            return "-∞".to_owned();
        }
        match decimals {
            _ if !x.is_finite() => "?".to_owned(),
            _ if x == 0.0 => "0".to_owned(),
            _ if largest < SMALL => scientific(x, round),
            Some(decimals) => fixed(x, decimals, round),
            // Without a width six digits serve, rounded outwards where they are not exact but for rounding.
            None if plain(x).parse().is_ok_and(|y: f64| (x - y).abs() <= NARROW * largest) => plain(x),
            None => match round {
                Round::Nearest => plain(x),
                outwards => fixed(x, (5 - leading(x).1).clamp(0, 12) as usize, outwards),
            },
        }
    };
    Printed {
        estimate: show(estimate, Round::Nearest),
        interval: format!("[{}, {}]", show(low, Round::Down), show(high, Round::Up)),
    }
}

/// Prints an estimate of the bootstrap, a number of units: `94 % [84, 99] %`. Without an interval it has three
/// significant digits.
pub fn estimated(found: &Estimate, unit: &str) -> String {
    let Some([low, high]) = found.interval else { return format!("{}{unit}", rounded(found.value, 2)) };
    let printed = interval(&Interval { estimate: found.value, low, high }, None);
    format!("{}{unit} {}{unit}", printed.estimate, printed.interval)
}

/// Prints an estimate as `estimated` does, or a dash where there is none.
pub fn maybe_estimated(found: Option<Estimate>, unit: &str) -> String {
    found.map_or_else(|| "-".to_owned(), |found| estimated(&found, unit))
}

/// The largest magnitude of the finite numbers.
fn largest(value: &Interval) -> f64 {
    let Interval { estimate, low, high } = *value;
    [estimate, low, high].into_iter().filter(|x| x.is_finite()).fold(0.0, |m: f64, x| m.max(x.abs()))
}

/// Decimal places that an interval supports; `None` where it has no width.
fn decimals(value: &Interval) -> Option<usize> {
    let Interval { estimate, low, high } = *value;
    let half = match (low.is_finite(), high.is_finite()) {
        (true, true) => 0.5 * (high - low),
        (true, false) if estimate.is_finite() => estimate - low,
        (false, true) if estimate.is_finite() => high - estimate,
        _ => return None,
    };
    if half <= NARROW * largest(value) || !half.is_finite() {
        return None;
    }
    let (leading, exponent) = leading(half);
    let decimals = -exponent + i32::from(leading <= 2);
    Some(decimals.clamp(0, 12) as usize)
}

/// First significant digit and decimal exponent.
fn leading(x: f64) -> (u8, i32) {
    let text = format!("{:.5e}", x.abs());
    let digit = text.bytes().next().map_or(0, |b| b.saturating_sub(b'0'));
    let exponent = text.split_once('e').and_then(|(_, e)| e.parse().ok()).unwrap_or(0);
    (digit, exponent)
}

/// The exponent of a positive number in decimal digits.
pub(super) fn exponent(x: f64) -> i32 {
    format!("{x:e}").split_once('e').and_then(|(_, digits)| digits.parse().ok()).unwrap_or(0)
}

/// A power of ten.
pub(super) fn power(exponent: i32) -> f64 {
    format!("1e{exponent}").parse().unwrap_or(1.0)
}

fn fixed(x: f64, decimals: usize, round: Round) -> String {
    let print = |x: f64| {
        let text = format!("{x:.decimals$}");
        if text.bytes().all(|b| matches!(b, b'-' | b'0' | b'.')) { text.replace('-', "") } else { text }
    };
    let nearest = print(x);
    let Ok(value) = nearest.parse::<f64>() else { return nearest };
    let unit = power(-(decimals as i32));
    match round {
        Round::Down if value > x => print(value - unit),
        Round::Up if value < x => print(value + unit),
        _ => nearest,
    }
}

/// Two significant digits with an exponent.
fn scientific(x: f64, round: Round) -> String {
    let nearest = format!("{x:.1e}");
    let Ok(value) = nearest.parse::<f64>() else { return nearest };
    let unit = power(leading(value).1 - 1);
    match round {
        Round::Down if value > x => format!("{:.1e}", value - unit),
        Round::Up if value < x => format!("{:.1e}", value + unit),
        _ => nearest,
    }
}

/// A number known exactly: at most six significant digits, without trailing zeros.
pub fn plain(x: f64) -> String {
    if x == 0.0 || !x.is_finite() {
        return if x.is_finite() { "0".into() } else { x.to_string() };
    }
    let (_, exponent) = leading(x);
    if !(-4..15).contains(&exponent) {
        return format!("{x:e}");
    }
    let text = format!("{x:.*}", (EXACT as i32 - 1 - exponent).max(0) as usize);
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// A number in four significant digits, without trailing zeros.
pub fn brief(x: f64) -> String {
    rounded(x, 3)
}

/// A number with so many digits after the first significant one, without trailing zeros.
fn rounded(x: f64, digits: usize) -> String {
    plain(format!("{x:.digits$e}").parse().unwrap_or(x))
}

/// Rounded to thousandths: seconds to 1 ms, metres to 1 mm. A zero has no sign.
pub fn thousandths(x: f64) -> f64 {
    (x * 1000.0).round() / 1000.0 + 0.0
}

/// A count with commas: `1,234,567`.
pub fn count(n: u64) -> String {
    let digits = n.to_string();
    let mut text = String::with_capacity(digits.len() + digits.len() / 3);
    for (k, digit) in digits.chars().enumerate() {
        if k > 0 && (digits.len() - k).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// A count and its noun: `1 trial`, `2 trials`.
pub fn counted(n: u64, noun: &str) -> String {
    format!("{} {noun}{}", count(n), if n == 1 { "" } else { "s" })
}

/// A count and what is so many times: `2 unresolved`; nothing of none.
pub fn some(n: u64, what: &str) -> String {
    if n == 0 { String::new() } else { format!("{} {what}", count(n)) }
}

/// The unit in which people read a quantity of about this size, and how many of the given unit it has: times from 2 min
/// on in minutes, from 2 h on in hours.
pub fn readable(unit: &str, size: f64) -> (&str, f64) {
    match (unit, size.abs()) {
        ("s", size) if size.is_finite() && size >= 2.0 * HOUR => ("h", HOUR),
        ("s", size) if size.is_finite() && size >= 2.0 * MINUTE => ("min", MINUTE),
        _ => (unit, 1.0),
    }
}

/// A moment of a trial, to the last digit: `3.42 s`, `6 min 12.5 s`, `2 h 0 min 3 s`.
pub fn clock(seconds: f64) -> String {
    if !seconds.is_finite() || seconds < 2.0 * MINUTE {
        return format!("{} s", plain(seconds));
    }
    let (hours, minutes) = ((seconds / HOUR).floor(), (seconds / MINUTE).floor());
    let rest = format!("{} min {} s", minutes - 60.0 * hours, plain(thousandths(seconds - MINUTE * minutes)));
    if hours > 0.0 { format!("{hours} h {rest}") } else { rest }
}

/// Events in a second: whole ones, and one significant digit below 1.
pub fn rate(x: f64) -> String {
    if x < 0.95 { rounded(x, 0) } else { count(x.round() as u64) }
}

/// A duration: `21 ms`, `1.32 s`, `2 min 5 s`.
pub fn duration(seconds: f64) -> String {
    if !seconds.is_finite() || seconds < 0.0 {
        "?".into()
    } else if seconds < 0.000_999_5 {
        format!("{:.0} µs", seconds * 1e6)
    } else if seconds < 0.999_5 {
        format!("{:.0} ms", seconds * 1e3)
    } else if seconds < 99.95 {
        format!("{seconds:.2} s")
    } else {
        let whole = seconds.round() as u64;
        format!("{} min {} s", whole / 60, whole % 60)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn printed(estimate: f64, low: f64, high: f64) -> String {
        let p = interval(&Interval { estimate, low, high }, Some(30.0));
        format!("{} {}", p.estimate, p.interval)
    }

    #[test]
    fn digits_follow_the_interval() {
        assert_eq!(printed(0.939_393, 0.841_2, 0.981_3), "0.94 [0.84, 0.99]");
        assert_eq!(printed(0.874_123, 0.864_9, 0.883_1), "0.874 [0.864, 0.884]");
        assert_eq!(printed(0.5, 0.4, 0.6), "0.50 [0.40, 0.60]");
        assert_eq!(printed(12345.6, 12000.0, 13000.0), "12346 [12000, 13000]");
        assert_eq!(printed(-0.001, -0.04, 0.03), "0.00 [-0.04, 0.03]");
    }

    #[test]
    fn nothing_seen_is_a_bound_and_never_plus_minus_nothing() {
        assert_eq!(printed(0.0, 0.0, 3.688_9e-6), "0 [0, 3.7e-6]");
        assert_eq!(printed(1e-5, 6.19e-6, 8.767e-5), "1.0e-5 [6.1e-6, 8.8e-5]");
        assert_eq!(printed(0.0, 0.0, 0.008), "0 [0, 0.008]");
    }

    #[test]
    fn a_width_of_rounding_gives_no_digits() {
        assert_eq!(printed(19.0, 18.999_999_999_999, 19.000_000_000_001), "19 [19, 19]");
        assert_eq!(printed(0.3, 0.1 + 0.2, 0.3), "0.3 [0.3, 0.3]");
        assert_eq!(printed(1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0), "0.333333 [0.333333, 0.333334]");
        assert_eq!(printed(19.0, 18.999_999, 19.000_001), "19.0000000 [18.9999990, 19.0000010]");
        assert_eq!(
            [0.0, 6.0 / 48.55, 0.007, 0.96, 3.4, 1234.5].map(rate),
            ["0", "0.1", "0.007", "1", "3", "1,235"]
        );
    }

    #[test]
    fn beyond_the_horizon_is_said_so() {
        assert_eq!(printed(f64::INFINITY, 28.3, f64::INFINITY), "> 30 [28.3, > 30]");
        assert_eq!(printed(20.0, 18.0, f64::INFINITY), "20.0 [18.0, > 30]");
        assert_eq!(printed(7.25, 7.25, 7.25), "7.25 [7.25, 7.25]");
        assert_eq!(printed(f64::NAN, f64::NEG_INFINITY, 1.0), "? [-∞, 1]");
    }

    #[test]
    fn counts_and_durations() {
        assert_eq!(count(0), "0");
        assert_eq!(count(1_234_567), "1,234,567");
        assert_eq!(counted(1, "trial"), "1 trial");
        assert_eq!(
            [3e-6, 0.021, 0.9999, 1.324, 125.0, f64::NAN].map(duration),
            ["3 µs", "21 ms", "1.00 s", "1.32 s", "2 min 5 s", "?"]
        );
        assert_eq!([-0.013_390_7, 13.0785, 30.0, 12_345.6].map(brief), ["-0.01339", "13.08", "30", "12350"]);
        assert_eq!(
            [3.42, 119.5, 372.5, 7203.0].map(clock),
            ["3.42 s", "119.5 s", "6 min 12.5 s", "2 h 0 min 3 s"]
        );
        assert_eq!([119.0, 120.0, 7200.0].map(|x| readable("s", x).0), ["s", "min", "h"]);
        assert_eq!([readable("m", 1e9), readable("s", f64::INFINITY)], [("m", 1.0), ("s", 1.0)]);
        let rounded = [2.800_000_000_000_000_3, -0.000_4, -7.149_6, 0.1 + 0.2].map(thousandths);
        assert_eq!(rounded.map(|x| x.to_string()), ["2.8", "0", "-7.15", "0.3"]);
        assert_eq!([0.05, 1e-7, 30.0, 2_093.0, 0.1 + 0.2].map(plain), ["0.05", "1e-7", "30", "2093", "0.3"]);
    }

    proptest! {
        #[test]
        fn the_printed_interval_contains_the_computed_one(
            away in -1e3..1e3_f64, exponent in -9..6_i32, share in 0.0..1.0_f64, width in 1.0..10.0_f64
        ) {
            let width = width * format!("1e{exponent}").parse::<f64>().unwrap();
            // In proportion to the width, so that rounding a double is nothing beside it.
            let low = away * width;
            let value = Interval { estimate: low + share * width, low, high: low + width };
            let text = interval(&value, None).interval;
            let (a, b) = text.trim_matches(['[', ']']).split_once(", ").unwrap();
            let (a, b) = (a.parse::<f64>().unwrap(), b.parse::<f64>().unwrap());
            prop_assert!(a <= low && b >= value.high, "{text} for {value:?}");
            // Numbers with an exponent have two digits, whatever the width.
            let wide = b - a > 1.4 * width;
            prop_assert!(!wide || text.contains('e'), "{text} is much wider than {value:?}");
        }
    }
}
